"""Small Xs in one stroke: the pen went along one bar, up a side, and back along the other bar.

With a wide pen so small a mark is a blot with four tips.  Its hole closes or looks like a pivot's, and its skeleton
is what thinning makes of a blot.  Its tips are plain to see, though, and so is whether the ink is that of two bars
between opposite tips and of one side.
"""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.skeleton.graph import Graph, Ink
from sketch.scan.strokes.ways import Way
from sketch.typing import Points

__all__ = ["crossed"]

# Pen widths between the tips of the longer bar: the skeleton of larger marks is plain.
SMALLEST, LARGEST = 2.5, 12.0
CORE = 0.3  # pen widths from the paper: ink so deep is near the pen's middle
LIKE = 3.0  # times that one bar may be as long as the other
BLUNT = 0.25  # pen widths that a tip may be off the straight line between others
FEW = 12  # corners of a hull that are looked at
BESIDE = 0.8  # pen widths from a line: ink so near is its ink
COVERED = 0.95  # of the ink must be beside the bars or the side
INKED = 0.7  # of the bars must be on ink
OPEN = 0.5  # of the middle of any other side may be: what is closed all around is an outline


def crossed(graph: Graph, ways: list[Way], distance: NDArray[Any], pen: float) -> list[Way]:
    """The Xs with a side among the small pieces of a drawing's ink.

    graph: of the skeleton.  ways: strokes that take all the ink [pixels].  distance: each pixel's distance to the
    paper, shape (h, w).  pen: its width [pixels].
    """
    import cv2

    out = []
    for points in _small_pieces(graph, pen):
        x0, y0 = np.floor(points.min(axis=0) - pen).astype(int).clip(0).tolist()
        x1, y1 = np.ceil(points.max(axis=0) + pen).astype(int).tolist()
        near = distance[y0 : y1 + 1, x0 : x1 + 1]
        _, label = cv2.connectedComponents((near > 0).astype(np.uint8))
        x, y = np.round(points[0] - (x0, y0)).astype(int)
        mine = label == label[y, x]
        core = cv2.findNonZero((mine & (near > CORE * pen)).astype(np.uint8))
        if core is None or len(core) < 4:
            continue
        found = _bars_and_side(core, mine, pen)
        if found is not None:
            ink = _ink_within(ways, mine, (x0, y0))
            if ink:
                out.append(Way(found + np.array([x0, y0]), ink))
    return out


def _small_pieces(graph: Graph, pen: float) -> list[Points]:
    """The points of each piece of ink that is small and not a simple line."""
    out = []
    for piece in graph.pieces():
        if max(max(graph.edges[e].ends) for e in piece) < 0:
            continue
        points = np.concatenate([graph.edges[e].points for e in piece])
        if np.ptp(points, axis=0).max() < LARGEST * pen:
            out.append(points)
    return out


def _bars_and_side(core: NDArray[Any], mine: NDArray[np.bool_], pen: float) -> Points | None:
    """The way along one bar, a side and the other bar of an X, (n, 2) a point a pixel; None where the ink is none.

    core: pixels near the pen's middle, shape (n, 1, 2).  mine: its ink, shape (h, w).
    """
    tips = _tips(core, pen)
    if tips is None:
        return None
    first, second = tips[[0, 2]], tips[[1, 3]]
    lengths = sorted(float(np.hypot(*(b - a))) for a, b in (first, second))
    if not SMALLEST * pen < lengths[1] < LARGEST * pen or lengths[1] > LIKE * lengths[0]:
        return None
    if min(_inked(a, b, mine) for a, b in (first, second)) < INKED:
        return None
    ink = np.argwhere(mine)[:, ::-1].astype(float)
    beside = [_off(ink, tips[n], tips[n - 1]) < BESIDE * pen for n in range(4)]
    left = np.minimum(_off(ink, *first), _off(ink, *second)) >= BESIDE * pen
    k = int(np.argmax([np.count_nonzero(left & near) for near in beside]))
    if (left & ~beside[k]).mean() > 1 - COVERED:
        return None
    thirds = (tips - np.roll(tips, 1, axis=0)) / 3
    others = [n for n in range(4) if n != k]
    if max(_inked(tips[n] - thirds[n], tips[n] - 2 * thirds[n], mine) for n in others) > OPEN:
        return None
    corners = tips[[k - 2, k, k - 1, k - 3]]
    lines = [_along(a, b) for a, b in pairwise(corners)]
    return np.concatenate([*lines, corners[-1:]])


def _tips(core: NDArray[Any], pen: float) -> Points | None:
    """The four places that enclose the most of the ink, in order around it, shape (4, 2)."""
    import cv2

    hull = cv2.approxPolyDP(cv2.convexHull(core), BLUNT * pen, closed=True)[:, 0].astype(float)
    if not 4 <= len(hull) <= FEW:
        return None
    fours = np.array(list(combinations(range(len(hull)), 4)))
    p, q = hull[fours[:, 2]] - hull[fours[:, 0]], hull[fours[:, 3]] - hull[fours[:, 1]]
    area = np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    return np.asarray(hull[fours[int(area.argmax())]])


def _inked(a: Points, b: Points, mine: NDArray[np.bool_]) -> float:
    """The share of a line that is on ink."""
    x, y = np.round(_along(a, b)).astype(int).T
    return float(mine[y, x].mean())


def _along(a: Points, b: Points) -> Points:
    """Points a pixel apart from a (with it) to b (without it)."""
    steps = max(round(float(np.hypot(*(b - a)))), 1)
    return np.asarray(a + (b - a) * (np.arange(steps) / steps)[:, None])


def _off(points: Points, a: Points, b: Points) -> NDArray[np.float64]:
    """The distance of points from a line between two places."""
    side = b - a
    t = np.clip((points - a) @ side / max(float(side @ side), 1e-9), 0, 1)
    return np.asarray(np.hypot(*(points - a - t[:, None] * side).T))


def _ink_within(ways: list[Way], mine: NDArray[np.bool_], corner: tuple[int, int]) -> Ink:
    """The stretches of the skeleton that are in a piece of ink. corner: of the picture, where that begins."""
    ink: Ink = {}
    height, width = mine.shape
    for way in ways:
        for name, points in way.ink.items():
            x, y = np.round(points[len(points) // 2] - corner).astype(int)
            if 0 <= x < width and 0 <= y < height and mine[y, x]:
                ink[name] = points
    return ink
