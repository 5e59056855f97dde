"""Quantiles without np.median and np.percentile: these load numpy.ma, a tenth of what reading a picture costs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["median", "percentile"]


def median(values: ArrayLike) -> float:
    """The middle one of some values, or the mean of the two in the middle."""
    flat = np.ravel(values)
    low, high = (len(flat) - 1) // 2, len(flat) // 2
    ordered = np.partition(flat, (low, high))
    return (float(ordered[low]) + float(ordered[high])) / 2


def percentile(values: NDArray[Any], percent: float) -> float:
    """What so many percent of some values are below, between two of them on the straight line."""
    flat = np.ravel(values)
    place = (len(flat) - 1) * percent / 100
    low = int(place)
    high = min(low + 1, len(flat) - 1)
    ordered = np.partition(flat, (low, high))
    return float(ordered[low]) + (place - low) * (float(ordered[high]) - float(ordered[low]))
