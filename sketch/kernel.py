"""Binding of the C fits (``sketch/core``): plain arrays in, plain arrays out."""

from __future__ import annotations

import ctypes
import math
from array import array as numbers
from collections.abc import Mapping, Sequence
from itertools import accumulate, chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sketch.library import address, library
from sketch.typing import Array, Point

__all__ = [
    "SIDES",
    "Mark",
    "Places",
    "Point",
    "Shaft",
    "Strokes",
    "bar",
    "beside",
    "course",
    "course_around",
    "crossing",
    "cuts",
    "depth",
    "depths",
    "fit_arrows",
    "fit_cross",
    "gap",
    "held",
    "is_simple",
    "joined",
    "lent",
    "measure",
    "off_outline",
    "place",
    "places",
    "ring",
    "together",
    "touch",
    "words",
]

SAMPLES, SIDES, BENDS, LEGS, PARTS = 48, 12, 6, 12, 8  # as in core/fit.h, core/strokes.c and core/cut.c
COURSE = 32  # as in core/course.c
ARROW_STROKES = 3  # of an arrow, at most: MOST_STROKES of core/arrow.c
WHOLE_WAYS = 6  # in which one stroke may be a whole arrow, as core/arrow.c tries them
LENT = 1000  # points of a side that is lent, at most: MOST_STEPS of core/lend.c
_lib = library()
_pointer, _double, _int = ctypes.c_void_p, ctypes.c_double, ctypes.c_int32
_strokes = ctypes.CFUNCTYPE(None, _pointer, _pointer, _int, *[_pointer] * 6)(("ink_strokes", _lib))
_bar = ctypes.CFUNCTYPE(_int, *[_pointer] * 3, _int, _pointer)(("ink_bar", _lib))
_crossing = ctypes.CFUNCTYPE(_int, *[_pointer] * 5)(("ink_crossing", _lib))
_cross = ctypes.CFUNCTYPE(_int, *[_pointer] * 5, _int, _double, _pointer)(("ink_cross", _lib))
_arrows = ctypes.CFUNCTYPE(_int, *[_pointer] * 6, _int, *[_pointer] * 2, _double, *[_pointer] * 2)(
    ("ink_arrows", _lib)
)
_beside = ctypes.CFUNCTYPE(ctypes.c_int64, _pointer, _int, _pointer, _int, _pointer, ctypes.c_int64)(
    ("ink_beside", _lib)
)
_held = ctypes.CFUNCTYPE(None, *[_pointer] * 2, _int, _pointer, _int, *[_double] * 3, *[_pointer] * 2)(
    ("ink_held", _lib)
)
_patches = ctypes.CFUNCTYPE(_int, *[_pointer] * 2, _int, _int, *[_pointer] * 2)(("ink_patches", _lib))
_words = ctypes.CFUNCTYPE(
    ctypes.c_int64, _pointer, _int, *[_pointer] * 3, _double, _double, _pointer, ctypes.c_int64
)(("ink_words", _lib))
_cuts = ctypes.CFUNCTYPE(None, *[_pointer] * 2, _int, *[_pointer] * 3)(("ink_cuts", _lib))
_off_outline = ctypes.CFUNCTYPE(None, _pointer, _pointer, _int, _pointer, _int, _pointer, _pointer)(
    ("ink_off_outline", _lib)
)
_is_simple = ctypes.CFUNCTYPE(_int, _pointer, _int)(("ink_is_simple", _lib))
_course = ctypes.CFUNCTYPE(_int, _pointer, _int, _double, _pointer)(("ink_course", _lib))
_around = ctypes.CFUNCTYPE(_int, _pointer, _int, _int, _pointer, _pointer)(("ink_course_around", _lib))
_placed = ctypes.CFUNCTYPE(_int, _pointer, _int, _pointer, _pointer, _int, _int)(("ink_placed", _lib))
_lend = ctypes.CFUNCTYPE(_int, *[_pointer] * 2, _int, *[_pointer] * 2, _double, _int, _pointer)(
    ("ink_lend", _lib)
)
_ring = ctypes.CFUNCTYPE(_int, _pointer, _int, _double, _pointer, _pointer)(("ink_ring", _lib))
_touch = ctypes.CFUNCTYPE(_int, _pointer, _int, _pointer, _int, *[_double] * 4)(("ink_touch", _lib))
_gap = ctypes.CFUNCTYPE(_double, _pointer, _int, _pointer, _int, _pointer)(("ink_gap", _lib))
_depth = ctypes.CFUNCTYPE(_double, _double, _double, _pointer, _int)(("ink_depth", _lib))
_depths = ctypes.CFUNCTYPE(None, _pointer, _int, _pointer, _int, _pointer)(("ink_depths", _lib))


