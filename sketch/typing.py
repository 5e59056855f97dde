"""Types that have one name throughout."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Box", "Image", "Point", "Points"]

Array = NDArray[np.float64]  # of any shape: whoever takes or returns one says which
Points = NDArray[np.float64]  # places [pixels], y down, shape (n, 2)
Point = tuple[float, float]
Box = tuple[float, float, float, float]  # least x and y, greatest x and y
Image = NDArray[Any]  # uint8, shape (h, w), or (h, w, 3) in the order blue, green, red
