"""Pictures whose pixels say little by themselves: dithered and printed greys, and the noise of a dark room.

The dots of a dithered grey are as dark as ink and may join it, so that no threshold parts them; only that they are
everywhere tells them from a drawing, most of whose paper is bare.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.quantiles import percentile

__all__ = ["smoothed_grain"]

COARSE = 12.0  # of 255: standard deviation of the bare paper's grain that is made smoother
FINE = 7.0  # likewise, that may be left
SIGMAS = (1.0, 1.5, 2.0, 3.0, 4.0)  # [pixels] of the smoothing, the least that does it is taken
SAMPLES = 20_000  # pixels that the grain is measured on
BLOCK = 64  # pixels of a stretch of these
BARE = 25  # percent of the stretches that certainly show bare paper


def smoothed_grain(picture: NDArray[Any]) -> NDArray[Any]:
    """The picture, smoothed by as little as its grain takes to be no ink.  picture: BGR, shape (h, w, 3)."""
    import cv2

    if _grain(picture, None) <= COARSE:
        return picture
    smooth = picture
    for sigma in SIGMAS:
        smooth = np.asarray(cv2.GaussianBlur(picture, (0, 0), sigma))
        if _grain(smooth, cv2.GaussianBlur(smooth, (0, 0), sigma)) <= FINE:
            break
    return smooth


def _grain(picture: NDArray[Any], smoother: NDArray[Any] | None) -> float:
    """Standard deviation of what changes from pixel to pixel on bare paper, or from a smoother picture.

    Of neighbours in a row the second difference has six times the variance of noise that is independent.
    """
    height, width = picture.shape[:2]
    step = max(height * width // SAMPLES, 1) | 1  # odd: a pattern's period is even
    if width < BLOCK + 2 or height < 4 * step:
        return 0.0
    rows = _darkest(picture[::step]).astype(np.int32)
    if smoother is None:
        off = (rows[:, 2:] - 2 * rows[:, 1:-1] + rows[:, :-2]).astype(np.float64) / 6**0.5
    else:
        off = (rows - _darkest(smoother[::step])).astype(np.float64)
    high, wide = len(off) // 4 * 4, off.shape[1] // BLOCK * BLOCK
    energy = (off[:high, :wide] ** 2).reshape(high // 4, 4, -1, BLOCK).mean(axis=(1, 3))
    return math.sqrt(percentile(energy, BARE))


def _darkest(rows: NDArray[Any]) -> NDArray[Any]:
    """The darkest channel of each pixel."""
    return np.asarray(np.minimum(np.minimum(rows[..., 0], rows[..., 1]), rows[..., 2]))
