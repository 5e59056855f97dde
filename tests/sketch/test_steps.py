"""A flight of steps: its ink is as near to the ramp over it as a careless hand's would be."""

import numpy as np
import pytest

from sketch import recognize
from sketch.ink import Sketch, Stroke
from sketch.synthetic import HANDS, outline
from tests.benchmarks.drawings import overlap


def steps(count: int) -> list[tuple[float, float]]:
    """A flight of steps, 300 pixels wide and high."""
    one = 300 / count
    corners = [(0.0, 0.0), (300.0, 0.0)]
    for k in range(1, count + 1):
        corners += [(300 - (k - 1) * one, k * one), (300 - k * one, k * one)]
    return corners


def share_read(corners: list[tuple[float, float]], strokes: list[np.ndarray]) -> float:
    """How much of what is meant and of what is read is in both."""
    (reading,) = recognize(Sketch([Stroke(s) for s in strokes], width=1000, height=700)).readings
    assert reading.kind == "polygon"
    return overlap(np.array(corners, float), reading.outline)


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("hand", ["neat", "quick", "shaky", "pieces"])
def test_a_flight_of_steps_is_no_ramp(hand, count):
    corners = [(300 + x, 200 + y) for x, y in steps(count)]
    for seed in range(4):
        strokes = outline(corners, HANDS[hand], np.random.default_rng(seed))
        # a ramp over all steps, or as much beside them as within, has 0.75 to 0.8 of them
        assert share_read(corners, strokes) > 0.87, seed
