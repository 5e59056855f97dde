"""Which of the strokes that may have been drawn were drawn: those that make the most sense together.

A skeleton does not tell how the pen went through a tangle, but what comes of it does: an outline that closes, an X, an
arrow.  So all strokes that the ink may be made of are read, and the set of readings chosen that describes the page
in the fewest nats, each stretch of ink in at most one: the recognizer's own measure, over stretches of ink instead
of strokes.
"""

from __future__ import annotations

import math
from collections.abc import Set
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sketch.context import Context
from sketch.kernel import depth
from sketch.marks import RARE, RARE_ARROW
from sketch.outlines import ARC, BOX, CORNER, ELLIPSE, FREEFORM, ROUND
from sketch.pieces import Page
from sketch.proposals import Proposals, proposing
from sketch.scan.binding import off_course
from sketch.scan.graph import Ink
from sketch.scan.ways import SIDE, Way
from sketch.scoring import PARAMETER, SLOPPY, STRANGE, TREMOR, Fitted
from sketch.search import best_packing

__all__ = ["settle"]

Points = NDArray[np.float64]

ROUNDS = 6  # of choosing, each with what the readings chosen before say about those around them
# pen widths that ink may be off what was fitted to it, for all that tracing leaves of it in a tangle
OFF = 0.5
MOSTLY = 0.1  # of a reading's ink: of two that have such a stretch in common neither stands around the other
SAMPLES = 8  # or a few more points of a stretch that are compared with what was fitted
# Nats for bodies that overlap, or have an X, and for the best arrow: what is around says more for them only once they
# are chosen.
AHEAD = 30.0
STRAIN = 6.0  # nats for each square radian at junctions: an end that lies on a line by chance, ln(page / pen)


def settle(
    likeliest: list[Way],
    others: list[Way],
    overlaps: list[Way],
    pen: float,
    width: float,
    height: float,
) -> list[Way]:
    """The ways that belong to the best readings of all; ink of the others is left over.

    likeliest: disjoint ways that take all the ink.  others: further ways over the same ink.  overlaps: likewise, along
    bodies that overlap at pivots.  pen: its width, and width, height: the picture's, in the pixels of the ways.
    """
    ways = likeliest + others + overlaps
    first = len(likeliest) + len(others)
    proposals = Proposals(math.hypot(width, height), _rivals([way.ink.keys() for way in ways]))
    proposals.add([way.points for way in ways])
    page = proposals.page
    prices = _Prices(page, ways, len(likeliest), pen)
    groups: list[tuple[int, ...]] = []  # of each candidate the pieces,
    taken: list[tuple[int, ...]] = []  # all stretches of ink,
    candidates: list[Fitted] = []  # and, as its pieces, those that are most of its ink
    gains: list[float] = []
    for c in (c for proposed in proposals.all() for c in proposed.candidates):
        if not all(page.apart(i, c.pieces) for i in c.pieces):
            continue
        ink = {name: points for i in c.pieces for name, points in ways[i].ink.items()}
        if (gain := prices.gain(c, ink)) > 0:
            least = MOSTLY * sum(map(len, ink.values()))
            groups.append(c.pieces)
            taken.append(tuple(ink))
            main = tuple(name for name, points in ink.items() if len(points) > least)
            candidates.append(replace(c, pieces=main))
            gains.append(gain)
    context, proposed = Context(), proposing(candidates, gains)
    likely = [min(group) >= first for group in groups]
    ahead = np.array(
        [AHEAD * (told_on or c) for told_on, c in zip(likely, _around_crosses(candidates), strict=True)]
    )
    arrows = [k for k, c in enumerate(candidates) if c.kind == "arrow"]
    if arrows:
        ahead[max(arrows, key=lambda k: gains[k])] = AHEAD
    best, most = list[int](), -np.inf
    for start in (gains, gains + ahead) if ahead.any() else (gains,):
        expected, chosen, told = np.array(start), list[int](), list[list[float]]()
        for _ in range(ROUNDS):
            live = np.flatnonzero(expected > 0).tolist()
            packed = best_packing([taken[k] for k in live], expected[live].tolist())
            last, chosen = chosen, [live[k] for k in packed]
            if chosen == last:
                break
            told.append(context.told([proposed], [(0, k) for k in chosen], page.size, page.drawn)[0])
            if (total := sum(told[-1][k] for k in chosen)) > most:  # as they stand around one another
                best, most = chosen, total
            # of two sets each may speak for the other: what all of them say in the mean speaks for one
            expected = np.mean(told, axis=0)
    return [ways[i] for k in best for i in groups[k]]


