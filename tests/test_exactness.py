"""The engine keeps to the error it was asked for, on every case whose motion is known."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim import Scene, simulate
from sim.bench.cases import CASES, Case, case_error

SAMPLES = Path(__file__).resolve().parent.parent / "samples"


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_the_tolerance_is_kept(case: Case) -> None:
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        run = simulate(case.scene, case.duration, tolerance=tolerance)
        assert case_error(case, run.times, run.positions, run.angles) <= 3 * tolerance


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_the_rate_of_samples_does_not_change_the_motion(case: Case) -> None:
    """Samples are read off the motion; they do not make it."""
    coarse, fine = (simulate(case.scene, case.duration, fps=fps, tolerance=1e-8) for fps in (20, 140))
    assert np.max(np.abs(coarse.positions - fine.positions[::7][: len(coarse)])) < 1e-7


def bits(name: str) -> str:
    run = simulate(Scene.load(SAMPLES / f"{name}.json"), duration=10.0)
    return hashlib.sha256(run.positions.tobytes() + run.angles.tobytes()).hexdigest()[:16]


@pytest.mark.parametrize("name", ["billiard-break", "cradle-of-steel"])
def test_the_same_scene_gives_the_same_bits(name: str) -> None:
    """In one process again, and in another with its own addresses and hashes."""
    code = f"from tests.test_exactness import bits; print(bits({name!r}))"
    other = subprocess.run(
        [sys.executable, "-c", code], cwd=SAMPLES.parent, capture_output=True, text=True, check=True
    )
    assert bits(name) == bits(name) == other.stdout.strip()
