"""Ink: what the pen left on the page, in the sketch's own pixels, y down."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Sketch", "Stroke"]


@dataclass(frozen=True, eq=False)
class Stroke:
    """One pen stroke, from pen down to pen up.

    Attributes:
        points: [pixels], y down, shape (n, 2), finite.
        times: [ms], shape (n,), or None.  Never to be relied on: it may be doubled or run backwards.
    """

    points: NDArray[np.float64]
    times: NDArray[np.float64] | None = None

    @property
    def has_length(self) -> bool:
        """Whether the pen moved at all."""
        return len(self.points) > 1 and bool((self.points != self.points[0]).any())


@dataclass(frozen=True, eq=False)
class Sketch:
    """A page of ink.

    Attributes:
        strokes: in the order of drawing.
        width, height: of the canvas or picture [pixels], or None.
        pixels_per_metre: the page's scale, or None where none is given.
        picture: the picture that the strokes were traced from, BGR, uint8, shape (h, w, 3), or None.
        notes: what reading the input had to decide or leave out.
    """

    strokes: list[Stroke]
    width: float | None = None
    height: float | None = None
    pixels_per_metre: float | None = None
    picture: NDArray[Any] | None = None
    notes: list[str] = field(default_factory=list)
