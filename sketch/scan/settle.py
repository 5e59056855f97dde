"""Which of the strokes that may have been drawn were drawn: those that make the most sense together.

A skeleton does not tell how the pen went through a tangle, but what comes of it does: an outline that closes, an X, an
arrow.  So all strokes that the ink may be made of are read, and the set of readings chosen that describes the page
in the fewest nats, each stretch of ink in at most one: the recognizer's own measure, over stretches of ink instead
of strokes.
"""

from __future__ import annotations

import math
from collections.abc import Set

import numpy as np
from numpy.typing import NDArray

from sketch.context import Context
from sketch.proposals import Proposals, proposing
from sketch.scan.graph import Ink
from sketch.scan.ways import Way
from sketch.scoring import Fitted, unread
from sketch.search import best_packing

__all__ = ["settle"]

Points = NDArray[np.float64]

ROUNDS = 4  # of choosing, each with what the readings chosen before say about those around them
OFF = 0.4  # of the scale of what it may belong to: ink further off than this is not explained
STRAIN = 4.0  # nats for each square radian that the pen turned at junctions


def settle(likeliest: list[Way], others: list[Way], pen: float, width: float, height: float) -> list[Way]:
    """The ways that belong to the best readings of all; ink of the others is left over.

    likeliest: disjoint ways that take all the ink.  others: further ways over the same ink.  pen: its width, and
    width, height: the picture's, in the pixels of the ways.
    """
    ways = likeliest + others
    ink = [way.ink for way in ways]
    proposals = Proposals(math.hypot(width, height), _rivals([names.keys() for names in ink]))
    proposals.add([way.points for way in ways])
    page = proposals.page
    free: dict[int, float] = {}  # nats to say each stretch of ink freely, as strokes of the likeliest ways
    scale: dict[int, float] = {}  # [pixels] of the smallest thing that it may be part of
    for p in page.pieces.values():
        stretches = ink[p.stroke]
        scale.update((name, min(p.scale, scale.get(name, np.inf))) for name in stretches)
        if p.stroke < len(likeliest):
            rate = unread(p) / max(sum(map(len, stretches.values())), 1)
            free.update((name, rate * len(points)) for name, points in stretches.items())
    distances: dict[tuple[int, int], float] = {}

    def explained(c: Fitted, name: int, points: Points) -> bool:
        key = id(c.outline), name
        if key not in distances:
            distances[key] = _off(c, points)
        return distances[key] <= max(OFF * min(scale[name], c.scale or np.inf), pen)

    candidates: list[Fitted] = []
    taken: list[tuple[int, ...]] = []
    gains: list[float] = []
    for c in (c for proposed in proposals.all() for c in proposed.candidates):
        if not all(page.apart(i, c.pieces) for i in c.pieces):
            continue
        names: Ink = {name: points for i in c.pieces for name, points in ink[i].items()}
        own = sum(unread(page.pieces[i]) for i in c.pieces)
        strain = sum(ways[page.pieces[i].stroke].strain for i in c.pieces)
        gain = (1 - c.cost / own) * sum(free.get(name, 0.0) for name in names) - STRAIN * strain
        if gain > 0 and c.kind != "cross":
            gain -= sum(free.get(n, 0.0) for n, points in names.items() if not explained(c, n, points))
        if gain > 0:
            candidates.append(c)
            taken.append(tuple(names))
            gains.append(gain)
    chosen: list[int] = []
    told, context, proposed = gains, Context(), proposing(candidates, gains)
    for _ in range(ROUNDS):
        live = [k for k, gain in enumerate(told) if gain > 0]
        before = chosen
        chosen = [live[k] for k in best_packing([taken[k] for k in live], [told[k] for k in live])]
        if chosen == before:
            break
        told = context.gains([proposed], candidates, chosen, page.size)
    return [ways[page.pieces[i].stroke] for k in chosen for i in candidates[k].pieces]


def _off(fitted: Fitted, points: Points) -> float:
    """The root mean square distance of some ink from what was fitted [pixels]."""
    line = fitted.outline if fitted.figure is None else fitted.figure
    if fitted.closed or fitted.figure is not None:
        line = np.concatenate([line, line[:1]])
    some = points[:: max(len(points) // 16, 1), None]
    start, side = line[:-1], np.diff(line, axis=0)
    along = ((some - start) * side).sum(axis=2) / np.maximum((side * side).sum(axis=1), 1e-9)
    off = some - start - np.clip(along, 0, 1)[..., None] * side
    return float(np.sqrt(np.mean((off * off).sum(axis=2).min(axis=1))))


def _rivals(ink: list[Set[int]]) -> list[set[int]]:
    """For each piece the others that have ink in common with it."""
    holders: dict[int, set[int]] = {}
    for p, names in enumerate(ink):
        for name in names:
            holders.setdefault(name, set()).add(p)
    return [set().union(*(holders[name] for name in names)) - {p} for p, names in enumerate(ink)]
