"""Lettering: masks of opacity, drawn large and reduced, because cv2's own small letters are ragged."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["lettering"]

OVERSAMPLE = 6


@lru_cache(maxsize=256)
def lettering(text: str, height: int) -> NDArray[Any]:
    """The text as a mask (h, w) uint8, sides even; `height` is that of a capital letter [pixels].

    cv2's letters are ASCII; others become question marks.
    """
    import cv2

    font, tall = cv2.FONT_HERSHEY_SIMPLEX, height * OVERSAMPLE
    thick = max(1, round(tall * 0.13))
    scale = cv2.getFontScaleFromHeight(font, tall, thick)
    (width, _), below = cv2.getTextSize(text, font, scale, thick)
    pad = thick + OVERSAMPLE
    rows = _even((tall + below + 2 * pad) / OVERSAMPLE)
    columns = _even((width + 2 * pad) / OVERSAMPLE)
    large = np.zeros((rows * OVERSAMPLE, columns * OVERSAMPLE), np.uint8)
    cv2.putText(large, text, (pad, pad + tall), font, scale, 255, thick, cv2.LINE_AA)
    return cv2.resize(large, (columns, rows), interpolation=cv2.INTER_AREA)


def _even(x: float) -> int:
    return 2 * int(np.ceil(x / 2))
