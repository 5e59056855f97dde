"""Ink as the recognizer sees it: each stroke measured once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sketch.ink import Sketch
from sketch.kernel import Strokes, measure

__all__ = ["Page", "Piece", "page_of"]

DOT = 0.08  # of the usual stroke's extent: in less the pen rested, and what it did there says little
OBSERVATIONS = 30  # in ink as long as the outline of a circle three times as wide as its ink's spread

Array = NDArray[np.float64]
Point = tuple[float, float]


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A stroke, or a part of one, with what every reading asks of it.

    Attributes:
        index: among the page's pieces.
        stroke: in the sketch.
        points: [pixels], shape (n, 2), without repeated points and hooks.
        ends: first and last point.
        box: least x, least y, greatest x, greatest y [pixels].
        length: along the stroke [pixels].
        gap: distance between its ends [pixels].
        extent: three times the root mean square distance from its centroid [pixels]: a size that no turn
        changes. scale: what its writer's precision goes with [pixels]: half of its extent; of a piece that
        closes, half of
            its thickness.
        observations: how many independent observations its ink is worth: neighbouring points err together,
        over
            a distance that goes with the size of what is drawn.
        residual: mean squared distance from its best polyline of k segments [pixels²], k from 1.
        vertices: of those polylines: vertices[k][:k + 1].
    """

    index: int
    stroke: int
    points: Array
    ends: tuple[Point, Point]
    box: tuple[float, float, float, float]
    length: float
    gap: float
    extent: float
    scale: float
    observations: float
    residual: list[float]
    vertices: list[list[list[float]]]

    @property
    def straight(self) -> float:
        """Root mean square distance from a straight line, as a share of its length."""
        return math.sqrt(self.residual[1]) / self.length

    def line(self, k: int) -> Array:
        """Its best polyline of k segments [pixels], (k + 1, 2)."""
        return np.array(self.vertices[k][: k + 1])


@dataclass(frozen=True, eq=False, slots=True)
class Page:
    """All pieces of a sketch.

    Attributes:
        pieces: those that have a length.
        strokes: their measures as arrays, for the fits; a piece's row is its stroke.
        size: diagonal of the ink's bounding box [pixels].
        boxes: of the pieces, (pieces, 4).
        rivals: of each piece, the other pieces that are the same ink, followed in another way: no two of them are in
            one reading.  Without any, empty.
    """

    pieces: list[Piece]
    strokes: Strokes
    size: float
    boxes: Array
    rivals: Sequence[Set[int]] = ()

    def apart(self, index: int, others: Iterable[int]) -> bool:
        """Whether a piece shares no ink with some others."""
        return not self.rivals or self.rivals[index].isdisjoint(others)

    def within(self, outline: Array, reach: float) -> list[Piece]:
        """The pieces that lie in an outline's bounding box, widened by `reach` [pixels]."""
        low, high = outline.min(axis=0) - reach, outline.max(axis=0) + reach
        b = self.boxes
        inside = (b[:, 0] >= low[0]) & (b[:, 1] >= low[1]) & (b[:, 2] <= high[0]) & (b[:, 3] <= high[1])
        return [self.pieces[i] for i in np.flatnonzero(inside).tolist()]


def page_of(sketch: Sketch) -> Page:
    strokes = measure([s.points for s in sketch.strokes])
    ends = strokes.ends.tolist()
    residuals, vertices = strokes.residual.tolist(), strokes.vertices.tolist()
    pieces: list[Piece] = []
    spread = strokes.measure[strokes.measure[:, 0] > 0, 6]
    # The median, without np.median: that loads numpy.ma, a twentieth of what reading a sketch costs.
    middle = np.sort(spread)[[(len(spread) - 1) // 2, len(spread) // 2]].mean() if len(spread) else 0.0
    dot = DOT * 3 * float(middle)
    for s, m in enumerate(strokes.measure.tolist()):
        if m[0] == 0:
            continue
        points = strokes.points[ends[s - 1] if s else 0 : ends[s]]
        pieces.append(_piece(len(pieces), s, points, m, residuals[s], vertices[s], dot))
    if not pieces:
        return Page([], strokes, 0.0, np.empty((0, 4)))
    boxes = np.array([p.box for p in pieces])
    width, height = boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)
    return Page(pieces, strokes, math.hypot(width, height), boxes)


def _piece(
    index: int,
    s: int,
    points: Array,
    m: list[float],
    residual: list[float],
    vertices: list[list[list[float]]],
    dot: float,
) -> Piece:
    length, x0, y0, x1, y1, gap, spread, across = m
    extent = 3 * spread
    first, last = points[[0, -1]].tolist()
    return Piece(
        index=index,
        stroke=s,
        points=points,
        ends=((first[0], first[1]), (last[0], last[1])),
        box=(x0, y0, x1, y1),
        length=length,
        gap=gap,
        extent=extent,
        scale=math.sqrt(2) * across if gap < 0.15 * length else extent / 2,
        observations=OBSERVATIONS * length / (math.pi * max(extent, dot)),
        residual=residual,
        vertices=vertices,
    )
