"""Printed lines on paper: a family of straight lines, evenly spaced, from one side of the sheet to the other.

Where they are as dark as the pen only their geometry tells them from a drawing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import columns, pieces, through
from sketch.scan.quantiles import median
from sketch.typing import Image

__all__ = ["drop_ruling"]

Line = NDArray[np.float64]  # y = a x² + b x + c, as polyfit gives it

LONG = 0.3  # of the picture's width: what a stretch of a printed line has at least
SHORT = 0.03  # of the picture's width: shorter stretches are crossings of other lines
FEWEST = 5  # printed lines of which such a stretch is seen
EVEN = 0.12  # of their distance: how far they are from even spacing
BEYOND = 16  # [pixels] around the picture: a printed line is looked at with what is beside it
NEAREST = 3  # [pixels] beyond the thickness of a printed line, to either side: its ink is looked for so far at least
SEEN = 0.35  # of a line's length that has to be ink, where it is only thought to be
HARDLY = 0.2  # of a line's length that has to be ink, where it has its place among others that are seen
WHOLE = 0.8  # of the picture's width: a line seen so far is seen whole
EDGED = 0.99  # of the sheet's width: what a line has to reach at both ends to run from edge to edge
STRAIGHT = 0.3  # [pixels]: how far a printed line is off a smooth one; a hand's is further
TREMOR = 25  # [pixels] along a line over which that is told
DARKER = 1.5  # times as dark as the printed line: ink on it
STEEPEST = 0.21  # of a family of printed lines on a turned sheet, up or down a pixel
STEPS = 0.01  # [up or down a pixel] between the slopes that are tried
COARSE = 4  # [pixels] a side of the squares that those are tried on
FLAT = 3  # columns a row: what is drawn across a printed line at a flatter slant is left as it is
SHARPER = 1.5  # times as much ink runs at a slope than level: the sheet is turned


def drop_ruling(mask: Image, darkness: Image, edge: Image | None, photographed: bool) -> tuple[bool, int]:
    """Erase ruling, squares and margins from a mask of ink, and from its darkness what is there and no ink, in place.

    Ink that crosses a printed line stays, and so does ink on it that is clearly darker.  edge: not 0 off the sheet and
    near its edge, or None where the sheet fills the picture.  photographed: whether a camera or scanner saw it, so that
    no straight line is a tool's.  Returns whether there was ruling, and how many other lines from edge to edge.
    """
    import cv2

    # a printed line along the picture's edge is looked at to either side, as others are
    rim = (BEYOND,) * 4
    whole, dark = (
        cv2.copyMakeBorder(some, *rim, cv2.BORDER_CONSTANT, value=(0,)) for some in (mask, darkness)
    )
    off = cv2.copyMakeBorder(
        np.zeros_like(mask) if edge is None else edge, *rim, cv2.BORDER_CONSTANT, value=(255,)
    )
    ruled, margins = _drop_turned(whole, dark, off, photographed)
    whole, dark = (np.ascontiguousarray(some.T) for some in (whole, dark))
    upright_ruled, more = _drop_turned(whole, dark, off.T, photographed)
    for some, to in ((whole, mask), (dark, darkness)):
        to[...] = some.T[BEYOND:-BEYOND, BEYOND:-BEYOND]
    return ruled or upright_ruled, margins + more


def _drop_turned(mask: Image, darkness: Image, edge: Image, photographed: bool) -> tuple[bool, int]:
    """Erase what is printed from left to right, at some slope: as in drop_ruling."""
    slope = _slope(mask)
    if not slope:
        return _drop_printed(mask, darkness, edge, photographed)
    level, dark, beyond = _levelled(mask, slope), _levelled(darkness, slope), _levelled(edge, slope, 255)
    found = _drop_printed(level, dark, beyond, photographed, turned=True)
    if any(found):
        for there, here in _runs(mask.shape, slope):
            mask[here], darkness[here] = level[there], dark[there]
    return found


def _levelled(image: Image, slope: float, off: int = 0) -> Image:
    """A picture whose columns are moved so that lines of some slope are level.  off: what is beyond its edges."""
    height, width = image.shape
    level = np.full((height + round(abs(slope) * (width - 1)), width), off, np.uint8)
    for there, here in _runs(image.shape, slope):
        level[there] = image[here]
    return level


def _runs(shape: tuple[int, ...], slope: float) -> list[tuple[tuple[slice, slice], tuple[slice, slice]]]:
    """The columns that are moved alike to level lines of some slope: where they are on the level picture, and here."""
    height, width = shape
    down = -np.round(slope * np.arange(width)).astype(np.intp)
    down -= down.min()
    first = np.flatnonzero(np.diff(down, prepend=-1)).tolist()
    return [
        ((slice(by, by + height), slice(a, b)), (slice(None), slice(a, b)))
        for a, b, by in zip(first, [*first[1:], width], down[first].tolist(), strict=True)
    ]


def _slope(mask: Image) -> float:
    """The slope at which most ink runs along lines, 0 where that is hardly more than level."""
    import cv2

    height, width = (side // COARSE for side in mask.shape)
    if min(height, width) < 2:
        return 0.0
    small = cv2.resize(
        mask[: height * COARSE, : width * COARSE] * np.uint8(255),
        (width, height),
        interpolation=cv2.INTER_AREA,
    )
    y, x = np.nonzero(small)
    ink = small[y, x].astype(np.float64)
    slopes = STEPS * np.arange(-round(STEEPEST / STEPS), round(STEEPEST / STEPS) + 1)
    rows = [np.round(y - slope * x).astype(np.intp) for slope in slopes]
    sharp = [float((np.diff(np.bincount(row - row.min(), ink)) ** 2).sum()) for row in rows]
    best = int(np.argmax(sharp))
    return float(slopes[best]) if sharp[best] > SHARPER * sharp[len(slopes) // 2] else 0.0


def _drop_printed(
    mask: Image, darkness: Image, edge: Image, photographed: bool, turned: bool = False
) -> tuple[bool, int]:
    """Erase what is printed from left to right: as in drop_ruling.  turned: whether it was levelled."""
    lines, thick = _long_lines(mask, turned)
    ruled, margins = len(lines) >= FEWEST and _drop_family(lines, thick, mask, darkness, edge), 0
    for rough in lines if photographed else ():
        line = _refined(rough, mask, edge, thick, SEEN)
        if line is not None and _is_across(line, mask, edge, thick):
            _erase([_belt(line, mask, darkness, thick)], mask, darkness)
            margins += not ruled
    return ruled, margins


def _drop_family(lines: list[Line], thick: float, mask: Image, darkness: Image, edge: Image) -> bool:
    """Erase the ruling that some long lines belong to."""
    family = _family(lines, mask.shape)
    found = [_refined(line, mask, edge, thick, SEEN) for line in family]
    if sum(line is not None for line in found) < FEWEST:
        return False
    for k, line in enumerate(family):
        if found[k] is None:  # its place among the others is known
            found[k] = _refined(line, mask, edge, thick, HARDLY)
    belts = [_belt(line, mask, darkness, thick) for line in found if line is not None]
    _erase(belts, mask, darkness)
    return True


def _erase(belts: list[_Belt], mask: Image, darkness: Image) -> None:
    """Erase lines that are printed alike: their ink, and of the darkness all but what stays ink."""
    levels = [median(belt.dark[belt.alone]) for belt in belts if belt.alone.any()]
    # all are printed alike: a line that is drawn along one of them, however far, is darker than the others
    for belt in belts:
        printed = ~belt.crossed & (belt.dark <= DARKER * median(levels)) if levels else ~belt.crossed
        # where drawn lines lead across, the rest is the printed one; where one ends, or goes along it, nobody can tell
        drawn = through(belt.ink, FLAT)
        gone = belt.ink > drawn
        doubtful = gone[0] | gone[-1] | ~(belt.crossed | printed | drawn.any(axis=0))
        near = np.ones(2 * len(gone) + 1, np.int32)
        gone &= printed | (np.convolve(doubtful, near, "same") == 0)
        row, column = np.nonzero(gone)
        mask[belt.rows[row, column], belt.x[column]] = 0
        darkness[belt.rows, belt.x] *= belt.ink & ~gone


def _is_across(line: Line, mask: Image, edge: Image, thick: float) -> bool:
    """Whether a line runs straight from one edge of the sheet to the other, as no hand draws it."""
    height, width = mask.shape
    reach = round(thick) + 1
    x = np.arange(width)
    middle = np.round(np.polyval(line, x)).astype(int)
    inside = (middle >= reach) & (middle < height - reach)
    x, middle = x[inside], middle[inside]
    x, middle = x[edge[middle, x] == 0], middle[edge[middle, x] == 0]
    rows = middle + np.arange(-reach, reach + 1)[:, None]
    ink = mask[rows, x] > 0
    count = ink.sum(axis=0)
    seen = np.flatnonzero(count)
    alone = (count > 0) & (count <= thick + 1.5)
    rim = (1 - EDGED) * len(x)
    if len(seen) < WHOLE * len(x) or len(x) < LONG * width or alone.sum() < LONG * width:
        return False
    if seen[0] > rim or seen[-1] < len(x) - 1 - rim:
        return False
    off = (rows * ink).sum(axis=0)[alone] / count[alone] - np.polyval(line, x[alone])
    smooth = np.convolve(off, np.full(TREMOR, 1 / TREMOR), "valid")
    return float(np.std(smooth)) < STRAIGHT


def _long_lines(mask: Image, turned: bool) -> tuple[list[Line], float]:
    """The long, thin, nearly straight and nearly level stretches of ink, and how thick they are [pixels]."""
    import cv2

    width = mask.shape[1]
    # a line a pixel thick that is not quite level still runs on within three
    level = cv2.dilate(mask, np.ones((3, 1), np.uint8))
    level = cv2.morphologyEx(level, cv2.MORPH_OPEN, np.ones((1, max(round(SHORT * width), 9)), np.uint8))
    pixels, start = pieces(level & mask)
    if not len(start):
        return [], 0.0
    y, x = np.divmod(pixels, width)
    area = np.diff(np.append(start, len(pixels)))
    wide = np.maximum.reduceat(x, start) - np.minimum.reduceat(x, start) + 1
    lines, thickness = [], []
    for k in np.flatnonzero(wide >= LONG * width):
        own = slice(start[k], start[k] + area[k])
        thick = area[k] / wide[k]
        # a turned sheet ends before the picture does: continued beyond, a bent line goes astray
        line = _fitted(x[own], y[own], 1 if turned and wide[k] < WHOLE * width else 2)
        if np.std(y[own] - np.polyval(line, x[own])) < 0.5 * thick + 0.5:
            lines.append(line)
            thickness.append(thick)
    return lines, median(thickness) if thickness else 0.0


def _family(lines: list[Line], shape: tuple[int, ...]) -> list[Line]:
    """All lines of the family that some belong to; none where those are not evenly spaced.

    Seen at a slant their distance and slope change steadily: each is the next one's, and so on.
    """
    height, width = shape
    x = np.linspace(0, width - 1, 9)
    at = np.array(sorted((np.polyval(line, x) for line in lines), key=lambda y: float(y[4])))
    gaps = np.diff(at[:, 4])
    step = median(gaps)
    if step < 6:
        return []
    number = np.concatenate([[0], np.cumsum(np.maximum(np.round(gaps / step), 0))])
    apart = np.append(True, np.diff(number) > 0)
    at, number = at[apart], number[apart]
    if len(number) < FEWEST:
        return []
    mean, spread = number.mean(), max(float(np.ptp(number)), 1.0)
    terms = np.vander((number - mean) / spread, 3)
    for _ in range(2):  # a line of the drawing may be among them
        shape_of, *_ = np.linalg.lstsq(terms, at, rcond=None)
        off = np.abs(terms @ shape_of - at).max(axis=1)
        good = off < EVEN * step
        if np.count_nonzero(good) < max(FEWEST, 0.7 * len(number)):
            return []
        terms, at = terms[good], at[good]
    first, last = -int(height / step) - 1, int(number[-1] + height / step) + 1
    whole = np.vander((np.arange(first, last + 1) - mean) / spread, 3) @ shape_of
    inside = (whole.max(axis=1) > 0) & (whole.min(axis=1) < height)
    return [np.polyfit(x, y, 2) for y in whole[inside]]


def _refined(line: Line, mask: Image, edge: Image, thick: float, least: float) -> Line | None:
    """Where exactly a line of the family runs; None where there is not so much ink along it, a share of its
    length on the sheet."""
    height, width = mask.shape
    x = np.arange(width, dtype=np.int32)
    for around in (10, 5, NEAREST):
        reach = round(thick) + around
        middle = np.round(np.polyval(line, x)).astype(np.int32)
        inside = (middle >= reach) & (middle < height - reach)
        inside[inside] = edge[middle[inside], x[inside]] == 0
        if not inside.any():
            return None
        middle, seen = middle[inside], x[inside]
        count, below = columns(mask, seen, middle, reach)
        alone = (count > 0) & (count <= thick + 1.5)
        if np.count_nonzero(alone) < least * len(count):
            if around > NEAREST:
                continue  # what is drawn along it at a slant is no nearer than this for so long
            return None
        y, seen = middle[alone] + below[alone] / count[alone], seen[alone]
        # a line that is seen in part is not bent: it would go astray beyond
        bends = 3 if np.ptp(seen) > WHOLE * width else 1
        line = np.asarray(np.polyadd(line, _fitted(seen, y - np.polyval(line, seen), bends)))
    return line


def _fitted(x: NDArray[Any], y: NDArray[Any], degree: int) -> Line:
    """The polynomial that comes nearest to some points, as polyfit gives it: by the normal equations, which are well
    conditioned for so low a degree and much faster."""
    size = max(float(x.max(initial=1)), 1.0)
    powers = np.vander(x / size, degree + 1)
    found, *_ = np.linalg.lstsq(powers.T @ powers, powers.T @ y)
    return np.asarray(found / size ** np.arange(degree, -1, -1))


@dataclass(frozen=True, eq=False)
class _Belt:
    """The pixels along a printed line, column by column.

    Attributes:
        x, rows: [pixels] of the columns, shape (n,), and the rows within the line's reach, shape (k, n).
        ink: 1 where they are ink, shape (k, n).
        dark: the darkest ink of each column, 0 without any.
        crossed: where ink leads beyond the line's reach.
    """

    x: NDArray[np.intp]
    rows: NDArray[np.intp]
    ink: Image
    dark: NDArray[Any]
    crossed: NDArray[np.bool_]

    @property
    def alone(self) -> NDArray[np.bool_]:
        return ~self.crossed & (self.dark > 0)


def _belt(line: Line, mask: Image, darkness: Image, thick: float) -> _Belt:
    height, width = mask.shape
    beyond = int(np.ceil(0.5 * thick + 1)) + 1
    x = np.arange(width)
    middle = np.round(np.polyval(line, x)).astype(int)
    inside = (middle >= beyond) & (middle < height - beyond)
    x, rows = x[inside], middle[inside] + np.arange(-beyond, beyond + 1)[:, None]
    ink = mask[rows, x]
    dark = (ink * darkness[rows, x]).max(axis=0, initial=0)
    return _Belt(x, rows, ink, dark, (ink[0] | ink[-1]) > 0)
