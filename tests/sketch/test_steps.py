"""Outlines with corners that turn inward, and outlines of which a file has the corners alone."""

import numpy as np
import pytest

from sketch import recognize
from sketch.ink import Sketch, Stroke
from sketch.synthetic import HANDS, outline
from tests.benchmarks.drawings import overlap

HOUSE = [(0, 0), (200, 0), (200, 200), (100, 300), (0, 200)]
HEXAGON = [(0, 0), (150, 0), (200, 100), (150, 200), (0, 200), (-50, 100)]


def steps(count: int) -> list[tuple[float, float]]:
    """A flight of steps, 300 pixels wide and high."""
    one = 300 / count
    corners = [(0.0, 0.0), (300.0, 0.0)]
    for k in range(1, count + 1):
        corners += [(300 - (k - 1) * one, k * one), (300 - k * one, k * one)]
    return corners


def share_read(corners: list[tuple[float, float]], strokes: list[np.ndarray]) -> float:
    """How much of what is meant and of what is read is in both."""
    readings = recognize(Sketch([Stroke(s) for s in strokes], width=1000, height=700)).readings
    assert len(readings) == 1
    assert readings[0].kind == "polygon"
    return overlap(np.array(corners, float), readings[0].outline)


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("hand", ["neat", "quick", "shaky", "pieces"])
def test_a_flight_of_steps_is_no_ramp(hand, count):
    corners = [(300 + x, 200 + y) for x, y in steps(count)]
    for seed in range(4):
        strokes = outline(corners, HANDS[hand], np.random.default_rng(seed))
        # a ramp over all steps, or as much beside them as within, has 0.75 to 0.8 of them
        assert share_read(corners, strokes) > 0.87, seed


@pytest.mark.parametrize("first", range(5))
@pytest.mark.parametrize("corners", [HOUSE, HEXAGON], ids=["house", "hexagon"])
def test_corners_alone_are_the_outline_between_them(corners, first):
    corners = [(300 + x, 200 + y) for x, y in np.roll(corners, first, axis=0).tolist()]
    assert share_read(corners, [np.array([*corners, corners[0]])]) > 0.99
