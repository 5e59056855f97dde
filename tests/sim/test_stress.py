"""A quick part of the stress suite: what holds of every hard scene."""

import numpy as np
import pytest

from sim import simulate
from sim.bench.stress import main, measure, overlap
from sim.bench.stress_scenes import cases, random_cases

QUICK = [
    c
    for c in cases()
    if not any(
        part in c.name
        for part in ("chain of 100", "bridge", "hour", "pyramid", "hills", "an hour", "sideways")
    )
]


def run(scene, duration, fps):
    return simulate(scene, duration, fps)


@pytest.mark.parametrize("case", QUICK, ids=lambda c: c.name)
def test_hard_scenes_stay_sane(case):
    m = measure(case._replace(duration=min(case.duration, 3.0)), run)
    assert m.finite
    assert m.growth < 1e-3
    assert not m.momentum > 1e-9  # nan where something outside acts
    assert m.drift < 0.01
    assert m.seconds < 5


def test_an_hour_at_rest_costs_nothing_and_moves_nothing():
    case = next(c for c in cases() if "hour" in c.name)
    result = simulate(case.scene, case.duration, 0.1)
    assert np.ptp(result.positions, axis=0).max() == 0
    assert measure(case, run).seconds < 0.5


@pytest.mark.parametrize("case", random_cases(40), ids=lambda c: c.name)
def test_scenes_as_sketches_have_them(case):
    m = measure(case, run)
    assert m.finite
    assert m.growth < 1e-2
    assert m.depth < 0.05
    assert m.drift < 0.05
    assert m.seconds < 3


def test_overlap_of_simple_pairs():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    assert overlap((square, 0), (np.add(square, (0.75, 0.1)), 0)) == pytest.approx(0.25)
    assert overlap((square, 0), (np.array([[1.5, 0.5]]), 0.75)) == pytest.approx(0.25)
    assert overlap((np.zeros((1, 2)), 1.0), (np.array([[0.0, 1.5]]), 1.0)) == pytest.approx(0.5)
    assert overlap((square, 0), (np.add(square, (1.25, 0)), 0)) == pytest.approx(-0.25)


def test_the_table_is_printed(capsys):
    assert main(["--only", "corner"]) == 0
    out = capsys.readouterr().out.splitlines()
    assert len(out) == 3
    assert "corner on corner" in out[1]
    assert "pymunk" in out[2]
