"""Outlines of any course beside quadrilaterals: a hill turns between its corners, a round-cornered box at them."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import box, page

from sketch import recognize
from sketch.kernel import depth
from sketch.shapes.closed import fit_closed
from sketch.synthetic import HANDS, Hand, curve, outline

Array = NDArray[np.float64]


def hill(high: float, steep: float) -> Array:
    """A bell on a flat base, closed: steep below 1 its sides are steep, above 1 its feet run out."""
    t = np.linspace(0, np.pi, 60)
    top = np.stack([640 - 420 * np.cos(t), 620 - high * np.sin(t) ** steep], axis=1)
    side, base = np.linspace(top[-1], (1060, 670), 8), np.linspace((1060, 670), (220, 670), 60)
    return np.concatenate([top, side, base, top[:1]])


def of_steps(stroke: Array, count: int) -> Array:
    """So many points of a stroke in equal steps."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(stroke, axis=0).T))])
    t = np.linspace(0, along[-1], count)
    return np.stack([np.interp(t, along, stroke[:, k]) for k in (0, 1)], axis=1)


def outlined(stroke: Array) -> Array:
    (reading,) = recognize(page([stroke])).readings
    return reading.outline


def sides(stroke: Array) -> int:
    return len(outlined(stroke))


def off(stroke: Array) -> float:
    """How far the outline that a stroke was read as is from its ink, short of hooks, and its corners are: at most, as
    a share of the ink's height."""
    outline = outlined(stroke)
    ink = [abs(depth(x, y, outline)) for x, y in of_steps(stroke, 400).tolist()]
    corners = np.hypot(*(outline[:, None] - of_steps(stroke, 400)).transpose(2, 0, 1)).min(axis=1)
    return max(float(np.quantile(ink, 0.97)), float(corners.max())) / float(np.ptp(stroke[:, 1]))


@pytest.mark.parametrize("hand", [HANDS["neat"], HANDS["shaky"]], ids=["neat", "shaky"])
@pytest.mark.parametrize("steep", [0.7, 1.0, 1.3])
@pytest.mark.parametrize("high", [170, 240])
def test_a_hill_is_no_quadrilateral_however_many_its_points(high: float, steep: float, hand: Hand) -> None:
    for seed in range(3):
        (stroke,) = curve(hill(high, steep), hand, np.random.default_rng(seed))
        for ink in (stroke, of_steps(stroke, 400), 4 * stroke):
            assert sides(ink) > 4


def test_the_outline_of_a_hill_follows_its_ink() -> None:
    close = 0
    for high, steep, seed in itertools.product([170, 240], [1.0, 1.3], range(8)):
        (stroke,) = curve(hill(high, steep), HANDS["neat"], np.random.default_rng(seed))
        close += sum(off(ink) < 0.03 for ink in (stroke, of_steps(stroke, 400), 4 * stroke))
    assert close >= 92, close  # of 96


@pytest.mark.parametrize("rounding", [0.15, 0.25])
@pytest.mark.parametrize("size", [(300, 200), (400, 120)])
def test_a_box_with_rounded_corners_has_four(size: tuple[float, float], rounding: float) -> None:
    hand = replace(HANDS["neat"], rounding=rounding, parts=(1,))
    for seed in range(4):
        (stroke,) = outline(box(500, 300, *size), hand, np.random.default_rng(seed))
        assert sides(stroke) == sides(of_steps(stroke, 400)) == 4


def test_the_turning_of_a_box_is_at_its_corners_and_that_of_a_hill_is_not() -> None:
    square = of_steps(np.array([*box(0, 0, 200, 150), (-100, -75)], dtype=float), 200)
    assert fit_closed([square], 0.5, 24.0, np.inf).turning[4] == pytest.approx(1.0, abs=0.02)
    assert fit_closed([hill(200, 1.0)], 0.5, 24.0, np.inf).turning[4] < 0.75
