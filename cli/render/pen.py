"""Lines of a true width, arrows and lettering, in sizes that follow the picture's."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import BLOOM, Box, Canvas, Stamp, fixed, stamp
from cli.render.outline import inset, segment
from cli.render.style import RGB, Style
from cli.render.text import lettering

__all__ = ["Pen"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pen:
    """Draws on pictures of `size` [pixels, width and height]; a `unit` is 1/720 of the smaller side."""

    style: Style
    size: tuple[int, int]

    @property
    def unit(self) -> float:
        return min(self.size) / 720

    @property
    def width(self) -> float:
        """Of outlines [pixels]."""
        return max(self.style.line * self.unit, 1.3)

    def line(self, canvas: Canvas, a: Array, b: Array, width: float, color: RGB) -> None:
        """A straight line from a to b [pixels]."""
        canvas.polygon(fixed(segment(a, b, max(width - 2 * BLOOM, 0.3))), color)

    def arrow(self, canvas: Canvas, tail: Array, tip: Array, width: float, color: RGB) -> None:
        """An arrow with a filled head, which is never longer than the arrow."""
        length = float(np.hypot(*(tip - tail)))
        if length < 1:
            return
        along = (tip - tail) / length
        across = np.array([-along[1], along[0]])
        head = min(5 * width, length)
        neck = tip - along * head
        if length > head:
            self.line(canvas, tail, neck + along, width, color)
        triangle = np.array([tip, neck + across * head / 2, neck - across * head / 2])
        canvas.polygon(fixed(inset(triangle, BLOOM)), color)

    def length(self, text: str, height: float) -> int:
        """Of a text [pixels]."""
        return int(self._mask(text, height).shape[1])

    def _mask(self, text: str, height: float) -> NDArray[Any]:
        return lettering(text, max(8, round(height * self.unit)))

    def write(self, canvas: Canvas, text: str, corner: tuple[float, float], height: float) -> Box:
        """Letters with their upper left corner there [pixels]; returns the box that was written on."""
        x, y = (2 * round(c / 2) for c in corner)
        canvas.put(self._letters(text, height, canvas.is_yuv), (x, y))
        rows, columns = self._mask(text, height).shape
        return (x, y, min(x + columns, self.size[0]), min(y + rows, self.size[1]))

    @lru_cache(maxsize=8)  # noqa: B019  a pen is two small values; a clock shows one text for several frames
    def _letters(self, text: str, height: float, yuv: bool) -> Stamp:
        """Letters with a halo of paper: legible on whatever lies under them."""
        import cv2

        mask = self._mask(text, height)
        reach = 2 * round(2 * self.unit) + 1
        halo: Any = cv2.dilate(mask, np.ones((reach, reach), np.uint8))
        return stamp([(halo, self.style.paper), (mask, self.style.ink)], yuv)
