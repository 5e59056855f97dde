"""What some ink was taken for."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Reading"]


@dataclass(eq=False)
class Reading:
    """What some ink was taken for.

    Attributes:
        kind: "circle", "rectangle", "polygon", "bar", "anchor", "pivot", "gravity" or "unread".
        strokes: indices of the sketch's strokes that it explains.
        score: probability of this reading among those of the same ink, 0 to 1.
        outline: [pixels], y down, shape (n, 2); closed for bodies and pivots.  An anchor's is its two bars
            end to end (4 points), the arrow's is tail and head (2 points).
        alternatives: other kinds that the same ink was scored as, with their scores, best first.
        gain: what the reading saves against saying the ink freely [nats].
        rough: nats that a polygon leaves to be said about where its ink is; a clean one leaves ten or so.
        forced: the kind that the caller said it is, or None.
    """

    kind: str
    strokes: tuple[int, ...]
    score: float
    outline: NDArray[np.float64]
    alternatives: list[tuple[str, float]] = field(default_factory=list)
    gain: float = 0.0
    rough: float = 0.0
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
