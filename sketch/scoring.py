"""The one scale on which every reading is scored: the length of a description, in nats (Rissanen 1978).

A reading's cost is what it takes to say what was meant (its parameters, and how rare such a thing is), plus
what it then takes to say where the ink is, given that. Ink that means nothing is said freely, point by
point. What a reading gains is what it saves against that.

Each constant has a meaning; they were set by looking at drawings of many writers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sketch.lazy import lazy
from sketch.typing import Array

if TYPE_CHECKING:
    from sketch.page.pieces import Piece

__all__ = ["ONE_MORE", "Fitted", "misfit", "misfit_of", "unread"]

# spread of ink about what was meant, as a share of its size; of outlines it is less
TREMOR = 0.05  # as in core/scoring.h
# nobody's ink is off by much more than this, as a share of the radius
SLOPPY = 0.1  # as in core/outline.h and core/scoring.h
# nats to say one parameter to that precision: about ln(page / tremor)
PARAMETER = 4.0  # as in core/scoring.h
FREE = 4.0  # nats an observation to say ink freely, point by point; as in core/scoring.h
STRANGE = 35.0  # nats to say that something was drawn that has no meaning here; as in core/scoring.h
# observations in a straight line: what is less, a tap of the pen, is less of a surprise
LINE = 11.0  # as in core/scoring.h
ONE_MORE = 6  # pieces, the first, of which each may be the only one that a primitive explains besides its own


@dataclass(eq=False)  # frozen, it would take four times as long to make, and very many are
class Fitted:
    """A primitive fitted to some ink. Never changed once it is made.

    Attributes:
        kind: "circle", "ellipse", "rectangle", "polygon", "free" (an outline of any course), "cross", "arrow" or "bar".
        pieces: indices of the pieces that it explains, in order.
        cost: description length [nats].
        model: of these, what its own parameters take, whatever the ink [nats].
        outline: [pixels], as in `sketch.reading.Reading`.
        scale: of a closed outline: the geometric mean of its half axes [pixels].
        narrow: of a closed outline: the shorter of its half axes, as it was judged [pixels].
        rough: nats to say the ink, given the outline, of which a clean one takes ten or so.
        gap: of a closed outline: what is missing of it, as a share of its ink.
        next: of a polygon: the number of sides that comes next, and the nats that it takes more.
        lender: the piece of another body of which it borrows a side, or -1.
        figure: of a cross or an arrow: a closed polygon along all that may be drawn of it [pixels], (n, 2).
    """

    kind: str
    pieces: tuple[int, ...]
    cost: float
    outline: Array
    model: float = 0.0
    scale: float = 0.0
    narrow: float = 0.0
    gap: float = 0.0
    rough: float = 0.0
    next: tuple[int, float] = (0, math.inf)
    figure: Array | None = None
    lender: int = -1

    @property
    def closed(self) -> bool:
        return self.scale > 0

    @lazy
    def middle(self) -> tuple[float, float]:
        """The mean of its outline's points [pixels]."""
        x, y = (np.add.reduce(self.outline, axis=0) / len(self.outline)).tolist()
        return x, y

    def together(self, costs: Mapping[int, float]) -> list[Fitted]:
        """The same with further pieces that it explains too, given what each costs: all, or one of the first."""
        sets = [tuple(costs)] if costs else []
        sets += ((j,) for j in list(costs)[:ONE_MORE] if len(costs) > 1)
        own = self.outline, self.model, self.scale, self.narrow, self.gap, self.rough, self.next, self.figure
        return [
            Fitted(
                self.kind, tuple(sorted((*self.pieces, *more))), self.cost + sum(costs[j] for j in more), *own
            )
            for more in sets
        ]


def unread(piece: Piece) -> float:
    """Nats to say a piece's ink freely: point by point, or as the polyline that says it in fewest. `Piece.unread`
    keeps them."""
    best = FREE * piece.observations
    for k in range(1, len(piece.residual)):
        said = 2 * (k + 1) * PARAMETER
        if said >= best:
            break
        best = min(best, said + misfit_of(piece, piece.residual[k]))
    return strange(piece.observations) + best


def strange(count: float) -> float:
    """Nats to say that so many observations were drawn that have no meaning."""
    return STRANGE * min(count / LINE, 1.0)


def misfit(mean_square: float, count: float) -> float:
    """Nats to say `count` observations, given a primitive that they are off by `mean_square` [shares of the radius].

    Student's t for a tremor that is unknown but about TREMOR, and a normal prior on how careless people are.
    """
    return 0.5 * count * (math.log1p(mean_square / TREMOR**2) + mean_square / SLOPPY**2)


def misfit_of(piece: Piece, mean_square: float, scale: float | None = None) -> float:
    """Nats to say where a piece's ink is, given lines that it is off by `mean_square` [pixels²].

    A writer's precision goes with the size of what is drawn, not with the group's: a small loop is no
    careless piece of something large.
    """
    return misfit(mean_square / max(scale or piece.scale, 1e-9) ** 2, piece.observations)
