"""What is printed or written on the sheet beside a drawing: rows of small pieces that differ, close to one another, on
a straight line, and the straight rules among them.

A worksheet's problem has more ink than the drawing below it, and darker ink: pen and paper would be taken from the
print, and a line of print that blurs together, or one to write on, for a rod.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import together
from sketch.scan.quantiles import median
from sketch.typing import Image

__all__ = ["without_print"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]

TALL = 0.045  # of the picture's size: nobody prints larger beside a drawing
LEAST = 4  # [pixels]: what is less high says nothing
FEWEST = 5  # pieces in a row of print: letters, or words that melt together
LONG = 8.0  # times as long as high: a row is longer
NEXT = 1.8  # of a letter's height: the next is no farther, beyond a space,
BESIDE = 0.5  # likewise, and not as far up or down,
ALIKE = 2.5  # times as high, at most
STRAIGHT = 0.3  # of the height of letters: how far they are off a straight line
DIFFER = (
    0.2  # standard deviation of letters' widths and of the lines across them, over the mean: balls are alike
)
SURE = (
    10  # pieces in a row that tells by itself that there is print: what grain leaves of a line is fewer, or
)
CURVED = 1.35  # lines from top to bottom of its letters, on the mean: those bits have little more than one
STACKED = 3  # rows above one another that are print together, though they are blurred
WOVEN = 0.6  # lines across, for each length that is as long as high: letters have more, a plank less
BAND = 1.0  # heights of its letters, above and below the middle of a row: what is small there is print, too,
BEYOND = 3.0  # likewise, before it and behind it: a dash, a stop
NEAR = 4.0  # likewise: short rows that are nearer to others are print, too
FEW = 2  # pieces in such a row
RULED = 6.0  # likewise: straight lines along rows that are nearer to print are printed
RULE = 4.0  # likewise, how long they are at least
PARALLEL = 0.02  # of a line's length: how much more or less it rises than rows do
THIN = 0.4  # of the height of letters: no rule is thicker
EVEN = 0.4  # [pixels]: how far a printed line is off a straight one


def without_print(
    mask: Image,
    darkness: Image,
    pixels: NDArray[np.int32],
    extent: NDArray[np.int32],
    area: NDArray[Any],
    reach: int,
) -> tuple[Image, int]:
    """The darkness of a page without rows of print, and how many those are.

    mask: its ink.  pixels: indices into it, piece after piece.  extent, area: of each piece, how many rows and columns
    it goes, shape (n, 2), and pixels it has.  reach: how far around ink darkness may be its own [pixels].
    """
    import cv2

    tall, ink = TALL * mask.size**0.5, None
    found: list[NDArray[np.int32]] = []
    for upright in (False, True):  # a sheet may lie on its side
        high = extent[:, int(upright)]
        letters = (high >= LEAST) & (high < tall)
        if np.count_nonzero(letters) < FEWEST:
            continue
        ink = np.split(pixels, np.cumsum(area)[:-1]) if ink is None else ink
        # letters of one line and the next stand in rows by chance, which are short
        found = max(found, _printed(mask, ink, letters, upright), key=lambda rows: sum(map(len, rows)))
    if not found:
        return darkness, 0
    print_ = np.zeros_like(mask)
    print_.ravel()[np.concatenate(found)] = 1
    near = np.ones((2 * reach + 1,) * 2, np.uint8)
    beside = cv2.dilate(print_, near) > cv2.dilate(mask & (1 - print_), near)
    return np.where(beside | (print_ > 0), np.uint8(0), darkness), len(found)


@dataclass(frozen=True)
class _Row:
    """A row of print, or a rule: from one x to another, y = y0 + slope (x - start) its middle, and so high letters."""

    start: float
    end: float
    y0: float
    slope: float
    high: float

    @property
    def is_long(self) -> bool:
        return self.end - self.start > LONG * self.high

    def off(self, x: Any, y: Any) -> Any:
        """How far places are above or below the row's middle [heights]."""
        return abs(self.y0 + self.slope * (x - self.start) - y) / self.high

    def is_beside(self, other: _Row, near: float) -> bool:
        """Whether it is so near to another, as many heights of letters, along it, and alike."""
        x = (self.start + self.end) / 2
        y = self.y0 + self.slope * (x - self.start)
        if other.off(x, y) > near or not other.high < ALIKE * self.high < ALIKE**2 * other.high:
            return False
        if self.is_long and other.is_long and abs(self.slope - other.slope) > PARALLEL:
            return False
        return min(self.end, other.end) > max(self.start, other.start) - 2 * near * other.high

    def is_like(self, rule: _Row) -> bool:
        """Of a rule, whether it has the same margins as another, as lines to write on."""
        ends = abs(rule.start - self.start), abs(rule.end - self.end)
        return max(ends) < rule.high and self.is_beside(rule, RULED)


