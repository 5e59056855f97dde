"""What a small ring is drawn over, and so may be a pin of: bodies and open lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sketch.kernel import depth
from sketch.scoring import Fitted
from sketch.typing import Array

__all__ = ["PINNED", "REACH", "is_on_line", "is_over"]

# times as large as a pivot is an open line that it joins, at least: the stem of an "a" is shorter
PINNED = 3.0
# of a ring's extent, from its middle: what is nearer is in the ring, and so is what it was drawn over, as it touches it
REACH = 0.5
# of a ring's extent: a line so near to its middle goes through it, and is no ground that it lies on
THROUGH = 0.25


def is_over(mark: Fitted, extent: float, body: Fitted, large: float) -> bool:
    """Whether the middle of a mark is over a body of other ink, or in a ring what the ring is over, a body or an open
    line; mark and body are of extents `extent` and `large` [pixels]."""
    if not set(mark.pieces).isdisjoint(body.pieces):
        return False
    ring = mark.kind == "circle"
    if not body.closed:
        return ring and is_on_line(mark.middle, extent, body.outline, large)
    return depth(*mark.middle, body.outline) < REACH * extent * ring


def is_on_line(middle: Sequence[float], extent: float, line: Array, long: float) -> bool:
    """Whether an open line, (n, 2), of extent `long`, ends in a ring of extent `extent` or goes through it [pixels]."""
    if PINNED * extent >= long:
        return False
    points = line.tolist()
    gap = min(math.dist(middle, points[0]), math.dist(middle, points[-1]))
    if gap < REACH * extent:
        return True
    if gap > long + extent:  # no point of the line is further from its ends than it is long
        return False
    return any(_distance(middle, a, b) < THROUGH * extent for a, b in pairwise(points))


def _distance(at: Sequence[float], a: Sequence[float], b: Sequence[float]) -> float:
    """How far a point is from the segment between two others."""
    (x, y), (ax, ay), (u, v) = at, a, (b[0] - a[0], b[1] - a[1])
    t = ((x - ax) * u + (y - ay) * v) / max(u * u + v * v, 1e-9)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(ax + t * u - x, ay + t * v - y)
