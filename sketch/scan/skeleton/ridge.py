"""The middle of the ink to a fraction of a pixel: a skeleton runs along whole pixels, the pen did not."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.skeleton.graph import RING, Graph
from sketch.typing import Points

__all__ = ["centre_on_ink"]

FARTHEST = 1.0  # [pixels] that a point is moved: thinning is off by no more along a clean line
STEP = 0.5  # [pixels] between the samples across a line
PALE = 0.4  # of the darkness of a line's middle: what has less is its rim, or other ink beside it


def centre_on_ink(graph: Graph, darkness: NDArray[Any], pen: float) -> None:
    """Move the points of all edges, in place, to the middle of the darkness across the line.

    darkness: of the page, uint8, shape (h, w).  pen: the width of the pen [pixels].
    """
    import cv2

    if not graph.edges:
        return
    points = np.concatenate([edge.points for edge in graph.edges])
    normals = _normals(points, np.array([len(edge.points) for edge in graph.edges]))
    reach = 0.5 * pen + 1.0
    offsets = np.arange(-reach, reach + STEP / 2, STEP)
    x, y = ((points[:, k, None] + normals[:, k, None] * offsets).astype(np.float32) for k in (0, 1))
    ink = _sample(cv2.GaussianBlur(darkness, (3, 3), 0), x, y)
    ink = np.maximum(ink - PALE * ink.max(axis=1, keepdims=True), 0.0)
    total = ink.sum(axis=1)
    shift = np.divide(ink @ offsets, total, out=np.zeros(len(points)), where=total > 0)
    points += normals * np.clip(shift, -FARTHEST, FARTHEST)[:, None]
    start = 0
    for edge in graph.edges:
        count = len(edge.points)
        edge.points = points[start : start + count]
        start += count
        if edge.ends == RING:
            edge.points[-1] = edge.points[0]


def _normals(points: Points, lengths: NDArray[np.intp]) -> Points:
    """Unit vectors across chains, given one after another, from the points two before and two after.

    lengths: of the chains, in points.
    """
    ends = np.cumsum(lengths)
    first, last = np.repeat(ends - lengths, lengths), np.repeat(ends - 1, lengths)
    index = np.arange(len(points))
    along = points[np.minimum(index + 2, last)] - points[np.maximum(index - 2, first)]
    size = np.hypot(along[:, 0], along[:, 1])
    along /= np.where(size > 0, size, 1.0)[:, None]
    return np.stack([-along[:, 1], along[:, 0]], axis=1)


def _sample(image: NDArray[Any], x: NDArray[np.float32], y: NDArray[np.float32]) -> NDArray[np.float64]:
    """The image between its pixels; remap takes no more than 32767 rows at once."""
    import cv2

    rows = 30_000
    parts = [
        cv2.remap(image, x[k : k + rows], y[k : k + rows], cv2.INTER_LINEAR) for k in range(0, len(x), rows)
    ]
    return np.concatenate(parts).astype(np.float64)
