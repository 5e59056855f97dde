"""Readings of open lines: thin bars, straight or bent, in one stroke or in two."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sketch.kernel import bar, course, off_outline
from sketch.page.pieces import Page, Piece
from sketch.scoring import PARAMETER, Fitted, misfit_of
from sketch.shapes.outlines import GAP, RETRACE
from sketch.typing import Array

__all__ = [
    "ASIDE",
    "LIFT",
    "bars_again",
    "line_of_any_course",
    "read_bar",
    "read_bar_of_two",
    "read_line",
    "read_line_gone_over",
]

OPEN = 0.3  # of its length: how far apart the ends of an open line are at least
# of its half extent: usual spread of a rod's ink; what is off by much more is bent on purpose
STRAIGHT = 0.02  # as in core/bar.c
LIFT = 0.1  # of a bar's length: what lacks at most where the pen was lifted within it
ASIDE = 0.06  # of a bar's length: how far aside the pen went on, at most, after it was lifted
AGAIN = 0.5  # of the shorter of two strokes: where so much of it lies along the other, one was gone over
RING = 0.2  # of its length: how far apart the ends of a small ring are at most
RARE = 25.0  # nats that an open line is rarer than an outline
ANY_COURSE = 5.0  # nats that a line of any course is rarer than ink without a meaning
THIN = 0.004  # of its length: what a line of any course is as thick as, at least


def read_bar(page: Page, piece: Piece) -> Fitted | None:
    """An open line or polyline: a thin bar. None for a stroke whose ends meet."""
    if piece.gap < OPEN * piece.length:
        return None
    segments, cost = bar(page.places, piece.stroke)
    return _bar((piece.index,), cost + RARE, piece.line(segments))


def read_line(piece: Piece) -> Fitted | None:
    """An open line of any course: ground, where an X stands on it; by itself free ink is likelier.

    None for one that crosses itself, or whose ends meet.
    """
    if piece.gap < OPEN * piece.length:
        return None
    line = line_of_any_course(piece)
    return None if line is None else _bar((piece.index,), piece.unread + ANY_COURSE, line)


def line_of_any_course(piece: Piece) -> Array | None:
    """A piece's ink as a few sides in equal steps [pixels]; None where it crosses itself."""
    return course(piece.points, THIN * piece.length)


def read_line_gone_over(piece: Piece) -> Fitted | None:
    """A straight bar that the pen went forth and back along. None for a stroke that goes once."""
    if not piece.retraces:
        return None
    scale = piece.extent / 2
    bowed = 0.5 * (piece.across / (STRAIGHT * scale)) ** 2
    cost = RARE + 4 * PARAMETER + misfit_of(piece, piece.across**2, scale) + bowed + _again(piece)
    return _bar((piece.index,), cost, np.array(piece.reach))


def _again(piece: Piece) -> float:
    """Nats to say what of a straight line's stroke goes over it again."""
    once = math.dist(*piece.reach) / piece.length if piece.retraces else 1.0
    return RETRACE * piece.observations * (1 - once)


def read_bar_of_two(page: Page, first: Piece, second: Piece) -> Fitted | None:
    """A straight bar in two strokes: one goes on where the other ends, or over it once more.

    None where they are not in line, or far apart; and where a small ring joins them: these are two rods.
    """
    (ax, ay), (bx, by) = first.reach
    chord = math.hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / chord, (by - ay) / chord
    at = [((x - ax) * ux + (y - ay) * uy, (y - ay) * ux - (x - ax) * uy) for x, y in second.reach]
    (low, off), (high, away) = sorted(at)
    long = max(chord, high) - min(0.0, low)
    lift = max(low - chord, -high, 0.0)  # what lacks between them
    if lift > LIFT * long or max(abs(off), abs(away)) > ASIDE * long:
        return None
    again = min(chord, high) - max(0.0, low)
    if again < AGAIN * min(chord, high - low):
        x, y = (bx, by) if low > 0.5 * chord else (ax, ay)
        reach = LIFT * long
        if any(r.gap < RING * r.length for r in page.touching(x - reach, y - reach, x + reach, y + reach)):
            return None
    ink = page.strokes.samples[[first.stroke, second.stroke]]
    weights = np.array([first.length, second.length]) / (len(ink[0]) * (first.length + second.length))
    middle = (weights[:, None, None] * ink).sum(axis=(0, 1))
    from_middle = ink - middle
    spread = np.einsum("s,sni,snj->ij", weights, from_middle, from_middle)
    squares, axes = np.linalg.eigh(spread)
    along = axes[:, 1]
    reaches = np.sort((np.array([*first.reach, *second.reach]) - middle) @ along)[[0, -1]]
    line = middle + reaches[:, None] * along
    square, count = float(squares[0]), first.observations + second.observations
    lacking = GAP * count * lift / long + RETRACE * count * max(again, 0.0) / long
    scale = math.sqrt(3) / 4 * long  # half of the extent of a straight line so long
    bowed = 0.5 * square / (STRAIGHT * scale) ** 2
    # each stroke is off it by its own writer's precision: a letter's bar is no part of a floor's side
    far, _ = off_outline(page.strokes, [first.stroke, second.stroke], line)
    said = sum(misfit_of(p, its, p.extent / 2) for p, its in zip((first, second), far, strict=True))
    lacking += _again(first) + _again(second)
    cost = RARE + 5 * PARAMETER + said + bowed + lacking  # its two ends, and where the pen was lifted
    names = (first.index, second.index)
    return _bar(names, cost, line)


def bars_again(page: Page, bar: Fitted, pieces: Sequence[Piece]) -> list[Fitted]:
    """A bar together with some other pieces, as far as they run along it once more."""
    others = [p for p in pieces if p.index not in bar.pieces and page.apart(p.index, bar.pieces)]
    if not others:
        return []
    off, _ = off_outline(page.strokes, [p.stroke for p in others], bar.outline)
    said = [
        PARAMETER + RETRACE * p.observations + misfit_of(p, square, p.extent / 2)
        for p, square in zip(others, off, strict=True)
    ]
    return bar.together({p.index: nats for p, nats in zip(others, said, strict=True) if nats < p.unread})


def _bar(names: tuple[int, ...], cost: float, line: Array) -> Fitted:
    return Fitted("bar", names, cost, line, model=RARE + 2 * len(line) * PARAMETER)
