"""What a pin may join besides bodies: open lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sketch.scoring import Fitted

__all__ = ["PINNED", "is_pinned"]

PINNED = 3.0  # times as large as a pivot is what it joins, at least: the stem of an "a" is shorter
# of a ring's extent: a line so near to its middle goes through it, and is no ground that it lies on
THROUGH = 0.25


def is_pinned(line: Fitted, long: float, ring: Fitted, extent: float) -> bool:
    """Whether an open line of other ink, of extent `long`, ends in a ring of extent `extent` or goes through it
    [pixels]."""
    if PINNED * extent >= long or not set(ring.pieces).isdisjoint(line.pieces):
        return False
    at, points = ring.middle, line.outline.tolist()
    gap = min(math.dist(at, points[0]), math.dist(at, points[-1]))
    if gap < extent or gap > long + extent:  # no point of the line is further from its ends than it is long
        return gap < extent
    return any(_distance(at, a, b) < THROUGH * extent for a, b in pairwise(points))


def _distance(at: Sequence[float], a: Sequence[float], b: Sequence[float]) -> float:
    """How far a point is from the segment between two others."""
    (x, y), (ax, ay), (u, v) = at, a, (b[0] - a[0], b[1] - a[1])
    t = ((x - ax) * u + (y - ay) * v) / max(u * u + v * v, 1e-9)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(ax + t * u - x, ay + t * v - y)
