"""Readings of open ink: bar, cross, arrow."""

from __future__ import annotations

import math

import numpy as np

from sketch.kernel import fit_arrow
from sketch.pieces import Page, Piece, Point
from sketch.scoring import FREE, PARAMETER, Fitted, misfit_of

__all__ = ["read_arrow", "read_bar", "read_cross"]

MOST_BENDS = 5
BEND = 8.0  # nats for each corner of a bar, and for each that folds it back
RARE = 15.0  # nats that an open line is rarer than an outline

Vertex = list[float]


def read_bar(piece: Piece) -> Fitted | None:
    """An open line or polyline: a thin bar. None for a stroke whose ends meet."""
    if piece.gap < 0.3 * piece.length:
        return None
    best, segments = math.inf, 1
    for k in range(1, MOST_BENDS + 1):
        cost = misfit_of(piece, piece.residual[k]) + 2 * (k + 1) * PARAMETER + BEND * (k - 1)
        if cost > best:
            continue
        cost += BEND * _folds(piece.vertices[k][: k + 1])
        if cost < best:
            best, segments = cost, k
    return Fitted("bar", (piece.index,), best + RARE, piece.line(segments))


def _folds(v: list[Vertex]) -> int:
    """How many corners turn by more than 115 degrees: a bar seldom runs back along itself."""
    sides = [complex(b[0] - a[0], b[1] - a[1]) for a, b in zip(v, v[1:], strict=False)]
    return sum(
        (b * a.conjugate()).real < -0.42 * abs(a) * abs(b) for a, b in zip(sides, sides[1:], strict=False)
    )


def read_cross(page: Page, names: tuple[int, ...]) -> Fitted | None:
    """An X: two bars that cross near their middles; in one stroke, further ink joins them."""
    if len(names) == 2:
        p, q = (page.pieces[i] for i in names)
        a, b = p.vertices[1][:2]
        c, d = q.vertices[1][:2]
        return _cross(a, b, c, d, names, misfit_of(p, p.residual[1]) + misfit_of(q, q.residual[1]))
    piece = page.pieces[names[0]]
    best = None
    for k in (3, 4, 5):
        v = piece.vertices[k]
        lengths = [math.dist(a, b) for a, b in zip(v[:k], v[1 : k + 1], strict=True)]
        off = misfit_of(piece, piece.residual[k])
        for i in range(k - 2):
            for j in range(i + 2, k):
                joining = 1 - (lengths[i] + lengths[j]) / piece.length
                # a third of the ink is what one side takes to join the bars
                extra = PARAMETER + FREE * piece.observations * max(joining - 0.35, 0.0)
                found = _cross(v[i], v[i + 1], v[j], v[j + 1], names, off + extra)
                if found is not None and (best is None or found.cost < best.cost):
                    best = found
    return best


def _cross(a: Vertex, b: Vertex, c: Vertex, d: Vertex, names: tuple[int, ...], off: float) -> Fitted | None:
    ux, uy, vx, vy, wx, wy = b[0] - a[0], b[1] - a[1], d[0] - c[0], d[1] - c[1], c[0] - a[0], c[1] - a[1]
    p, q, det = math.hypot(ux, uy), math.hypot(vx, vy), ux * vy - uy * vx
    if abs(det) < 0.3 * p * q or max(p, q) > 3 * min(p, q):  # at less than 17 degrees, or unlike
        return None
    t, s = (wx * vy - wy * vx) / det, (wx * uy - wy * ux) / det
    if not (0.1 < t < 0.9 and 0.1 < s < 0.9):
        return None
    centred = ((t - 0.5) ** 2 + (s - 0.5) ** 2) / (2 * 0.12**2)
    alike = 0.5 * (math.log(p / q) / 0.3) ** 2
    return Fitted("cross", names, 6 * PARAMETER + off + centred + alike, np.array([a, b, c, d]))


def read_arrow(page: Page, names: tuple[int, ...], tail: Point, toward: Point) -> Fitted | None:
    """A shaft from `tail` toward the tip, and a head of two barbs; None where the ink has no head."""
    pieces = [page.pieces[i] for i in names]
    fit = fit_arrow(page.strokes, tuple(p.stroke for p in pieces), tail, toward)
    if fit is None:
        return None
    shaft, left, right = fit.lengths
    whole = 0.55 * shaft if len(pieces) == 1 else None  # its ends may meet, yet it is no loop
    off = sum(misfit_of(p, square, whole) for p, square in zip(pieces, fit.off, strict=True))
    drawn = sum(p.length for p in pieces)
    twice = max(1 - (shaft + left + right) / drawn, 0.0)  # the share of the ink that was drawn twice
    again = FREE * twice * sum(p.observations for p in pieces)
    # a head is two barbs alike, at some 35 degrees, less than half as long as the shaft
    alike = (math.log(left / right) / 0.35) ** 2
    size = (math.log((left + right) / 2 / shaft / 0.45) / 0.4) ** 2
    spread = sum(((angle - 0.6) / 0.25) ** 2 for angle in fit.angles)
    cost = 6 * PARAMETER + off + again + 0.5 * (alike + size + spread)
    return Fitted("arrow", tuple(sorted(names)), cost, np.array([tail, fit.head[0].tolist()]))
