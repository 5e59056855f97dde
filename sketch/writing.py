"""Writing beside a machine: small strokes in a row, some of which mean nothing, are letters, and so are the rings and
crosses among them. A line with a mark at either end says how long something is."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import depth
from sketch.pieces import Page, Piece
from sketch.proposals import Proposed, Row
from sketch.scoring import Fitted

__all__ = ["LARGEST", "WRITTEN", "written"]

Array = NDArray[np.float64]
Pick = tuple[int, int]  # what was proposed by which piece, and which of it
Rows = dict[int, set[int]]  # of each small stroke those that mean nothing in the row that it stands in

# nats that another thing in a row is likelier a letter, for each stroke there that means nothing
WRITTEN = 60.0
LARGEST = 0.05  # of what is drawn: nobody writes larger beside a drawing
BETWEEN = 1.0  # of the larger one's extent: what is between the strokes of a word, or of two, at most
UNLIKE = 4.0  # times that strokes of one word are as large as others: a letter's bar, and its stem
TALL = 2.2  # times that a thing in a word is as large as the largest stroke there, at most
OVER = 1.2  # times as large as a mark is what it is a mark on, at least
FEW = 16  # points of a stroke that are compared with others
MEASURE = 30.0  # nats that a line with a mark at either end is no rod
MARK = 0.25  # of its length: as large as those are,
AT_END = 0.05  # and as near to its ends,
ON = 0.02  # while others that are nearer to it mean something else: hatching, a floor


def written(
    page: Page, proposed: list[Proposed], told: list[list[float]], likely: list[Pick]
) -> list[list[float]]:
    """Gains, less what rings, crosses and bars lose by what is written there.

    told: the gains of all that is proposed.  likely: which of it the ink makes likely.
    """
    chosen = [(proposed[p].candidates[k], told[p][k]) for p, k in likely]
    # an X loses by its surroundings where no body is
    crosses = {c for (c, gain), (p, k) in zip(chosen, likely, strict=True) if gain < proposed[p].gains[k]}
    idle = page.pieces.keys() - {
        i for c, _ in chosen if c.kind != "bar" and not (c.kind == "cross" and c in crosses) for i in c.pieces
    }
    if not idle:
        return told
    marks = _Marks(chosen, [proposed[p].rows[k] for p, k in likely], LARGEST * page.drawn)
    small = _Small(page, [p for p in page.pieces.values() if p.extent < marks.largest])
    while True:
        rows = small.rows(idle)
        lost = {
            i
            for c, gain in chosen
            if not rows.keys().isdisjoint(c.pieces) and gain < marks.loss(page, rows, c)
            for i in c.pieces
        }
        if lost <= idle:
            break
        idle |= lost
    lone = [page.pieces[i] for i in sorted(idle)]
    lines = (p.candidates[k] for p, gains in zip(proposed, told, strict=True) for k in p.bars if gains[k] > 0)
    measured = {i for bar in lines if idle.issuperset(bar.pieces) for i in _measured(page, bar, lone)}
    touched = rows.keys() | measured
    out = list(told)
    for n, p in enumerate(proposed):
        if touched.isdisjoint(p.alone.pieces):
            continue
        own = out[n] = list(told[n])
        for k, c in enumerate(p.candidates):
            if own[k] > 0 and not touched.isdisjoint(c.pieces):
                own[k] -= marks.loss(page, rows, c)
                own[k] -= MEASURE * (c.kind == "bar" and not measured.isdisjoint(c.pieces))
    return out


class _Marks:
    """What the ink makes likely, to be asked whether a reading may be a letter instead.

    Attributes:
        largest: of what is written [pixels].
    """

    def __init__(self, likely: Sequence[tuple[Fitted, float]], rows: Sequence[Row], largest: float) -> None:
        """rows: where those that are likely lie, as of `Proposed`."""
        self.largest = largest
        self._bodies = [c for c, _ in likely if c.closed]
        where = np.array([row for (c, _), row in zip(likely, rows, strict=True) if c.closed]).reshape(-1, 5)
        self._boxes, self._extents = where[:, :4], where[:, 4]
        self._known: dict[Fitted, bool] = {}

    def loss(self, page: Page, rows: Rows, c: Fitted) -> float:
        """Nats that a reading is rarer, given the strokes that mean nothing in the rows that its pieces stand in."""
        beside = set[int]().union(*(rows.get(i, ()) for i in c.pieces)).difference(c.pieces)
        if not beside or c.kind == "arrow":
            return 0.0
        extent = _extent(c)
        said = WRITTEN * sum(extent < TALL * page.pieces[i].extent for i in beside)
        if not said or extent >= self.largest:
            return 0.0
        if c not in self._known:
            self._known[c] = self._may_be_written(c, extent)
        return said if self._known[c] else 0.0

    def _may_be_written(self, c: Fitted, extent: float) -> bool:
        """Whether it is no X on a body, and no pivot: of two bodies, or the only one of its body."""
        if c.kind not in ("circle", "cross") or not (under := self._under(c, extent)):
            return True
        return c.kind == "circle" and len(under) == 1 and self._is_pinned_again(under[0], c)

    def _is_pinned_again(self, body: Fitted, c: Fitted) -> bool:
        """Whether another small ring than c lies over a body and no other."""
        low, high = body.outline.min(axis=0), body.outline.max(axis=0)
        middles = (self._boxes[:, :2] + self._boxes[:, 2:]) / 2
        near = (self._extents < self.largest) & ((middles > low) & (middles < high)).all(axis=1)
        rings = (self._bodies[k] for k in np.flatnonzero(near).tolist())
        return any(
            ring.kind == "circle" and ring.pieces != c.pieces and self._under(ring, _extent(ring)) == [body]
            for ring in rings
        )

    def _under(self, c: Fitted, extent: float) -> list[Fitted]:
        """The bodies of other ink, that are larger, that its middle is over."""
        at = np.array(c.middle)
        near = (self._boxes[:, :2] < at).all(axis=1) & (self._boxes[:, 2:] > at).all(axis=1)
        near &= self._extents > OVER * extent
        bodies = (self._bodies[k] for k in np.flatnonzero(near).tolist())
        return [b for b in bodies if set(c.pieces).isdisjoint(b.pieces) and depth(*c.middle, b.outline) < 0]


def _extent(c: Fitted) -> float:
    """The diagonal of a reading's bounding box [pixels]."""
    return math.dist(c.outline.min(axis=0), c.outline.max(axis=0))


