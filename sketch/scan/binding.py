"""The C core of scanning: ink, thinning and tracing, through ctypes."""

from __future__ import annotations

import ctypes
import functools
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.library import library

__all__ = ["Chains", "belt", "crests", "distances", "pieces", "thin", "trace"]

_MASK = np.ctypeslib.ndpointer(np.uint8, ndim=2, flags=("C_CONTIGUOUS", "WRITEABLE"))
_FLOATS = np.ctypeslib.ndpointer(np.float32, ndim=2, flags=("C_CONTIGUOUS", "WRITEABLE"))
_DOUBLES = np.ctypeslib.ndpointer(np.float64, ndim=1, flags=("C_CONTIGUOUS", "WRITEABLE"))
RAYS = 48  # as in core/belt.c
_INTS = np.ctypeslib.ndpointer(np.int32, ndim=1, flags=("C_CONTIGUOUS", "WRITEABLE"))


@functools.cache
def _library() -> ctypes.CDLL:
    core = library()
    int32, real = ctypes.c_int32, ctypes.c_float
    core.ink_crests.argtypes = [_MASK, _MASK, int32, int32, int32, int32, real, real, _MASK]
    core.ink_crests.restype = None
    core.ink_belt.argtypes = [_MASK, int32, int32, _DOUBLES, ctypes.c_double, _DOUBLES]
    core.ink_belt.restype = int32
    core.ink_distance.argtypes = [_MASK, int32, int32, _FLOATS]
    core.ink_distance.restype = None
    core.ink_thin.argtypes = [_MASK, int32, int32]
    core.ink_thin.restype = int32
    core.ink_trace.argtypes = [_MASK, int32, int32, int32, *[_INTS] * 6]
    core.ink_trace.restype = int32
    core.ink_pieces.argtypes = [_MASK, int32, int32, _INTS, _INTS]
    core.ink_pieces.restype = int32
    return core


def belt(
    mask: NDArray[np.uint8], seed: tuple[float, float, float], pen: float
) -> tuple[float, NDArray[np.float64], float, NDArray[np.float64]] | None:
    """The belt of ink around a small ring's middle: its roundness, middle, radius and closed way, or None.

    mask: ink 1, paper 0, shape (h, w).  seed: about its middle and its radius [pixels].  pen: its width [pixels].
    Roundness is 1 for a perfect circle and 0 for what is as much out of round as a careless square.
    """
    height, width = mask.shape
    out = np.zeros(4 + 2 * RAYS)
    if not _library().ink_belt(mask, width, height, np.array(seed, dtype=np.float64), pen, out):
        return None
    points = out[4:].reshape(-1, 2)
    return float(out[0]), out[1:3], float(out[3]), np.concatenate([points, points[:1]])


def crests(
    darkness: NDArray[Any], mask: NDArray[Any], faintest: float, reach: int, crest: float, beside: float
) -> NDArray[np.uint8]:
    """1 on the crests of lines that are darker than `faintest` and not in the mask, shape (h, w).

    Across a crest, the next pixel has less than `crest` times its darkness, and within `reach` pixels to both
    sides darkness falls below `beside` of it.
    """
    line = np.zeros(mask.shape, np.uint8)
    height, width = mask.shape
    _library().ink_crests(darkness, mask, width, height, int(faintest), reach, crest, beside, line)
    return line


def distances(mask: NDArray[Any]) -> NDArray[np.float32]:
    """How far each pixel of ink is from the paper, 0 on paper [pixels], shape (h, w).

    The outermost rows and columns count as paper.
    """
    distance = np.zeros(mask.shape, np.float32)
    height, width = mask.shape
    _library().ink_distance(mask, width, height, distance)
    return distance


def thin(mask: NDArray[Any]) -> tuple[NDArray[np.uint8], int]:
    """The skeleton of a mask, 1 on lines one pixel wide, shape (h, w), and how many pixels it has.

    The outermost rows and columns count as paper.
    """
    skeleton = np.array(mask, np.uint8, order="C")
    height, width = skeleton.shape
    count = int(_library().ink_thin(skeleton, width, height))
    if count < 0:
        raise MemoryError("no memory for thinning")
    return skeleton, count


@dataclass(frozen=True, eq=False)
class Chains:
    """A skeleton as chains of pixels between its nodes.

    Attributes:
        chains: [pixels] x and y along each chain, shape (n, 2), without the pixels of its nodes.
        ends: the nodes at both ends of each chain; -1 is a free end, -2 at both ends a ring.
        nodes: [pixels] the centre of each node's pixels, shape (k, 2).
    """

    chains: list[NDArray[np.float64]]
    ends: list[tuple[int, int]]
    nodes: NDArray[np.float64]


def trace(skeleton: NDArray[np.uint8], count: int) -> Chains:
    """Trace a skeleton of `count` pixels, as `thin` leaves it."""
    height, width = skeleton.shape
    points, node_pixels, node_ids = (np.zeros(max(count, 1), np.int32) for _ in range(3))
    start, ends, counts = (
        np.zeros(count + 1, np.int32),
        np.zeros(2 * count + 2, np.int32),
        np.zeros(3, np.int32),
    )
    arrays = (points, start, ends, node_pixels, node_ids, counts)
    if _library().ink_trace(skeleton, width, height, count, *arrays) != 0:
        raise MemoryError("no memory for tracing")
    chain_count, node_count, node_size = (int(n) for n in counts)

    def pixels(index: NDArray[np.int32]) -> NDArray[np.float64]:
        return np.stack([index % width, index // width], axis=1).astype(np.float64)

    along = pixels(points[: start[chain_count]])
    members = node_ids[:node_size]
    size = np.maximum(np.bincount(members, minlength=node_count), 1)
    at = pixels(node_pixels[:node_size])
    nodes = np.stack([np.bincount(members, at[:, k], minlength=node_count) / size for k in (0, 1)], axis=1)
    return Chains(
        [along[a:b] for a, b in pairwise(start[: chain_count + 1])],
        [(int(a), int(b)) for a, b in ends[: 2 * chain_count].reshape(-1, 2)],
        nodes,
    )


def pieces(mask: NDArray[Any]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The connected pieces of a mask: the indices of all ink pixels, piece after piece, and each one's start.

    The outermost rows and columns count as paper.
    """
    height, width = mask.shape
    count = int(np.count_nonzero(mask))
    pixels, start = np.zeros(max(count, 1), np.int32), np.zeros(count + 1, np.int32)
    found = int(_library().ink_pieces(mask, width, height, pixels, start))
    if found < 0:
        raise MemoryError("no memory for the pieces of the ink")
    return pixels[: start[found]], start[:found]
