"""Strokes of a brush: drawing programs write the filled outline of what a pen left, not where it went."""

from __future__ import annotations

import numpy as np

from sketch.typing import Array

__all__ = ["centre_line"]

# By judgement, on outlines made of known strokes (tests/sketch/test_brush.py).
FEWEST = 16  # corners of such an outline: ready shapes have fewer
THICKEST = 0.25  # of the stroke's length; and
OF_PAGE = 0.012  # of the page's diagonal: a broad pen, but no body
PAIRS = 48  # of points of the two sides, to find the ends
STEP, MOST = 5.0, 400  # between the points of the stroke [pixels], and how many there are
ASKEW = 0.1  # of the length that two points across from each other may differ in, as an inner side is shorter
STARTS = np.linspace(-0.02, 0.02, 9)  # where the pen may have begun and
ENDS = np.linspace(0.4, 0.6, 41)  # where it may have ended, as shares of the way around


def centre_line(outline: Array, diagonal: float) -> Array | None:
    """Where the pen went that left a closed outline (n, 2), shape (m, 2); None where it is no pen's.

    The outline begins at one end of the stroke, runs along its one side to the other end, and back along the other
    side.  The ends are where the two sides, each cut into as many equal parts, lie nearest to each other; then every
    point's partner is the nearest one about there.

    diagonal: of the page, in the outline's unit.
    """
    if len(outline) < FEWEST:
        return None
    ring = np.concatenate([outline, outline[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    length = float(along[-1])
    if length == 0:
        return None
    share = np.linspace(0, 1, PAIRS)
    start, end = STARTS[:, None, None], ENDS[None, :, None]
    there = _at(ring, along, start + (end - start) * share)
    back = _at(ring, along, start + 1 - (1 + start - end) * share)
    apart = np.hypot(*np.moveaxis(there - back, -1, 0))  # (starts, ends, pairs)
    best = np.unravel_index(int(np.argmin(apart.mean(axis=2))), apart.shape[:2])
    start, end = STARTS[best[0]], ENDS[best[1]]
    count = int(np.clip(length / 2 / STEP, PAIRS, MOST))
    ahead, behind = np.linspace(0, 1, count), np.linspace(0, 1, 3 * count)
    left = _at(ring, along, start + (end - start) * ahead)
    right = _at(ring, along, start + 1 - (1 + start - end) * behind)
    gaps = np.hypot(*(left[:, None] - right[None]).transpose(2, 0, 1))
    gaps[np.abs(ahead[:, None] - behind[None]) > ASKEW] = np.inf
    if float(gaps.min(axis=1).max()) > min(THICKEST * length / 2, OF_PAGE * diagonal):
        return None
    middle: Array = (left + right[gaps.argmin(axis=1)]) / 2
    return middle


def _at(ring: Array, along: Array, share: Array) -> Array:
    """Points at shares of the way around a ring, whole turns more or less."""
    where = (share % 1.0) * along[-1]
    return np.stack([np.interp(where, along, ring[:, k]) for k in range(2)], axis=-1)
