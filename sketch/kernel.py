"""Binding of the C fits (``sketch/core``): plain arrays in, plain arrays out."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["SIDES", "ClosedFit", "OpenFit", "fit_closed", "fit_open"]

Array = NDArray[np.float64]

SAMPLES, SIDES = 64, 14  # as in core/fit.h
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_lib = ctypes.CDLL(str(Path(__file__).with_name("_ink" + _SUFFIX)))
_pointer, _double, _int = ctypes.c_void_p, ctypes.c_double, ctypes.c_int32
_closed = ctypes.CFUNCTYPE(None, _pointer, _pointer, _int, _double, _double, _double, *[_pointer] * 7)(
    ("ink_closed", _lib)
)
_open = ctypes.CFUNCTYPE(_double, _pointer, _int, _pointer, _pointer, _pointer)(("ink_open", _lib))


_COUNTS = (10, 2, 10, SIDES + 1, SIDES + 1, 2 * SIDES * (SIDES + 1))  # of ink_closed's results, in order
_OFFSETS = tuple(sum(_COUNTS[:k]) for k in range(len(_COUNTS) + 1))


class ClosedFit(NamedTuple):
    """Readings of a closed chain of ink in its normal frame (see core/outline.c).

    Attributes:
        mean: the frame's origin [pixels].  back: (2, 2), pixel = mean + back @ normal.
        ink, gap: lengths of the ink and of the gaps, in the frame.
        conic: a, b, c, d, e of x² + y² = a(x² - y²) + 2bxy + cx + dy + e.
        ellipse_cost: nats to say the ink, given it.
        circle: centre and radius [pixels].  circle_cost: nats to say the ink, given it.
        residual: of the best k-gon, for k = 0 .. SIDES.
        cost: nats to say the ink, given that polygon.
        corners: in the frame, (SIDES + 1, SIDES, 2).
    """

    mean: Array
    back: Array
    ink: float
    gap: float
    conic: Array
    ellipse_cost: float
    circle: tuple[float, float, float]
    circle_cost: float
    residual: list[float]
    cost: list[float]
    corners: Array

    def vertices(self, sides: int) -> Array:
        """Corners of the best polygon of so many sides [pixels], (sides, 2)."""
        return np.asarray(self.mean + self.corners[sides, :sides] @ self.back.T)


class OpenFit(NamedTuple):
    """Readings of one stroke as a polyline: see core/polyline.c."""

    length: float
    samples: Array
    residual: list[float]
    corners: Array

    def vertices(self, segments: int) -> Array:
        return self.corners[segments, : segments + 1]


def fit_closed(parts: list[Array], least_axis: float, cap: float, observations: float) -> ClosedFit:
    """Fit the closed chain of ink that `parts`, each (n, 2) in pixels, make one after another."""
    xy = np.ascontiguousarray(np.concatenate(parts) if len(parts) > 1 else parts[0], dtype=np.float64)
    ends = np.cumsum([len(p) for p in parts], dtype=np.int32)
    out = np.empty(_OFFSETS[-1] + 2 * len(xy))
    at = out.ctypes.data
    _closed(xy.ctypes.data, ends.ctypes.data, len(ends), least_axis, cap, observations, *(at + 8 * o for o in _OFFSETS))
    frame, length, conic, residual, cost, corners, rest = _OFFSETS
    return ClosedFit(
        mean=out[0:2],
        back=out[6:10].reshape(2, 2),
        ink=float(out[length]),
        gap=float(out[length + 1]),
        conic=out[conic : conic + 5],
        ellipse_cost=float(out[conic + 5]),
        circle=(float(out[conic + 6]), float(out[conic + 7]), float(out[conic + 8])),
        circle_cost=float(out[conic + 9]),
        residual=out[residual:cost].tolist(),
        cost=out[cost:corners].tolist(),
        corners=out[corners:rest].reshape(SIDES + 1, SIDES, 2),
    )


def fit_open(points: Array) -> OpenFit:
    """Fit one stroke, (n, 2) in pixels, as polylines of 1 .. SIDES segments."""
    xy = np.ascontiguousarray(points, dtype=np.float64)
    samples, residual = np.empty((SAMPLES, 2)), np.empty(SIDES + 1)
    corners = np.zeros((SIDES + 1, SIDES + 1, 2))
    length = _open(xy.ctypes.data, len(xy), samples.ctypes.data, residual.ctypes.data, corners.ctypes.data)
    return OpenFit(length, samples, residual.tolist(), corners)