def _printed(
    mask: Image, ink: list[NDArray[np.int32]], some: NDArray[np.bool_], upright: bool
) -> list[NDArray[np.int32]]:
    """Of the level rows of print, or of the upright ones, the pixels.

    ink: of each piece, as indices into the mask.  some: which of them are as high as letters.
    """
    box = _boxes(mask, ink, upright)
    wide, high = (box[:, 2:] - box[:, :2]).T
    beside, above = (mask.shape[1], 1) if upright else (1, mask.shape[1])
    across, down = np.zeros(len(ink)), np.zeros(len(ink))
    for k in np.flatnonzero(some).tolist():
        across[k], down[k] = (np.count_nonzero(mask.ravel()[ink[k] - step] == 0) for step in (beside, above))
    letters = np.flatnonzero(across > WOVEN * wide)
    words = _chains(box, letters)
    rows = _certain(box, words, across / high, down / wide)
    if not rows:
        return []
    typical = median(np.array([row.high for row in rows]))
    thin = np.flatnonzero((wide > RULE * typical) & ~np.isin(np.arange(len(ink)), letters))
    rules = [row for k in thin if (row := _rule(mask, ink[k], box[k], typical, upright))]
    short = [row for own in words if (row := _row(box[own], FEW, 1.0))]
    return _within(box, ink, _with_those_beside(rows, short, rules))


def _certain(box: Array, words: list[Index], across: Array, down: Array) -> list[_Row]:
    """The rows that are print for themselves.

    words: pieces beside one another.  across, down: how many lines lead across each, and from top to bottom, on the
    mean.
    """
    likely = [
        (row, len(own), np.mean(down[own]) > CURVED)
        for own in words
        if (row := _row(box[own], FEWEST, LONG))
        and math.hypot(_spread(box[own, 2] - box[own, 0]), _spread(across[own])) > DIFFER
    ]
    stacked = [
        row for row, *_ in likely if sum(row.is_beside(other, NEAR) for other, *_ in likely) >= STACKED
    ]
    if not stacked and not any(is_curved and count >= SURE for _, count, is_curved in likely):
        return []
    return [row for row, _, is_curved in likely if is_curved or row in stacked]


def _with_those_beside(rows: list[_Row], short: list[_Row], rules: list[_Row]) -> list[_Row]:
    """Rows of print with short ones and rules near them, those near these, and so on."""
    rows = rows + [rule for rule in rules if any(rule.is_like(other) for other in rules if other is not rule)]
    rest = [(row, near) for some, near in ((short, NEAR), (rules, RULED)) for row in some if row not in rows]
    fresh = rows
    while fresh:
        fresh = [row for row, near in rest if any(row.is_beside(other, near) for other in fresh)]
        rest = [(row, near) for row, near in rest if row not in fresh]
        rows = rows + fresh
    return rows


def _spread(values: Array) -> float:
    return float(np.std(values) / np.mean(values))


