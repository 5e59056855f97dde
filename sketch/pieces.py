"""Ink as the recognizer sees it: each stroke measured once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sketch.ink import Sketch
from sketch.kernel import OpenFit, fit_open

__all__ = ["Piece", "cut_into_pieces"]

OBSERVATIONS = 30  # in the ink of a circle's length over its diameter

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Piece:
    """A stroke, or a part of one, with what every reading asks of it.

    Attributes:
        stroke: index in the sketch.
        points: [pixels], shape (n, 2), without repeated points and hooks.
        fit: its polylines.
    """

    stroke: int
    points: Array
    fit: OpenFit

    @property
    def length(self) -> float:
        return self.fit.length

    @cached_property
    def extent(self) -> float:
        """Diagonal of the bounding box [pixels]."""
        size = np.ptp(self.points, axis=0)
        return float(np.hypot(size[0], size[1]))

    @cached_property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        (a, b), (c, d) = self.points[0].tolist(), self.points[-1].tolist()
        return (a, b), (c, d)

    @cached_property
    def gap(self) -> float:
        """Distance between its ends [pixels]."""
        (a, b), (c, d) = self.ends
        return float(np.hypot(c - a, d - b))

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        lo, hi = self.points.min(axis=0), self.points.max(axis=0)
        return float(lo[0]), float(lo[1]), float(hi[0]), float(hi[1])

    @cached_property
    def straight(self) -> float:
        """Root mean square distance from its chord's best line, as a share of its length."""
        return float(np.sqrt(self.fit.residual[1])) / max(self.length, 1e-9)

    @cached_property
    def observations(self) -> float:
        """How many independent observations its ink is worth: neighbouring points err together, over a distance that
        goes with the size of what is drawn."""
        return OBSERVATIONS * self.length / (math.pi * max(self.extent, 1e-9))

    @cached_property
    def scale(self) -> float:
        """Half of its extent; of a piece that closes, half of its thickness [pixels]."""
        if self.gap > 0.15 * self.length:
            return self.extent / 2
        around = self.fit.samples - self.fit.samples.mean(axis=0)
        return math.sqrt(2 * max(float(np.linalg.eigvalsh(around.T @ around)[0]) / len(around), 0.0))


def cut_into_pieces(sketch: Sketch) -> list[Piece]:
    pieces = []
    for i, stroke in enumerate(sketch.strokes):
        if not stroke.has_length:
            continue
        points = _without_hooks(_without_repeats(stroke.points))
        pieces.append(Piece(i, points, fit_open(points)))
    return pieces


def _without_repeats(points: Array) -> Array:
    keep = np.ones(len(points), dtype=bool)
    keep[1:] = (points[1:] != points[:-1]).any(axis=1)
    return points[keep]


def _without_hooks(points: Array) -> Array:
    """The stroke without the little turn back that a pen leaves where it goes down or up.

    A hook is a sharp turn (over 60°) in the first or last twentieth of the length.
    """
    if len(points) < 5:
        return points
    steps = np.diff(points, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    around = points - points.mean(axis=0)
    thickness = 4 * math.sqrt(max(float(np.linalg.eigvalsh(around.T @ around)[0]) / len(points), 0.0))
    reach = min(0.05 * along[-1], 0.2 * thickness)  # a thin box's short side is no hook
    first = _hook_end(points, along, reach)
    backwards = (along[-1] - along)[::-1]
    last = len(points) - _hook_end(points[::-1], backwards, reach)
    return points[first:last] if last - first >= 3 else points


def _hook_end(points: Array, along: Array, reach: float) -> int:
    """The index of the last sharp turn within `reach` of the start, 0 for none."""
    stop = int(np.searchsorted(along, reach, side="right"))
    best = 0
    for i in range(1, min(stop, len(points) - 1)):
        ahead = points[min(int(np.searchsorted(along, along[i] + reach)), len(points) - 1)] - points[i]
        back = points[i] - points[0]
        if float(ahead @ back) < 0.5 * float(np.hypot(*ahead) * np.hypot(*back)):
            best = i
    return best
