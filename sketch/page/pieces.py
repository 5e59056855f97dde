"""Ink as the recognizer sees it: each stroke measured once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np

from sketch.kernel import joined, measure, places
from sketch.lazy import lazy
from sketch.library import address
from sketch.page.loose import Chain, End, LooseEnds
from sketch.page.near import Near
from sketch.scoring import ONE_MORE, unread
from sketch.typing import Array, Point

__all__ = ["Looked", "Page", "Piece"]

SPECK = 1 / 8  # of the canvas: what is drawn on less of it is small, not a page of its own
DOT = 0.08  # of the usual stroke's extent: in less the pen rested, and what it did there says little
ONCE = 1.2  # of its extent: a straight line that is longer is gone over again; one that is not is 1.15 extents long
LINE = 0.03  # of its extent: how far across ink is, at most, that goes over one straight line again
MOST_AGAIN = 24  # pieces that are drawn along one outline once more: in shading, and in a net, most are
OBSERVATIONS = 30  # in ink as long as the outline of a circle three times as wide as its ink's spread
FACTS = 6  # numbers of a struct Facts of core/facts.h


NOTHING = measure([])


@dataclass(eq=False)  # frozen, it would take four times as long to make
class Piece:
    """A stroke, or a part of one, with what every reading asks of it. Never changed once it is made.

    Attributes:
        index: among the page's pieces.
        stroke: in the sketch.
        points: [pixels], shape (n, 2), without repeated points and hooks.
        ends: first and last point.
        box: least x, least y, greatest x, greatest y [pixels].
        length: along the stroke [pixels].
        gap: distance between its ends [pixels].
        extent: three times the root mean square distance from its centroid [pixels]: a size that no turn changes.
        scale: what its writer's precision goes with [pixels]: half of its extent; of a piece that closes, half of
            its thickness.
        observations: how many independent observations its ink is worth: neighbouring points err together, over
            a distance that goes with the size of what is drawn.
        residual: mean squared distance from its best polyline of k segments [pixels²], k from 1.
        vertices: of those polylines: vertices[k, :k + 1].
        across: root mean square distance from its longer axis [pixels].
        given: of few points in equal steps of length those that the stroke came with, without corners between them.
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
    vertices: Array
    across: float
    given: Array | None = None

    @lazy
    def straight(self) -> float:
        """Root mean square distance from a straight line, as a share of its length."""
        return math.sqrt(self.residual[1]) / self.length

    @lazy
    def retraces(self) -> bool:
        """Whether it goes along a straight line, and over that again."""
        return self.length > ONCE * self.extent and self.across < LINE * self.extent

    @lazy
    def reach(self) -> tuple[Point, Point]:
        """Of a straight line, where it begins and ends: at its ends, if it does not go over itself."""
        if not self.retraces:
            return self.ends
        steps = np.diff(self.points, axis=0)
        long, halfway = np.hypot(*steps.T)[:, None], self.points[:-1] + steps / 2
        middle = (long * halfway).sum(axis=0) / long.sum()
        from_middle = halfway - middle
        along = np.linalg.eigh((long * from_middle).T @ from_middle)[1][:, 1]
        at = (self.points - middle) @ along
        (ax, ay), (bx, by) = (middle + np.outer((at.min(), at.max()), along)).tolist()
        return (ax, ay), (bx, by)

    @lazy
    def unread(self) -> float:
        """Nats to say its ink freely."""
        return unread(self)

    def is_near(self, other: Piece, reach: float) -> bool:
        """Whether its box comes within `reach` of another's [pixels]."""
        (a, b, c, d), (e, f, g, h) = self.box, other.box
        return e < c + reach and f < d + reach and g > a - reach and h > b - reach

    def line(self, k: int) -> Array:
        """Its best polyline of k segments [pixels], (k + 1, 2)."""
        return self.vertices[k, : k + 1].copy()

    def corners(self, k: int) -> list[list[float]]:
        """The same as numbers. Few are asked for: they are not kept."""
        corners: list[list[float]] = self.vertices[k, : k + 1].tolist()
        return corners


@dataclass(eq=False, slots=True)
class Looked:
    """What somebody asked of the page: the answers stay the same while no ink comes or goes there.

    Attributes:
        boxes: least x, least y, greatest x, greatest y [pixels].
        ends: whose neighbours were asked for.
    """

    boxes: list[tuple[float, float, float, float]] = field(default_factory=list)
    ends: set[End] = field(default_factory=set)


