"""Which of the strokes that may have been drawn were drawn: those that make the most sense together.

A skeleton does not tell how the pen went through a tangle, but what comes of it does: an outline that closes, an X, an
arrow.  So all strokes that the ink may be made of are read, and the set of readings chosen that describes the page
in the fewest nats, each stretch of ink in at most one: the recognizer's own measure, over stretches of ink instead
of strokes.
"""

from __future__ import annotations

import math
from collections.abc import Set
from dataclasses import dataclass, replace

import numpy as np

from sketch.around.arrows import likeliest_arrow, prefer_arrow
from sketch.around.context import Context, held_ends
from sketch.kernel import depth
from sketch.page.pieces import Page
from sketch.patches import Likely, Patch
from sketch.scan.binding import course_length
from sketch.scan.strokes.prices import Prices
from sketch.scan.strokes.together import Together
from sketch.scan.strokes.ways import Way
from sketch.scoring import Fitted
from sketch.shapes.proposals import HOPELESS, Proposals, Proposed, proposing
from sketch.typing import Array

__all__ = ["settle"]

ROUNDS = 6  # of choosing, each with what the readings chosen before say about those around them
# Nats for bodies that overlap, or have an X, and for the best arrow: what is around says more for them only once they
# are chosen.
AHEAD = 30.0


def settle(
    likeliest: list[Way],
    others: list[Way],
    overlaps: list[Way],
    ends: dict[int, int],
    pen: float,
    canvas: tuple[float, float],
) -> list[Way]:
    """The ways that belong to the best readings of all; ink of the others is left over.

    likeliest: disjoint ways that take all the ink.  others: further ways over the same ink.  overlaps: likewise, along
    bodies that overlap at pivots.  ends: as of `lines`, of all these ways.  pen: its width, and canvas: the picture's
    width and height, in the pixels of the ways.
    """
    ways = likeliest + others + overlaps
    proposals = Proposals(math.hypot(*canvas), _rivals([way.ink.keys() for way in ways]))
    proposals.add([way.points for way in ways])
    prices = Prices(proposals.page, ways, len(likeliest), ends, pen)
    readings = _priced(proposals, prices)
    left = _left_over(likeliest, prices, ends)
    ahead = _ahead(readings, len(likeliest) + len(others))
    lengths = {name: course_length(points) / pen for way in ways for name, points in way.ink.items()}
    together = Together(readings.own, left, prices.free, lengths)
    best = _best_together(proposals.page, readings, together, ahead)
    return [ways[i] for k in best for i in readings.groups[k]]


@dataclass(frozen=True, eq=False)
class _Readings:
    """What the ways may be.

    Attributes:
        groups: of each reading the ways that it is of.
        own: the stretches of ink that no other may have.
        proposed: the readings, with the stretches that are most of their ink for pieces, and their gains.
    """

    groups: list[tuple[int, ...]]
    own: list[tuple[int, ...]]
    proposed: Proposed


def _priced(proposals: Proposals, prices: Prices) -> _Readings:
    """The readings of ways, priced by stretches of ink; of those of the same ways none that gain much less."""
    groups, own, candidates = list[tuple[int, ...]](), list[tuple[int, ...]](), list[Fitted]()
    gains: list[float] = []
    best_of: dict[tuple[int, ...], float] = {}
    for c in (c for proposed in proposals.all() for c in proposed.candidates):
        taken, least = prices.of(c.pieces), best_of.get(c.pieces, HOPELESS) - HOPELESS
        if taken is not None and (gain := prices.gain(c, taken, least)) > least:
            best_of[c.pieces] = max(gain, best_of.get(c.pieces, HOPELESS))
            groups.append(c.pieces)
            own.append(taken.own)
            candidates.append(replace(c, pieces=taken.main))
            gains.append(gain)
    return _Readings(groups, own, proposing(candidates, gains))


def _left_over(
    likeliest: list[Way], prices: Prices, ends: dict[int, int]
) -> list[tuple[tuple[int, ...], float]]:
    """The stretches that may be left over together, as the ways that take all the ink are, and the nats that saves."""
    left = [
        (tuple(name for name in way.ink if name in ends), prices.together(k))
        for k, way in enumerate(likeliest)
    ]
    return [(ink, saved) for ink, saved in left if len(ink) > 1 and saved > 0]


def _ahead(readings: _Readings, first: int) -> Array:
    """Nats that readings may gain by others, once these are chosen. first: of the ways along bodies that overlap."""
    proposed = readings.proposed
    overlapping = (min(group) >= first for group in readings.groups)
    ahead = np.array(
        [AHEAD * (told_on or c) for told_on, c in zip(overlapping, _around_crosses(proposed), strict=True)]
    )
    if proposed.arrows:
        ahead[max(proposed.arrows, key=proposed.gains.__getitem__)] = AHEAD
    return ahead


def _best_together(page: Page, readings: _Readings, together: Together, ahead: Array) -> list[int]:
    """The readings that gain the most as they stand around one another, looked for from two beginnings: what each
    gains by itself, and that with what others may say for it."""
    proposed, context = readings.proposed, Context()
    gains = np.array(proposed.gains)
    best, most = list[int](), -math.inf
    for expected in (gains, gains + ahead) if ahead.any() else (gains,):
        chosen, told = list[int](), list[list[float]]()
        for _ in range(ROUNDS):
            last, (chosen, saved) = chosen, together.best(expected.tolist())
            if chosen == last:
                break
            told.append(_told(context, page, proposed, chosen))
            if (total := sum(told[-1][k] for k in chosen) + saved) > most:
                best, most = chosen, total
            # of two sets each may speak for the other: what all of them say in the mean speaks for one
            expected = np.mean(told, axis=0)
    return best


def _told(context: Context, page: Page, proposed: Proposed, chosen: list[int]) -> list[float]:
    """The gains of all readings as they stand around those chosen, with one arrow likelier than others."""
    likely = [(0, k) for k in chosen]
    its = [Likely(Patch((proposed,)), tuple(chosen))]
    told = context.told(its, held_ends(its), page.size, page.drawn)
    arrows = [(0, k) for k in proposed.arrows]
    first = likeliest_arrow([proposed], told, arrows, likely, lambda pick: told[0][pick[1]])
    if first is not None:
        prefer_arrow([proposed], told, arrows, first)
    return told[0]


def _around_crosses(proposed: Proposed) -> list[bool]:
    """Which of the readings are bodies with an X in them."""
    candidates = proposed.candidates
    out = [False] * len(candidates)
    crosses = [c for c in candidates if c.kind == "cross"]
    bodies = [k for k, c in enumerate(candidates) if c.closed]
    if not crosses or not bodies:
        return out
    x0, y0, x1, y1 = np.array([proposed.rows[k][:4] for k in bodies]).T[:, :, None]
    x, y = np.array([c.middle for c in crosses]).T
    for b, n in np.argwhere((x0 < x) & (x < x1) & (y0 < y) & (y < y1)).tolist():
        body, cross = candidates[bodies[b]], crosses[n]
        if not out[bodies[b]] and set(body.pieces).isdisjoint(cross.pieces):
            out[bodies[b]] = depth(*cross.middle, body.outline) < 0
    return out


def _rivals(ink: list[Set[int]]) -> list[set[int]]:
    """For each piece the others that have ink in common with it."""
    holders: dict[int, set[int]] = {}
    for p, names in enumerate(ink):
        for name in names:
            holders.setdefault(name, set()).add(p)
    return [set().union(*(holders[name] for name in names)) - {p} for p, names in enumerate(ink)]