class _Small:
    """The strokes that may be in a row, to be asked which stand in one."""

    def __init__(self, page: Page, pieces: Sequence[Piece]) -> None:
        self._page, self._pieces = page, {p.index: p for p in pieces}
        self._indices = np.array([p.index for p in pieces], dtype=np.intp)
        self._boxes = np.array([p.box for p in pieces]).reshape(-1, 4)
        self._extents = np.array([p.extent for p in pieces])
        self._near: dict[int, list[int]] = {}

    def rows(self, idle: Collection[int]) -> Rows:
        """idle: the strokes that mean nothing."""
        left, rows = set(self._pieces), Rows()
        for start in sorted(idle):
            if start not in left:
                continue
            left.remove(start)
            row = [start]
            for i in row:  # it grows meanwhile
                near = [j for j in self.near(i) if j in left]
                left.difference_update(near)
                row += near
            its = {i for i in row if i in idle}
            rows.update((i, its) for i in row)
        return rows

    def near(self, i: int) -> list[int]:
        """The strokes that are as near to one, and as alike in size, as those of a word."""
        if i not in self._near:
            p = self._pieces[i]
            large = np.maximum(p.extent, self._extents)
            reach = BETWEEN * large[:, None]
            close = (self._boxes[:, :2] < p.box[2:] + reach) & (self._boxes[:, 2:] > p.box[:2] - reach)
            close[:, 0] &= large <= UNLIKE * np.minimum(p.extent, self._extents)
            some = self._indices[close.all(axis=1)].tolist()
            self._near[i] = [j for j in some if j != i and self._joins(p, self._pieces[j])]
        return self._near[i]

    def _joins(self, p: Piece, q: Piece) -> bool:
        """Whether the ink of two strokes is no further apart than that of a word."""
        one, other = (self._page.strokes.samples[r.stroke] for r in (p, q))
        step = max(len(one) // FEW, 1)
        gaps = one[::step, None] - other[None, ::step]
        return bool((gaps**2).sum(axis=2).min() < (BETWEEN * max(p.extent, q.extent)) ** 2)


def _boxes_near(p: Piece, q: Piece, reach: float) -> bool:
    (a, b, c, d), (e, f, g, h) = p.box, q.box
    return e < c + reach and f < d + reach and g > a - reach and h > b - reach


def _measured(page: Page, bar: Fitted, idle: Sequence[Piece]) -> set[int]:
    """A line and the small marks at its ends, if there is one at either end, that means nothing else, and none between
    them: their pieces."""
    ends = bar.outline[[0, -1]]
    long = math.dist(*ends.tolist())
    its = [page.pieces[i] for i in bar.pieces]
    near = [
        q
        for q in idle
        if q.extent < MARK * long and q not in its and any(_boxes_near(p, q, AT_END * long) for p in its)
    ]
    if len(near) < 2:
        return set()
    inks = [page.strokes.samples[q.stroke] for q in near]
    at = np.array(
        [np.hypot(*(ink[:, None] - ends).transpose(2, 0, 1)).min(axis=0) < AT_END * long for ink in inks]
    )
    (ax, ay), (ux, uy) = ends[0], (ends[1] - ends[0]) / max(long, 1e-9)
    off = np.array([np.abs((ink[:, 1] - ay) * ux - (ink[:, 0] - ax) * uy).min() for ink in inks])
    there = np.asarray(at.any(axis=1))
    if not (at.any(axis=0).all() and (there | (off > ON * long)).all()):
        return set()
    return {*bar.pieces, *(q.index for q, end in zip(near, there, strict=True) if end)}
