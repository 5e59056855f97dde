"""What made-up sheets of paper have been through before anyone drew on them."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["fold", "grain", "punch", "stain"]

Array = NDArray[Any]


def punch(sheet: Array, holes: int) -> None:
    """Holes along the left edge that show what is under the sheet."""
    height, width = sheet.shape[:2]
    for k in range(holes):
        y = height * (0.5 + 0.22 * (k - 0.5 * (holes - 1)))
        at = round(0.022 * width), round(y)
        cv2.circle(sheet, at, round(0.01 * width), (50, 60, 70), cv2.FILLED, cv2.LINE_AA)


def stain(sheet: Array, rng: np.random.Generator) -> None:
    height, width = sheet.shape[:2]
    at = np.array([width, height]) * rng.uniform(0.35, 0.65, 2)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    radius, off = 0.2 * height, np.hypot(x - at[0], y - at[1])
    ring = np.exp(-(((off - radius) / (0.02 * height)) ** 2)) + 0.3 * (off < radius)
    sheet *= 1 - ring[..., None] * np.array([0.30, 0.17, 0.10], np.float32)


def fold(sheet: Array, rng: np.random.Generator) -> None:
    """A crease: one side of it lies in a little less light, and its edge is lit and shaded."""
    height, width = sheet.shape[:2]
    y, x = np.mgrid[:height, :width].astype(np.float32)
    a = rng.choice([0.0, 0.5 * math.pi]) + rng.normal(0, 0.05)
    off = (x - width * rng.uniform(0.3, 0.7)) * math.cos(a) + (y - height * rng.uniform(0.3, 0.7)) * math.sin(
        a
    )
    crease = -0.1 * np.exp(-((off / 3) ** 2)) + 0.05 * np.exp(-(((off - 5) / 4) ** 2))
    sheet *= (1 + crease - 0.07 * (off > 0))[..., None]


def grain(shape: tuple[int, ...], size: float, rng: np.random.Generator) -> Array:
    """Smooth noise of variance 1, about `size` pixels coarse."""
    noise = rng.standard_normal(shape[:2], np.float32)
    cv2.GaussianBlur(noise, (0, 0), size, noise)
    noise /= max(float(noise.std()), 1e-9)
    return noise
