"""Ink → scene: readings of groups of strokes, scored, and the set of them that explains all the ink best."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.scene import Scene
from sketch.ink import Sketch

__all__ = ["Reading", "Recognition", "recognize"]


@dataclass(frozen=True, eq=False)
class Reading:
    """What some ink was taken for.

    Attributes:
        kind: "circle", "rectangle", "polygon", "bar", "anchor", "pivot", "gravity" or "unread".
        strokes: indices of the sketch's strokes that it explains.
        score: probability of this reading among those of the same ink, 0 to 1.
        outline: [pixels], y down, shape (n, 2); closed for bodies and pivots.  An anchor's is its two bars
            end to end (4 points), the arrow's is tail and head (2 points).
        alternatives: other kinds that the same ink was scored as, with their scores, best first.
    """

    kind: str
    strokes: tuple[int, ...]
    score: float
    outline: NDArray[np.float64]
    alternatives: list[tuple[str, float]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Recognition:
    """A sketch as it was understood: the scene and the readings that it was made from."""

    sketch: Sketch
    scene: Scene
    readings: list[Reading]


def recognize(sketch: Sketch) -> Recognition:
    raise NotImplementedError
