"""The page: even light, and which pixels are ink."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Page", "ink_mask", "read_page"]

Image = NDArray[Any]  # uint8

WIDEST_LINE = 0.035  # of the picture's size, to either side: what is dark and wider is no pen line
DIMMEST = 24  # of 255: light below this shows nothing but noise
LEAST_CONTRAST = 18  # of 255: paper's own texture stays below


@dataclass(frozen=True, eq=False)
class Page:
    """A page under even light.

    Attributes:
        darkness: 0 is bare paper, 255 is black, shape (h, w).
        noise: standard deviation of the bare paper's darkness.
        ink: the darkness that full ink has.
    """

    darkness: Image
    noise: float
    ink: float


def read_page(picture: Image) -> Page:
    """Divide the light out of a BGR picture.

    What is darker than its surroundings and narrower than WIDEST_LINE counts as drawn: a closing at a quarter
    of the resolution takes that away and leaves paper, shadows and the table, each with its own light.
    """
    import cv2

    blue, green, red = cv2.split(picture)
    grey = cv2.min(cv2.min(blue, green), red)
    height, width = grey.shape
    small = cv2.resize(grey, (max(width // 4, 1), max(height // 4, 1)), interpolation=cv2.INTER_AREA)
    reach = max(int(WIDEST_LINE * (small.shape[0] * small.shape[1]) ** 0.5), 2) * 2 + 1
    light = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((reach, reach), np.uint8))
    # where light changes at an edge its side is known to a small pixel only: taken as on the dark side
    light = cv2.blur(cv2.erode(light, np.ones((3, 3), np.uint8)), (3, 3))
    light = cv2.resize(light, (width, height), interpolation=cv2.INTER_LINEAR)
    darkness = cv2.divide(cv2.subtract(light, grey), np.maximum(light, np.uint8(DIMMEST)), scale=255.0)
    return _measure(darkness)


def _measure(darkness: Image) -> Page:
    import cv2

    histogram = np.asarray(cv2.calcHist([darkness], [0], None, [256], [0, 256])).ravel()
    total = np.cumsum(histogram)
    middle = int(np.searchsorted(total, 0.5 * total[-1]))
    upper = int(np.searchsorted(total, 0.84 * total[-1]))
    noise = max(float(upper - middle), 1.0)
    least = int(max(LEAST_CONTRAST, middle + 5 * noise))
    tail = np.cumsum(histogram[min(least, 255) :])
    ink = least + int(np.searchsorted(tail, 0.7 * tail[-1]))
    return Page(darkness, noise, float(ink))


def ink_mask(page: Page, reach: int) -> Image:
    """The pixels that are ink, 1, shape (h, w): half as dark as the darkest within `reach` pixels."""
    import cv2

    kernel = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    half = cv2.dilate(page.darkness, kernel) // 2
    floor = max(LEAST_CONTRAST, 4 * page.noise, 0.35 * page.ink)
    return np.asarray(page.darkness > np.maximum(half, np.uint8(min(floor, 254))), np.uint8)


def drop_specks(mask: Image, least: float) -> Any:
    """Without the pieces of fewer than `least` pixels."""
    import cv2

    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    keep = (stats[:, cv2.CC_STAT_AREA] >= least).astype(np.uint8)
    keep[0] = 0
    return keep[labels] if count > 1 else mask
