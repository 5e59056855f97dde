"""Tails: where a hand closes an outline it seldom stops at once, so that its end lies beside its beginning.

A skeleton shows that as an outline with a short line on it.  The pen drew both in one go: along the line, then around.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.ways import Way

__all__ = ["with_tails"]

Points = NDArray[np.float64]

TAIL = 0.25  # of an outline's length: a longer line is none's tail
OPEN = 0.6  # of its own length: nearer ends are a loop's
ENDS = 1.5  # [rad²] of strain: more than that of one end at a junction, less than that of two
BESIDE = 1.0  # pen widths: where a tail leaves its outline


def with_tails(ways: list[Way], pen: float) -> list[Way]:
    """The closed ways among these each with each short open one that leaves it, as one stroke.

    pen: its width, in the pixels of the ways.
    """
    closed = [(way, _length(way.points)) for way in ways if np.array_equal(way.points[0], way.points[-1])]
    # of a tail one end is at a junction, the other free
    loose = [way for way in ways if way.strain < ENDS and not np.array_equal(way.points[0], way.points[-1])]
    lines = [(way, _length(way.points)) for way in loose]
    out = []
    for tail, short in lines:
        for outline, around in closed:
            loop = np.hypot(*(tail.points[0] - tail.points[-1])) < OPEN * short
            if loop or short > TAIL * around or not outline.ink.keys().isdisjoint(tail.ink):
                continue
            found = _joined(tail.points, outline.points[:-1], BESIDE * pen)
            if found is not None:
                out.append(Way(found, {**outline.ink, **tail.ink}, outline.strain, frozenset(tail.ink)))
    return out


def _length(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


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
