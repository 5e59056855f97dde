"""Readings of open ink: bar, cross, arrow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise

import numpy as np

from sketch.kernel import ArrowFit, Shaft, course, fit_arrows, off_outline
from sketch.outlines import GAP, RETRACE
from sketch.pieces import Page, Piece
from sketch.scoring import FREE, PARAMETER, Fitted, meaningless, misfit, misfit_of
from sketch.typing import Array

__all__ = [
    "ASIDE",
    "LIFT",
    "line_of_any_course",
    "read_arrows",
    "read_bar",
    "read_bar_of_two",
    "read_cross",
    "read_line",
    "with_strays",
]

MOST_BENDS = 5
# of its half extent: usual spread of a rod's ink; what is off by much more is bent on purpose
STRAIGHT = 0.02
LIFT = 0.1  # of a bar's length: what lacks at most where the pen was lifted within it
ASIDE = 0.06  # of a bar's length: how far aside the pen went on, at most, after it was lifted
BEND = 3.0  # nats for each corner of a bar
SHARP = 12.0  # nats that a right angle is rarer in a bar, one that folds it back twice that
HEAD = 2.0  # nats an observation to say ink freely, where it lies within an arrow's head
SHAFT = 0.55  # of the shaft: what the distance of an arrow's ink from it is measured in
GAPS = 0.5  # of the shaft: what the distance of an arrow from the nearest ink is measured in: a barb is drawn
# times that a shaft and the barbs of an arrow are drawn: the pen comes back along a barb
OFTEN = (1.3, 2.0, 2.0)
STRAY = 0.08  # of a mark's extent: how far beyond it ink may be that belongs to it
# of its length, what the ends of a loop are apart; of its extent, half of a wide one's thickness
LOOP = (0.12, 0.2)
OFF_BAR = 0.22  # of an X's half extent: ink further from its bars is said in fewer nats freely than as theirs
JOINED = 0.3  # of a bar's length: as near to its end is what joins it
MOSTLY = 0.6  # of an X's ink: what lies on its bars; a side that joins them is no longer than either
RARE = 25.0  # nats that an open line is rarer than an outline
ANY_COURSE = 5.0  # nats that a line of any course is rarer than ink without a meaning
THIN = 0.004  # of the length of such a line: what it is as thick as, at least
RARE_ARROW = 2.0  # likewise for an arrow: there is one on a page, or none

Vertex = list[float]


def read_bar(piece: Piece) -> Fitted | None:
    """An open line or polyline: a thin bar. None for a stroke whose ends meet."""
    if piece.gap < 0.3 * piece.length:
        return None
    best, segments = math.inf, 1
    for k in range(1, MOST_BENDS + 1):
        said = 2 * (k + 1) * PARAMETER
        if said + BEND * (k - 1) > best:
            break
        bowed = 0.5 * piece.residual[k] / (STRAIGHT * max(piece.scale, 1e-9)) ** 2
        cost = misfit_of(piece, piece.residual[k]) + bowed + said + BEND * (k - 1)
        if cost > best:
            continue
        cost += SHARP * _turning(piece.corners(k))
        if cost < best:
            best, segments = cost, k
    return _bar((piece.index,), best + RARE, piece.line(segments))


def read_line(piece: Piece) -> Fitted | None:
    """An open line of any course: ground, where an X stands on it; by itself free ink is likelier.

    None for one that crosses itself, or whose ends meet.
    """
    if piece.gap < 0.3 * piece.length:
        return None
    line = line_of_any_course(piece)
    return None if line is None else _bar((piece.index,), piece.unread + ANY_COURSE, line)


def line_of_any_course(piece: Piece) -> Array | None:
    """A piece's ink as a few sides in equal steps [pixels]; None where it crosses itself."""
    return course(piece.points, THIN * piece.length)


