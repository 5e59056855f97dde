"""Outlines of sides and arcs, in one stroke or two: what is round of them is no polygon's side."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import page

from sketch import recognize
from sketch.kernel import course_around
from sketch.synthetic import HANDS, curve

Array = NDArray[np.float64]

HAND = [(name, seed) for name in ("neat", "quick") for seed in range(3)]
BASE, CORNER = [(150.0, 0.0), (-150.0, 0.0)], [(0.0, -200.0), (0.0, 0.0), (-200.0, 0.0)]


def arc(x: float, y: float, radius: float, begin: float, end: float) -> Array:
    t = np.linspace(begin, end, 40)
    return np.stack([x + radius * np.cos(t), y + radius * np.sin(t)], axis=1)


HALF_DISC = arc(0, 0, 150, math.pi, 2 * math.pi), BASE
QUARTER = arc(0, 0, 200, math.pi, 1.5 * math.pi), CORNER
# where an arc meets a straight side is found as little by the corners of its best polygon as how deep it is
RAMP = (
    arc(150, -150, 300, 0.5 * math.pi, math.pi),
    [(-150.0, -150.0), (-210.0, -150.0), (-210.0, 210.0), (150.0, 210.0)],
)


def along(corners: Array) -> Array:
    """Places in equal steps along a line, and its corners."""
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    t = np.union1d(np.linspace(0, at[-1], 60), at)
    return np.stack([np.interp(t, at, corners[:, k]) for k in (0, 1)], axis=1)


@pytest.mark.parametrize("shape", [HALF_DISC, QUARTER, RAMP], ids=["half disc", "quarter disc", "ramp"])
@pytest.mark.parametrize("angle", [0.0, 0.9])
@pytest.mark.parametrize(("name", "seed"), HAND)
def test_what_bows_like_an_arc_is_followed(shape, angle: float, name: str, seed: int) -> None:
    c, s = math.cos(angle), math.sin(angle)
    first, second = (np.array(part) @ [[c, s], [-s, c]] + (640, 360) for part in shape)
    second = np.concatenate([first[-1:], second, first[:1]])
    rng = np.random.default_rng(seed)
    strokes = [s for part in (first, second) for s in curve(along(part), HANDS[name], rng)]
    (reading,) = recognize(page(strokes)).readings
    assert len(reading.outline) > 8
    around = along(np.concatenate([reading.outline, reading.outline[:1]]))
    meant = along(np.concatenate([first, second]))
    assert np.hypot(*(around[:, None] - meant).transpose(2, 0, 1)).min(axis=1).max() < 25


def test_what_two_strokes_have_beyond_their_corners_is_cut_off() -> None:
    t = np.linspace(0, 1, 50)[:, None]
    a, b, c = np.array([[0.0, 0.0], [300.0, 0.0], [150.0, 240.0]])
    first = np.concatenate([a + t * (b - a), b + t[1:] * (c - b)])
    beyond, before = c + 0.05 * (c - b), c + 0.06 * (c - a)
    got = course_around([np.concatenate([first, [beyond]]), before + t * (a - before)])
    assert got is not None
    assert np.hypot(*(got[:, None] - [a, b, c]).transpose(2, 0, 1)).min(axis=1).max() < 1
    twice = np.concatenate([first, c + t * (a - c)])
    assert course_around([twice, twice + 5]) is None
