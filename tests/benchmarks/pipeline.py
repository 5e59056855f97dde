"""The whole way, process by process: from a drawing or a scene to a video and to numbers.

Every figure is that of a whole process, started afresh: the least CPU and the least wall time of several runs
that take turns with what they are compared with.  `sketchsim bench pipeline` prints the table.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cli
from cli.arguments import Parser, whole_number

__all__ = ["main"]

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
PLAIN = Path(__file__).with_name("plain_script.py")
RUNS = 5

# Four bodies that have come to rest before three seconds are over.
RESTING: dict[str, Any] = {
    "gravity": [0, -9.81],
    "bodies": [
        {
            "id": name,
            "shape": {"type": "rectangle", "size": size},
            "position": at,
            "angle": angle,
            "anchored": name == "floor",
        }
        for name, size, at, angle in (
            ("floor", [12, 0.5], [6.4, -6.5], 0.0),
            ("low", [1, 1], [4, -5.7], 0.0),
            ("high", [0.8, 0.8], [4, -4.2], 0.0),
            ("tilted", [1.2, 0.6], [7, -3], 0.5),
            ("other", [0.7, 0.7], [9.5, -2], 0.2),
        )
    ],
    "view": {"pixels_per_metre": 100, "width": 1280, "height": 720},
}

# The same with a wheel on a pivot that turns for ever: every frame is a new one.
WHEEL: dict[str, Any] = {
    "id": "wheel",
    "shape": {"type": "circle", "radius": 0.5},
    "position": [2, -2],
    "angular_velocity": 5,
}
TURNING = {
    **RESTING,
    "bodies": [*RESTING["bodies"], WHEEL],
    "joints": [{"type": "pivot", "bodies": ["wheel", None], "position": [2, -2]}],
}


@dataclass
class Measured:
    """The least times of the processes that ran one command [s]."""

    cpu: float = float("inf")
    wall: float = float("inf")
    walls: list[float] = field(default_factory=list)

    def run(self, argv: list[str]) -> None:
        began = time.perf_counter()
        process = os.posix_spawn(
            sys.executable,
            [sys.executable, *argv],
            os.environ,
            file_actions=[(os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_WRONLY, 0) for stream in (1, 2)],
        )
        _, status, used = os.wait4(process, 0)
        wall = time.perf_counter() - began
        if status != 0:
            raise RuntimeError(f"exit status {os.waitstatus_to_exitcode(status)} of: {' '.join(argv)}")
        self.walls.append(wall)
        self.wall = min(self.wall, wall)
        self.cpu = min(self.cpu, used.ru_utime + used.ru_stime)


def take_turns(commands: dict[str, list[str]], runs: int) -> dict[str, Measured]:
    """Run the commands in turn, `runs` times each."""
    measured = {name: Measured() for name in commands}
    for _ in range(runs):
        for name, argv in commands.items():
            measured[name].run(argv)
    return measured


def main(argv: list[str]) -> int:
    parser = Parser(prog="sketchsim bench pipeline", description=__doc__)
    parser.add_argument(
        "--runs",
        type=whole_number(1, 1000),
        default=RUNS,
        help="of each command, of which the least times count",
    )
    parser.add_argument("--sketches", type=whole_number(1, 100_000), default=200, help="in the batch")
    options = parser.parse_args(argv)
    # The processes run the package that runs this, be it the source or an installed one.
    os.chdir(Path(cli.__file__).resolve().parents[1])
    with tempfile.TemporaryDirectory() as folder:
        videos(Path(folder), options.runs)
        data(Path(folder), options.runs)
        batch(Path(folder), options.sketches)
    return 0


def videos(folder: Path, runs: int) -> None:
    cart = folder / "cart.json"
    sketchsim("recognize", SAMPLES / "cart.json", "-o", cart)
    resting, turning = folder / "resting.json", folder / "turning.json"
    resting.write_text(json.dumps(RESTING))
    turning.write_text(json.dumps(TURNING))
    out = folder / "out.mp4"
    measured = take_turns(
        {
            "plain": [str(PLAIN), str(cart), str(out)],
            "cart": ["-m", "cli", "simulate", str(SAMPLES / "cart.json"), "-q", "-o", str(out)],
            "resting": ["-m", "cli", "simulate", str(resting), "-q", "-o", str(out)],
            "turning": ["-m", "cli", "simulate", str(turning), "-q", "-o", str(out)],
        },
        runs,
    )
    plain = measured["plain"]
    print(f"{'10 s, 60 fps, 1280x720':<48}{'CPU':>8}{'wall':>8}      of the plain script's")
    for name, title, wanted in (
        ("plain", "plain script (pymunk, cv2, mp4v), scene JSON", ""),
        ("cart", "samples/cart.json (strokes) to .mp4", "(at most 0.6 and 0.5)"),
        ("turning", "boxes that fall, and a wheel that turns", ""),
        ("resting", "the same without the wheel: at rest before 3 s", ""),
    ):
        m = measured[name]
        print(
            f"{title:<48}{m.cpu:7.2f}s{m.wall:7.2f}s"
            f"     {m.cpu / plain.cpu:5.2f} CPU {m.wall / plain.wall:5.2f} wall  {wanted}".rstrip()
        )
    share = measured["resting"].cpu / measured["turning"].cpu
    print(f"{'at rest, of with the wheel':<48}{share:8.2f}                             (at most 0.4)")


def data(folder: Path, runs: int) -> None:
    scene, out = folder / "cart.json", folder / "out.npz"
    names = sorted(path.stem for path in SAMPLES.glob("*.json") if b'"strokes"' in path.read_bytes())
    scenes = {}
    for name in names:
        scenes[name] = folder / f"{name}-scene.json"
        sketchsim("recognize", SAMPLES / f"{name}.json", "-o", scenes[name])
    columns = ("strokes to scene", "scene to .npz", "scene to .json")
    print("\nat most 200 ms of wall time for a scene, 150 ms for a motion")
    print(f"{'10 s; CPU and wall':<20}" + "".join(f"{column:>24}" for column in columns))
    for name in names:
        measured = take_turns(
            {
                "read": ["-m", "cli", "recognize", str(SAMPLES / f"{name}.json"), "-o", str(scene)],
                "npz": ["-m", "cli", "simulate", str(scenes[name]), "-q", "-o", str(out)],
                "json": ["-m", "cli", "simulate", str(scenes[name]), "-q", "-o", "-"],
            },
            max(2, runs - 2),
        )
        times = ((measured[key].cpu * 1e3, measured[key].wall * 1e3) for key in ("read", "npz", "json"))
        print(f"{name:<20}" + "".join(f"{cpu:14.0f} {wall:6.0f} ms" for cpu, wall in times))


def batch(folder: Path, count: int) -> None:
    """How busy the cores are with many sketches: the samples over and over, each a little larger or smaller."""
    drawn = [json.loads(path.read_bytes()) for path in sorted(SAMPLES.glob("*.json"))]
    drawn = [sketch for sketch in drawn if "strokes" in sketch]
    lines = folder / "sketches.jsonl"
    with lines.open("w") as f:
        for k in range(count):
            sketch = dict(drawn[k % len(drawn)])
            factor = 0.9 + 0.2 * k / count
            sketch["strokes"] = [
                {"points": [[x * factor, y * factor] for x, y, *_ in stroke["points"]]}
                for stroke in sketch["strokes"]
            ]
            print(json.dumps(sketch), file=f)
    measured = Measured()
    measured.run(["-m", "cli", "batch", str(lines), "-q", "-o", str(folder / "runs")])
    cores = len(os.sched_getaffinity(0))
    written = len(list((folder / "runs").glob("*.npz")))
    busy = measured.cpu / (measured.wall * cores)
    print(
        f"\nbatch: {written} of {count} sketches in {measured.wall:.1f} s, {cores} cores busy {busy:.0%} (at least 90%)"
    )


def sketchsim(*argv: object) -> None:
    Measured().run(["-m", "cli", *map(str, argv)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
