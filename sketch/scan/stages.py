"""What was seen, as pictures, for anyone who wonders why a drawing was read as it was."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.tracing import Traced

__all__ = ["write_stages"]


def write_stages(folder: str | os.PathLike[str], picture: NDArray[Any], traced: Traced) -> list[Path]:
    """Write 1-page.png, 2-mask.png, 3-skeleton.png and 4-strokes.png; returns their paths.

    The first three have the resolution that the ink was looked at; the strokes are drawn over the picture,
    each in a colour of its own, with a dot where it begins and a ring where it ends.  Raises OSError where the
    folder cannot be written.
    """
    import cv2

    pictures = {"4-strokes": _over(picture, traced)}
    if (seen := traced.seen) is not None:
        pictures["1-page"] = 255 - seen.page.darkness
        pictures["2-mask"] = 255 - 255 * seen.mask
        pictures["3-skeleton"] = 255 - np.maximum(255 * seen.skeleton, 60 * seen.mask)
    Path(folder).mkdir(parents=True, exist_ok=True)
    paths = []
    for name, image in sorted(pictures.items()):
        path = Path(folder, name + ".png")
        path.write_bytes(cv2.imencode(".png", image)[1].tobytes())
        paths.append(path)
    return paths


def _over(picture: NDArray[Any], traced: Traced) -> NDArray[Any]:
    import cv2

    image = (picture // 2 + 127).astype(np.uint8)
    wide = max(round(max(picture.shape[:2]) / 700), 1)
    for k, stroke in enumerate(traced.strokes):
        hue = np.array(
            [[[round(179 * (0.382 * k % 1)), 255, 200]]], np.uint8
        )  # the golden angle tells neighbours apart
        color = tuple(int(c) for c in cv2.cvtColor(hue, cv2.COLOR_HSV2BGR)[0, 0])
        points = np.round(stroke.points * 16).astype(np.int32)
        cv2.polylines(image, [points], False, color, wide, cv2.LINE_AA, 4)
        cv2.circle(image, points[0].tolist(), 48 * wide, color, cv2.FILLED, cv2.LINE_AA, 4)
        cv2.circle(image, points[-1].tolist(), 80 * wide, color, wide, cv2.LINE_AA, 4)
    return image
