"""Corners where the pen turned: thinning cuts them short, by the more the sharper they are."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import turns
from sketch.scan.quantiles import median
from sketch.scan.skeleton.graph import RING, Graph
from sketch.typing import Points

__all__ = ["begin_at_corner", "sharpen_corners"]

CUT = 1.0  # pen widths to either side of a corner that thinning bends
SIDE = 2.0  # pen widths of each side, beyond, that show where it leads
FEWEST = 3  # points of each at least
SHARP = 0.6  # [rad] that a corner turns by at least: those of a hexagon by 1.05
SHARPER = 2.0  # times that it turns more than its sides do on the same length: a small circle's would not
STRAIGHT = 0.15  # pen widths that a side may be off a line
INKED = 0.2  # pen widths that the corner must lie within the ink


def sharpen_corners(graph: Graph, distance: NDArray[Any], pen: float) -> None:
    """Set the corners of all edges, in place, to where their sides meet, if there is ink.

    distance: each pixel's distance to the paper, shape (h, w).  pen: the width of the pen [pixels].
    """
    for edge in graph.edges:
        x, y = np.round(edge.points).astype(int).T
        wide = max(pen, 2 * median(distance[y, x]))  # a slow pen draws wider
        cut, side = round(CUT * wide), max(round(SIDE * wide), 3)
        closed = edge.ends == RING
        points = edge.points[:-1] if closed else edge.points
        if len(points) < 2 * (cut + side) + 3:
            continue
        if closed:  # begin where it bends the least all around
            turn, reach = turns(points, cut), cut + side
            around = np.concatenate([turn[-reach:], turn, turn[:reach]])
            turn = np.convolve(around, np.ones(2 * reach + 1), "valid")
            points = np.roll(points, -int(np.argmin(turn)), axis=0)
        points = _sharpened(points, distance, wide, cut, side)
        edge.points = np.concatenate([points, points[:1]]) if closed else points


def begin_at_corner(points: Points, pen: float) -> Points:
    """A stroke, if it is closed begun where it turns the most, as a hand would; shape (n, 2)."""
    cut = max(round(CUT * pen), 1)
    if len(points) < 4 * cut or not np.array_equal(points[0], points[-1]):
        return points
    begin = int(turns(points[:-1], cut).argmax())
    return np.concatenate([points[begin:-1], points[: begin + 1]])


def _sharpened(points: Points, distance: NDArray[Any], pen: float, cut: int, side: int) -> Points:
    turn = turns(points, cut)
    turn[:cut] = turn[len(turn) - cut :] = 0  # nobody knows near open ends
    pieces, done = [], 0
    at = np.flatnonzero(turn > SHARP)
    groups = [group for group in np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if len(group)]
    corners = [int(group[np.argmax(turn[group])]) for group in groups]
    for before, k, after in zip([-cut, *corners], corners, [*corners[1:], len(points) + cut], strict=False):
        first = max(k - cut - side, before + cut, done)
        last = min(k + cut + side, after - cut, len(points) - 1)
        if k - cut - first < FEWEST or last - k - cut < FEWEST:
            continue
        along = cut + side // 2
        beside = turn[max(k - along, 0)] + turn[min(k + along, len(points) - 1)]
        if turn[k] < SHARPER * beside / 2:
            continue
        corner = _meeting(points[first : k - cut + 1], points[k + cut : last + 1], pen)
        if corner is None or np.hypot(*(corner - points[k])) > 2 * CUT * pen:
            continue
        x, y = np.round(corner).astype(int)
        if not (0 <= y < distance.shape[0] and 0 <= x < distance.shape[1]) or distance[y, x] < INKED * pen:
            continue
        pieces += [points[done : k - cut], _even(points[k - cut], corner), _even(corner, points[k + cut])]
        done = k + cut
    return np.concatenate([*pieces, points[done:]])


def _meeting(before: Points, after: Points, pen: float) -> Points | None:
    """Where the lines of two sides cross; None where one is no line or they are nearly parallel."""
    lines = []
    for points in (before, after):
        middle = points.mean(axis=0)
        _, size, axes = np.linalg.svd(points - middle, full_matrices=False)
        if size[1] > STRAIGHT * pen * len(points) ** 0.5:
            return None
        lines.append((middle, axes[0]))
    (p, u), (q, v) = lines
    sine = u[0] * v[1] - u[1] * v[0]
    if abs(sine) < 0.2:
        return None
    along = ((q[0] - p[0]) * v[1] - (q[1] - p[1]) * v[0]) / sine
    return np.asarray(p + along * u)


def _even(a: Points, b: Points) -> Points:
    """Points a pixel apart from a (with it) to b (without it)."""
    steps = max(round(float(np.hypot(*(b - a)))), 1)
    return np.asarray(a + (b - a) * (np.arange(steps) / steps)[:, None])
