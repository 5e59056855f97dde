"""Which stretches of the skeleton run along an outline."""

from __future__ import annotations

import numpy as np

from sketch.scan.skeleton.graph import Ink
from sketch.typing import Points

__all__ = ["Stretches"]

BESIDE = 0.9  # pen widths: ink as near to an outline is its ink
MOSTLY = 0.8  # of a stretch of ink must be
PLACES = 12  # or a few less, of a stretch that are looked at


class Stretches:
    """All stretches of a skeleton, by name.

    ink: [pixels].  pen: its width [pixels].
    """

    def __init__(self, ink: Ink, pen: float) -> None:
        self.ink, self._pen = ink, pen
        self._all, self._whose = (
            np.empty(0, complex),
            np.empty(0, np.intp),
        )  # all places, once they are asked for
        some = [points[:: len(points) // PLACES + 1] for points in ink.values()]
        counts = np.array([len(points) for points in some], dtype=np.intp)
        self._first = np.cumsum(counts) - counts
        self._counts = counts
        self._names = np.array(list(ink), dtype=np.intp)
        self._at = np.round(np.concatenate([np.empty((0, 2)), *some])).astype(np.intp)

    def at(self, place: Points) -> int:
        """The one on which a place is, or that is the nearest to it."""
        if not len(self._all):
            self._all = np.concatenate(list(self.ink.values())).view(complex)[:, 0]
            self._whose = np.repeat(self._names, [len(points) for points in self.ink.values()])
        return int(self._whose[int(np.abs(self._all - complex(*place.tolist())).argmin())])

    def beside(self, outline: Points) -> frozenset[int]:
        """Those that run along an outline, shape (n, 2)."""
        import cv2

        if not len(self._names):
            return frozenset()
        margin = int(np.ceil(BESIDE * self._pen)) + 1
        corner = np.floor(outline.min(axis=0)).astype(np.intp) - margin
        width, height = (np.ceil(outline.max(axis=0)).astype(np.intp) + margin + 1 - corner).tolist()
        belt = np.zeros((height, width), np.uint8)
        way = np.round((outline - corner) * 16).astype(np.int32)
        cv2.polylines(belt, [way], True, 1, max(round(2 * BESIDE * self._pen), 1), cv2.LINE_8, 4)
        x, y = (self._at - corner).T
        within = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        on = np.zeros(len(x))
        on[within] = belt[y[within], x[within]]
        share = np.add.reduceat(on, self._first) / self._counts
        return frozenset(self._names[share >= MOSTLY].tolist())
