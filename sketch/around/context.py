"""What stands around a reading: told last, in nats, so that it decides between readings that are nearly
equal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, islice
from typing import NamedTuple

import numpy as np

from sketch.around.pins import PINNED, REACH, follows, is_on_line, is_over, stands_on
from sketch.around.writing import LARGEST, WITHIN, WRITTEN
from sketch.kernel import beside, depth, gap
from sketch.kernel import held as ends_held
from sketch.patches import Likely, Patch
from sketch.scoring import Fitted
from sketch.search import Part, part
from sketch.shapes.proposals import Pick, Proposed, Row
from sketch.typing import Array, Point

__all__ = ["Context", "grounds", "held_ends", "linked"]

Around = dict[Fitted, Row]  # bodies and marks, each with where it is
Gaps = dict[tuple[Fitted, Fitted], tuple[float, Point]]  # of open lines: how wide [pixels], and where

# nats that an X, or a small circle, is likelier over a body, or over two, than elsewhere; an arrow less
ANCHORS = 15.0
ON_RIM = 0.25  # of an X's extent: as near to an outline's side is the middle of one that is drawn on it
AXLE = 0.1  # of the extent of a round body: as near to its middle is an axle
MARKED = (
    2.0  # times as large as a body, at most, is an X on it: a larger one is two rods that cross under a pin
)
NO_BODY = 33.0  # nats that an X away from every body is unlikely: it would mean nothing
SLIP = 25.0  # nats that a short mark on an outline is a slip of the pen and no rod
SLIPPED = 0.2  # of a body's scale: as near to its outline is an end of such a mark
TOUCHING = 30.0  # nats that small bars which touch are no rods but a letter
NEAR_BY = 0.4  # of a bar's extent: as near as the strokes of a letter are
LETTER = 0.15  # of the page: larger bars are no letter
TAP = 0.1  # of a bar's extent: what is smaller beside it is no stroke of a letter
LARGE = 0.22  # of the page: a larger X is two rods that cross
ROUGH = 20.0  # nats that a small polygon in several strokes leaves to be said about its ink, and is a letter by itself
SCRAWLED = 70.0  # likewise an X, what its strokes have besides its bars among it
TWIG = 0.04  # of what is drawn: an open line, or an arrow, that is shorter is a slip too
DOT = 0.012  # of what is drawn: nobody draws a smaller body
DOT_SPREAD = 0.1  # of the logarithm of a size, below that
# of a ring's extent: a line so near to its middle goes into it; the sides of a box that is as wide run along its rim
THROUGH_RING = 0.3
# nats that an open line is likelier a rod for each of its ends that a small ring holds, and an outline of it rarer, if
# that is no rod itself, with the ring between its sides
HELD = 12.5


class Ends(NamedTuple):
    """How many ends of an open line rings hold, and the extent of the largest of these [pixels]."""

    many: int
    wide: float


NOT_HELD = Ends(0, 0.0)
Held = tuple[int, Ends]  # which of what is proposed is such a line, and its ends


class Context:
    """What the likely bodies say of the marks on and around them; kept for ink whose surroundings stay."""

    def __init__(self) -> None:
        self._gaps: Gaps = {}
        self._known: dict[Proposed, list[float]] = {}
        self._bodies: Around = {}
        self._walls: Around = {}
        self._sizes = (0.0, 0.0)

    def told(
        self, likely: Sequence[Likely], held: Mapping[int, tuple[Held, ...]], size: float, drawn: float
    ) -> list[list[float]]:
        """The gains of all that is proposed, by patch, given the bodies that the ink by itself makes likely.

        held: as of `held_ends`.
        size: of the page [pixels]; what is small on it may be a letter.  drawn: of what is drawn on it [pixels]; what
        is small in that is no part of it.
        """
        proposed = [p for own in likely for p in own.patch.proposed]
        bodies = dict(body for own in likely for body in own.bodies)
        courses = {line: (course, row) for own in likely for line, course, row in own.lines}
        ends: dict[Fitted, Ends] = {}
        for n, its in held.items():
            p = likely[n].patch.whole
            for k, of_line in its:
                line = p.candidates[k]
                ends[line] = of_line
                if p.gains[k] > 0:  # rods, though their ink may go around with others
                    courses[line] = p.course(line)
        bodies |= {line: row for line, (_, row) in courses.items()}
        walls = _walls(likely)
        others = {c: self._bodies.get(c) or bodies[c] for c in self._bodies.keys() ^ bodies.keys()}
        others |= {c: self._walls.get(c) or walls[c] for c in self._walls.keys() ^ walls.keys()}
        known = self._known if (size, drawn) == self._sizes else {}
        stay = [k for k, p in enumerate(proposed) if p in known]
        kept = set(stay).difference(stay[k] for k, _ in _beside([proposed[k] for k in stay], others))
        anew = [k for k in range(len(proposed)) if k not in kept]
        sides = {i for line in walls for i in line.pieces}
        near = {k: _Bodies(ends, courses, sides) for k in anew}
        every = list(bodies.items())
        sorts = [None if c.closed else c.kind for c in bodies]
        for k, b in _beside([proposed[k] for k in anew], bodies):
            near[anew[k]].add(*every[b], sorts[b])
        told = [_told(p, near[k], size, drawn) if k in near else known[p] for k, p in enumerate(proposed)]
        self._known = dict(zip(proposed, told, strict=True))
        self._bodies, self._walls, self._sizes = bodies, walls, (size, drawn)
        gains = iter(told)
        out = [list(chain.from_iterable(islice(gains, len(own.patch.proposed)))) for own in likely]
        for n, k in _letters(likely, LETTER * size, self._gaps):
            out[n][k] -= TOUCHING
        return out


def held_ends(likely: Sequence[Likely]) -> dict[int, tuple[Held, ...]]:
    """Of each patch the open lines that rings among the likely bodies hold."""
    rings = [ring for own in likely for ring in own.rings]
    leading = [(n, own.patch.whole) for n, own in enumerate(likely) if own.patch.whole.bars] if rings else []
    if not leading:
        return {}
    lines = [p.candidates[k].outline for _, p in leading for k in p.bars]
    ends = map(Ends, *ends_held(lines, np.array(rings), REACH, THROUGH_RING, PINNED))
    held = {}
    for n, p in leading:
        its = dict(zip(p.bars, ends, strict=False))
        # of each ink, as a straight line ends aside of one that bends
        most: dict[tuple[int, ...], Ends] = {}
        for k, of_line in its.items():
            ink = p.candidates[k].pieces
            most[ink] = max(most.get(ink, NOT_HELD), of_line)
        if any(of_line.many for of_line in most.values()):
            lines_there = ((k, most[p.candidates[k].pieces]) for k in p.bars)
            held[n] = tuple((k, of_line) for k, of_line in lines_there if of_line.many)
    return held


def linked(patch: Patch, held: tuple[Held, ...]) -> Part:
    """What is proposed of a patch, with what it gains by its ink and by rings alone."""
    whole = patch.whole
    gains, ends = list(whole.gains), dict[int, Ends]()
    for k, its in held:
        gains[k] += HELD * its.many
        ends[whole.candidates[k].pieces[0]] = its
    for k, c in enumerate(whole.candidates):
        gains[k] -= HELD * _corners(c, ends)
    return part([c.pieces for c in whole.candidates], gains)


def grounds(likely: Sequence[Likely]) -> dict[int, tuple[int, ...]]:
    """Of each patch the open lines of ink that by itself means nothing, and on which a likely X stands."""
    crosses = [mark for own in likely for mark in own.bodies if mark[0].kind == "cross"]
    found: dict[int, tuple[int, ...]] = {}
    for n, own in enumerate(likely) if crosses else ():
        whole, taken = own.patch.whole, {i for c, _ in own.chosen for i in c.pieces}
        for k in sorted(whole.bars, key=lambda k: -whole.gains[k]):
            line = whole.candidates[k]
            if not taken.isdisjoint(line.pieces):
                continue
            course = whole.course(line)
            if any(stands_on(cross, row[4], line, *course) for cross, row in crosses):
                found[n] = (*found.get(n, ()), k)
                taken.update(line.pieces)
    return found


def _corners(outline: Fitted, ends: Mapping[int, Ends]) -> int:
    """How many ends of lines that are strokes of an outline rings hold, but for rings between its sides: those are as
    large as it is narrow."""
    if not outline.closed or len(outline.pieces) == 1:
        return 0
    return sum(its.many for i in outline.pieces if (its := ends.get(i, NOT_HELD)).wide < outline.narrow)


def _walls(likely: Sequence[Likely]) -> Around:
    """The open lines, each with where it is, that are sides of one likely outline, and on which an X each stands: as an
    outline it has no use for more than one, as walls they have."""
    crosses = [mark for own in likely for mark in own.bodies if mark[0].kind == "cross"]
    walls: Around = {}
    for own in likely if len(crosses) > 1 else ():
        for outline, box in own.closed:
            if len(outline.pieces) == 1:
                continue
            on = [mark for mark in crosses if _is_on_rim(*mark, outline, box)]
            sides = _stood_on(own.patch.whole, outline, on) if len(on) > 1 else {}
            if len({line.pieces for line in sides}) > 1:
                walls |= sides
    return walls


def _is_on_rim(cross: Fitted, row: Row, outline: Fitted, box: Row) -> bool:
    """Whether an X is drawn on a side of a larger outline, neither in it nor over two.  row, box: where they are."""
    (x, y), (x0, y0, x1, y1, _), extent = cross.middle, box, row[4]
    near = x0 - extent < x < x1 + extent and y0 - extent < y < y1 + extent
    return near and _is_on_side(cross, extent, outline)


def _is_on_side(cross: Fitted, extent: float, outline: Fitted) -> bool:
    """Whether the middle of an X of some extent [pixels] is on a side of a larger outline."""
    return extent < outline.narrow and abs(depth(*cross.middle, outline.outline)) < ON_RIM * extent


def _stood_on(whole: Proposed, outline: Fitted, crosses: list[tuple[Fitted, Row]]) -> Around:
    """The open lines that an outline's sides may be and on which some X stands, each with where it is."""
    sides = (whole.candidates[k] for k in whole.bars)
    courses = {line: whole.course(line) for line in sides if set(line.pieces) <= set(outline.pieces)}
    return {
        line: row
        for line, (course, row) in courses.items()
        if any(stands_on(cross, its[4], line, course, row) for cross, its in crosses)
    }


