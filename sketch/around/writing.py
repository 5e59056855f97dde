"""Writing beside a machine: small strokes in a row, some of which mean nothing, are letters, and so are the rings and
crosses among them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set

import numpy as np

from sketch.around.dimensions import dimension_line
from sketch.around.hatching import hatching
from sketch.around.pins import REACH, is_over, stands_on
from sketch.around.rows import TALL, Rows, near_one_another
from sketch.kernel import depth
from sketch.page.near import overlap
from sketch.page.pieces import Page
from sketch.scoring import Fitted
from sketch.shapes.proposals import Pick, Proposed, Row
from sketch.typing import Array, Point

__all__ = ["LARGEST", "WITHIN", "WRITTEN", "written"]

# nats that another thing in a row is likelier a letter, for each stroke there that means nothing
WRITTEN = 60.0
LARGEST = 0.05  # of what is drawn: nobody writes larger beside a drawing
WITHIN = 2 * WRITTEN  # likewise of what is drawn over a body, which else is a mark on it
# times that it is as large as a letter there, at most: marks are larger than what is written at them; in one stroke
# with loops, as those of a digit beside an "m", an X is one less likely than in two
MARKED = {"circle": 1.7, "looped": 1.7, "cross": 1.25}
# of the larger stroke: between a letter and the next, at most; a mark is set apart, and of two bars
NEXT = {"circle": 0.5, "cross": 0.35}
SAME = 0.1  # and between strokes of one
CLEAR = 0.08  # of a body's narrower half: as far from its outline as what is written in it is, at least
JOINED = 0.35  # of a bar of an X: as near to its ends are those of what joins them
SHORT = 0.6  # likewise: what is among them and no longer is a loose side of the X
SPOKE = 0.05  # of its length, what a spoke bends
STRAIGHT = 0.9  # of its length, the distance of the ends of a letter's bar, at least
OVER = 1.2  # times as large as a mark is what it is a mark on, at least
HATCHED = WRITTEN  # nats that a stroke of hatching is no side of an outline
LEFT = WITHIN  # nats that an outline no larger than a letter is rarer, if all of it is such as tracing left
MEASURE = WRITTEN  # nats that a line with a mark at either end is no rod


def written(
    page: Page,
    proposed: list[Proposed],
    told: list[list[float]],
    likely: list[Pick],
    pointing: set[int],
    remains: frozenset[int],
) -> list[list[float]]:
    """Gains, less what rings, crosses and bars lose by what is written there.

    told: the gains of all that is proposed.  likely: which of it the ink makes likely.  pointing: the pieces of arrows
    that are no gravity.  remains: what tracing left of the ink of others, which means nothing and is no letter.
    """
    chosen = [(proposed[p].candidates[k], told[p][k], proposed[p].rows[k]) for p, k in likely]
    open_lines = [
        (c, *proposed[p].course(c)) for (p, _), (c, *_) in zip(likely, chosen, strict=True) if c.kind == "bar"
    ]
    marks = _Marks(page, [(c, row) for c, _, row in chosen], open_lines, LARGEST * page.drawn)
    letters = marks.in_bodies() - remains
    pins = {  # among those, each as a ring
        i
        for p, _ in (likely if letters else ())
        for c, gain, row in zip(proposed[p].candidates, told[p], proposed[p].rows, strict=True)
        if gain > 0 and not letters.isdisjoint(c.pieces) and marks.joins(c, row[4])
        for i in c.pieces
    }
    alone = (proposed[p].gains[k] for p, k in likely)  # an X loses by its surroundings where no body is
    idle_crosses = {
        c for (c, gain, _), own in zip(chosen, alone, strict=True) if c.kind == "cross" and gain < own
    }
    meant = {i for c, *_ in chosen if c.kind != "bar" and c not in idle_crosses for i in c.pieces}
    unmeant = page.pieces.keys() - meant - remains
    rows, idle, known = _spread(page, marks, chosen, pointing | unmeant | letters - pins)
    lone = [page.pieces[i] for i in sorted(idle)]
    bars = (p.candidates[k] for p, gains in zip(proposed, told, strict=True) for k in p.bars if gains[k] > 0)
    lines = (dimension_line(page, bar, lone) for bar in bars if idle >= set(bar.pieces))
    measured = pointing.union(*lines)
    hatched = hatching(page, marks.largest, idle)
    touched = rows.of.keys() | measured | letters | hatched | remains
    out = list(told)
    for n, p in enumerate(proposed):
        if touched.isdisjoint(p.pieces):
            continue
        own = out[n] = list(told[n])
        for k, (c, row) in enumerate(zip(p.candidates, p.rows, strict=True)):
            if own[k] > 0 and not touched.isdisjoint(c.pieces):
                own[k] -= known[c] if c in known else marks.loss(rows, c, row)
                own[k] -= MEASURE * (c.kind == "bar" and not measured.isdisjoint(c.pieces))
                if c.closed and not letters.isdisjoint(c.pieces):
                    own[k] -= WITHIN * (c.kind != "circle" or pins.isdisjoint(c.pieces))
                own[k] -= HATCHED * (c.closed and len(hatched.intersection(c.pieces)))
                own[k] -= LEFT * (c.closed and row[4] < marks.largest and remains.issuperset(c.pieces))
    return out


def _spread(
    page: Page, marks: _Marks, chosen: Sequence[tuple[Fitted, float, Row]], idle: Set[int]
) -> tuple[Rows, Set[int], dict[Fitted, float]]:
    """The rows of strokes that mean nothing, as they make letters of what is beside them, and these of what is beside
    these, until nothing changes; which strokes mean nothing then; and what each of the likely readings loses [nats].

    chosen: the likely readings, each with its gain, and where it is.  idle: what means nothing by itself.
    """
    near, fresh = near_one_another(page, marks.largest, idle), idle
    rows = Rows(page, near, idle)
    known = dict[Fitted, float]()
    while fresh:
        anew = {id(rows.of[i]) for i in fresh & rows.of.keys()}
        lost = set[int]()
        for c, gain, row in chosen:
            if any(id(rows.of.get(i)) in anew for i in c.pieces):
                known[c] = loss = marks.loss(rows, c, row)
                lost.update(c.pieces if gain < loss else ())
        fresh = lost - idle
        if fresh:
            idle = idle | fresh
            rows = Rows(page, near, idle)
    return rows, idle, known


class _Marks:
    """What the ink makes likely, to be asked whether a reading may be a letter instead.

    Attributes:
        largest: of what is written [pixels].
    """

    def __init__(
        self,
        page: Page,
        likely: Sequence[tuple[Fitted, Row]],
        lines: Sequence[tuple[Fitted, Array, Row]],
        largest: float,
    ) -> None:
        """likely: with where they lie, as of `Proposed`.  lines: those that are open, along their ink, likewise."""
        self.largest = largest
        self._page = page
        self._bodies = [c for c, _ in likely if c.closed]
        self._lines = lines
        where = np.array([row for c, row in likely if c.closed]).reshape(-1, 5)
        self._boxes, self._extents = where[:, :4], where[:, 4]
        self._known: dict[Fitted, list[Fitted]] = {}
        self._held: dict[tuple[int, Fitted], bool] = {}
        # of each body the rings on it and no other
        self._rings: dict[Fitted, list[tuple[int, ...]]] | None = None

    def in_bodies(self) -> set[int]:
        """The pieces of small outlines, of anything but a ring, within bodies: letters, as no body is there."""
        small = [k for k in np.flatnonzero(self._extents < self.largest) if self._bodies[k].kind != "circle"]
        # within each other's: from its greatest to its least x and y, a box is within those that it overlaps
        held = overlap(self._boxes, self._boxes[small][:, [2, 3, 0, 1]])
        found = set[int]()
        for k, b in np.argwhere(held).tolist():
            c, body = self._bodies[small[k]], self._bodies[b]
            apart = (
                set(c.pieces).isdisjoint(body.pieces) and self._extents[b] > OVER * self._extents[small[k]]
            )
            if apart and all(depth(x, y, body.outline) < 0 for x, y in c.outline.tolist()):
                found.update(c.pieces)
        return found

    def loss(self, rows: Rows, c: Fitted, where: Row) -> float:
        """Nats that a reading is rarer, given the strokes that mean nothing in the rows that its pieces stand in.

        A pivot is no letter. What else is drawn over a body is one if they are within that body too, and
        next to it.
        """
        if where[4] >= self.largest or c.kind == "arrow":
            return 0.0
        single = len(c.pieces) == 1
        # as large as the strokes of a letter are, whatever was made of them
        size = max(self._page.pieces[i].extent for i in c.pieces) if single or not c.closed else where[4]
        beside = rows.beside(c.pieces, size)
        near = rows.near_idle(c.pieces) if beside or single else []
        halves = self._halves(c, near, rows.middles) if near and single and c.closed else []
        if near and c.closed:  # what is written in a body does not make a letter of it
            x0, y0, x1, y1, _ = where
            for i in set(near).difference(halves):
                x, y = rows.middles[i]
                tall = (
                    x0 < x < x1 and y0 < y < y1 and size < TALL * self._page.pieces[i].extent <= TALL * size
                )
                beside -= tall and self._holds(c, i)
        beside += sum(TALL * self._page.pieces[i].extent <= size for i in halves)
        if not beside or c.kind not in ("circle", "cross"):
            return WRITTEN * beside
        under = self._under(c, where[4])
        if self.joins(c, where[4]):
            return 0.0
        if not under:
            on_line = c.kind == "cross" and any(stands_on(c, where[4], *line) for line in self._lines)
            return WRITTEN * beside * (not on_line)
        every = rows.idle(c.pieces, size * TALL / MARKED["circle"]) if c.kind == "circle" else []
        on = {i for i in every if self._is_on(under, i) and not self._is_spoke(c, size, i)}.union(halves)
        if on and c.kind == "circle" and self._is_pinned_again(under[0], c):
            return WITHIN * len(on)
        large = {i for i in near if size < TALL * self._page.pieces[i].extent}.union(halves)
        if c.kind == "cross":  # what is among its strokes joins its bars, and is no letter beside them
            large = {i for i in large if not self._is_between(c, i)}
        return WITHIN * sum(
            self._is_on(under, i) and not self._is_spoke(c, size, i) and self._is_next(c, size, i)
            for i in large
        )

    def _halves(self, c: Fitted, near: list[int], middles: Mapping[int, Point]) -> list[int]:
        """Of strokes those that go through an outline in one stroke, from side to side: of a theta."""
        ring, (x, y), found = self._page.pieces[c.pieces[0]], c.middle, []
        off = ring.extent / 3
        for i in near:
            u, v = middles[i]
            if not (-off < u - x < off and -off < v - y < off):
                continue
            p, ink = self._page.pieces[i], self._page.strokes.samples[ring.stroke, :, None]
            if p.gap > STRAIGHT * p.length:
                gaps = np.hypot(*(ink - p.ends).transpose(2, 0, 1)).min(axis=0)
                if gaps.max() < SAME * ring.extent:
                    found.append(i)
        return found

    def joins(self, c: Fitted, extent: float) -> bool:
        """Whether it is a ring over two things, bodies or open lines: a pivot, however rough."""
        if c.kind != "circle":
            return False
        bodies = len(self._under(c, extent))
        return (
            bodies > 1 or bodies + sum(is_over(c, extent, line, row[4]) for line, _, row in self._lines) > 1
        )

    def _is_pinned_again(self, body: Fitted, c: Fitted) -> bool:
        """Whether another small ring than c lies over a body and no other: eyes, and no nails."""
        if self._rings is None:
            self._rings = {}
            for ring, extent in zip(self._bodies, self._extents.tolist(), strict=True):
                if ring.kind == "circle" and extent < self.largest:
                    under = self._under(ring, extent)
                    if len(under) == 1:
                        self._rings.setdefault(under[0], []).append(ring.pieces)
        return any(pieces != c.pieces for pieces in self._rings.get(body, ()))

    def _is_next(self, c: Fitted, size: float, i: int) -> bool:
        """Whether a stroke is as near to a reading's ink, and as large, as that of the same letter, or of the next."""
        pieces, other = self._page.pieces, self._page.pieces[i]
        marked = MARKED["looped" if c.kind == "cross" and len(c.pieces) == 1 else c.kind]
        reach = NEXT[c.kind] if size < marked * other.extent else SAME
        reach *= max(size, other.extent)
        near = [pieces[j].stroke for j in c.pieces if pieces[j].is_near(other, reach)]
        if not near:
            return False
        ink = self._page.strokes.samples
        gaps = ink[near].reshape(-1, 1, 2) - ink[other.stroke, None, ::2]
        return bool((gaps**2).sum(axis=2).min() < reach**2)

    def _is_between(self, c: Fitted, i: int) -> bool:
        """Whether a stroke goes from an end of an X's bars to another, or is a short one among them."""
        p, ends = self._page.pieces[i], c.outline.tolist()
        long = math.dist(*ends[:2])
        if p.extent < SHORT * long:
            x0, y0, x1, y1 = zip(*(self._page.pieces[k].box for k in c.pieces), strict=True)
            x, y = (p.box[0] + p.box[2]) / 2, (p.box[1] + p.box[3]) / 2
            return bool(min(x0) < x < max(x1) and min(y0) < y < max(y1))
        first, last = ({k for k, end in enumerate(ends) if math.dist(end, e) < JOINED * long} for e in p.ends)
        return bool(first and last and len(first | last) > 1)

    def _is_on(self, bodies: Sequence[Fitted], i: int) -> bool:
        """Whether the middle of a stroke is within one of some bodies."""
        x0, y0, x1, y1 = self._page.pieces[i].box
        return any(depth((x0 + x1) / 2, (y0 + y1) / 2, body.outline) < 0 for body in bodies)

    def _is_spoke(self, c: Fitted, size: float, i: int) -> bool:
        """Whether a stroke beside a ring is straight, and points at its middle."""
        p, (x, y), radius = self._page.pieces[i], c.middle, size / 3
        (ax, ay), (bx, by) = p.ends
        off = abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / max(p.gap, 1e-9)
        away = math.hypot((ax + bx) / 2 - x, (ay + by) / 2 - y)
        return c.kind == "circle" and p.straight < SPOKE and off < radius / 2 and away > radius

    def _holds(self, body: Fitted, i: int) -> bool:
        """Whether a stroke is within a body, clear of its outline: not a spoke."""
        if (i, body) not in self._held:
            p, clear = self._page.pieces[i], -CLEAR * body.narrow
            within = depth((p.box[0] + p.box[2]) / 2, (p.box[1] + p.box[3]) / 2, body.outline) < 0
            points = self._page.strokes.samples[p.stroke, ::4].tolist() if within else []
            self._held[i, body] = within and all(depth(x, y, body.outline) < clear for x, y in points)
        return self._held[i, body]

    def _under(self, c: Fitted, extent: float) -> list[Fitted]:
        """The bodies of other ink, that are larger, that its middle is over; or that a ring is over."""
        if c not in self._known:
            at, reach = np.array(c.middle), REACH * extent * (c.kind == "circle")
            near = ((self._boxes[:, :2] - reach < at) & (self._boxes[:, 2:] + reach > at)).all(axis=1)
            near &= self._extents > OVER * extent
            bodies = ((self._bodies[k], self._extents[k]) for k in np.flatnonzero(near).tolist())
            self._known[c] = [b for b, large in bodies if is_over(c, extent, b, large)]
        return self._known[c]
