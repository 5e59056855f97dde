"""Hatching: short straight strokes side by side, as alike as one hand makes them in a row. It says what is ground, and
is no part of an outline that it begins at."""

from __future__ import annotations

from collections.abc import Set

import numpy as np

from sketch.page.pieces import Page

__all__ = ["hatching"]

FEWEST = 5  # strokes of a row
BUT = 2  # strokes of a row, at most, that may mean something by themselves
STRAIGHT = 0.05  # of its length: how far a stroke is off a line, at most
LONG = 0.9  # of its length: how far apart its ends are, at least
LONGER = 1.8  # times that a stroke is as long as the next one, at most
PARALLEL = 0.35  # sine of the angle between a stroke and the next, at most
ASIDE = 0.15, 2.5  # of a stroke's length: how far the next one is beside it, at least and at most
AHEAD = 1.5  # of a stroke's length: how far the next one is ahead of it, at most


def hatching(page: Page, largest: float, idle: Set[int]) -> set[int]:
    """The strokes of a page that are hatching.

    largest: [pixels]; longer ones are none.  idle: those that mean nothing by themselves.
    """
    if len(idle) < FEWEST - BUT:
        return set()
    live = np.fromiter(page.pieces, dtype=np.intp)
    length, gap = page.strokes.measure[live][:, [0, 5]].T
    off = np.sqrt(page.strokes.residual[live, 1])
    may_be = live[(gap < largest) & (gap > LONG * length) & (off < STRAIGHT * length)].tolist()
    if len(idle & set(may_be)) < FEWEST - BUT:
        return set()
    straight = [page.pieces[i] for i in may_be]
    ends = np.array([p.ends for p in straight]) @ (1, 1j)
    ways, middles = ends[:, 1] - ends[:, 0], (ends[:, 0] + ends[:, 1]) / 2
    longs = np.abs(ways)
    found, left = set[int](), np.ones(len(straight), dtype=bool)
    for start, p in enumerate(straight):
        if p.index not in idle or not left[start]:
            continue
        left[start] = False
        row = [start]
        for k in row:  # it grows meanwhile
            along = (middles - middles[k]) * ways[k].conjugate() / longs[k] ** 2
            across, ahead = np.abs(along.imag), np.abs(along.real)
            turn = np.abs((ways * ways[k].conjugate()).imag) / (longs * longs[k])
            next_to = left & (turn < PARALLEL) & (across > ASIDE[0]) & (across < ASIDE[1]) & (ahead < AHEAD)
            next_to &= np.maximum(longs, longs[k]) < LONGER * np.minimum(longs, longs[k])
            left &= ~next_to
            row += np.flatnonzero(next_to).tolist()
        its = {straight[k].index for k in row}
        if len(its) >= FEWEST and len(its & idle) >= len(its) - BUT:
            found |= its
    return found