def read_bar_of_two(page: Page, first: Piece, second: Piece) -> Fitted | None:
    """A straight bar in two strokes: one goes on where the other ends, or over it once more.

    None where they are not in line, or far apart; and where a small ring joins them: these are two rods.
    """
    (ax, ay), (bx, by) = first.ends
    chord = math.hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / chord, (by - ay) / chord
    at = [((x - ax) * ux + (y - ay) * uy, (y - ay) * ux - (x - ax) * uy) for x, y in second.ends]
    (low, off), (high, away) = sorted(at)
    long = max(chord, high) - min(0.0, low)
    lift = max(low - chord, -high, 0.0)  # what lacks between them
    if lift > LIFT * long or max(abs(off), abs(away)) > ASIDE * long:
        return None
    again = min(chord, high) - max(0.0, low)
    if again < 0.5 * min(chord, high - low):
        x, y = (bx, by) if low > 0.5 * chord else (ax, ay)
        reach = LIFT * long
        if any(r.gap < 0.2 * r.length for r in page.touching(x - reach, y - reach, x + reach, y + reach)):
            return None
    ink = page.strokes.samples[[first.stroke, second.stroke]]
    weights = np.array([first.length, second.length]) / (len(ink[0]) * (first.length + second.length))
    middle = (weights[:, None, None] * ink).sum(axis=(0, 1))
    from_middle = ink - middle
    spread = np.einsum("s,sni,snj->ij", weights, from_middle, from_middle)
    squares, axes = np.linalg.eigh(spread)
    along = axes[:, 1]
    reaches = np.sort((np.array([*first.ends, *second.ends]) - middle) @ along)[[0, -1]]
    line = middle + reaches[:, None] * along
    square, count = float(squares[0]), first.observations + second.observations
    lacking = GAP * count * lift / long + RETRACE * count * max(again, 0.0) / long
    scale = math.sqrt(3) / 4 * long  # half of the extent of a straight line so long
    bowed = 0.5 * square / (STRAIGHT * scale) ** 2
    # each stroke is off it by its own writer's precision: a letter's bar is no part of a floor's side
    far = off_outline(page.strokes, [first.stroke, second.stroke], line)
    said = sum(misfit_of(p, its) for p, its in zip((first, second), far, strict=True))
    cost = RARE + 5 * PARAMETER + said + bowed + lacking
    names = (first.index, second.index)
    return _bar(names, cost, line)


def _bar(names: tuple[int, ...], cost: float, line: Array) -> Fitted:
    return Fitted("bar", names, cost, line, model=RARE + 2 * len(line) * PARAMETER)


