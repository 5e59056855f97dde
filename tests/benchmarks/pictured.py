"""Pictures of sketches that were read wrong: ink and truth on the left, the reading on the right."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import Canvas
from cli.render.overlay import overlay
from cli.render.still import png
from sketch import Recognition

__all__ = ["failure"]

INK, TRUTH, TEXT = (60, 60, 60), (60, 160, 0), (40, 40, 200)  # BGR
WIDTH = 800  # of either half [pixels]
LINE = 22  # of text [pixels]


def failure(recognition: Recognition, wrong: list[str], truth: list[NDArray[np.float64]]) -> bytes:
    """A PNG: truth in green over the ink, beside what was read; what is wrong in words below."""
    import cv2

    read = overlay(recognition).planes[0]
    height, width = read.shape[:2]
    up = WIDTH / width
    read = cv2.resize(read, (WIDTH, max(1, round(height * up))), interpolation=cv2.INTER_AREA)
    sketch = recognition.sketch
    longer = (
        max(sketch.width or 0.0, sketch.height or 0.0)
        or float(np.max(np.concatenate(_ink(recognition)))) + 20
    )
    scale = max(read.shape[:2]) / longer
    drawn = np.full_like(read, 255)
    for stroke in _ink(recognition):
        cv2.polylines(drawn, [_fixed(stroke * scale)], False, INK, 1, cv2.LINE_AA, 4)
    for outline in truth:
        cv2.polylines(drawn, [_fixed(outline * scale)], True, TRUTH, 1, cv2.LINE_AA, 4)
    words = np.full((LINE * (len(wrong) + 1), 2 * WIDTH, 3), 255, np.uint8)
    for k, text in enumerate(wrong):
        cv2.putText(words, text, (8, LINE * (k + 1)), cv2.FONT_HERSHEY_SIMPLEX, 0.5, TEXT, 1, cv2.LINE_AA)
    return png(Canvas((np.concatenate([np.concatenate([drawn, read], axis=1), words]),)))


def _ink(recognition: Recognition) -> list[NDArray[np.float64]]:
    return [s.points for s in recognition.sketch.strokes if len(s.points)]


def _fixed(points: NDArray[np.float64]) -> NDArray[np.int32]:
    """Points as cv2 takes them with four bits of fraction."""
    return np.rint(points * 16).astype(np.int32)
