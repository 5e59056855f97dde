"""Writing beside a machine: small strokes in a row, some of which mean nothing, are letters, and so are the rings and
crosses among them."""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from typing import NamedTuple

import numpy as np

from sketch.around.dimensions import dimension_line
from sketch.around.hatching import hatching
from sketch.around.pins import REACH, is_over, stands_on
from sketch.around.rows import TALL, Rows, near_one_another
from sketch.kept import Kept
from sketch.kernel import depth, together
from sketch.page.near import Boxes, overlap
from sketch.page.pieces import Page, Piece
from sketch.patches import Likely
from sketch.scoring import Fitted
from sketch.shapes.proposals import Row
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
    every: Sequence[Likely],
    told: list[list[float]],
    pointing: set[int],
    remains: frozenset[int],
    kept: Kept,
) -> list[list[float]]:
    """Gains, less what rings, crosses and bars lose by what is written there.

    every: what the ink makes likely of each patch.  told: the gains of all that is proposed.  pointing: the pieces of
    arrows that are no gravity.  remains: what tracing left of the ink of others, which means nothing and is no letter.
    """
    proposed = [own.patch.whole for own in every]
    likely = [(n, k) for n, own in enumerate(every) for k in own.which]
    chosen = [(proposed[p].candidates[k], told[p][k], proposed[p].rows[k]) for p, k in likely]
    lines = [line for own in every for line in own.lines]
    marks = _Marks([(c, row) for c, _, row in chosen], lines, LARGEST * page.drawn)
    letters = marks.in_bodies() - remains
    pins = {  # among those, each as a ring
        i
        for p, own in (likely if letters else ())
        for k in every[p].patch.along_with(own)
        if told[p][k] > 0
        and not letters.isdisjoint(proposed[p].candidates[k].pieces)
        and marks.joins(proposed[p].candidates[k], proposed[p].rows[k][4])
        for i in proposed[p].candidates[k].pieces
    }
    alone = (proposed[p].gains[k] for p, k in likely)  # an X loses by its surroundings where no body is
    idle_crosses = {
        c for (c, gain, _), own in zip(chosen, alone, strict=True) if c.kind == "cross" and gain < own
    }
    meant = {i for c, *_ in chosen if c.kind != "bar" and c not in idle_crosses for i in c.pieces}
    unmeant = page.pieces.keys() - meant - remains
    if not (unmeant or pointing or letters or remains):
        return told
    rows, idle, known = _spread(page, marks, chosen, pointing | unmeant | letters - pins, kept)
    lone = [page.pieces[i] for i in sorted(idle)]
    bars = (p.candidates[k] for p, gains in zip(proposed, told, strict=True) for k in p.bars if gains[k] > 0)
    dimensions = (dimension_line(page, bar, lone) for bar in bars if idle >= set(bar.pieces))
    measured = pointing.union(*dimensions)
    hatched = hatching(page, marks.largest, idle)
    touched = rows.keys() | measured | letters | hatched | remains
    out = list(told)
    for n, p in enumerate(proposed):
        if touched.isdisjoint(p.pieces):
            continue
        own = out[n] = list(told[n])
        for k, (c, row) in enumerate(zip(p.candidates, p.rows, strict=True)):
            if own[k] > 0 and not touched.isdisjoint(c.pieces):
                if c not in known:
                    its = tuple(dict.fromkeys(rows[i] for i in c.pieces if i in rows))
                    around = marks.around(c, row[4]) if its else _Around()
                    known[c] = kept(_loss, page, marks.largest, its, c, row[4], around) if its else 0.0
                own[k] -= known[c]
                own[k] -= MEASURE * (c.kind == "bar" and not measured.isdisjoint(c.pieces))
                if c.closed and not letters.isdisjoint(c.pieces):
                    own[k] -= WITHIN * (c.kind != "circle" or pins.isdisjoint(c.pieces))
                own[k] -= HATCHED * (c.closed and len(hatched.intersection(c.pieces)))
                own[k] -= LEFT * (c.closed and row[4] < marks.largest and remains.issuperset(c.pieces))
    return out


