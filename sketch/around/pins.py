"""What a mark is drawn over: a small ring, that so may be a pin, over bodies and open lines; an X on an open line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sketch.kernel import depth, gap
from sketch.scoring import Fitted
from sketch.typing import Array

__all__ = ["PINNED", "REACH", "follows", "is_on_line", "is_over", "stands_on"]

# times as large as a pivot is an open line that it joins, at least: the stem of an "a" is shorter
PINNED = 3.0
# of a ring's extent, from its middle: what is nearer is in the ring, and so is what it was drawn over, as it touches it
REACH = 0.5
# of a ring's extent: a line so near to its middle goes through it, and is no ground that it lies on
THROUGH = 0.25
ON_LINE = 0.5  # of an X's extent: a line that goes by its middle as near as that is what it stands on
# of a line's length: nineteen in twenty straight ones are nowhere further off
OFF = 0.04
LARGER = 2.0  # times as large as an X is a line that it stands on, at least: else it is an asterisk


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


def stands_on(cross: Fitted, extent: float, line: Fitted, course: Array, row: Sequence[float]) -> bool:
    """Whether an X of some extent [pixels] stands on an open line of other ink, that is as large as ground is.

    course: along the line's ink, (n, 2).  row: least x and y, greatest x and y, and extent of that [pixels].
    """
    (x, y), (x0, y0, x1, y1, long), reach = cross.middle, row, ON_LINE * extent
    if extent >= long / LARGER or not (x0 - reach < x < x1 + reach and y0 - reach < y < y1 + reach):
        return False
    if not set(line.pieces).isdisjoint(cross.pieces):
        return False
    return gap(np.array([cross.middle, cross.middle]), course)[0] < reach


def follows(line: Fitted, course: Array) -> bool:
    """Whether a line is its own course, or straight, and leaves out no bend or end that is no slip of the hand.

    course: as of `stands_on`.
    """
    if len(line.outline) > 2:
        return len(line.outline) == len(course)
    a, b = line.outline.tolist()
    off = OFF * math.dist(a, b)
    return all(_distance(at, a, b) < off for at in course.tolist())


def _distance(at: Sequence[float], a: Sequence[float], b: Sequence[float]) -> float:
    """How far a point is from the segment between two others."""
    (x, y), (ax, ay), (u, v) = at, a, (b[0] - a[0], b[1] - a[1])
    t = ((x - ax) * u + (y - ay) * v) / max(u * u + v * v, 1e-9)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(ax + t * u - x, ay + t * v - y)
