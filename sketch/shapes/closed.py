"""Binding of the C fits of closed outlines (``sketch/core/outline.c``), and of what their readings take to say."""

from __future__ import annotations

import ctypes
from array import array as numbers
from itertools import accumulate
from typing import Any

import numpy as np

from sketch.kernel import SIDES
from sketch.library import address, library
from sketch.typing import Array

__all__ = ["ClosedFit", "ClosedReadings", "Few", "Said", "closed_readings", "fit_closed"]

LIFT = 6  # numbers that a struct Lift of core/outline.h takes
_pointer, _double, _int = ctypes.c_void_p, ctypes.c_double, ctypes.c_int32
_closed = ctypes.CFUNCTYPE(None, _pointer, _pointer, _int, *[_double] * 3, _pointer, _pointer)(
    ("ink_closed", library())
)
_readings = ctypes.CFUNCTYPE(None, *[_pointer] * 2, *[_double] * 2, *[_pointer] * 2)(
    ("ink_readings", library())
)

# of a struct Closed of core/closed.h its parts, in order, and how many numbers each has
_CLOSED = {
    "mean": 2,
    "to": 4,
    "back": 4,
    "ink": 1,
    "gap": 1,
    "conic": 5,
    "ellipse_cost": 1,
    "circle": 3,
    "circle_cost": 1,
    "residual": SIDES + 1,
    "cost": SIDES + 1,
    "lacks": SIDES + 1,
    "corners": 2 * SIDES * (SIDES + 1),
    "extra": 1,
    "box": 8,
    "turning": SIDES + 1,
    "is_ellipse": 1,
    "middle": 2,
    "axes": 4,
    "missing": 1,
    "arced": 1,
}
_ENDS = dict(zip(_CLOSED, accumulate(_CLOSED.values()), strict=True))
_PLACES = {
    name: slice(_ENDS[name] - n, _ENDS[name]) if n > 1 else _ENDS[name] - 1 for name, n in _CLOSED.items()
}
_CLOSED_NUMBERS = sum(_CLOSED.values())


class ClosedFit:
    """Fits to a closed chain of ink, kept where the library put them; what they are, core/closed.h says.

    Attributes:
        values: a struct Closed as numbers, each part of which is an attribute too, and what the fits needed besides.
        address: of these.
    """

    __slots__ = ("address", "values")

    def __init__(self, values: Array) -> None:
        self.values = values
        self.address = address(values)

    def __getattr__(self, name: str) -> Any:
        if name not in _PLACES:
            raise AttributeError(name)
        return self.values[_PLACES[name]]

    def vertices(self, sides: int) -> Array:
        """Corners of the best polygon of so many sides [pixels], (sides, 2)."""
        first = _ENDS["lacks"] + 2 * SIDES * sides
        return self.values[first : first + 2 * sides].reshape(sides, 2).copy()

    @property
    def rectangle(self) -> Array:
        """The nearest to the quadrilateral [pixels], (4, 2)."""
        return self.values[_PLACES["box"]].reshape(4, 2).copy()

    @property
    def ellipse(self) -> tuple[Array, Array] | None:
        """The middle of the ellipse [pixels], and half axes of it as columns, (2, 2); None where it is none."""
        if not self.values[_PLACES["is_ellipse"]]:
            return None
        return self.values[_PLACES["middle"]], self.values[_PLACES["axes"]].reshape(2, 2)


class Few(ctypes.Structure):
    """What is known of ink that came in few points, in equal steps (see core/readings.c).

    said: numbers that they say; 0 for ink that came in many.  steps: between them.
    even, cornered: nats to say how even these are, of something round and of a polygon of few sides.
    """

    _fields_ = tuple((name, _double) for name in ("said", "steps", "even", "cornered"))


class Said(ctypes.Structure):
    """What a reading takes to say [nats], infinitely many for none, of that its parameters, and the ink, given a
    polygon's outline."""

    _fields_ = tuple((name, _double) for name in ("cost", "model", "rough"))


class ClosedReadings(ctypes.Structure):
    """The readings of a closed chain of ink (see core/readings.c).

    scale, narrow, gap: as of `sketch.scoring.Fitted`.
    circle, ellipse, polygon, rectangle, free: what each takes to say.
    at: the circle's centre and radius [pixels].
    sides: of the polygon.  next, ahead: of the one that comes next, and the nats that it takes more.
    """

    _fields_ = (
        *((name, _double) for name in ("scale", "narrow", "gap")),
        *((name, Said) for name in ("circle", "ellipse", "polygon", "rectangle", "free")),
        ("at", _double * 3),
        *((name, _double) for name in ("sides", "next", "ahead")),
    )


def fit_closed(parts: list[Array], least_axis: float, observations: float, hopeless: float) -> ClosedFit:
    """Fit the closed chain of ink that `parts`, each (n, 2) in pixels, make one after another.

    least_axis: what the frame's radii are at least [pixels].  observations: that the ink is worth.
    hopeless: a first split that costs more [nats] is not looked into further.
    """
    xy = np.ascontiguousarray(np.concatenate(parts) if len(parts) > 1 else parts[0], dtype=np.float64)
    ends = numbers("i", accumulate(map(len, parts)))
    fit = ClosedFit(np.empty(_CLOSED_NUMBERS + 2 * len(xy) + LIFT * len(parts)))
    at, scratch = fit.address, fit.address + 8 * _CLOSED_NUMBERS
    _closed(address(xy), address(ends), len(parts), least_axis, observations, hopeless, at, scratch)
    return fit


def closed_readings(
    fit: ClosedFit, rounded: ClosedFit, observations: float, besides: float, few: Few
) -> ClosedReadings:
    """The readings of a closed chain of ink.

    rounded: the fits by which it is round.  besides: nats to say what else there is.
    """
    found = ClosedReadings()
    at = ctypes.byref(few), ctypes.byref(found)
    _readings(fit.address, rounded.address, observations, besides, *at)
    return found
