"""Lines that are broken: chalk and graphite leave out what lies deep in the grain, and the noise of a dark room is as
strong as a pencil.

Along itself a line goes on, and neither grain nor noise does: the mean along it is the line's.  One that is whole needs
none of this, and loses a little of its corners by it.
"""

from __future__ import annotations

import numpy as np

from sketch.scan.binding import along_lines, ends
from sketch.typing import Image

__all__ = ["is_broken", "smooth_lines"]

WHOLE = 14.0  # pen widths of line to an end: a drawing has more
BESIDE_PRINT = 28.0  # likewise, where a bit of a printed line is likelier than an end
STROKE = 1.5  # [pixels]: standard deviation of the smoothing before directions are looked at
PAPER = 3.0  # times the noise: what is darker may be ink


def is_broken(skeleton: Image, pen: float, *, printed: bool) -> bool:
    """Whether lines end much more often than those of a drawing.

    pen: its width [pixels].  printed: whether printed lines were erased, which left bits or took some along.
    """
    import cv2

    whole = BESIDE_PRINT if printed else WHOLE
    return bool(cv2.countNonZero(skeleton) < whole * pen * ends(skeleton))


def smooth_lines(darkness: Image, noise: float, reach: int) -> Image:
    """Darkness, smoothed along the lines by `reach` pixels to either side; noise: of the bare paper."""
    import cv2

    height, width = (side // 2 for side in darkness.shape)
    half = cv2.resize(darkness[: 2 * height, : 2 * width], (width, height), interpolation=cv2.INTER_AREA)
    half = cv2.GaussianBlur(half, (0, 0), STROKE / 2)
    near = cv2.dilate((half > PAPER * noise).view(np.uint8), np.ones((3, 3), np.uint8))
    x, y = (np.asarray(cv2.Sobel(half, cv2.CV_32F, *way)) for way in ((1, 0), (0, 1)))
    tensor = [np.asarray(cv2.GaussianBlur(part, (0, 0), reach / 4)) for part in (x * x, x * y, y * y)]
    return along_lines(cv2.GaussianBlur(darkness, (3, 3), 0), near, tensor, reach)