class Strokes(NamedTuple):
    """All strokes of a page, measured (see core/strokes.c).

    Attributes:
        points: without repeats and hooks, (n, 2) [pixels].  ends: where each stroke's points end.
        measure: (strokes, 8): length, box (4), distance of its ends, root mean square distance from the centroid, and
            across the longer axis [pixels].
        samples: (strokes, SAMPLES, 2), in equal steps of length.
        residual: (strokes, LEGS + 1): mean squared distance from its best k segments [pixels²].
        vertices: (strokes, BENDS + 1, BENDS + 1, 2): of those segments.
    """

    points: Array
    ends: NDArray[np.int32]
    measure: Array
    samples: Array
    residual: Array
    vertices: Array


class Shaft(NamedTuple):
    """What may be an arrow's shaft.

    names: its stroke, then those that may be its head.  heads: how many of them it takes, at least and at most: none
    where the stroke is the whole arrow.
    tail, toward: its tail, and a point toward its tip [pixels]; of a whole arrow any.
    """

    names: tuple[int, ...]
    heads: tuple[int, int]
    tail: Point
    toward: Point


class Places(NamedTuple):
    """Where the library finds what is known of a page's strokes: as of `Strokes`, and of each a struct Facts of
    core/facts.h."""

    samples: int
    measure: int
    residual: int
    vertices: int
    facts: int


class Mark(NamedTuple):
    """A cross or an arrow on some strokes, as a reading.

    names: the strokes; of an arrow its shaft's first.  cost: nats; rough: of these, to say the ink.
    figure: a closed polygon along all that may be drawn of it [pixels], (n, 2).
    """

    names: tuple[int, ...]
    cost: float
    rough: float
    figure: Array


def places(strokes: Strokes, facts: Array) -> Places:
    """Where they are."""
    return Places(
        *map(address, (strokes.samples, strokes.measure, strokes.residual, strokes.vertices, facts))
    )


def measure(strokes: list[Array]) -> Strokes:
    """Clean, sample and measure strokes, each (n, 2) in pixels."""
    count = len(strokes)
    xy = np.ascontiguousarray(np.concatenate([np.empty((0, 2)), *strokes]), dtype=np.float64)
    ends = np.fromiter(accumulate(map(len, strokes)), dtype=np.int32)
    out = Strokes(
        np.empty_like(xy),
        np.empty_like(ends),
        np.empty((count, 8)),
        np.empty((count, SAMPLES, 2)),
        np.empty((count, LEGS + 1)),
        np.empty((count, BENDS + 1, BENDS + 1, 2)),
    )
    _strokes(address(xy), address(ends), count, *(address(part) for part in out))
    return out


def joined(a: Strokes, b: Strokes) -> Strokes:
    """The measures of strokes and of further ones; their points are left out."""
    samples, residual, vertices = (np.concatenate(pair) for pair in zip(a[3:], b[3:], strict=True))
    rows = np.concatenate([a.measure, b.measure])
    return Strokes(a.points[:0], a.ends[:0], rows, samples, residual, vertices)


def bar(known: Places, name: int) -> tuple[int, float]:
    """Of how many sides a stroke is as a bar, and the nats to say it so, besides how rare that is (see core/bar.c)."""
    cost = _double()
    sides = _bar(known.residual, known.vertices, known.facts, name, ctypes.byref(cost))
    return sides, cost.value


def crossing(bars: Array) -> tuple[float, float] | None:
    """Nats of how far from their middles two bars cross, given their ends, (4, 2), and of how unlike they are; None for
    no X (see core/cross.c)."""
    at, odd = address(bars), np.empty(2)
    if not _crossing(at, at + 16, at + 32, at + 48, address(odd)):
        return None
    return float(odd[0]), float(odd[1])


def fit_cross(known: Places, names: tuple[int, ...], most: float) -> Mark | None:
    """An X of one stroke or two; None where there is none in `most` nats (see core/cross.c)."""
    out = np.empty((10, 2))
    which, at = numbers("i", names), address(out)
    ink = known.samples, known.residual, known.vertices, known.facts, address(which)
    if not _cross(*ink, len(names), most, at):
        return None
    cost, rough = out[0].tolist()
    return Mark(names, cost, rough, out[1:])


