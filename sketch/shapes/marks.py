"""Readings of open ink as marks: an X of two bars, an arrow of a shaft and a head."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise

import numpy as np

from sketch.kernel import ArrowFit, Shaft, fit_arrows, off_outline, within
from sketch.page.pieces import Page, Piece
from sketch.scoring import FREE, PARAMETER, Fitted, meaningless, misfit, misfit_of
from sketch.shapes.outlines import RETRACE
from sketch.typing import Array

__all__ = ["read_arrows", "read_cross", "read_cross_over", "with_strays"]

# Of an X: two bars that cross.
CROSS = 6 * PARAMETER  # nats to say its bars
JOINING = 0.5  # of an X's ink: what joins its bars, at most
ONE_SIDE = 0.35  # of an X's ink: what a side takes that joins its bars; what is beyond is said freely
JOINED = 0.3  # of a bar's length: as near to its end is what joins it
MOSTLY = 0.6  # of an X's ink: what lies on its bars; a side that joins them is no longer than either
OFF_BAR = 0.22  # of an X's half extent: ink further from its bars is said in fewer nats freely than as theirs
LEAST_SINE = 0.3  # of the angle at which bars cross: 17 degrees
UNLIKE = 3.0  # times that one bar is as long as the other, at most
AT_END = 0.1  # of a bar's length: nearer to its end no other crosses it
OFF_MIDDLE = 0.12  # of a bar's length: how far from its middle the other usually crosses it
AS_LONG = 0.3  # of the logarithm of the bars' lengths' ratio: how much it usually differs from 0

# Of an arrow: a shaft and a head of two barbs.
RARE_ARROW = 2.0  # nats that an arrow is rarer than an outline: there is one on a page, or none
ARROW = RARE_ARROW + 4 * PARAMETER  # nats to say tail and tip; the head is said by how unlike a head it is
HEAD = 2.0  # nats an observation to say ink freely, where it lies within an arrow's head
SHAFT = 0.55  # of the shaft: what the distance of an arrow's ink from it is measured in
GAPS = 0.5  # of the shaft: what the distance of an arrow from the nearest ink is measured in: a barb is drawn
SMALL = 0.6  # of the shaft: what is smaller may be part of a head
# times that a shaft and the barbs of an arrow are drawn, at most: the pen comes back along a barb
OFTEN = (1.3, 2.0, 2.0)
LOOP = 0.12  # of its length: how far apart the ends of a loop are, at most
THICK = 0.2  # of its extent: half the thickness of a loop that is no barb drawn forth and back

STRAY = 0.08  # of an X's or an arrow's extent: how far beyond it ink may be that belongs to it

Vertex = list[float]


def read_cross(page: Page, names: tuple[int, ...], most: float = math.inf) -> Fitted | None:
    """An X: two bars that cross near their middles; where the pen went on, further ink joins them.

    None where they do not, or where it takes more than `most` [nats].
    """
    parts = [page.pieces[i] for i in names]
    length = sum(p.length for p in parts)
    count = sum(p.observations for p in parts)
    best = None
    single = len(parts) == 1
    rough_by = [[misfit_of(p, square) for square in p.residual[:6]] for p in parts]  # by number of sides
    for bends in ((3,), (4,), (5,)) if single else ((1, 1), (1, 2), (2, 1), (1, 3), (3, 1), (2, 2)):
        off = sum(by[n] for by, n in zip(rough_by, bends, strict=True))
        if CROSS + off > most and not single:
            continue
        sides = [
            (part, k, a, b, math.dist(a, b))
            for part, (p, n) in enumerate(zip(parts, bends, strict=True))
            for k, (a, b) in enumerate(pairwise(p.corners(n)))
        ]
        for (part, k, a, b, long), (other, m, c, d, wide) in combinations(sides, 2):
            if part == other and (m < k + 2 or len(parts) == 2):
                continue
            joining = 1 - (long + wide) / length
            if joining > JOINING:
                continue
            extra = PARAMETER + FREE * count * max(joining - ONE_SIDE, 0.0) if len(sides) > 2 else 0.0
            odd = _crossing(a, b, c, d)
            if odd is None:
                continue
            said = off + extra
            if single and CROSS + PARAMETER + FREE * count * joining + odd[0] + odd[1] < most:
                # what joins them may go any way
                said = min(said, PARAMETER + _joined(page, parts[0], np.array([a, b, c, d])))
            cost = CROSS + said + odd[0] + odd[1]
            if cost <= most and (best is None or cost < best[0]):
                away = 0.0
                if len(sides) > 2 and not single:
                    away = _elsewhere(parts[part], bends[part], k, (c, d))
                    away += _elsewhere(parts[other], bends[other], m, (a, b))
                rough = off + odd[0] + odd[1] + meaningless(count * away / length)
                best, most = (cost, a, b, c, d, rough), cost
    if best is None:
        return None
    cost, a, b, c, d, rough = best
    figure = np.array([a, b, d, a, c, b, c, d, c])
    bars = np.array([a, b, c, d])
    return Fitted("cross", names, cost, bars, model=CROSS, rough=rough, figure=figure)


def read_cross_over(bar: Fitted, other: Piece, most: float = math.inf) -> Fitted | None:
    """An X of a bar that is in two strokes, as its reading says, and one in a single stroke. None as of read_cross."""
    (a, b), (c, d) = bar.outline.tolist(), other.corners(1)
    odd = _crossing(a, b, c, d)
    if odd is None:
        return None
    rough = bar.cost - bar.model + misfit_of(other, other.residual[1]) + sum(odd)
    if CROSS + rough > most:
        return None
    names = tuple(sorted((*bar.pieces, other.index)))
    figure, bars = np.array([a, b, d, a, c, b, c, d, c]), np.array([a, b, c, d])
    return Fitted("cross", names, CROSS + rough, bars, model=CROSS, rough=rough, figure=figure)


def _elsewhere(piece: Piece, bends: int, bar: int, other: tuple[Vertex, Vertex]) -> float:
    """How much of a stroke of an X goes on beyond its bar to no end of the other [pixels].

    bends: sides of the stroke; bar: which of them is its bar.
    """
    v = piece.corners(bends)
    reach, found = JOINED * math.dist(*other), 0.0
    for beyond in (v[bar::-1], v[bar + 1 :]):  # to where the stroke begins, and to where it ends
        if min(math.dist(beyond[-1], end) for end in other) > reach:
            found += sum(math.dist(a, b) for a, b in pairwise(beyond))
    return found


def _joined(page: Page, piece: Piece, bars: Array) -> float:
    """Nats to say a stroke's ink, given two bars, (4, 2), on which most of it lies, and what joins them freely."""
    ink = page.strokes.samples[piece.stroke]
    from_start = ink[:, None] - bars[::2]
    along = bars[1::2] - bars[::2]
    t = np.clip((from_start * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
    square = ((from_start - t[..., None] * along) ** 2).sum(axis=2).min(axis=1)
    on = square < (OFF_BAR * piece.extent / 2) ** 2
    share = float(on.mean())
    if share < MOSTLY:
        return math.inf
    mean = float(square[on].mean()) / (piece.extent / 2) ** 2 if share else 0.0
    return misfit(mean, share * piece.observations) + FREE * (1 - share) * piece.observations


def _crossing(a: Vertex, b: Vertex, c: Vertex, d: Vertex) -> tuple[float, float] | None:
    """Nats of how far from their middles two bars cross, and of how unlike they are; None for no X."""
    ux, uy, vx, vy, wx, wy = b[0] - a[0], b[1] - a[1], d[0] - c[0], d[1] - c[1], c[0] - a[0], c[1] - a[1]
    p, q, det = math.hypot(ux, uy), math.hypot(vx, vy), ux * vy - uy * vx
    if abs(det) < LEAST_SINE * p * q or max(p, q) > UNLIKE * min(p, q):
        return None
    t, s = (wx * vy - wy * vx) / det, (wx * uy - wy * ux) / det
    if not (AT_END < t < 1 - AT_END and AT_END < s < 1 - AT_END):
        return None
    return ((t - 0.5) ** 2 + (s - 0.5) ** 2) / (2 * OFF_MIDDLE**2), 0.5 * (math.log(p / q) / AS_LONG) ** 2


def read_arrows(page: Page, shafts: Sequence[Shaft], worse: float = math.inf) -> list[Fitted]:
    """Arrows of shafts, each from its tail toward the tip, and heads of two barbs.

    worse: nats more than their ink takes freely that arrows are looked for up to.
    """
    if not shafts:
        return []
    free = [page.pieces[i].unread for shaft in shafts for i in shaft.names]
    fits = fit_arrows(page.strokes, shafts, free, worse - ARROW)
    apart = (fit for fit in fits if page.apart(fit.names[-1], fit.names[:-1]))
    return [arrow for fit in apart if (arrow := _arrow(page, fit, worse)) is not None]


def _arrow(page: Page, fit: ArrowFit, worse: float) -> Fitted | None:
    """An arrow with its price; None where it is more than `worse` nats above what its ink takes freely."""
    shaft, left, right = fit.lengths
    pieces = [page.pieces[i] for i in fit.names]
    count = sum(p.observations for p in pieces)
    most = sum(p.unread for p in pieces) + worse
    # what lacks, and what goes over the arrow more often than a hand does, takes as much to say as free ink
    parts = zip((shaft, left, right), OFTEN, fit.ink, strict=True)
    wrong = sum(max(long - ink, ink - often * long, 0.0) for long, often, ink in parts)
    again = FREE * wrong / sum(fit.ink) * count + misfit(fit.bare / (GAPS * shaft) ** 2, count)
    off, said = 0.0, ARROW + again + fit.unlike
    for p, square in zip(pieces, fit.off, strict=False):
        small = p.extent < SMALL * shaft
        # an arrow whose ends meet is no loop, nor a barb that was drawn forth and back
        scale = SHAFT * shaft if len(pieces) == 1 else p.extent / 2 if small else None
        cost, free = misfit_of(p, square, scale), HEAD * p.observations
        if said + off + (min(cost, free) if small else cost) > most:
            return None
        off += free if cost > free and small and _within(page, p, np.array(fit.head)) else cost
    cost = ARROW + off + again + fit.unlike
    if cost > most:
        return None
    tip, left_end, right_end = fit.head
    figure = np.array([fit.tail, tip, left_end, tip, right_end, tip])
    names, line = tuple(sorted(fit.names)), np.array([fit.tail, tip])
    return Fitted("arrow", names, cost, line, model=ARROW, figure=figure)


def _within(page: Page, piece: Piece, head: Array) -> bool:
    """Whether a piece lies within an arrow's head, given its tip and the ends of its barbs [pixels].

    A wide loop does not: a barb that was gone over is a thin one, and a wheel is no part of a head.
    """
    if piece.gap < LOOP * piece.length and piece.scale > THICK * piece.extent:
        return False
    a, b, c = head.tolist()
    return within(page.strokes, piece.stroke, head, STRAY * (math.dist(a, b) + math.dist(a, c)))


def with_strays(page: Page, mark: Fitted, free: Mapping[int, float]) -> list[Fitted]:
    """A cross or an arrow together with smaller ink along it: a side that joins its bars, a barb drawn twice.

    free: nats to say each piece freely.
    """
    if mark.figure is None or mark.cost > sum(free[i] for i in mark.pieces):
        return []
    x, y = mark.figure.T.tolist()
    reach = STRAY * math.hypot(max(x) - min(x), max(y) - min(y))
    near = [
        p
        for p in page.along(mark.figure, reach)
        if p.index not in mark.pieces and page.apart(p.index, mark.pieces)
    ]
    costs: dict[int, float] = {}
    shaft = math.dist(mark.figure[0], mark.figure[1])
    squares = off_outline(page.strokes, [p.stroke for p in near], mark.figure) if near else []
    for p, off in zip(near, squares, strict=True):
        cost = PARAMETER + RETRACE * p.observations + misfit_of(p, off, p.extent / 2)
        most, in_head = free[p.index], PARAMETER + HEAD * p.observations
        if mark.kind == "arrow" and in_head < min(cost, most) and p.extent < SMALL * shaft:
            cost = in_head if _within(page, p, mark.figure[[1, 2, 4]]) else cost
        if cost < most:
            costs[p.index] = cost
    return mark.together(costs)
