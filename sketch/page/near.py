"""Where things lie on a page, its pieces above all, to be asked which of them are near something."""

from __future__ import annotations

import ctypes
from array import array as numbers
from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import Places, Strokes
from sketch.library import address, library
from sketch.typing import Array, Box, Point

__all__ = ["Boxes", "Near", "boxes_around", "overlap"]

HEADS = 4  # as in core/heads.c

_pointer, _double, _int = ctypes.c_void_p, ctypes.c_double, ctypes.c_int32
_again = ctypes.CFUNCTYPE(
    _int, _int, *[_pointer] * 7, _int, _double, _pointer, _int, *[_double] * 2, *[_pointer] * 3
)(("ink_again", library()))
_heads = ctypes.CFUNCTYPE(None, _int, *[_pointer] * 5, _int, _pointer, *[_double] * 3, _pointer, _pointer)(
    ("ink_heads", library())
)
_touching = ctypes.CFUNCTYPE(_int, _int, _pointer, *[_double] * 4, _pointer)(("ink_touching", library()))
_reaching = ctypes.CFUNCTYPE(_int, _int, *[_pointer] * 2, *[_double] * 5, _pointer)(
    ("ink_reaching", library())
)


def boxes_around(outlines: Sequence[Array]) -> Array:
    """The boxes around outlines, each (n, 2), with a point at least: least x and y, greatest x and y, (outlines, 4)."""
    if not outlines:
        return np.empty((0, 4))
    first = np.fromiter(accumulate(map(len, outlines[:-1]), initial=0), dtype=np.intp)
    points = np.concatenate(outlines)
    return np.concatenate([np.minimum.reduceat(points, first), np.maximum.reduceat(points, first)], axis=1)


def overlap(boxes: Array, others: Array) -> Array:
    """Which of some boxes, (n, 4), have a point in common with which others, (m, 4), and no edge alone: (m, n)."""
    (x0, y0, x1, y1), (left, top, right, bottom) = boxes.T, others.T[..., None]
    # a pair at a time: numpy takes all of two in many times as long
    return np.asarray((x0 < right) & (y0 < bottom) & (x1 > left) & (y1 > top))


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

    def __init__(
        self,
        boxes: Array,
        strokes: Strokes,
        sizes: Array,
        points: NDArray[np.int64],
        places: Places,
        rivals: tuple[int | None, int | None],
    ) -> None:
        """sizes: of each: what its distances from other ink are compared with [pixels].  points: of each where they
        are, and how many.  places: of the strokes.  rivals: as of `LooseEnds`."""
        super().__init__(boxes)
        self._arrays = strokes, sizes, points  # kept, as the library is told where they are
        self._box, self._tips, self._costs = np.empty(4), np.empty((2, 2)), np.empty(len(boxes))
        self._places, self._rivals, self._measure = places, rivals, places.measure
        self._sizes, self._points = address(sizes), address(points)
        out = self._box, self._tips, self._costs
        self._into_box, self._into_tips, self._into_costs = map(address, out)

    def again(
        self, outline: Array, reach: float, names: tuple[int, ...], scale: float, shaft: float
    ) -> tuple[dict[int, float], Box]:
        """Those in an outline's box, widened by `reach` [pixels], that are drawn along it once more, with the nats to
        say each, and that box (see core/again.c).

        names: of which it is.  scale: of a body, or 0.  shaft: of an arrow, or 0 [pixels].
        """
        which = numbers("i", names)
        of = len(self.boxes), self._at, self._places.samples, self._sizes, self._places.facts, *self._rivals
        line = address(outline), len(outline), reach, address(which), len(names), scale, shaft
        count = _again(*of, *line, self._into_box, self._into, self._into_costs)
        x0, y0, x1, y1 = self._box.tolist()
        found = zip(self._first(count), self._costs[:count].tolist(), strict=True) if count else ()
        return dict(found), (x0, y0, x1, y1)

    def reaching(self, box: Box, reach: float) -> list[int]:
        """Those that may come within `reach` of two places, given the box around these [pixels] (see core/near.c)."""
        return self._first(_reaching(len(self.boxes), self._at, self._measure, *box, reach, self._into))

    def heads(
        self,
        shaft: int,
        tips: tuple[Point, Point],
        limits: tuple[float, float, float],
    ) -> tuple[list[int], list[int]]:
        """Those that may be a shaft's head, for each of two tips, the nearest first (see core/heads.c).

        limits: reach, span and size [pixels].
        """
        self._tips[:] = tips
        of = len(self.boxes), self._at, self._measure, self._points
        _heads(*of, *self._rivals, shaft, self._into_tips, *limits, self._into, self._into + 8 * HEADS)
        *near, first, second = self._first(2 * HEADS + 2)
        return near[:first], near[HEADS : HEADS + second]