def fit_arrows(known: Places, shafts: Sequence[Shaft], worse: float) -> list[Mark]:
    """The arrows of some shafts and their heads.

    worse: nats more than their ink takes freely that arrows are looked for up to.
    """
    which: list[int] = []
    ends: list[int] = []
    heads: list[int] = []
    given: list[float] = []
    most = 0
    for names, head, tail, toward in shafts:
        which += names
        ends.append(len(which))
        heads += head
        given += tail + toward
        most += len(names) ** 2 if head[1] else WHOLE_WAYS
    count, whole = len(ends), len(which)
    out, groups = np.empty(13 * most), np.empty(ARROW_STROKES * most, dtype=np.int32)
    ints, doubles = numbers("i", which + ends + heads), numbers("d", given)
    at = address(ints)
    found = _arrows(
        known.samples,
        known.measure,
        known.vertices,
        known.facts,
        at,
        at + 4 * whole,
        count,
        at + 4 * (whole + count),
        address(doubles),
        worse,
        address(out),
        address(groups),
    )
    if not found:
        return []
    arrows = out[: 13 * found].reshape(found, 13).copy()
    figures = arrows[:, 1:].reshape(found, 6, 2).copy()
    strokes = groups[: ARROW_STROKES * found].reshape(found, ARROW_STROKES).tolist()
    return [
        Mark(tuple([i for i in its if i >= 0]), cost, 0.0, figure)
        for its, cost, figure in zip(strokes, arrows[:, 0].tolist(), figures, strict=True)
    ]


def beside(boxes: Array, bodies: Array) -> list[list[int]]:
    """Pairs of a box of marks, (n, 4), and a body, (m, 5), that can matter to them (see core/beside.c), in order."""
    room = 16 * len(boxes)
    while True:
        pairs = np.empty((room, 2), dtype=np.int32)
        at = address(boxes), len(boxes), address(bodies), len(bodies), address(pairs)
        count = _beside(*at, room)
        if count <= room:
            found: list[list[int]] = pairs[:count].tolist()
            return found
        room = count


def held(
    lines: Sequence[Array], rings: Array, in_ring: float, through: float, shorter: float
) -> tuple[list[int], list[float]]:
    """By how many rings each open line, (n, 2), is held, given their middles and extents, (m, 3), and the extent of the
    largest of these [pixels] (see core/held.c)."""
    count = len(lines)
    first = np.fromiter(accumulate(map(len, lines), initial=0), dtype=np.int32)
    found, wide = np.empty(count, dtype=np.int32), np.empty(count)
    points = np.ascontiguousarray(np.concatenate(lines), dtype=np.float64)  # kept, while it is read
    of = address(points), address(first), count, address(rings), len(rings)
    _held(*of, in_ring, through, shorter, address(found), address(wide))
    return found.tolist(), wide.tolist()


def cuts(strokes: Sequence[Array]) -> list[tuple[list[float], list[int]]]:
    """Where each stroke, (n, 2), may go on from one thing to the next: shares of its length, 0 and 1 among them, and
    what the parts between look like: 0 a loop, 1 a straight line, 2 a way (see core/cut.c)."""
    count = len(strokes)
    points = np.concatenate([np.empty((0, 2)), *strokes])
    ends = np.fromiter(accumulate(map(len, strokes)), dtype=np.int32)
    parts = np.empty(count, dtype=np.int32)
    shares, kinds = np.empty((count, PARTS + 1)), np.empty((count, PARTS), dtype=np.int32)
    _cuts(address(points), address(ends), count, address(shares), address(kinds), address(parts))
    return [
        (shares[k, : n + 1].tolist(), kinds[k, :n].tolist()) if n > 1 else ([0.0, 1.0], [0])
        for k, n in enumerate(parts.tolist())
    ]


def course(points: Array, pen: float) -> Array | None:
    """An open line, (n, 2), as COURSE sides at most; None where it crosses itself.

    pen: what it is at least as thick as [pixels].
    """
    line = np.empty((COURSE + 1, 2))
    given = np.ascontiguousarray(points)
    count = _course(address(given), len(given), pen, address(line))
    return line[:count].copy() if count else None


def course_around(parts: Sequence[Array]) -> Array | None:
    """Ink that goes once around, parts of (n, 2), as a closed outline of COURSE corners at most, without what runs
    beyond its closing or, of several parts, beyond where they cross [pixels]; None where it crosses itself."""
    given = np.ascontiguousarray(np.concatenate(parts))
    outline, scratch = np.empty((COURSE, 2)), np.empty(3 * len(given) + 6)
    count = _around(address(given), len(given), len(parts) > 1, address(scratch), address(outline))
    return outline[:count].copy() if count else None


def off_outline(strokes: Strokes, names: Sequence[int], outline: Array) -> tuple[list[float], list[float]]:
    """Mean squared distances of some strokes from a closed outline, (n, 2), and the greatest ones [pixels²]."""
    which, off = np.array(names, dtype=np.int32), np.empty((2, len(names)))
    _off_outline(
        address(strokes.samples),
        address(which),
        len(names),
        address(outline),
        len(outline),
        address(off[0]),
        address(off[1]),
    )
    mean, greatest = off.tolist()
    return mean, greatest


