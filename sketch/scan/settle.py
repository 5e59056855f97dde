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

from sketch.arrows import ONE_ARROW
from sketch.context import Context
from sketch.kernel import depth
from sketch.proposals import HOPELESS, Proposals, Proposed, proposing
from sketch.scan.prices import Prices
from sketch.scan.ways import Way
from sketch.scoring import Fitted
from sketch.search import Packing, part

__all__ = ["settle"]

Points = NDArray[np.float64]

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
    first = len(likeliest) + len(others)
    proposals = Proposals(math.hypot(*canvas), _rivals([way.ink.keys() for way in ways]))
    proposals.add([way.points for way in ways])
    page = proposals.page
    prices = Prices(page, ways, len(likeliest), ends, pen)
    groups: list[tuple[int, ...]] = []  # of each candidate the pieces,
    own: list[tuple[int, ...]] = []  # the stretches of ink that no other may have,
    candidates: list[Fitted] = []  # and, as its pieces, those that are most of its ink
    gains: list[float] = []
    best_of: dict[tuple[int, ...], float] = {}  # of the same pieces: what gains much less is not it
    for c in (c for proposed in proposals.all() for c in proposed.candidates):
        taken, least = prices.of(c.pieces), best_of.get(c.pieces, HOPELESS) - HOPELESS
        if taken is not None and (gain := prices.gain(c, taken, least)) > least:
            best_of[c.pieces] = max(gain, best_of.get(c.pieces, HOPELESS))
            groups.append(c.pieces)
            own.append(taken.own)
            candidates.append(replace(c, pieces=taken.main))
            gains.append(gain)
    left = [
        (tuple(name for name in way.ink if name in ends), prices.together(k))
        for k, way in enumerate(likeliest)
    ]
    left = [(ink, saved) for ink, saved in left if len(ink) > 1 and saved > 0]
    context, proposed = Context(), proposing(candidates, gains)
    standing = [min(group) >= first for group in groups]
    ahead = np.array(
        [AHEAD * (told_on or c) for told_on, c in zip(standing, _around_crosses(proposed), strict=True)]
    )
    arrows = [k for k, c in enumerate(candidates) if c.kind == "arrow"]
    if arrows:
        ahead[max(arrows, key=lambda k: gains[k])] = AHEAD
    best, most = list[int](), -np.inf
    inks, first_of = own + [ink for ink, _ in left], dict[int, list[int]]()
    for k, ink in enumerate(inks):
        first_of.setdefault(ink[0], []).append(k)
    packing, leading = Packing(), list(first_of.values())
    for start in (gains, gains + ahead) if ahead.any() else (gains,):
        expected, chosen, told = np.array(start), list[int](), list[list[float]]()
        for _ in range(ROUNDS):
            worth = [*expected.tolist(), *(saved for _, saved in left)]
            parts = [part([inks[k] for k in some], [worth[k] for k in some]) for some in leading]
            packed = [leading[p][k] for p, k in packing.best(parts)]
            last, chosen = chosen, [k for k in packed if k < len(candidates)]
            if chosen == last:
                break
            likely = [(0, k) for k in chosen]
            told.append(
                _one_arrow(context.told([proposed], likely, page.size, page.drawn)[0], candidates, chosen)
            )
            saved = sum(worth[k] for k in packed if k >= len(candidates))
            if (total := sum(told[-1][k] for k in chosen) + saved) > most:  # as they stand around one another
                best, most = chosen, total
            # of two sets each may speak for the other: what all of them say in the mean speaks for one
            expected = np.mean(told, axis=0)
    return [ways[i] for k in best for i in groups[k]]


def _one_arrow(told: list[float], candidates: list[Fitted], chosen: list[int]) -> list[float]:
    """The same gains, with the likeliest arrow likelier and the others rarer: of those chosen, or else on ink of
    nothing that is."""
    every = [k for k, c in enumerate(candidates) if c.kind == "arrow"]
    taken = {name for k in chosen if candidates[k].kind != "bar" for name in candidates[k].pieces}
    arrows = [k for k in every if k in chosen]
    arrows = arrows or [k for k in every if taken.isdisjoint(candidates[k].pieces)]
    if not arrows:
        return told
    first, out = candidates[max(arrows, key=told.__getitem__)].pieces, list(told)
    for k in every:
        out[k] += -ONE_ARROW if set(first).isdisjoint(candidates[k].pieces) else ONE_ARROW
    return out


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
