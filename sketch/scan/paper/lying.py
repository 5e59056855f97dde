"""Things that lie across the edge of the sheet: a pen, a ruler, a cable.

They are long and thin as ink is, but thicker than the pen's lines, and lead off the sheet, where nobody draws.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import pieces
from sketch.scan.quantiles import median
from sketch.typing import Image

__all__ = ["drop_things"]

THICKER = 1.7  # times as thick as the lines elsewhere on the sheet
LONG = 3.0  # times as long as thick: what is shorter may be a blot or filled
FULL = 0.5  # of the straight box around it: what is seen of a thing that shines covers so much
BROAD = 2.5  # lines' thicknesses, at least: how wide the box around such a thing is


def drop_things(mask: Image, skeleton: Image, distance: NDArray[Any], edge: Image) -> int:
    """Erase things that lie across the sheet's edge from a mask, its skeleton and its distances to the paper, in
    place; returns how many there were.

    edge: not 0 off the sheet and near its edge, shape (h, w), as the others.
    """
    import cv2

    pixels, start = pieces(mask)
    if not len(start):
        return 0
    at_edge = np.maximum.reduceat(edge.ravel()[pixels], start) > 0
    if not at_edge.any() or at_edge.all():
        return 0
    # a line is one pixel wider than twice its middle's distance to the paper's nearest pixel
    size = np.diff(np.append(start, len(pixels)))
    middle = skeleton.ravel()[pixels] > 0
    half = distance.ravel()[pixels]
    elsewhere = middle & np.repeat(~at_edge, size)
    if not elsewhere.any():
        return 0
    line = 2 * median(half[elsewhere]) - 1
    count = 0
    for k in np.flatnonzero(at_edge):
        own = slice(start[k], start[k] + size[k])
        points = np.stack(np.divmod(pixels[own], mask.shape[1])[::-1], axis=1).astype(np.float32)
        _, box, _ = cv2.minAreaRect(points)
        broad, long = sorted(side + 1 for side in box)
        thick = 2 * median(half[own][middle[own]]) - 1 if middle[own].any() else 0.0
        shines = broad > BROAD * line and size[k] > FULL * broad * long and long > LONG * broad
        if shines or (thick > THICKER * line and np.count_nonzero(middle[own]) > LONG * thick):
            for image in (mask, skeleton, distance):
                image.ravel()[pixels[own]] = 0
            count += 1
    return count
