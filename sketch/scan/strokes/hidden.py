"""Lines whose ends are hidden under other ink: a bar of an X that reaches just into a plank's side.

Where a line ends at other ink, nobody can see whether it ends there or goes on beneath.  It may go on as far as there
is ink straight ahead; what other lines it crosses, or what it is a part of, tells.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import heading
from sketch.scan.skeleton.graph import SIGHT
from sketch.scan.strokes.ways import Way
from sketch.typing import Points

__all__ = ["going_on"]

ROUND = 0.5  # pen widths: an end of a line is as far from the edge of its ink; less than as much further is nothing


def going_on(ways: list[Way], distance: NDArray[Any], pen: float) -> list[Way]:
    """The open ways among these that may go on under other ink, each prolonged straight at every such end.

    distance: each pixel's distance to the paper, shape (h, w).  pen: its width [pixels].
    """
    out = []
    for way in ways:
        if np.array_equal(way.points[0], way.points[-1]) or not way.strain:
            continue
        head, tail = (_beyond(points, distance, pen) for points in (way.points[::-1], way.points))
        if len(head) or len(tail):
            out.append(replace(way, points=np.concatenate([head[::-1], way.points, tail])))
    return out


def _beyond(points: Points, distance: NDArray[Any], pen: float) -> Points:
    """Where a way may go on from its last point on, under ink, shape (n, 2), a point a pixel; empty where it cannot."""
    end = points[-1]
    _, back = heading(points[::-1], end, pen, SIGHT * pen)
    (x, y), (dx, dy), count = end.tolist(), back.tolist(), 0
    while _is_ink(distance, x - (count + 1) * dx, y - (count + 1) * dy):
        count += 1
    count = count - round(ROUND * pen)
    steps = np.arange(1, count + 1 if count > ROUND * pen else 1)
    return np.asarray(end - steps[:, None] * back)


def _is_ink(distance: NDArray[Any], x: float, y: float) -> bool:
    height, width = distance.shape
    return 0 <= round(y) < height and 0 <= round(x) < width and bool(distance[round(y), round(x)] > 0)
