"""Whole sketches and exact motions, measured on ink and cases that are not part of the project.

    python .ci/accept.py SHARED

Fails if one of the rates or errors is worse than the floor beside it.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from sim import InputError
from sketch import load_sketch, recognize

SKETCHES = 180
RIGHT = {"strokes": 0.98, "scan": 0.94}  # share of whole sketches, at least
EXACT = {"S1_": 1e-9, "S2_": 1e-9, "S9_": 1e-5}  # error [m] at tolerance 1e-6, at most
ELSE = 1e-6


def run(*command: object) -> str:
    return subprocess.run(
        [sys.executable, *map(str, command)], check=True, capture_output=True, text=True
    ).stdout


def read(job: tuple[Path, Path]) -> None:
    source, target = job
    try:
        target.write_bytes(recognize(load_sketch(source)).scene.to_json())
    except InputError as e:
        print(f"{source.name}: {e}", file=sys.stderr)


def share_right(corpus: Path, sketches: list[Path], truth: Path, scenes: Path) -> float:
    scenes.mkdir()
    with ProcessPoolExecutor() as pool:
        list(pool.map(read, [(path, scenes / f"{path.stem}.json") for path in sketches], chunksize=8))
    report = run(corpus / "score.py", truth, scenes)
    print(report)
    match = re.search(r"wholly right (\d+)/(\d+)", report)
    assert match is not None
    return int(match[1]) / int(match[2])


def recognition(corpus: Path, work: Path) -> dict[str, float]:
    truth = work / "sketches.jsonl"
    run(corpus / "compose.py", "--count", SKETCHES, "--seed", 11, "--out", truth)
    strokes = work / "strokes"
    strokes.mkdir()
    for line in truth.read_text().splitlines():
        sketch = json.loads(line)
        del sketch["truth"]
        (strokes / f"{sketch['id']}.json").write_text(json.dumps(sketch))
    rates = {"strokes": share_right(corpus, sorted(strokes.glob("*.json")), truth, work / "from-strokes")}

    pictures = work / "pictures"
    run(corpus / "scan.py", truth, pictures, "--kind", "scan")
    moved = work / "scans.jsonl"
    moved.write_text("".join(path.read_text() + "\n" for path in sorted(pictures.glob("*.json"))))
    rates["scan"] = share_right(corpus, sorted(pictures.glob("*.jpg")), moved, work / "from-scans")
    return rates


def inexact(physics: Path) -> list[str]:
    """Cases with a known motion whose error is larger than asked; crowds have none, and show nan."""
    table = run(physics / "check.py", "--repeat", 1)
    print(table)
    rows = [line.split() for line in table.splitlines() if line.startswith("S")]
    asked = {name: EXACT.get(name[: name.index("_") + 1], ELSE) for name, *_ in rows}
    known = {name: float(error) for name, error, *_ in rows if error != "nan"}
    return [name for name, error in known.items() if not error <= asked[name]] if known else ["no case ran"]


def main() -> int:
    shared = Path(sys.argv[1])
    poor = []
    with tempfile.TemporaryDirectory() as work:
        for kind, rate in recognition(shared / "corpus", Path(work)).items():
            print(f"{kind}: {rate:.1%} wholly right, at least {RIGHT[kind]:.0%} asked")
            poor += [kind] if rate < RIGHT[kind] else []
    poor += inexact(shared / "physics")
    if poor:
        print("worse than asked:", ", ".join(poor))
    return 1 if poor else 0


if __name__ == "__main__":
    sys.exit(main())
