"""The compiled library of ``sketch/core``, loaded once."""

from __future__ import annotations

import ctypes
import functools
import sys
from array import array as numbers
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["address", "library"]

ABI = 39  # as core/abi.c says
_first_byte = ctypes.c_char.from_buffer
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


@functools.cache
def library() -> ctypes.CDLL:
    """The library; raises ImportError where there is none, or one built from other sources than this package."""
    path = Path(__file__).with_name("_ink" + _SUFFIX)
    try:
        found = ctypes.CDLL(str(path))
    except OSError as e:
        raise ImportError(f"the ink library does not load ({e}); install the project again") from None
    if not hasattr(found, "ink_abi") or found.ink_abi() != ABI:
        raise ImportError(f"{path.name} does not belong to this version; install the project again")
    return found


def address(array: NDArray[Any] | numbers[Any]) -> int:
    """Where an array's values are, for the library: `array.ctypes.data` in a quarter of its time.

    A few numbers are given as an `array.array`: of ctypes' arrays each length is a type, and making that takes longer
    than many a fit.
    """
    try:
        return ctypes.addressof(_first_byte(array))  # type: ignore[arg-type]
    except (TypeError, ValueError):  # one that is empty, or may not be written
        return np.asarray(array).ctypes.data
