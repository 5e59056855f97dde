"""Samples are read off the motion and do not make it, and every process makes the same."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim import Scene, simulate
from sim.bench.cases import CASES, Case

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_the_rate_of_samples_does_not_change_the_motion(case: Case) -> None:
    coarse, fine = (simulate(case.scene, case.duration, fps=fps, tolerance=1e-8) for fps in (20, 140))
    assert np.max(np.abs(coarse.positions - fine.positions[::7][: len(coarse)])) < 1e-7


def bits(name: str) -> str:
    run = simulate(Scene.load(ROOT / "samples" / f"{name}.json"), duration=10.0)
    return hashlib.sha256(run.positions.tobytes() + run.angles.tobytes()).hexdigest()


@pytest.mark.parametrize("name", ["billiard-break", "cradle-of-steel"])
def test_another_process_gives_the_same_bits(name: str) -> None:
    """With other addresses and hashes."""
    code = f"from tests.sim.test_sampling import bits; print(bits({name!r}))"
    other = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert bits(name) == other.stdout.strip()