def _turning(v: list[Vertex]) -> float:
    """How sharply a polyline turns: each corner by 1 - cos of its angle."""
    sides = [complex(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(v)]
    return sum(1 - (b * a.conjugate()).real / max(abs(a) * abs(b), 1e-12) for a, b in pairwise(sides))


def read_cross(page: Page, names: tuple[int, ...], most: float = math.inf) -> Fitted | None:
    """An X: two bars that cross near their middles; where the pen went on, further ink joins them.

    None where they do not, or where it takes more than `most` [nats].
    """
    parts = [page.pieces[i] for i in names]
    length = sum(p.length for p in parts)
    count = sum(p.observations for p in parts)
    best = None
    single = len(parts) == 1
    for bends in ((3,), (4,), (5,)) if single else ((1, 1), (1, 2), (2, 1), (1, 3), (3, 1), (2, 2)):
        off = sum(misfit_of(p, p.residual[n]) for p, n in zip(parts, bends, strict=True))
        if 6 * PARAMETER + off > most and not single:
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
            if joining > 0.5:
                continue
            # a third of the ink is what one side takes to join the bars
            extra = PARAMETER + FREE * count * max(joining - 0.35, 0.0) if len(sides) > 2 else 0.0
            odd = _crossing(a, b, c, d)
            if odd is None:
                continue
            said = off + extra
            if single and 7 * PARAMETER + FREE * count * joining + odd[0] + odd[1] < most:
                # what joins them may go any way
                said = min(said, PARAMETER + _joined(page, parts[0], np.array([a, b, c, d])))
            cost = 6 * PARAMETER + said + odd[0] + odd[1]
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
    return Fitted("cross", names, cost, bars, model=6 * PARAMETER, rough=rough, figure=figure)


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
    if abs(det) < 0.3 * p * q or max(p, q) > 3 * min(p, q):  # at less than 17 degrees, or unlike
        return None
    t, s = (wx * vy - wy * vx) / det, (wx * uy - wy * ux) / det
    if not (0.1 < t < 0.9 and 0.1 < s < 0.9):
        return None
    return ((t - 0.5) ** 2 + (s - 0.5) ** 2) / (2 * 0.12**2), 0.5 * (math.log(p / q) / 0.3) ** 2


def read_arrows(page: Page, shafts: Sequence[Shaft], worse: float = math.inf) -> list[Fitted]:
    """Arrows of shafts, each from its tail toward the tip, and heads of two barbs.

    worse: nats more than their ink takes freely that arrows are looked for up to.
    """
    if not shafts:
        return []
    free = [page.pieces[i].unread for shaft in shafts for i in shaft.names]
    fits = fit_arrows(page.strokes, shafts, free, worse - RARE_ARROW - 4 * PARAMETER)
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
    model = RARE_ARROW + 4 * PARAMETER  # tail and tip; the head is said by how unlike a head it is
    off, said = 0.0, model + again + fit.unlike
    for p, square in zip(pieces, fit.off, strict=False):
        small = p.extent < 0.6 * shaft
        # an arrow whose ends meet is no loop, nor a barb that was drawn forth and back
        scale = SHAFT * shaft if len(pieces) == 1 else p.extent / 2 if small else None
        cost, free = misfit_of(p, square, scale), HEAD * p.observations
        if said + off + (min(cost, free) if small else cost) > most:
            return None
        off += free if cost > free and small and _within(page, p, np.array(fit.head)) else cost
    cost = model + off + again + fit.unlike
    if cost > most:
        return None
    tip, left_end, right_end = fit.head
    figure = np.array([fit.tail, tip, left_end, tip, right_end, tip])
    names, line = tuple(sorted(fit.names)), np.array([fit.tail, tip])
    return Fitted("arrow", names, cost, line, model=model, figure=figure)


def _within(page: Page, piece: Piece, head: Array) -> bool:
    """Whether a piece lies within an arrow's head, given its tip and the ends of its barbs [pixels].

    A wide loop does not: a barb that was gone over is a thin one, and a wheel is no part of a head.
    """
    if piece.gap < LOOP[0] * piece.length and piece.scale > LOOP[1] * piece.extent:
        return False
    a, b, c = head
    if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]):
        b, c = c, b
    reach = STRAY * (math.dist(a, b) + math.dist(a, c))
    points = page.strokes.samples[piece.stroke]
    for p, q in ((a, b), (b, c), (c, a)):
        side = (q - p) / max(math.dist(p, q), 1e-9)
        if ((points - p) @ np.array([-side[1], side[0]])).min() < -reach:
            return False
    return True


def with_strays(page: Page, mark: Fitted, free: Mapping[int, float]) -> list[Fitted]:
    """A cross or an arrow together with smaller ink along it: a side that joins its bars, a barb drawn twice.

    free: nats to say each piece freely.
    """
    if mark.figure is None or mark.cost > sum(free[i] for i in mark.pieces):
        return []
    reach = STRAY * math.dist(mark.figure.min(axis=0), mark.figure.max(axis=0))
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
        if mark.kind == "arrow" and p.extent < 0.6 * shaft and _within(page, p, mark.figure[[1, 2, 4]]):
            cost = min(cost, PARAMETER + HEAD * p.observations)
        if cost < free[p.index]:
            costs[p.index] = cost
    return mark.together(costs)