def _boxes(mask: Image, ink: list[NDArray[np.int32]], upright: bool) -> Array:
    """From left to right and top to bottom of each piece [pixels], shape (n, 4): x0, y0, x1, y1.

    upright: x and y change places.
    """
    start = np.cumsum([0, *map(len, ink)])[:-1]
    y, x = np.divmod(np.concatenate(ink), mask.shape[1])
    at = (y, x) if upright else (x, y)
    ends = [np.minimum.reduceat(v, start) for v in at] + [np.maximum.reduceat(v, start) + 1 for v in at]
    return np.stack(ends, axis=1).astype(np.float64)


def _chains(box: Array, letters: Index) -> list[Index]:
    """Letters that stand beside one another, from left to right."""
    letters = letters[np.argsort(box[letters, 0], kind="stable")]
    if not len(letters):
        return []
    x0, y0, x1, y1 = box[letters].T
    high, y = y1 - y0, (y0 + y1) / 2
    # of each, those that begin where the next may: as pairs
    first, last = np.arange(len(letters)) + 1, np.searchsorted(x0, x1 + ALIKE * NEXT * high, side="right")
    count = np.maximum(last - first, 0)
    a = np.repeat(np.arange(len(letters)), count)
    b = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + a + 1
    large, little = np.maximum(high[a], high[b]), np.minimum(high[a], high[b])
    beside = (x0[b] - x1[a] < NEXT * large) & (abs(y[a] - y[b]) < BESIDE * large) & (large < ALIKE * little)
    pairs = np.stack([a[beside], b[beside]], axis=1)
    numbers = np.array(together([[k] for k in range(len(letters))] + pairs.tolist())[: len(letters)])
    order = np.argsort(numbers, kind="stable")
    return [letters[own] for own in np.split(order, np.flatnonzero(np.diff(numbers[order])) + 1)]


def _row(box: Array, fewest: int, long: float) -> _Row | None:
    """The row that some pieces from left to right are, if they are so many on a straight line so long."""
    high, start, end = median(box[:, 3] - box[:, 1]), float(box[0, 0]), float(box[:, 2].max())
    if len(box) < fewest or end - start < long * high:
        return None
    x, y = ((box[:, :2] + box[:, 2:]) / 2).T
    slope, y0 = np.polyfit(x - start, y, 1) if end - start > LONG * high else (0.0, y.mean())
    row = _Row(start, end, float(y0), float(slope), high)
    return row if np.sqrt(np.mean(row.off(x, y) ** 2)) < STRAIGHT else None


def _rule(mask: Image, ink: NDArray[np.int32], box: Array, high: float, upright: bool) -> _Row | None:
    """The rule that a piece is, as print is whose letters are so high."""
    start, end = float(box[0]), float(box[2])
    if len(ink) > THIN * high * (end - start):
        return None
    y, x = np.divmod(ink, mask.shape[1])
    x, y = (y, x) if upright else (x, y)
    count = np.bincount(x - round(start))
    middle = np.bincount(x - round(start), y) / np.maximum(count, 1)
    along = np.flatnonzero(count)
    slope, y0 = np.polyfit(along, middle[along], 1)
    if np.std(middle[along] - slope * along - y0) > EVEN:
        return None
    return _Row(start, end, float(y0), float(slope), high)


def _within(box: Array, ink: list[NDArray[np.int32]], rows: list[_Row]) -> list[NDArray[np.int32]]:
    """The pixels of all that is in some rows and no higher than those."""
    found, x, y = [], *((box[:, :2] + box[:, 2:]) / 2).T
    wide, high = (box[:, 2:] - box[:, :2]).T
    for row in rows:
        beyond = BEYOND * row.high
        there = (box[:, 0] > row.start - beyond) & (box[:, 2] < row.end + beyond)
        there &= (row.off(x, y) < BAND) & (high - abs(row.slope) * wide < 2 * BAND * row.high)
        found.append(np.concatenate([ink[k] for k in np.flatnonzero(there)]))
    return found
