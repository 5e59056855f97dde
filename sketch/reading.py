"""What some ink was taken for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Reading", "scored"]

# How fast a reading that is ahead of its rivals becomes certain. Nats count for less than a coder's would: what is
# not in the model (another grouping, a careless hand) errs at any margin. Fitted by maximum likelihood on 2000 shapes
# and 6000 bodies of sketches; `sketchsim bench recognition` prints how it holds, for single shapes on writers that
# the fit left out.
STEEP = 1.3


@dataclass(eq=False)
class Reading:
    """What some ink was taken for.

    Attributes:
        kind: "circle", "rectangle", "polygon", "bar", "anchor", "pivot", "gravity" or "unread".
        strokes: indices of the sketch's strokes that it explains.
        score: probability that this is what was meant (a circle, so many sides, a mark), 0 to 1.
        outline: [pixels], y down, shape (n, 2); closed for bodies and pivots.  An anchor's is its two bars
            end to end (4 points), the arrow's is tail and head (2 points).
        alternatives: what else the same ink may mean, with their scores, best first.
        gain: what the reading saves against saying the ink freely [nats].
        margin: what it saves against the next best reading of another meaning, or against saying the ink freely
            [nats].
        rough: nats that a polygon leaves to be said about where its ink is; a clean one leaves ten or so.
        error: standard error of a body's corners, or of its centre and radius [pixels]; 0 for marks.
        forced: the kind that the caller said it is, or None.
    """

    kind: str
    strokes: tuple[int, ...]
    score: float
    outline: NDArray[np.float64]
    alternatives: list[tuple[str, float]] = field(default_factory=list)
    gain: float = 0.0
    margin: float = 0.0
    rough: float = 0.0
    error: float = 0.0
    forced: str | None = None

    @property
    def solid(self) -> bool:
        """Whether it is a body."""
        return self.kind in ("circle", "rectangle", "polygon", "bar")

    @property
    def named(self) -> str:
        """Its strokes, as a note names them."""
        numbers = ", ".join(map(str, self.strokes))
        return f"stroke {numbers}" if len(self.strokes) == 1 else f"strokes {numbers}"


def scored(rivals: Mapping[str, float]) -> tuple[float, list[tuple[str, float]]]:
    """The probability of a reading, and those of its rivals, best first.

    rivals: of other kinds, what each saves more than the reading [nats], mostly less than nothing.
    """
    margin = max(-max(rivals.values()), 0.0)
    odds = (1 + margin) ** STEEP
    score = odds / (1 + odds)
    weight = {kind: math.exp(max((ahead + margin) / 4, -50.0)) for kind, ahead in rivals.items()}
    total = sum(weight.values())
    others = [(kind, (1 - score) * w / total) for kind, w in weight.items()]
    return score, sorted(others, key=lambda t: -t[1])
