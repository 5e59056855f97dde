"""A longer run begins as a shorter one does, to the bit: nothing that is decided on the way hangs on its length."""

from __future__ import annotations

import numpy as np
import pytest

from sim import Scene, simulate
from sim.bench.cases import CASES, Case
from tests.sim.test_closed_box import boxed
from tests.sim.test_random_scenes import room


def assert_begins_as(scene: Scene, short: float, long: float, fps: float, tolerance: float) -> None:
    a = simulate(scene, short, fps, tolerance=tolerance)
    b = simulate(scene, long, fps, tolerance=tolerance)
    n = len(a.times)
    assert n < len(b.times)
    for name in ("positions", "angles", "velocities", "angular_velocities", "energy"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name)[:n], err_msg=name)
    assert a.events == [e for e in b.events if e.time <= a.times[-1]]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_known_motion(case: Case) -> None:
    assert_begins_as(case.scene, 0.4 * case.duration, case.duration, 60.0, 1e-5)


@pytest.mark.parametrize("seed", range(6))
def test_machines_in_a_room(seed: int) -> None:
    assert_begins_as(room(np.random.default_rng(seed)), 1.5, 5.0, 60.0, 1e-4)


@pytest.mark.parametrize("seed", [3, 7, 12, 13, 14, 38])  # these go to the crowd and come back
@pytest.mark.parametrize("fps", [60.0, 23.976])
def test_closed_boxes(seed: int, fps: float) -> None:
    assert_begins_as(boxed(seed), 3.0, 5.0, fps, 1e-4)
