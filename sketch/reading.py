"""What some ink was taken for."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from sketch.typing import Array

__all__ = ["Reading", "Rival", "scored"]

# What parts two readings, in nats, mostly comes from how far the ink is off either. There a nat counts for a share of
# one: points err together, and hands otherwise than the model has it. The share differs between hands and drawings; as
# a gamma variate with this shape and this rate its mean odds are a power, as in Student's t for an unknown spread.
SHAPE, RATE = 3.5, 11.0
# A circle and an ellipse say the ink alike but for one number: little of the difference is in the ink.
WORTH = 0.8  # of a nat
# All three by maximum likelihood on 7000 shapes, alone and in sketches; fitted on half of the writers they hold as well
# for the other half. `sketchsim bench recognition` prints how they hold.


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
        stray: how far a body's ink is off its outline, at most [pixels]; 0 for marks.
        forced: the kind that the caller said it is, or None.
    """

    kind: str
    strokes: tuple[int, ...]
    score: float
    outline: Array
    alternatives: list[tuple[str, float]] = field(default_factory=list)
    gain: float = 0.0
    margin: float = 0.0
    rough: float = 0.0
    error: float = 0.0
    stray: float = 0.0
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


class Rival(NamedTuple):
    """What the ink of a reading may mean else.

    Attributes:
        kind: as of a reading; of polygons with their sides.
        behind: what it saves less than the reading [nats].
        alike: whether it says the ink alike but for one number.
    """

    kind: str
    behind: float
    alike: bool = False

    @property
    def odds(self) -> float:
        """Against the reading."""
        behind = max(self.behind, 0.0)
        return math.exp(-WORTH * behind) if self.alike else (1 + behind / RATE) ** -SHAPE


def scored(rivals: Iterable[Rival]) -> tuple[float, list[tuple[str, float]]]:
    """The probability of a reading, and those of its rivals, best first."""
    odds: dict[str, float] = {}
    for rival in rivals:
        odds[rival.kind] = odds.get(rival.kind, 0.0) + rival.odds
    every = 1 + sum(odds.values())
    others = [(kind, its / every) for kind, its in odds.items()]
    return 1 / every, sorted(others, key=lambda t: -t[1])