def _beside(proposed: list[Proposed], bodies: Around) -> list[list[int]]:
    """Pairs of what one piece proposed and a body that can matter to it, as numbers."""
    if not proposed or not bodies:
        return []
    return beside(np.array([p.box for p in proposed]), np.array(list(bodies.values())))


def _told(proposed: Proposed, bodies: _Bodies, size: float, drawn: float) -> list[float]:
    """The gains of one piece's proposals, given the bodies around them."""
    gains = list(proposed.gains)
    for k, (c, row) in enumerate(zip(proposed.candidates, proposed.rows, strict=True)):
        if gains[k] < -NO_BODY:
            continue
        extent = row[4]
        if c.closed and extent < DOT * drawn:  # where the pen rested
            gains[k] -= 0.5 * (math.log(DOT * drawn / max(extent, 1e-9)) / DOT_SPREAD) ** 2
        if c.kind == "bar":
            gains[k] += HELD * bodies.held.get(c, NOT_HELD).many
            gains[k] += NO_BODY * (not bodies.walls.isdisjoint(c.pieces))
        elif c.closed and len(c.pieces) > 1:
            gains[k] -= NO_BODY * max(len(bodies.walls.intersection(c.pieces)) - 1, 0)
            gains[k] -= HELD * _corners(c, bodies.held_of)
        if len(c.pieces) > 1 and extent < LARGEST * drawn:
            if c.kind == "cross":
                gains[k] -= WITHIN * (c.rough > SCRAWLED)
            elif c.rough > ROUGH:
                gains[k] -= WRITTEN
        if c.kind == "cross":
            large = extent > LARGE * size or bodies.pins(c, extent)
            if any(bodies.under(c, extent, extent / MARKED)) or (not large and bodies.on_line(c, extent)):
                gains[k] += ANCHORS
            elif large or not bodies.reached(c):
                gains[k] -= NO_BODY * (1 + large)
        elif c.kind == "arrow":
            gains[k] -= ANCHORS * any(bodies.under(c, extent))
            slips = len(c.pieces) * (extent < TWIG * drawn)  # each stroke of a tiny one is
            gains[k] -= SLIP * (slips + bodies.slip(c, extent))
        elif c.kind in ("ellipse", "free"):
            gains[k] -= ANCHORS * (extent < LARGEST * drawn)  # what is so small and no ring is written
        elif c.kind == "bar":
            gains[k] -= SLIP * (extent < TWIG * drawn or (c not in bodies.held and bodies.slip(c, extent)))
            gains[k] += NO_BODY * (bodies.ground(c, row) and follows(c, proposed.course(c)[0]))
        elif c.kind == "circle" and (bodies.joined(c, extent) > 1 or bodies.axle(c, extent)):
            gains[k] += ANCHORS
    return gains


