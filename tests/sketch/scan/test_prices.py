"""What readings of ink on paper owe where they say it less precisely than it was drawn."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from sketch.page.pieces import Page
from sketch.scan.strokes.prices import Prices, lines
from sketch.scan.strokes.ways import Way
from sketch.scoring import Fitted

PEN = 4.0
CORNERS = np.array([[40.0, 40.0], [400.0, 40.0], [400.0, 120.0], [40.0, 120.0]])


def along(*corners: tuple[float, float]) -> NDArray[np.float64]:
    """A point a pixel along some corners."""
    parts = [
        np.linspace(a, b, round(float(np.hypot(*np.subtract(b, a)))), endpoint=False)
        for a, b in pairwise(corners)
    ]
    return np.concatenate([*parts, [corners[-1]]])


def owed(beyond: NDArray[np.float64], *, by_itself: bool) -> float:
    """Nats that a box owes for what goes on from one of its sides."""
    three, side = along((400, 120), (40, 120), (40, 40), (400, 40)), along((400, 40), (400, 120))
    whole = Way(np.concatenate([side, beyond[1:]]), {1: side, 2: beyond})
    ways = [Way(three, {0: three}), whole, *([Way(beyond, {2: beyond})] if by_itself else [])]
    page = Page()
    page.add([way.points for way in ways])
    page.settle()
    prices = Prices(page, ways, 2, lines(ways, PEN), PEN)
    box = Fitted("rectangle", (0, 1), 30.0, CORNERS, 17.0, scale=100.0)
    taken = prices.of((0, 1))
    assert taken is not None
    return taken.freely - 30.0 - prices.gain(box, taken, -np.inf)


def test_a_hook_beyond_a_corner_is_part_of_its_side() -> None:
    """Shorter than a side, and open, it is nothing by itself that would be said more precisely."""
    hook = along((400, 120), (398, 127), (394, 128))
    assert owed(hook, by_itself=True) == pytest.approx(owed(hook, by_itself=False), abs=1.0)


def test_a_ring_at_a_corner_is_no_part_of_its_side() -> None:
    turn = np.linspace(-np.pi / 2, 1.5 * np.pi, 40)
    ring = np.array([400.0, 126.0]) + 6 * np.stack([np.cos(turn), np.sin(turn)], 1)
    ring[-1] = ring[0]
    assert owed(ring, by_itself=True) > owed(ring, by_itself=False) + 20.0
