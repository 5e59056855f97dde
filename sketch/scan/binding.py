"""The C core of scanning: ink, thinning and tracing, through ctypes."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.library import address, library
from sketch.typing import Points

__all__ = [
    "Chains",
    "along_lines",
    "belt",
    "bend",
    "cheapest_cover",
    "coarseness",
    "columns",
    "course_length",
    "crests",
    "crisp_ink",
    "darkness",
    "distances",
    "ends",
    "heading",
    "link",
    "measure_pieces",
    "nearest",
    "pieces",
    "smoothed",
    "thin",
    "through",
    "trace",
    "turns",
]

_MASK = np.ctypeslib.ndpointer(np.uint8, ndim=2, flags=("C_CONTIGUOUS", "WRITEABLE"))
_PICTURE = np.ctypeslib.ndpointer(np.uint8, ndim=3, flags="C_CONTIGUOUS")
_FLOATS = np.ctypeslib.ndpointer(np.float32, ndim=2, flags=("C_CONTIGUOUS", "WRITEABLE"))
_DOUBLES = np.ctypeslib.ndpointer(np.float64, ndim=1, flags=("C_CONTIGUOUS", "WRITEABLE"))
RAYS = 48  # as in core/belt.c
_INTS = np.ctypeslib.ndpointer(np.int32, ndim=1, flags=("C_CONTIGUOUS", "WRITEABLE"))


@functools.cache
def _library() -> ctypes.CDLL:
    core = library()
    int32, real = ctypes.c_int32, ctypes.c_float
    core.ink_along_lines.argtypes = [_MASK, int32, int32, _MASK, _FLOATS, _FLOATS, _FLOATS, int32, _MASK]
    core.ink_along_lines.restype = None
    core.ink_crests.argtypes = [_MASK, _MASK, int32, int32, int32, int32, real, real, _MASK]
    core.ink_crests.restype = None
    core.ink_crisp.argtypes = [_MASK, _MASK, ctypes.c_int64, ctypes.c_uint8, _MASK, _MASK]
    core.ink_crisp.restype = None
    core.ink_darkness.argtypes = [_PICTURE, _MASK, int32, int32, int32, int32, _MASK]
    core.ink_darkness.restype = int32
    core.ink_link.argtypes = [_MASK, int32, int32, int32, ctypes.c_double, _MASK]
    core.ink_link.restype = int32
    pointer, double = ctypes.c_void_p, ctypes.c_double
    core.ink_bend.argtypes = [pointer, int32, pointer, double, double]
    core.ink_bend.restype = double
    core.ink_heading.argtypes = [pointer, int32, pointer, double, double, pointer]
    core.ink_heading.restype = None
    core.ink_turns.argtypes = [pointer, int32, int32, pointer]
    core.ink_turns.restype = None
    core.ink_smooth.argtypes = [pointer, int32, pointer, int32, int32, pointer]
    core.ink_smooth.restype = None
    core.ink_nearest.argtypes = [pointer, int32, double, double]
    core.ink_nearest.restype = int32
    core.ink_length.argtypes = [pointer, int32]
    core.ink_length.restype = double
    core.ink_coarseness.argtypes = [*[pointer] * 3, int32, pointer, int32, int32, double, double]
    core.ink_coarseness.restype = double
    core.ink_cover.argtypes = [*[pointer] * 6, int32, pointer, int32, pointer, int32, pointer]
    core.ink_cover.restype = int32
    core.ink_belt.argtypes = [_MASK, int32, int32, _DOUBLES, ctypes.c_double, _DOUBLES]
    core.ink_belt.restype = int32
    core.ink_columns.argtypes = [_MASK, int32, _INTS, _INTS, int32, int32, _INTS, _INTS]
    core.ink_columns.restype = None
    core.ink_through.argtypes = [_MASK, int32, int32, int32, _MASK]
    core.ink_through.restype = None
    core.ink_distance.argtypes = [_MASK, int32, int32, _FLOATS]
    core.ink_distance.restype = None
    core.ink_thin.argtypes = [_MASK, int32, int32]
    core.ink_thin.restype = int32
    core.ink_ends.argtypes = [_MASK, int32, int32]
    core.ink_ends.restype = int32
    core.ink_measure_pieces.argtypes = [pointer, pointer, int32, int32, *[pointer] * 5]
    core.ink_measure_pieces.restype = None
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


def bend(points: Points, start: Points, sight: float, smooth: float) -> float:
    """The curvature of a line, (n, 2) [pixels], from `start` on, over twice `sight`, leftwards positive [1/pixel].

    It is 0 where too little of the line is there to tell, or where it turns a corner: is off an arc by more than
    `smooth` of the sight.
    """
    line, at = np.ascontiguousarray(points), np.ascontiguousarray(start)
    return float(_library().ink_bend(address(line), len(line), address(at), sight, smooth))


def course_length(points: Points) -> float:
    """The length of a course, (n, 2) [pixels]."""
    line = np.ascontiguousarray(points)
    return float(_library().ink_length(address(line), len(line)))


def nearest(points: Points, place: Points) -> int:
    """Which of some points, (n, 2), is nearest to a place, (2,), the first of several."""
    line = np.ascontiguousarray(points)
    return int(_library().ink_nearest(address(line), len(line), *place.tolist()))


def turns(points: Points, cut: int) -> NDArray[np.float64]:
    """By how much a chain, (n, 2) [pixels], turns within `cut` points to either side of each, as if it went around
    [rad], (n,)."""
    line, out = np.ascontiguousarray(points), np.empty(len(points))
    _library().ink_turns(address(line), len(line), cut, address(out))
    return out


def smoothed(points: Points, weights: NDArray[np.float64], *, closed: bool) -> Points:
    """A chain, (n, 2), smoothed along itself: each point becomes the mean of those around it with these weights, an odd
    number.

    closed: whether the last point leads to the first; else both stay.
    """
    line, out = np.ascontiguousarray(points), np.empty((len(points), 2))
    _library().ink_smooth(address(line), len(line), address(weights), len(weights) // 2, closed, address(out))
    return out


def heading(points: Points, centre: Points, reach: float, sight: float) -> tuple[Points, Points]:
    """Where a branch gets clear of a junction's ink, and its direction there as a unit vector.

    Thinning bends a branch within `reach` of the junction's centre, so it is looked at beyond, for the
    length of `sight`; a branch shorter than that from half of its length on.
    """
    line, at, out = np.ascontiguousarray(points), np.ascontiguousarray(centre), np.empty(4)
    _library().ink_heading(address(line), len(line), address(at), reach, sight, address(out))
    return out[:2], out[2:]


def coarseness(
    ink: Points,
    ends: NDArray[np.int32],
    worth: Points,
    corners: Points,
    slack: float,
    size: float,
    *,
    closed: bool,
) -> float:
    """Nats that a shape owes where it says stretches of ink less precisely than the smallest thing that each may be
    part of.

    ink: all stretches, one after another, (n, 2) [pixels].  ends: of each, the points up to its end.  worth: of each
    the size of that smallest thing [pixels], its observations, and the nats to say it freely, (stretches, 3).
    corners: of the shape, (k, 2) [pixels].  slack: how far off it ink may be [pixels].  size: of the shape [pixels], or
    0 for a line.  closed: whether the last corner leads to the first.
    """
    line = np.ascontiguousarray(corners)
    given = address(ink), address(ends), address(worth), len(ends), address(line), len(line)
    return float(_library().ink_coarseness(*given, closed, slack, size or np.inf))


def cheapest_cover(
    of: tuple[NDArray[np.int32], NDArray[np.int32]],
    left: NDArray[np.bool_],
    cost: NDArray[np.float64],
    free: NDArray[np.float64],
    length: NDArray[np.float64],
    some: NDArray[np.int32],
    first: Sequence[int],
) -> tuple[list[int], float]:
    """The readings among `some` that say a drawing's ink for the least, and the nats that saves against saying it
    freely (see core/cover.c).

    of: the stretches of all readings, one after another, and of each reading the first of its own, and one more.
    left: whether each is ink that is left over together.  cost: nats to say each.  free, length: of each stretch, nats
    to say it freely, and pen widths.  first: a cover to begin with.
    """
    chosen, most = np.empty(len(some) + 1, np.int32), np.empty(1)
    chosen[: len(first)] = first
    given = [address(values) for values in (of[1], of[0], left, cost, free, length)]
    ways = address(some), len(some), address(chosen), len(first), address(most)
    found = int(_library().ink_cover(*given, len(free), *ways))
    if found < 0:
        raise MemoryError("no memory for covers of the ink")
    return chosen[:found].tolist(), float(most[0])


def along_lines(
    dark: NDArray[Any], near: NDArray[Any], tensor: Sequence[NDArray[Any]], reach: int
) -> NDArray[np.uint8]:
    """Darkness, shape (h, w), and where `near` is not 0 its mean along the line there, up to `reach` [pixels] each way.

    near, tensor: shape (h // 2, w // 2); of the structure tensor xx, xy and yy.
    """
    smooth = np.array(dark, np.uint8)
    height, width = dark.shape
    _library().ink_along_lines(dark, width, height, near, *tensor, reach, smooth)
    return smooth


def columns(
    mask: NDArray[np.uint8], x: NDArray[np.int32], middle: NDArray[np.int32], reach: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Of columns x of a mask the ink within `reach` rows of `middle`, each shape (n,): how many pixels, and the sum of
    how far these are below it [pixels].  All of these rows are on the mask."""
    pixels, below = np.empty_like(x), np.empty_like(x)
    _library().ink_columns(mask, mask.shape[1], x, middle, len(x), reach, pixels, below)
    return pixels, below


def through(belt: NDArray[np.uint8], flat: int) -> NDArray[np.uint8]:
    """1 for the ink of a belt, shape (k, n) of two rows and more, on straight ways all of ink from its first row to its
    last that move no more than `flat` columns a row."""
    out = np.zeros_like(belt)
    _library().ink_through(belt, *belt.shape, flat, out)
    return out


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


def crisp_ink(
    dark: NDArray[Any], darkest: NDArray[Any], around: NDArray[Any], floor: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """1 where it is crisper than half of the darkest, and darker than `floor`, shape (h, w); and how crisp it is.

    A pixel is as crisp as it is dark, and half of what it is darker than the mean around it again. `around` is that
    mean, and is used up.
    """
    mask = np.empty_like(dark)
    _library().ink_crisp(dark, darkest, dark.size, floor, around, mask)
    return mask, around


def darkness(
    picture: NDArray[np.uint8], light: NDArray[np.uint8], *, dimmest: int, negative: bool
) -> NDArray[np.uint8]:
    """How much darker than the light on it each pixel of a BGR picture is, 0 to 255 of that light, shape (h, w).

    light: at each pixel, shape (h, w); below `dimmest` it counts as that.  negative: of the picture's negative.
    """
    dark = np.empty_like(light)
    height, width = light.shape
    picture = np.ascontiguousarray(picture)
    if _library().ink_darkness(picture, light, width, height, negative, dimmest, dark):
        raise MemoryError("no memory for a row of the picture")
    return dark


def link(line: NDArray[np.uint8], longest: float, mask: NDArray[Any]) -> None:
    """Add to a mask of ink the pieces of a line, as `crests` finds it, that are at least `longest` [pixels] or lie
    between two stretches of ink."""
    height, width = line.shape
    if _library().ink_link(line, width, height, int(np.count_nonzero(line)), longest, mask):
        raise MemoryError("no memory for the pieces of thin lines")


def distances(mask: NDArray[Any], known: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
    """How far each pixel of ink is from the paper, 0 on paper [pixels], shape (h, w).

    The outermost rows and columns count as paper.  known: of a mask that has no other ink, to be set.
    """
    distance = np.zeros(mask.shape, np.float32) if known is None else known
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


def ends(skeleton: NDArray[np.uint8]) -> int:
    """How many pixels of a skeleton, as `thin` leaves it, have one neighbour: the ends of its lines."""
    height, width = skeleton.shape
    return int(_library().ink_ends(skeleton, width, height))


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


def measure_pieces(
    found: tuple[NDArray[np.int32], NDArray[np.int32]],
    width: int,
    dark: NDArray[np.uint8] | None,
    edge: NDArray[np.uint8] | None,
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.bool_]]:
    """Of each piece, as `pieces` lists them, how many rows and columns it goes from its first to its last, (n, 2), its
    mean darkness, (n,), and whether it has a pixel at the sheet's edge, (n,): 0 and not where these are not given.

    width: of the mask.  dark, edge: of the page, shape (h, w), as in `Page`.
    """
    pixels, start = found
    count = len(start)
    bounds = np.append(start, np.int32(len(pixels)))
    extent, strength, at_edge = np.empty((count, 2), np.int32), np.empty(count), np.empty(count, bool)
    of = [None if some is None else np.ascontiguousarray(some) for some in (dark, edge)]
    given = [None if some is None else address(some) for some in of]
    out = [address(some) for some in (extent, strength, at_edge)]
    _library().ink_measure_pieces(address(pixels), address(bounds), count, width, *given, *out)
    return extent, strength, at_edge