def _letters(likely: Sequence[Likely], largest: float, known: Gaps) -> list[Pick]:
    """Bars no larger than `largest` [pixels] that touch or cross one another, with no small circle there to join them.

    A letter, an asterisk, a battery's sign are that; rods that are meant to do something are joined, or large.
    known: gaps of the last time, replaced by those of this one.
    """
    pins = [pin for own in likely for pin in own.pins]
    # a stroke too short or bent for a rod is in a letter too
    bars = [
        (row, c, [(n, k) for k in ks])
        for n, own in enumerate(likely)
        for c, row, ks in own.bars
        if row[4] < largest
    ]
    bars.sort(key=lambda t: t[0])
    found: set[Pick] = set()
    now: Gaps = {}
    for a, b in _near_by([row for row, *_ in bars]):
        ((*_, extent), c, its), ((*_, wide), other, others) = bars[a], bars[b]
        if not set(c.pieces).isdisjoint(other.pieces) or min(extent, wide) < TAP * max(extent, wide):
            continue
        reach = NEAR_BY * max(extent, wide)
        pair = c, other
        apart, at = now[pair] = known.get(pair) or gap(c.outline, other.outline)
        if apart <= reach and not _is_pinned(at, 2 * reach, pins):
            found.update(its, others)
    known.clear()
    known.update(now)
    return sorted(found)