def _spread(
    page: Page, marks: _Marks, chosen: Sequence[tuple[Fitted, float, Row]], idle: Set[int], kept: Kept
) -> tuple[dict[int, Rows], Set[int], dict[Fitted, float]]:
    """Of strokes the rows of those that mean nothing, as they make letters of what is beside them, and these of what is
    beside these, until nothing changes; which strokes mean nothing then; and what each of the likely readings loses
    [nats].

    chosen: the likely readings, each with its gain, and where it is.  idle: what means nothing by itself.
    """
    near = near_one_another(page, marks.largest, idle)
    small = [(c, gain, row[4]) for c, gain, row in chosen if not near.keys().isdisjoint(c.pieces)]
    inks = [[i, *others] for i, others in near.items()]
    numbers = together([*inks, *([i for i in c.pieces if i in near] for c, *_ in small)])
    # what stands in rows that share readings is looked at together, and by itself
    lines: dict[int, tuple[list[int], list[tuple[Fitted, float, float]]]] = {}
    for i, n in zip(near, numbers, strict=False):
        if i in idle:
            lines.setdefault(n, ([], []))
    for i, n in zip(near, numbers, strict=False):
        if n in lines:
            lines[n][0].append(i)
    for reading, n in zip(small, numbers[len(inks) :], strict=True):
        if n in lines:
            lines[n][1].append(reading)
    found = []
    for strokes, readings in lines.values():
        its = tuple((page.pieces[i], tuple(near[i])) for i in strokes)
        around = tuple(marks.around(c, extent) for c, _, extent in readings)
        unmeant = tuple(i for i in strokes if i in idle)
        found.append(kept(_spread_along, page, marks.largest, its, unmeant, tuple(readings), around))
    known = {c: loss for _, _, losses in found for c, loss in losses.items()}
    by_stroke = {i: rows for rows, *_ in found for i in rows.of}
    return by_stroke, set(idle).union(*(lost for _, lost, _ in found)), known


def _spread_along(
    page: Page,
    largest: float,
    strokes: tuple[tuple[Piece, tuple[int, ...]], ...],
    unmeant: tuple[int, ...],
    readings: tuple[tuple[Fitted, float, float], ...],
    around: tuple[_Around, ...],
) -> tuple[Rows, set[int], dict[Fitted, float]]:
    """As of `_spread`, of some strokes and no others.

    strokes: with those that are near each.  unmeant: which of them mean nothing by themselves.  readings: those that
    they are a part of, with their gains and extents.  around: these.
    """
    near = {p.index: others for p, others in strokes}
    there = {c: own for (c, *_), own in zip(readings, around, strict=True)}
    idle = fresh = set(unmeant)
    rows = Rows(page, near, idle)
    known = dict[Fitted, float]()
    while fresh:
        anew = {id(rows.of[i]) for i in fresh & rows.of.keys()}
        lost = set[int]()
        for c, gain, extent in readings:
            if any(id(rows.of.get(i)) in anew for i in c.pieces):
                known[c] = loss = _loss(page, largest, (rows,), c, extent, there[c])
                lost.update(c.pieces if gain < loss else ())
        fresh = lost - idle
        if fresh:
            idle = idle | fresh
            rows = Rows(page, near, idle)
    return rows, idle, known


class _Around(NamedTuple):
    """What a small ring or an X is drawn on.

    under: bodies.  joins: whether it is a ring over two things, bodies or open lines: a pivot, however rough.
    is_pinned_again: whether another small ring lies over the same body and no other: eyes, and no nails.
    on_line: whether it is an X that stands on an open line, and over no body.
    """

    under: tuple[Fitted, ...] = ()
    joins: bool = False
    is_pinned_again: bool = False
    on_line: bool = False


