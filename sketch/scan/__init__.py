"""A picture of paper → strokes, by which the drawing goes on as if it had been made on a tablet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.ink import Sketch, Stroke
from sketch.scan.binding import thin, trace
from sketch.scan.decode import decode, is_picture
from sketch.scan.graph import build_graph
from sketch.scan.page import fill_pinholes, ink_mask, read_page
from sketch.scan.ridge import centre_on_ink
from sketch.scan.rings import find_rings, take_rings
from sketch.scan.strokes import trace_strokes

__all__ = ["is_picture", "read_picture"]

WORK_PIXELS = 2_500_000  # more than this are not looked at before the pen's width is known
NARROWEST_PEN = 3.0  # [pixels]: a thinner pen is thinned at twice the resolution, where there is more
WIDEST_PEN = 6.4  # [pixels]: a wider pen is thinned at half the resolution
SMOOTHING = 0.8  # [pixels]: standard deviation of the smoothing along a stroke


def read_picture(data: bytes) -> Sketch:
    """The strokes on a picture of paper, from the bytes of its file.

    The strokes are in the pixels of the picture as displayed upright, y down.  Raises InputError for what
    cannot be read.
    """
    picture = decode(data)
    height, width = picture.shape[:2]
    strokes = [Stroke(points) for points in trace_picture(picture)]
    notes = [] if strokes else ["no ink was found on the picture"]
    return Sketch(strokes, float(width), float(height), None, picture, notes)


def trace_picture(picture: NDArray[Any]) -> list[NDArray[np.float64]]:
    """The strokes on a BGR picture, each shape (n, 2) [pixels of the picture]."""
    import cv2

    scale = 1.0
    work = picture
    while work.shape[0] * work.shape[1] > WORK_PIXELS:
        scale *= 2
        work = _reduced(picture, scale)
    if min(work.shape[:2]) < 8:
        return []
    tried = {scale}
    while True:
        page = read_page(work)
        mask = ink_mask(page, 4)
        skeleton, count = thin(mask)
        if count == 0:
            return []
        pen = float(np.count_nonzero(mask)) / count
        better = scale * 2 if pen > WIDEST_PEN else scale / 2 if pen < NARROWEST_PEN else scale
        if better in tried or better < 1 or min(picture.shape[:2]) < 100 * better:
            break
        scale = better
        tried.add(scale)
        work = _reduced(picture, scale)
    if fill_pinholes(mask, pen):
        skeleton, count = thin(mask)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    graph = build_graph(trace(skeleton, count), distance, pen)
    rings = take_rings(graph, find_rings(mask, distance, pen), pen)
    centre_on_ink(graph, page.darkness, pen)
    strokes = [smooth(s, SMOOTHING) for s in trace_strokes(graph, pen) + rings]
    return [(s + 0.5) * scale - 0.5 for s in strokes if len(s) > 1]


def _reduced(picture: NDArray[Any], scale: float) -> NDArray[Any]:
    import cv2

    if scale == 1:
        return picture
    way = cv2.INTER_AREA if scale > 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(picture, None, fx=1 / scale, fy=1 / scale, interpolation=way))


def smooth(points: NDArray[np.float64], sigma: float) -> NDArray[np.float64]:
    """Points smoothed along the stroke by a Gaussian of `sigma` points; the ends of an open stroke stay."""
    reach = int(np.ceil(3 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    n = len(points)
    if n < 4:
        return points
    if np.hypot(*(points[0] - points[-1])) < 1e-9:
        index = np.arange(-reach, n - 1 + reach) % (n - 1)
        padded = points[index]
    else:
        k = min(reach, n - 1)
        before, after = 2 * points[0] - points[k:0:-1], 2 * points[-1] - points[-2 : -2 - k : -1]
        fill = reach - k
        padded = np.concatenate(
            [np.repeat(before[:1], fill, 0), before, points, after, np.repeat(after[-1:], fill, 0)]
        )
    out = np.stack([np.convolve(padded[:, d], kernel, "valid") for d in (0, 1)], axis=1)
    return np.concatenate([out, out[:1]]) if len(out) == n - 1 else out