def _is_pinned(at: Point, reach: float, pins: list[Point]) -> bool:
    """Whether a pin is nearer to a place than so much."""
    x, y = at
    return any(abs(u - x) < reach and abs(v - y) < reach and math.dist((u, v), at) < reach for u, v in pins)


def _near_by(rows: list[Row]) -> list[tuple[int, int]]:
    """Pairs of bars, given where they are, whose boxes are no further apart than NEAR_BY of the larger one's extent."""
    if len(rows) < 2:
        return []
    x0, y0, x1, y1, extent = np.array(rows).T
    reach = NEAR_BY * np.maximum(extent, extent[:, None])
    far = (x0 > x1[:, None] + reach) | (y0 > y1[:, None] + reach)
    return [(a, b) for a, b in np.argwhere(~(far | far.T)).tolist() if a < b]


class _Bodies:
    """The likely bodies, and the marks on them, to be asked which of them are at a place."""

    def __init__(
        self, held: dict[Fitted, Ends], courses: dict[Fitted, tuple[Array, Row]], walls: set[int]
    ) -> None:
        """held: open lines whose ends small rings hold.  courses: of likely ones, as of `Proposed`.
        walls: pieces of outlines on which an X each stands, where there are several."""
        self.held, self.walls = held, walls
        self._courses = courses
        # likewise of the ink that each is most of; on a picture a line that others cross may be most of none
        self.held_of: dict[int, Ends] = {}
        self.closed: list[tuple[Fitted, Row]] = []
        self.lines: list[tuple[Fitted, Row]] = []
        self.crosses: list[tuple[Fitted, float]] = []

    def add(self, c: Fitted, row: Row, kind: str | None) -> None:
        """Take one in, with where it is.  kind: of a line or a mark, else None."""
        if kind is None:
            self.closed.append((c, row))
        elif kind == "cross":
            self.crosses.append((c, row[4]))
        else:
            self.lines.append((c, row))
            if c.pieces:
                self.held_of[c.pieces[0]] = self.held.get(c, NOT_HELD)

    def under(self, mark: Fitted, extent: float, least: float = 0.0) -> Iterator[Fitted]:
        """The bodies, of extents of more than `least`, that a mark is over; where any will do, the others are not
        looked at."""
        x, y = mark.middle
        for body, (x0, y0, x1, y1, large) in self.closed:
            near = x0 - extent < x < x1 + extent and y0 - extent < y < y1 + extent
            if near and large > least and is_over(mark, extent, body, large):
                yield body

    def joined(self, ring: Fitted, extent: float) -> int:
        """How many bodies and open lines, all much larger, a small circle is over."""
        lines = sum(is_over(ring, extent, line, row[4]) for line, row in self.lines)
        return lines + sum(1 for _ in self.under(ring, extent, PINNED * extent))

    def reached(self, cross: Fitted) -> bool:
        """Whether a bar of an X ends in a body of other ink: its middle misses it by a slip of the hand."""
        low, high = cross.outline.min(axis=0).tolist(), cross.outline.max(axis=0).tolist()
        return any(
            x0 < high[0]
            and y0 < high[1]
            and x1 > low[0]
            and y1 > low[1]
            and extent > math.dist(low, high)
            and set(cross.pieces).isdisjoint(body.pieces)
            and any(depth(x, y, body.outline) < 0 for x, y in cross.outline.tolist())
            for body, (x0, y0, x1, y1, extent) in self.closed
        )

    def pins(self, cross: Fitted, extent: float) -> bool:
        """Whether a ring that is small beside an X is where its bars cross: of two rods the pin."""
        return any(
            body.kind == "circle"
            and all(
                is_on_line(body.middle, wide, bar, extent) for bar in (cross.outline[:2], cross.outline[2:])
            )
            for body, (*_, wide) in self.closed
        )

    def axle(self, c: Fitted, extent: float) -> bool:
        """Whether a small circle is at the middle of a round body of other ink."""
        return any(
            body.kind == "circle"
            and 2 * extent < wide
            and math.dist(c.middle, body.middle) < AXLE * wide
            and set(c.pieces).isdisjoint(body.pieces)
            for body, (_, _, _, _, wide) in self.closed
        )

    def slip(self, c: Fitted, extent: float) -> bool:
        """Whether an end of c touches the outline of a body of other ink that is twice as large, with no pin there."""
        large = [(body, row) for body, row in self.closed if extent < 0.5 * row[4]]
        pins = [(body, wide) for body, (*_, wide) in self.closed if wide < 0.5 * extent]
        for x, y in (c.outline[0].tolist(), c.outline[-1].tolist()) if large else ():
            if any(math.dist(pin.middle, (x, y)) < wide for pin, wide in pins):
                continue
            for body, (x0, y0, x1, y1, _) in large:
                r = SLIPPED * body.scale
                if (
                    x0 - r <= x <= x1 + r
                    and y0 - r <= y <= y1 + r
                    and abs(depth(x, y, body.outline)) < r
                    and not set(c.pieces).intersection(body.pieces)
                ):
                    return True
        return False

    def on_line(self, cross: Fitted, extent: float) -> bool:
        """Whether an X stands on an open line of other ink."""
        return any(self._stands_on(cross, extent, line, row) for line, row in self.lines)

    def ground(self, line: Fitted, row: Row) -> bool:
        """Whether an X of other ink stands on an open line, and in no closed outline: at most on a side."""
        return any(
            self._stands_on(cross, extent, line, row)
            and all(_is_on_side(cross, extent, body) for body in self.under(cross, extent))
            for cross, extent in self.crosses
        )

    def _stands_on(self, cross: Fitted, extent: float, line: Fitted, row: Row) -> bool:
        """Whether an X of some extent [pixels] stands on an open line of other ink.  row: where the line is."""
        return stands_on(cross, extent, line, *self._courses.get(line, (line.outline, row)))