class _Prices:
    """What it costs to say each stretch of ink, freely and as part of something."""

    def __init__(self, page: Page, ways: list[Way], likeliest: int, pen: float) -> None:
        """page: with the ways for pieces, the likeliest first.  likeliest: how many those are, which take all the ink.
        pen: its width [pixels]."""
        self._ways, self._page, self._pen = ways, page, pen
        # nats to say each stretch of ink freely, as strokes of the likeliest ways
        self._free: dict[int, float] = {}
        self._fine: dict[int, float] = {}  # observations that it is worth, likewise
        self._strange: dict[int, float] = {}  # of the nats, those for being a stroke of its own
        self._scale: dict[int, float] = {}  # [pixels] of the smallest thing that it may be part of
        self._some = {
            name: points[:: len(points) // SAMPLES + 1] for way in ways for name, points in way.ink.items()
        }
        for p in page.pieces.values():
            stretches = ways[p.index].ink
            self._scale.update((name, min(p.scale, self._scale.get(name, np.inf))) for name in stretches)
            if p.index < likeliest:
                count = max(sum(map(len, stretches.values())), 1)
                alone = STRANGE if p.length > SIDE * pen else 0.0  # what is no side means nothing
                freely = p.unread - STRANGE + alone
                for name, points in stretches.items():
                    share = len(points) / count
                    self._free[name] = freely * share
                    self._fine[name] = p.observations * share
                    self._strange[name] = alone * share

    def gain(self, c: Fitted, ink: Ink) -> float:
        """Nats that a reading saves against saying its ink freely."""
        ways = [self._ways[i] for i in c.pieces]
        tails = frozenset[int]().union(*(way.tail for way in ways))
        freely = sum(self._free.get(name, 0.0) for name in ink)
        freely -= sum(self._strange.get(name, 0.0) for name in tails)
        # what is off its ink is said as finely as that ink is said freely, in more strokes maybe, never less finely
        own = sum(self._page.pieces[i].observations for i in c.pieces)
        finer = max(sum(self._fine.get(name, 0.0) for name in ink) / own, 1.0)
        said = _said(c)
        gain = freely - said - (c.cost - said) * finer - STRAIN * sum(way.strain for way in ways)
        # the strokes of a cross, and of an arrow in one stroke, are judged as a whole
        if gain <= 0 or c.kind == "cross" or (c.kind == "arrow" and len(c.pieces) == 1):
            return gain
        return gain - self._coarse(c, [name for name in ink if name not in tails])

    def _coarse(self, c: Fitted, names: list[int]) -> float:
        """Nats that a reading owes where it says ink less precisely than the smallest thing that it may be part of
        would: a pivot's ring is no bump on a long side."""
        off = np.maximum(_off(c, [self._some[name] for name in names]) - OFF * self._pen, 0.0)
        scale = np.maximum([self._scale[name] for name in names], self._pen / 2)  # nothing drawn is smaller
        fine = np.array([self._fine.get(name, 0.0) for name in names])
        free = np.array([self._free.get(name, 0.0) for name in names])
        whole = c.scale or np.inf
        more = fine * (_misfit(off / np.minimum(scale, whole)) - _misfit(off / whole))
        return float(np.minimum(more, free).sum())


def _around_crosses(candidates: list[Fitted]) -> list[bool]:
    """Which of the readings are bodies with an X in them."""
    crosses = [c for c in candidates if c.kind == "cross"]
    out = []
    for body in candidates:
        (x0, y0), (x1, y1) = body.outline.min(axis=0).tolist(), body.outline.max(axis=0).tolist()
        out.append(
            body.closed
            and any(
                x0 < x < x1
                and y0 < y < y1
                and depth(x, y, body.outline) < 0
                and set(body.pieces).isdisjoint(c.pieces)
                for c, (x, y) in ((c, c.middle) for c in crosses)
            )
        )
    return out


def _said(fitted: Fitted) -> float:
    """Nats to say a shape, without where its ink is."""
    corners = len(fitted.outline)
    least = {
        "circle": ROUND,
        "ellipse": ROUND + ELLIPSE,
        "rectangle": BOX,
        "polygon": 2 * corners * CORNER,
        "free": FREEFORM + 3 * ARC,
        "bar": RARE + 2 * corners * PARAMETER,
        "cross": 6 * PARAMETER,
        "arrow": RARE_ARROW + 4 * PARAMETER,
    }
    return min(least[fitted.kind], fitted.cost)


def _misfit(off: Points) -> Points:
    """As of `sketch.scoring.misfit`, for one observation each."""
    return np.asarray(0.5 * (np.log1p((off / TREMOR) ** 2) + (off / SLOPPY) ** 2))


def _off(fitted: Fitted, stretches: list[Points]) -> Points:
    """The root mean square distance of each stretch of ink from what was fitted [pixels]."""
    line = fitted.outline if fitted.figure is None else fitted.figure
    if fitted.closed or fitted.figure is not None:
        line = np.concatenate([line, line[:1]])
    return off_course(stretches, line)


def _rivals(ink: list[Set[int]]) -> list[set[int]]:
    """For each piece the others that have ink in common with it."""
    holders: dict[int, set[int]] = {}
    for p, names in enumerate(ink):
        for name in names:
            holders.setdefault(name, set()).add(p)
    return [set().union(*(holders[name] for name in names)) - {p} for p, names in enumerate(ink)]
