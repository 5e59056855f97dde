"""Where things lie on a page, its pieces above all, to be asked which of them are near something."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import Strokes
from sketch.library import address, library
from sketch.typing import Array, Box, Point

__all__ = ["Boxes", "Near"]

HEADS = 4  # as in core/heads.c

_pointer, _double, _int = ctypes.c_void_p, ctypes.c_double, ctypes.c_int32
_along = ctypes.CFUNCTYPE(_int, _int, *[_pointer] * 4, _int, _double, _pointer, _pointer)(
    ("ink_along", library())
)
_heads = ctypes.CFUNCTYPE(None, _int, *[_pointer] * 5, _int, _pointer, *[_double] * 3, _pointer, _pointer)(
    ("ink_heads", library())
)
_touching = ctypes.CFUNCTYPE(_int, _int, _pointer, *[_double] * 4, _pointer)(("ink_touching", library()))
_reaching = ctypes.CFUNCTYPE(_int, _int, *[_pointer] * 2, *[_double] * 5, _pointer)(
    ("ink_reaching", library())
)


class Boxes:
    """Boxes, and where they are for the library, which is asked for them very often.

    Attributes:
        boxes: (n, 4): least x and y, greatest x and y [pixels]; NaN for none.
    """

    def __init__(self, boxes: Array) -> None:
        self.boxes = boxes
        self._found = np.empty(max(len(boxes), 2 * HEADS + 2), dtype=np.int32)
        self._at, self._into = address(boxes), address(self._found)

    def touching(self, box: Box) -> list[int]:
        """Those that have a point in one."""
        return self._first(_touching(len(self.boxes), self._at, *box, self._into))

    def _first(self, count: int) -> list[int]:
        """The first so many of what was found."""
        numbers: list[int] = self._found[:count].tolist()
        return numbers


class Near(Boxes):
    """The boxes of all pieces, and their measures."""

    def __init__(self, boxes: Array, strokes: Strokes, sizes: Array, points: NDArray[np.int64]) -> None:
        """sizes: of each: what its distances from other ink are compared with [pixels].  points: of each where they
        are, and how many."""
        super().__init__(boxes)
        self._arrays = strokes, sizes, points  # kept, as the library is told where they are
        self._box, self._tips = np.empty(4), np.empty((2, 2))
        self._samples, self._measure = address(strokes.samples), address(strokes.measure)
        self._sizes, self._points = address(sizes), address(points)
        self._into_box, self._into_tips = address(self._box), address(self._tips)

    def along(self, outline: Array, reach: float) -> tuple[list[int], Box]:
        """Those in an outline's box, widened by `reach` [pixels], whose ink may run along it, and that box (see
        core/along.c)."""
        of = len(self.boxes), self._at, self._samples, self._sizes
        count = _along(*of, address(outline), len(outline), reach, self._into_box, self._into)
        x0, y0, x1, y1 = self._box.tolist()
        return self._first(count), (x0, y0, x1, y1)

    def reaching(self, box: Box, reach: float) -> list[int]:
        """Those that may come within `reach` of two places, given the box around these [pixels] (see core/near.c)."""
        return self._first(_reaching(len(self.boxes), self._at, self._measure, *box, reach, self._into))

    def heads(
        self,
        rivals: tuple[int | None, int | None],
        shaft: int,
        tips: tuple[Point, Point],
        limits: tuple[float, float, float],
    ) -> tuple[list[int], list[int]]:
        """Those that may be a shaft's head, for each of two tips, the nearest first (see core/heads.c).

        rivals: as of `LooseEnds`.  limits: reach, span and size [pixels].
        """
        self._tips[:] = tips
        of = len(self.boxes), self._at, self._measure, self._points
        _heads(*of, *rivals, shaft, self._into_tips, *limits, self._into, self._into + 8 * HEADS)
        *near, first, second = self._first(2 * HEADS + 2)
        return near[:first], near[HEADS : HEADS + second]