class Page:
    """The pieces of a sketch: they come and go, and keep their index.

    Attributes:
        pieces: by index, those that have a length, in the order of drawing.
        strokes: their measures as arrays, for the fits; a piece's row is its stroke.
        size: of the page [pixels]; the canvas', or so much more as the ink takes.
        drawn: how much of it the ink takes [pixels], whatever the canvas, short of specks on it.
        rivals: of each stroke, the others that are the same ink, followed in another way: no two of them are in
            one reading.  Without any, empty.
        ends: of its pieces, as far as they are loose.
        looked: where it is noted what is asked of the page.
        places: where the library finds what is known of its strokes.
    """

    def __init__(self, canvas: float = 0.0, rivals: Sequence[Set[int]] = ()) -> None:
        """canvas: its diagonal [pixels], or 0."""
        self.rivals = rivals
        self.pieces: dict[int, Piece] = {}
        self.strokes = NOTHING
        self.size = self.drawn = self._canvas = canvas
        self.ends = LooseEnds(rivals)
        self.looked = Looked()
        self._dot = 0.0
        self._boxes = np.empty((0, 4))
        self._sizes = np.empty(0)  # of each: what its distances from other ink are compared with [pixels]
        self._points = np.empty((0, 2), dtype=np.int64)  # of each piece where its points are, and how many
        self._facts = np.empty((0, FACTS))  # of each, as of core/facts.h
        self._fresh: list[int] = []  # those of which these are not known yet

    def add(self, strokes: list[Array], given: Sequence[Array | None] = ()) -> range:
        """Measure further strokes, each (n, 2) in pixels; returns their indices.

        given: of each, if of any, which of its points it came with, where they are few and in equal steps.
        """
        first = len(self._boxes)
        new, count = measure(strokes), len(strokes)
        self.strokes = joined(self.strokes, new) if first else new
        stops = new.ends.tolist()
        bounds = list(zip([0, *stops], stops, strict=False))
        self._boxes = np.concatenate([self._boxes, np.full((count, 4), np.nan)])
        self._sizes = np.concatenate([self._sizes, np.zeros(count)])
        ends = np.zeros((count, 2, 2))
        at = address(new.points)
        places = [(at + 16 * begin, end - begin) for begin, end in bounds]
        self._points = np.concatenate([self._points, np.array(places, dtype=np.int64)])
        residuals = new.residual.tolist()
        for k, m in enumerate(new.measure.tolist()):
            if m[6] > 0:  # of a length, and not so tiny that nothing is left of its square
                i, points = first + k, new.points[slice(*bounds[k])]
                few = given[k] if given else None
                few = None if few is None else _among(points, few)
                piece = _piece(i, i, points, m, residuals[k], new.vertices[k], self._dot, few)
                self.pieces[i] = piece
                self._boxes[i], ends[k] = piece.box, piece.ends
                self._sizes[i] = max(piece.scale, piece.extent / 2)
        self.ends.add(ends, new.measure[:, 0])
        self._facts = np.concatenate([self._facts, np.zeros((count, FACTS))])
        self._fresh += range(first, first + count)
        self._look()
        return range(first, first + count)

    def _look(self) -> None:
        """Find anew where all is: there is other ink."""
        self.places = places(self.strokes, self._facts)
        of = self._boxes, self.strokes, self._sizes, self._points
        self._near = Near(*of, self.places, self.ends.rivals)

    def remove(self, index: int) -> None:
        """Take a piece away, which is not loose any more."""
        if self.pieces.pop(index, None) is not None:
            self._boxes[index] = np.nan

    def settle(self) -> list[int]:
        """Measure the page's size and its usual stroke anew; returns the pieces that are other pieces now."""
        live = list(self.pieces)
        extents = [p.extent for p in self.pieces.values()]
        in_order, half = sorted(extents), len(live) // 2
        dot = DOT * (in_order[half] + in_order[~half]) / 2 if live else 0.0  # of the median
        less = max(dot, self._dot) if dot != self._dot else 0.0
        changed = [i for i, extent in zip(live, extents, strict=True) if extent < less]
        self._dot = dot
        for i in changed:
            p = self.pieces[i]
            self.pieces[i] = replace(p, observations=_observations(p.length, p.extent, dot))
        other = [self.pieces[i] for i in {*changed, *self._fresh} if i in self.pieces]
        self._facts[[p.index for p in other]] = [
            (p.observations, p.scale, p.extent, p.unread, p.gap, p.length) for p in other
        ] or np.empty((0, FACTS))
        self._fresh.clear()
        self.size = self.drawn = self._canvas
        if live:
            boxes = self._boxes[live]
            ink = math.hypot(*(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)).tolist())
            # In steps, so that a page that grows is seldom another page.
            stepped = 2 ** (math.ceil(2 * math.log2(ink)) / 2)
            self.size = stepped if ink > self._canvas else self._canvas
            self.drawn = max(SPECK * self._canvas, stepped)
        return changed

    # ------------------------------------------------------------ what lies where

    def apart(self, index: int, others: Iterable[int]) -> bool:
        """Whether a piece shares no ink with some others."""
        return not self.rivals or self.rivals[index].isdisjoint(others)

    def again(
        self, outline: Array, reach: float, names: tuple[int, ...], scale: float, shaft: float = 0.0
    ) -> dict[int, float]:
        """The pieces that are drawn along an outline once more, with the nats to say each, fewer than it takes freely;
        of many those that save the most, these first.

        reach: as far from the outline's box as they are [pixels].  names: the pieces that the outline is of.
        scale: of a body, which is drawn over no more precisely than it is; 0 for a mark [pixels].
        shaft: of an arrow its length, else 0 [pixels].
        """
        costs, box = self._near.again(outline, reach, names, scale, shaft)
        self.looked.boxes.append(box)
        if len(costs) > ONE_MORE:
            most = sorted(costs, key=lambda i: costs[i] - self.pieces[i].unread)[:MOST_AGAIN]
            costs = {i: costs[i] for i in most}
        return costs

    def touching(self, x0: float, y0: float, x1: float, y1: float) -> list[Piece]:
        """The pieces whose bounding box has a point in this one."""
        self.looked.boxes.append((x0, y0, x1, y1))
        return self.around(x0, y0, x1, y1)

    def around(self, x0: float, y0: float, x1: float, y1: float) -> list[Piece]:
        """The same, asked for an answer that is not kept: nothing is noted of it."""
        return [self.pieces[i] for i in self._near.touching((x0, y0, x1, y1))]

    def reaching(self, a: Point, b: Point, reach: float) -> list[Piece]:
        """The pieces of which both of two places are within `reach` [pixels], for all that their boxes tell; of a long
        one it is a step of its samples more."""
        (x0, x1), (y0, y1) = sorted((a[0], b[0])), sorted((a[1], b[1]))
        self.looked.boxes.append((x0 - reach, y0 - reach, x1 + reach, y1 + reach))
        return [self.pieces[i] for i in self._near.reaching((x0, y0, x1, y1), reach)]

    def heads(
        self, shaft: Piece, tips: tuple[Point, Point], reach: float, span: float, size: float
    ) -> tuple[list[int], list[int]]:
        """For each of its tips the pieces that may be a shaft's head, the nearest first: those that come within
        `reach` of it, go no further than `span`, and are no larger than `size` [pixels]."""
        self.looked.boxes += [(x - reach, y - reach, x + reach, y + reach) for x, y in tips]
        return self._near.heads(shaft.index, tips, (reach, span, size))

    def chains(self, start: int) -> list[tuple[float, float, float, Chain]]:
        """As of `LooseEnds.chains`."""
        found, asked = self.ends.chains(start)
        self.looked.ends |= asked
        return found

    def open_ways(self, start: int) -> list[Chain]:
        """As of `LooseEnds.open_ways`."""
        found, asked = self.ends.open_ways(start)
        self.looked.ends |= asked
        return found


def _among(points: Array, given: Array) -> Array:
    """Those of the given points that are left among a piece's."""
    left = set(map(tuple, points.tolist()))
    return given[[(x, y) in left for x, y in given.tolist()]]


def _piece(
    index: int,
    s: int,
    points: Array,
    m: list[float],
    residual: list[float],
    vertices: Array,
    dot: float,
    given: Array | None,
) -> Piece:
    length, x0, y0, x1, y1, gap, spread, across = m
    extent = 3 * spread
    first, last = points[:: len(points) - 1].tolist()
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
        observations=_observations(length, extent, dot),
        residual=residual,
        vertices=vertices,
        across=across,
        given=given,
    )


def _observations(length: float, extent: float, dot: float) -> float:
    tap = min(2 * extent / dot, 1.0) if dot else 1.0  # in half of a dot how the pen trembled says nothing
    return tap * OBSERVATIONS * length / (math.pi * max(extent, dot))
