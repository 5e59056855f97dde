"""Tails: where a hand closes an outline it seldom stops at once, so that its end lies beside its beginning.

A skeleton shows that as an outline with a short line on it.  The pen drew both in one go: along the line, then around.
"""

from __future__ import annotations

import math

import numpy as np

from sketch.scan.binding import course_length
from sketch.scan.strokes.ways import Way
from sketch.typing import Points

__all__ = ["with_tails"]

TAIL = 0.25  # of an outline's length: a longer line is none's tail
OPEN = 0.6  # of its own length: nearer ends are a loop's
ENDS = 1.5  # [rad²] of strain: more than that of one end at a junction, less than that of two
BESIDE = 1.0  # pen widths: where a tail leaves its outline


def with_tails(ways: list[Way], pen: float) -> list[Way]:
    """The closed ways among these each with each short open one that leaves it, as one stroke.

    pen: its width, in the pixels of the ways.
    """
    reach = BESIDE * pen
    closed = []
    for way in ways:
        if np.array_equal(way.points[0], way.points[-1]):
            low, high = way.points.min(axis=0) - reach, way.points.max(axis=0) + reach
            closed.append((way, course_length(way.points), (*low.tolist(), *high.tolist())))
    out = []
    for tail in ways:
        ends = tail.points[[0, -1]].tolist()
        # of a tail one end is at a junction, the other free
        if tail.strain >= ENDS or ends[0] == ends[1]:
            continue
        short = course_length(tail.points)
        if math.dist(*ends) < OPEN * short:
            continue
        for outline, around, (x0, y0, x1, y1) in closed:
            if short > TAIL * around or not any(x0 <= x <= x1 and y0 <= y <= y1 for x, y in ends):
                continue
            if not outline.ink.keys().isdisjoint(tail.ink):
                continue
            found = _joined(tail.points, outline.points[:-1], reach)
            if found is not None:
                out.append(Way(found, {**outline.ink, **tail.ink}, outline.strain, frozenset(tail.ink)))
    return out


def _joined(tail: Points, outline: Points, reach: float) -> Points | None:
    """Along a tail and then around an outline as smoothly as can be; None where neither end is within reach."""
    gaps = [np.hypot(*(outline - end).T) for end in (tail[0], tail[-1])]
    near = [float(gap.min()) for gap in gaps]
    if min(near) > reach:
        return None
    if near[0] < near[1]:
        tail = tail[::-1]
    at = int(gaps[int(near[1] <= near[0])].argmin())
    around = np.roll(outline, -at, axis=0)
    few = min(len(tail), len(around)) // 2 + 1
    onward = tail[-1] - tail[-few]
    if onward @ (around[few - 1] - around[0]) < onward @ (around[-few + 1] - around[0]):
        around = np.roll(around[::-1], 1, axis=0)
    return np.concatenate([tail, around])
