"""Readings of open ink as marks: an X of two bars, an arrow of a shaft and a head."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sketch.kernel import Shaft, crossing, fit_arrows, fit_cross
from sketch.page.pieces import Page, Piece
from sketch.scoring import PARAMETER, Fitted, misfit_of

__all__ = ["read_arrows", "read_cross", "read_cross_over", "with_strays"]

CROSS = 6 * PARAMETER  # nats to say the bars of an X; as in core/cross.c
RARE_ARROW = (
    2.0  # nats that an arrow is rarer than an outline: there is one on a page, or none; as in core/arrow.c
)
ARROW = RARE_ARROW + 4 * PARAMETER  # nats to say tail and tip; the head is said by how unlike a head it is
STRAY = (
    0.08  # of an X's or an arrow's extent: how far beyond it ink may be that belongs to it; as in core/mark.h
)


def read_cross(page: Page, names: tuple[int, ...], most: float = math.inf) -> Fitted | None:
    """An X: two bars that cross near their middles; where the pen went on, further ink joins them.

    None where they do not, or where it takes more than `most` [nats].
    """
    found = fit_cross(page.places, names, most)
    if found is None:
        return None
    figure = found.figure
    bars = figure[[0, 1, 4, 2]]
    return Fitted("cross", names, found.cost, bars, model=CROSS, rough=found.rough, figure=figure)


def read_cross_over(bar: Fitted, other: Piece, most: float = math.inf) -> Fitted | None:
    """An X of a bar that is in two strokes, as its reading says, and one in a single stroke. None as of read_cross."""
    bars = np.concatenate([bar.outline, other.line(1)])
    odd = crossing(bars)
    if odd is None:
        return None
    rough = bar.cost - bar.model + misfit_of(other, other.residual[1]) + sum(odd)
    if CROSS + rough > most:
        return None
    names, figure = tuple(sorted((*bar.pieces, other.index))), bars[[0, 1, 3, 0, 2, 1, 2, 3, 2]]
    return Fitted("cross", names, CROSS + rough, bars, model=CROSS, rough=rough, figure=figure)


def read_arrows(page: Page, shafts: Sequence[Shaft], worse: float = math.inf) -> list[Fitted]:
    """Arrows of shafts, each from its tail toward the tip, and heads of two barbs.

    worse: nats more than their ink takes freely that arrows are looked for up to.
    """
    return [
        Fitted("arrow", tuple(sorted(names)), cost, figure[:2], ARROW, figure=figure)
        for names, cost, _, figure in (fit_arrows(page.places, shafts, worse) if shafts else ())
        if page.apart(names[-1], names[:-1])
    ]


def with_strays(page: Page, mark: Fitted, free: float) -> list[Fitted]:
    """A cross or an arrow together with smaller ink along it: a side that joins its bars, a barb drawn twice.

    free: nats to say its ink freely.
    """
    figure = mark.figure
    if figure is None or mark.cost > free:
        return []
    x, y = figure.T.tolist()
    reach = STRAY * math.hypot(max(x) - min(x), max(y) - min(y))
    shaft = math.hypot(x[1] - x[0], y[1] - y[0]) if mark.kind == "arrow" else 0.0
    return mark.together(page.again(figure, reach, mark.pieces, 0.0, shaft))