def place(ink: Array, corners: Array, sides: int, rectangle: bool = False) -> Array | None:
    """A convex polygon, (sides, 2), or with no sides a circle's centre and radius, (3,), moved to where it differs
    least in area from the convex hull of ink, (n, 2); None where it has no such place (see core/place.c)."""
    n = len(ink)
    points = np.empty((3 * n + 2, 2))
    points[:n] = ink
    out = np.array(corners, dtype=np.float64)
    at = address(points)
    found = n > 1 and _placed(at, n, at + 16 * n, address(out), sides, rectangle)
    return out if found else None


def ring(points: Array, length: float) -> tuple[Array, float] | None:
    """A stroke of some length from where its ends cross on, and what of its length runs on beyond that [pixels]; None
    where they do not cross (see core/closing.c)."""
    out = np.empty((len(points) + 2, 2))
    at = address(out)
    count = _ring(address(points), len(points), length, at + 16, at)
    return (out[1 : count + 1], float(out[0, 0])) if count else None


def lent(
    strokes: Strokes, name: int, points: Array, ends: Array, reach: float, *, several: bool
) -> tuple[Array, float] | None:
    """The side that a stroke lends to others, along it from their last end to their first, (n, 2), and the steps
    that it is in [pixels]; None where it lends none (see core/lend.c).

    points: of the stroke, (n, 2).  ends: of the others, the first and the last, (2, 2).  reach: as near to them its ink
    must come.  several: whether they are several strokes.
    """
    out = np.empty((LENT + 2, 2))
    at, row = address(out), strokes.measure[name]
    samples = address(strokes.samples) + 16 * SAMPLES * name
    out[0] = row[0], row[5]
    count = _lend(samples, address(points), len(points), at, address(ends), reach, several, at + 16)
    return (out[1 : count + 1].copy(), float(out[0, 0])) if count else None


def is_simple(outline: Array) -> bool:
    """Whether no two sides of a closed outline, (n, 2), cross or touch."""
    return bool(_is_simple(address(outline), len(outline)))


def depth(x: float, y: float, outline: Array) -> float:
    """Distance of a point from a closed outline, (n, 2) [pixels]; negative inside."""
    return float(_depth(x, y, address(outline), len(outline)))


def depths(points: Array, outline: Array) -> list[float]:
    """Likewise of points, (m, 2)."""
    found = np.empty(len(points))
    _depths(address(points), len(points), address(outline), len(outline), address(found))
    return found.tolist()


def gap(one: Array, other: Array) -> tuple[float, Point]:
    """How near two open lines, (n, 2), come to each other [pixels], and a place on one of them where they do."""
    at, one, other = np.empty(2), np.ascontiguousarray(one), np.ascontiguousarray(other)
    wide = float(_gap(address(one), len(one), address(other), len(other), address(at)))
    return wide, (float(at[0]), float(at[1]))


def together(inks: Sequence[Sequence[int]]) -> list[int]:
    """Numbers of the patches that some inks are in, each of a piece at least: those that share pieces, however
    indirectly, are in one (see core/patches.c)."""
    if not inks:
        return []
    members = np.fromiter(chain.from_iterable(inks), dtype=np.int32)
    ends = np.fromiter(accumulate(map(len, inks)), dtype=np.int32)
    most, patch = int(members.max()) + 1, np.empty(len(inks), dtype=np.int32)
    parent = np.empty(2 * most, dtype=np.int32)
    _patches(address(members), address(ends), len(inks), most, address(parent), address(patch))
    return patch.tolist()


def touch(one: Array, other: Array, at: Point, reach: float, near: float) -> bool:
    """Whether two closed outlines, (n, 2), overlap or come nearer than `near` within `reach` of a point [pixels]."""
    return bool(_touch(address(one), len(one), address(other), len(other), *at, reach, near))


def words(
    strokes: Strokes, sizes: Mapping[int, float], of_larger: float, of_smaller: float = math.inf
) -> list[list[int]]:
    """Pairs of some strokes that may be in one word, given how large each, or its word, is [pixels], and what is
    between them at most, as shares of the larger and of the smaller (see core/words.c)."""
    which, extents = np.array(list(sizes), dtype=np.int32), np.array(list(sizes.values()), dtype=float)
    boxes = strokes.measure[which, 1:5].copy()
    ink = address(which), len(which), address(boxes), address(extents), address(strokes.samples)
    room = 16 * len(which)
    while True:
        pairs = np.empty((room, 2), dtype=np.int32)
        count = _words(*ink, of_larger, of_smaller, address(pairs), room)
        if count <= room:
            found: list[list[int]] = which[pairs[:count]].tolist()
            return found
        room = count
