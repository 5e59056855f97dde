"""Letters: small strokes, alone or a few that touch or go around, of which no more is said than that they were
written."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np

from sketch.kernel import depth, words
from sketch.page.pieces import Page
from sketch.scoring import PARAMETER, Fitted
from sketch.shapes.proposals import MEANT, Proposed, proposing

__all__ = ["Letter", "Letters"]

LETTER = 4 * PARAMETER  # nats to say which letter it is, where, and how large
FORMED = 2.0  # nats an observation to say its ink, given that: how its writer forms it
LIFTED = 15.0  # nats that what is so small is likelier a letter where the pen was lifted
USUAL = 0.025  # of what is drawn: the extent of a letter beside a machine
SPREAD = 0.15  # of the logarithm of a letter's extent, where that is larger than usual
LARGEST = 0.1  # of what is drawn: no letter is of a larger extent
NAIL = 0.04  # of what is drawn: the extent of a ring that may be a pin
SURER = 10.0  # nats, at most, that a letter gains beyond an X of its ink: a body under that says more for it
# nats that an X in two strokes leaves to be said about its ink: 99 in 100 of people's leave less, an "f", a "4" and a
# crossed "7" more
PLAIN = 25.0
ODD = 15.0  # nats, at most, that an X is odd: as much says a body under it, which then says nothing
EVEN = (
    0.15  # of the logarithm of its bars' lengths' ratio: how much that differs from 0; a "t" has a short bar
)
SHORT = 0.6  # of the bars of an X: what is no longer, and touches them, is a loose side of it
TOUCHING = 0.12  # of the smaller stroke: what is between the strokes of one letter
MOST_STROKES = 4  # of one letter
MOST_CORNERS = (
    4  # of a body so plain that it is no letter, though it was drawn in several strokes that do not touch
)
NOWHERE = np.zeros((1, 2))  # a letter's outline: none


@dataclass(frozen=True, eq=False)
class Letter:
    """What may be a letter.

    Attributes:
        proposed: that reading, and what it gains.
        marks: readings of its strokes as small rings, or as an X with short ink besides, or within an outline: where
            one of them is a mark, there is no letter.
    """

    proposed: Proposed
    marks: tuple[Fitted, ...]

    def is_none(self, proposed: Proposed, told: Sequence[float]) -> bool:
        """Whether one of its marks is likelier one than by its ink.

        proposed: what its ink may be else, and told: what that gains, given what stands around.
        """
        which = map(proposed.candidates.index, self.marks)
        return any(told[k] > proposed.gains[k] for k in which)


class Letters:
    """The letters that a page may have, kept while the ink there stays."""

    def __init__(self) -> None:
        self._drawn = 0.0
        self._alone: dict[Proposed, tuple[bool, int, list[tuple[int, ...]]]] = {}
        self._known: dict[tuple[Proposed, ...], Letter | None] = {}

    def possible(self, page: Page, proposed: Sequence[Proposed]) -> list[Letter]:
        """Each small stroke as a letter, but straight ones and rings, and those that touch or go around as one.

        proposed: what the pieces mean else, in the order of drawing.
        """
        if page.drawn != self._drawn:
            self._drawn, self._alone, self._known = page.drawn, {}, {}
        largest = LARGEST * page.drawn
        of = {i: p for (i, q), p in zip(page.pieces.items(), proposed, strict=False) if q.extent < largest}
        alone, self._alone = self._alone, {}
        groups, outlines = [], []
        for i, p in of.items():
            there = alone.get(p)
            if there is None:
                there = _alone(p, i, page.pieces[i].extent < NAIL * page.drawn)
            self._alone[p] = is_plain, _, around = there
            if not is_plain:
                groups.append((i,))
            if around:
                outlines += [group for group in around if of.keys() >= set(group)]
        known, self._known = self._known, {}
        out = []
        touching = _touching(page, {i: page.pieces[i].extent for i in of})
        for group in groups + touching + sorted(set(outlines).difference(touching)):
            key = tuple(map(of.__getitem__, group))
            letter = known[key] if key in known else self._read(page, of, group)
            self._known[key] = letter
            if letter is not None:
                out.append(letter)
        return out

    def _read(self, page: Page, of: Mapping[int, Proposed], group: tuple[int, ...]) -> Letter | None:
        """Some pieces as a letter; None where that saves nothing."""
        extent, small = _extent(page, group), {i: page.pieces[i].extent for i in group}
        if extent >= LARGEST * page.drawn:
            return None
        ring, is_plain = _as_ring(of, group) if len(group) > 1 and extent < NAIL * page.drawn else ([], False)
        if is_plain:
            return None
        crosses, whole = _crosses(of, group, small) if len(group) > 1 else ([], [])
        gain = _gain(page, group, extent / (USUAL * page.drawn))
        gain = max([gain, *(min(gain + rough, its + SURER + odd) for its, rough, odd in whole)])
        if gain <= 0:
            return None
        rings = [(i, self._alone[of[i]][1]) for i in group if small[i] < NAIL * page.drawn]
        marks = [of[i].candidates[k] for i, k in (*rings, *ring, *crosses) if k >= 0]
        return Letter(proposing([Fitted("letter", group, 0.0, NOWHERE)], [gain]), tuple(marks))


def _alone(proposed: Proposed, index: int, may_pin: bool) -> tuple[bool, int, list[tuple[int, ...]]]:
    """Whether a piece is no letter by itself, as it is straight, or a ring; which of what it proposed is that ring, -1
    for none; and which few pieces go around as neither a ring nor a plain body, as those of a "D" do whose stem its bow
    does not touch.

    may_pin: whether it is as small as a ring that is a pin.
    """
    best, ring = -1, -1
    gains = proposed.gains
    around: dict[tuple[int, ...], tuple[float, bool]] = {}
    for k, c in enumerate(proposed.candidates):
        if c.closed and 1 < len(c.pieces) <= MOST_STROKES and gains[k] > 0:
            its = gains[k], c.kind != "circle" and len(c.outline) > MOST_CORNERS
            around[c.pieces] = max(around.get(c.pieces, its), its)
        if gains[k] > 0 and c.pieces == (index,):
            if c.kind == "circle" and (ring < 0 or gains[k] > gains[ring]):
                ring = k
            if best < 0 or gains[k] > gains[best]:
                best = k
    is_pin = ring >= 0 and may_pin
    is_plain = best == ring if is_pin else best >= 0 and _is_straight(proposed.candidates[best])
    return is_plain, ring, [pieces for pieces, (_, is_odd) in around.items() if is_odd]


def _crosses(
    of: Mapping[int, Proposed], group: Sequence[int], small: Mapping[int, float]
) -> tuple[list[tuple[int, int]], list[tuple[float, float, float]]]:
    """Readings of some pieces as an X that the others are short beside, or go around: which piece proposed it, and
    which it is; and of each X of all pieces what it gains, what it leaves to be said of its ink, and how odd an X it is
    [nats].

    of: what the pieces propose.  small: their extents [pixels].
    """
    found, whole, every = [], [], set(group)
    for i in group:
        for k, (c, gain) in enumerate(zip(of[i].candidates, of[i].gains, strict=True)):
            if gain > 0 and c.kind == "cross" and every.issuperset(c.pieces):
                rest, least = every.difference(c.pieces), min(small[j] for j in c.pieces)
                if not rest:
                    whole.append((gain, c.rough, _odd(c)))
                elif all(small[j] < SHORT * least for j in rest) or _is_held(of, c, rest):
                    found.append((i, k))
    return found, whole


def _is_held(of: Mapping[int, Proposed], cross: Fitted, rest: Set[int]) -> bool:
    """Whether some pieces are an outline around an X."""
    for i in rest:
        for c, gain in zip(of[i].candidates, of[i].gains, strict=True):
            if c.closed and gain > 0 and set(c.pieces) == rest and depth(*cross.middle, c.outline) < 0:
                return True
    return False


def _odd(cross: Fitted) -> float:
    """Nats that an X in two strokes is rarer than what people draw as one."""
    a, b, c, d = cross.outline.tolist()
    uneven = math.log(math.dist(a, b) / math.dist(c, d)) / EVEN
    return min(max(cross.rough - PLAIN, 0.0) + 0.5 * uneven**2, ODD)


def _as_ring(of: Mapping[int, Proposed], group: tuple[int, ...]) -> tuple[list[tuple[int, int]], bool]:
    """Readings of all pieces of a group together as one ring: which piece proposed it, and which it is; and whether
    nothing says them as well."""
    its = [
        (gain, c.kind == "circle", i, k)
        for i in group
        for k, (c, gain) in enumerate(zip(of[i].candidates, of[i].gains, strict=True))
        if gain > 0 and c.pieces == group
    ]
    return [(i, k) for _, is_ring, i, k in its if is_ring], bool(its) and max(its)[1]


def _is_straight(c: Fitted) -> bool:
    return c.kind == "bar" and len(c.outline) == 2


def _touching(page: Page, small: dict[int, float]) -> list[tuple[int, ...]]:
    """Strokes that touch, and further ones that touch these, as far as they are few."""
    near: dict[int, list[int]] = {}
    for i, j in words(page.strokes, small, TOUCHING, TOUCHING) if len(small) > 1 else ():
        near.setdefault(i, []).append(j)
        near.setdefault(j, []).append(i)
    found, seen = [], set[int]()
    for start in near:
        if start in seen:
            continue
        group = [start]
        seen.add(start)
        for i in group:  # it grows meanwhile
            new = [j for j in near[i] if j not in seen]
            seen.update(new)
            group += new
        if len(group) <= MOST_STROKES:
            found.append(tuple(sorted(group)))
    return found


def _extent(page: Page, group: Iterable[int]) -> float:
    """Of the box around some pieces [pixels]."""
    x0, y0, x1, y1 = zip(*(page.pieces[i].box for i in group), strict=True)
    return math.hypot(max(x1) - min(x0), max(y1) - min(y0))


def _gain(page: Page, group: tuple[int, ...], size: float) -> float:
    """Nats that some pieces save as a letter, given its size as a share of the usual one."""
    its = [page.pieces[i] for i in group]
    large = max(math.log(size), 0.0) / SPREAD
    said = LETTER + FORMED * sum(p.observations for p in its) + 0.5 * large**2 - LIFTED * (len(its) > 1)
    return sum(p.unread for p in its) - said - MEANT