class _Marks:
    """What the ink makes likely, to be asked whether a reading may be a letter instead.

    Attributes:
        largest: of what is written [pixels].
    """

    def __init__(
        self, likely: Sequence[tuple[Fitted, Row]], lines: Sequence[tuple[Fitted, Array, Row]], largest: float
    ) -> None:
        """likely: with where they lie, as of `Proposed`.  lines: those that are open, along their ink, likewise."""
        self.largest = largest
        self._bodies = [c for c, _ in likely if c.closed]
        self._lines = lines
        where = np.array([row for c, row in likely if c.closed]).reshape(-1, 5)
        self._boxes, self._extents = np.ascontiguousarray(where[:, :4]), where[:, 4]
        self._near, self._wide = Boxes(self._boxes), self._extents.tolist()
        self._known: dict[Fitted, tuple[Fitted, ...]] = {}
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

    def around(self, c: Fitted, extent: float) -> _Around:
        """What a reading of some extent [pixels] is drawn on, if that matters to whether it is a letter."""
        if extent >= self.largest or c.kind not in ("circle", "cross"):
            return _Around()
        under, joins, is_ring = self._under(c, extent), self.joins(c, extent), c.kind == "circle"
        again = is_ring and len(under) > 0 and not joins and self._is_pinned_again(under[0], c)
        on_line = not (is_ring or under) and any(stands_on(c, extent, *line) for line in self._lines)
        return _Around(under, joins, again, on_line)

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

    def _under(self, c: Fitted, extent: float) -> tuple[Fitted, ...]:
        """The bodies of other ink, that are larger, that its middle is over; or that a ring is over."""
        if c not in self._known:
            (x, y), reach = c.middle, REACH * extent * (c.kind == "circle")
            near = self._near.touching((x - reach, y - reach, x + reach, y + reach))
            bodies = ((self._bodies[k], self._wide[k]) for k in near if self._wide[k] > OVER * extent)
            self._known[c] = tuple(b for b, large in bodies if is_over(c, extent, b, large))
        return self._known[c]


def _loss(
    page: Page,
    largest: float,
    its: tuple[Rows, ...],
    c: Fitted,
    extent: float,
    around: _Around,
) -> float:
    """Nats that a reading is rarer, given the rows that its pieces stand in with strokes that mean nothing.

    A pivot is no letter. What else is drawn over a body is one if they are within that body too, and
    next to it.

    largest: of what is written [pixels].  around: as of `_Marks.around`.
    """
    if extent >= largest or c.kind == "arrow":
        return 0.0
    rows = its[0] if len(its) == 1 else Rows(page, {}, set(), its)
    single = len(c.pieces) == 1
    # as large as the strokes of a letter are, whatever was made of them
    size = max(page.pieces[i].extent for i in c.pieces) if single or not c.closed else extent
    beside = rows.beside(c.pieces, size)
    near = [page.pieces[i] for i in rows.near_idle(c.pieces)] if beside or single else []
    halves = _halves(page, c, near)
    if near and c.closed:  # what is written in a body does not make a letter of it
        (x0, y0), (x1, y1) = c.outline.min(axis=0).tolist(), c.outline.max(axis=0).tolist()
        for p in set(near).difference(halves):
            x, y = _middle(p)
            tall = x0 < x < x1 and y0 < y < y1 and size < TALL * p.extent <= TALL * size
            beside -= tall and _holds(page, c, p)
    beside += sum(TALL * p.extent <= size for p in halves)
    if not beside or c.kind not in ("circle", "cross"):
        return WRITTEN * beside
    under, joins, is_pinned_again, on_line = around
    if joins:
        return 0.0
    if not under:
        return WRITTEN * beside * (not on_line)
    if is_pinned_again:
        every = (page.pieces[i] for i in rows.idle(c.pieces, size * TALL / MARKED["circle"]))
        on = {p for p in every if _is_on(under, p) and not _is_spoke(c, size, p)}.union(halves)
        if on:
            return WITHIN * len(on)
    large = {p for p in near if size < TALL * p.extent}.union(halves)
    if c.kind == "cross":  # what is among its strokes joins its bars, and is no letter beside them
        large = {p for p in large if not _is_between(page, c, p)}
    return WITHIN * sum(
        _is_on(under, p) and not _is_spoke(c, size, p) and _is_next(page, c, size, p) for p in large
    )


