"""A short run of the fuzz target, under the sanitizers: random bytes make scenes, and they run."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SEEDS = 100


@pytest.mark.slow
def test_random_bytes_make_scenes_that_run(tmp_path: Path) -> None:
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no compiler that has the sanitizers")
    sources = [str(path) for path in sorted((ROOT / "sim/core").glob("*.c"))]
    built = tmp_path / "fuzz"
    flags = ["-g", "-O1", "-std=c11", "-ffp-contract=off", f"-DSEEDS={SEEDS}"]
    sanitize = ["-fsanitize=address,undefined", "-fno-sanitize-recover=undefined"]
    target = str(ROOT / "tests/sim/fuzz_scene.c")
    subprocess.run([compiler, *flags, *sanitize, *sources, target, "-o", str(built), "-lm"], check=True)
    run = subprocess.run([str(built)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr[-2000:]
    assert run.stdout == f"{SEEDS} scenes ran\n"
