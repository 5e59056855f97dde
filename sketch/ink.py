"""Ink: what the pen left on the page, in the sketch's own pixels, y down."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.scene import InputError
from sketch.typing import Array

__all__ = ["Sketch", "Stroke"]


@dataclass(frozen=True, eq=False)
class Stroke:
    """One pen stroke, from pen down to pen up.

    Attributes:
        points: [pixels], y down, shape (n, 2), finite.
        times: [ms], shape (n,), or None.  Never to be relied on: it may be doubled or run backwards.
        remains: whether it is, on a picture, what is left of the ink of strokes that it runs into: no letter.

    Raises InputError for points that are not so.
    """

    points: Array
    times: Array | None = None
    remains: bool = False

    def __post_init__(self) -> None:
        try:
            points = np.asarray(self.points, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError("points", "not rows of two numbers") from None
        if points.size == 0:
            points = np.zeros((0, 2))
        if points.ndim != 2 or points.shape[1] != 2:
            raise InputError("points", f"of shape {points.shape}, not (n, 2)")
        if not np.isfinite(points).all():
            k = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
            raise InputError(f"points[{k}]", "not finite")
        object.__setattr__(self, "points", points)

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

    Raises InputError for a size or a scale that is not greater than 0.
    """

    strokes: list[Stroke]
    width: float | None = None
    height: float | None = None
    pixels_per_metre: float | None = None
    picture: NDArray[Any] | None = None
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        for name in ("width", "height", "pixels_per_metre"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError(name, f"{value} is not greater than 0")