# ---------------------------------------------------------------- what stands near a reading in its row


def _middle(p: Piece) -> Point:
    x0, y0, x1, y1 = p.box
    return (x0 + x1) / 2, (y0 + y1) / 2


def _halves(page: Page, c: Fitted, near: Sequence[Piece]) -> list[Piece]:
    """Of strokes those that go through an outline in one stroke, from side to side: of a theta."""
    if len(c.pieces) > 1 or not c.closed:
        return []
    ring, (x, y), found = page.pieces[c.pieces[0]], c.middle, []
    off = ring.extent / 3
    for p in near:
        u, v = _middle(p)
        if not (-off < u - x < off and -off < v - y < off):
            continue
        ink = page.strokes.samples[ring.stroke, :, None]
        if p.gap > STRAIGHT * p.length:
            gaps = np.hypot(*(ink - p.ends).transpose(2, 0, 1)).min(axis=0)
            if gaps.max() < SAME * ring.extent:
                found.append(p)
    return found


def _is_next(page: Page, c: Fitted, size: float, other: Piece) -> bool:
    """Whether a stroke is as near to a reading's ink, and as large, as that of the same letter, or of the next."""
    marked = MARKED["looped" if c.kind == "cross" and len(c.pieces) == 1 else c.kind]
    reach = NEXT[c.kind] if size < marked * other.extent else SAME
    reach *= max(size, other.extent)
    its = (page.pieces[j] for j in c.pieces)
    near = [p.stroke for p in its if p.is_near(other, reach)]
    if not near:
        return False
    ink = page.strokes.samples
    gaps = ink[near].reshape(-1, 1, 2) - ink[other.stroke, None, ::2]
    return bool((gaps**2).sum(axis=2).min() < reach**2)


def _is_between(page: Page, c: Fitted, p: Piece) -> bool:
    """Whether a stroke goes from an end of an X's bars to another, or is a short one among them."""
    ends = c.outline.tolist()
    long = math.dist(*ends[:2])
    if p.extent < SHORT * long:
        x0, y0, x1, y1 = zip(*(page.pieces[k].box for k in c.pieces), strict=True)
        x, y = _middle(p)
        return bool(min(x0) < x < max(x1) and min(y0) < y < max(y1))
    first, last = ({k for k, end in enumerate(ends) if math.dist(end, e) < JOINED * long} for e in p.ends)
    return bool(first and last and len(first | last) > 1)


def _is_on(bodies: Sequence[Fitted], p: Piece) -> bool:
    """Whether the middle of a stroke is within one of some bodies."""
    return any(depth(*_middle(p), body.outline) < 0 for body in bodies)


def _is_spoke(c: Fitted, size: float, p: Piece) -> bool:
    """Whether a stroke beside a ring is straight, and points at its middle."""
    (x, y), radius = c.middle, size / 3
    (ax, ay), (bx, by) = p.ends
    off = abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / max(p.gap, 1e-9)
    away = math.hypot((ax + bx) / 2 - x, (ay + by) / 2 - y)
    return c.kind == "circle" and p.straight < SPOKE and off < radius / 2 and away > radius


def _holds(page: Page, body: Fitted, p: Piece) -> bool:
    """Whether a stroke is within a body, clear of its outline: not a spoke."""
    clear = -CLEAR * body.narrow
    if depth(*_middle(p), body.outline) >= 0:
        return False
    return all(depth(x, y, body.outline) < clear for x, y in page.strokes.samples[p.stroke, ::4].tolist())
