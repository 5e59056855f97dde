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
from sketch.kernel import depth
from sketch.marks import RARE, RARE_ARROW
from sketch.outlines import ARC, BOX, CORNER, ELLIPSE, FREEFORM, ROUND
from sketch.proposals import Proposals, proposing
from sketch.scan.graph import Ink
from sketch.scan.ways import SIDE, Way
from sketch.scoring import PARAMETER, STRANGE, Fitted
from sketch.search import best_packing

__all__ = ["settle"]

Points = NDArray[np.float64]

ROUNDS = 6  # of choosing, each with what the readings chosen before say about those around them
OFF = 0.4  # of the scale of what it may belong to: ink further off than this is not explained
SAMPLES = 8  # or a few more points of a stretch that are compared with what was fitted
TO_COMPLEX = np.array([1, 1j])
AHEAD = 30.0  # nats for bodies that overlap, or have an X: what marks say of them is told only once they are chosen
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
    ink = [way.ink for way in ways]
    proposals = Proposals(math.hypot(width, height), _rivals([names.keys() for names in ink]))
    proposals.add([way.points for way in ways])
    page = proposals.page
    free: dict[int, float] = {}  # nats to say each stretch of ink freely, as strokes of the likeliest ways
    fine: dict[int, float] = {}  # observations that it is worth, likewise
    strange: dict[int, float] = {}  # of these, for being a stroke of its own
    scale: dict[int, float] = {}  # [pixels] of the smallest thing that it may be part of
    for p in page.pieces.values():
        stretches = ink[p.stroke]
        scale.update((name, min(p.scale, scale.get(name, np.inf))) for name in stretches)
        if p.stroke < len(likeliest):
            count = max(sum(map(len, stretches.values())), 1)
            alone = STRANGE if p.length > SIDE * pen else 0.0  # what is no side means nothing
            freely = p.unread - STRANGE + alone
            free.update((name, freely / count * len(points)) for name, points in stretches.items())
            fine.update((name, p.observations / count * len(points)) for name, points in stretches.items())
            strange.update((name, alone / count * len(points)) for name, points in stretches.items())
    some = {name: points[:: len(points) // SAMPLES + 1] for names in ink for name, points in names.items()}
    candidates: list[Fitted] = []
    taken: list[tuple[int, ...]] = []
    gains: list[float] = []
    for c in (c for proposed in proposals.all() for c in proposed.candidates):
        if not all(page.apart(i, c.pieces) for i in c.pieces):
            continue
        names: Ink = {name: points for i in c.pieces for name, points in ink[i].items()}
        strain = sum(ways[page.pieces[i].stroke].strain for i in c.pieces)
        tails = {name for i in c.pieces for name in ways[page.pieces[i].stroke].tail}
        said_freely = sum(free.get(name, 0.0) for name in names)
        said_freely -= sum(strange.get(name, 0.0) for name in tails)
        # what is off its ink is said as finely as that ink is said freely, in more strokes maybe, never less finely
        own = sum(page.pieces[i].observations for i in c.pieces)
        finer = max(sum(fine.get(name, 0.0) for name in names) / own, 1.0)
        said = _said(c)
        gain = said_freely - said - (c.cost - said) * finer - STRAIN * strain
        # the strokes of a cross, and of an arrow in one stroke, are judged as a whole
        if gain > 0 and c.kind != "cross" and not (c.kind == "arrow" and len(c.pieces) == 1):
            body = [name for name in names if name not in tails]
            near = [max(OFF * min(scale[name], c.scale or np.inf), pen) for name in body]
            off = _off(c, [some[name] for name in body]) > near
            gain -= sum(free.get(name, 0.0) for name, far in zip(body, off.tolist(), strict=True) if far)
        if gain > 0:
            candidates.append(c)
            taken.append(tuple(names))
            gains.append(gain)
    context, proposed = Context(), proposing(candidates, gains)
    likely = [all(page.pieces[i].stroke >= first for i in c.pieces) for c in candidates]
    ahead = np.array(
        [AHEAD * (told_on or c) for told_on, c in zip(likely, _around_crosses(candidates), strict=True)]
    )
    best, most = list[int](), -np.inf
    for start in (gains, gains + ahead) if ahead.any() else (gains,):
        expected, chosen, told = np.array(start), list[int](), list[list[float]]()
        for _ in range(ROUNDS):
            live = np.flatnonzero(expected > 0).tolist()
            packed = best_packing([taken[k] for k in live], expected[live].tolist())
            last, chosen = chosen, [live[k] for k in packed]
            if chosen == last:
                break
            told.append(context.told([proposed], [(0, k) for k in chosen], page.size)[0])
            if (total := sum(told[-1][k] for k in chosen)) > most:  # as they stand around one another
                best, most = chosen, total
            # of two sets each may speak for the other: what all of them say in the mean speaks for one
            expected = np.mean(told, axis=0)
    return [ways[page.pieces[i].stroke] for k in best for i in candidates[k].pieces]


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


def _off(fitted: Fitted, stretches: list[Points]) -> Points:
    """The root mean square distance of each stretch of ink from what was fitted [pixels]."""
    line = fitted.outline if fitted.figure is None else fitted.figure
    if fitted.closed or fitted.figure is not None:
        line = np.concatenate([line, line[:1]])
    counts = [len(points) for points in stretches]
    z = np.concatenate(stretches) @ TO_COMPLEX
    corners = line @ TO_COMPLEX
    side = corners[1:] - corners[:-1]
    side[side == 0] = 1e-9
    across = (z[:, None] - corners[:-1]) / side  # each side lies from 0 to 1
    off = np.abs(across - np.clip(across.real, 0, 1)) * np.abs(side)
    square = off.min(axis=1) ** 2
    starts = np.cumsum([0, *counts[:-1]])
    return np.asarray(np.sqrt(np.add.reduceat(square, starts) / counts))


def _rivals(ink: list[Set[int]]) -> list[set[int]]:
    """For each piece the others that have ink in common with it."""
    holders: dict[int, set[int]] = {}
    for p, names in enumerate(ink):
        for name in names:
            holders.setdefault(name, set()).add(p)
    return [set().union(*(holders[name] for name in names)) - {p} for p, names in enumerate(ink)]
