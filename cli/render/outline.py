"""Outlines made narrower or into lines of a true width, as polygons to fill."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["inset", "is_convex", "rim", "ring", "segment"]

Array = NDArray[np.float64]

SHARPEST = 4.0  # a corner's inset is at most so many times the distance, however sharp the corner


def signed_area(v: Array) -> float:
    """Of a polygon (n, 2): positive when counter-clockwise with y up."""
    x, y = (v - v[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def is_convex(v: NDArray[Any]) -> bool:
    side = np.roll(v, -1, axis=0) - v
    following = np.roll(side, -1, axis=0)
    turn = side[:, 0] * following[:, 1] - side[:, 1] * following[:, 0]
    return bool(np.all(turn >= 0) or np.all(turn <= 0))


def inset(v: Array, distance: float) -> Array:
    """The polygon (n, 2) with every side moved inwards by `distance`.

    Corners are where the moved sides meet (mitred).  Where nothing is left of a side, its corners fall on
    one point; a polygon narrower than twice the distance shrinks towards its middle instead.
    """
    orientation = 1.0 if signed_area(v) > 0 else -1.0
    side = np.roll(v, -1, axis=0) - v
    length = np.hypot(*side.T)
    length[length == 0] = 1.0
    inwards = np.stack([-side[:, 1], side[:, 0]], axis=1) / length[:, None] * orientation
    before = np.roll(inwards, 1, axis=0)
    bisector = inwards + before
    squared = np.maximum(np.sum(bisector**2, axis=1), 4 / SHARPEST**2)
    moved = v + bisector * (2 * distance / squared)[:, None]
    reversed_side = np.sum((np.roll(moved, -1, axis=0) - moved) * side, axis=1) < 0
    if reversed_side.all():
        middle: Array = v.mean(axis=0)
        return middle + (v - middle) * 0.2
    out: Array = moved.copy()
    for k in np.flatnonzero(reversed_side):
        j = (k + 1) % len(v)
        out[k] = out[j] = (moved[k] + moved[j]) / 2
    return out


def rim(v: Array, outer: float, inner: float) -> list[Array]:
    """The band between two insets of a polygon (n, 2), as a quadrilateral (4, 2) for every side."""
    a, b = inset(v, outer), inset(v, inner)
    ends = zip(a, np.roll(a, -1, axis=0), np.roll(b, -1, axis=0), b, strict=True)
    return [np.array(quadrilateral) for quadrilateral in ends]


def ring(radius: float) -> Array:
    """A circle about the origin [pixels] as a polygon (n, 2) that stays within a tenth of a pixel of it."""
    corners = max(8, int(np.ceil(np.pi / np.arccos(1 - min(0.1 / radius, 1.0)))))
    turn = np.arange(corners) * (2 * np.pi / corners)
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def segment(a: Array, b: Array, width: float) -> Array:
    """A straight line from a to b as a rectangle (4, 2) of that width."""
    along = b - a
    across = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-12) * (width / 2)
    return np.array([a + across, b + across, b - across, a - across])
