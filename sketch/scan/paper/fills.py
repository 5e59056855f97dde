"""Ink that is more than lines, and paper within lines: what is filled or hatched, and the grain's pinholes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import distances
from sketch.typing import Image

__all__ = ["FILL", "fill_grain", "fill_hatching", "holes", "hollow_fills"]

FILL = 1.3  # pen widths from the paper: no line is as wide, nor two that cross
BLOT = 2.0  # squares of the pen width inside its rim: larger ink is filled, whatever leads there
AWAY = 1.5  # pen widths from there: the lines that lead away are told apart
GRAIN = 1.0  # squares of the pen width: larger holes are no grain
WITHIN = 1.0  # pen widths from the paper: nothing within one line, nor where two cross, is as far
AROUND = (
    0.6  # likewise, all around a hole: a line that leaves one bare has less than half its width beside it
)
PINHOLE = 0.3  # squares of the pen width: nobody draws around a smaller hole
GAP = 2.0  # pen widths: the lines of hatching are not farther apart
# of its area, the square of half the way around a gap between such lines: four times as long as wide
LONG = 6.0
FEWEST = 5  # gaps between lines of hatching, at least, in a drawing that has some
SOME = 3  # gaps between lines of hatching, at least, in one shape that has some
ALIGNED = 0.6  # how far the gaps in a hatched shape lie along each other, at least: 1 is wholly
SIGHT = 5  # [pixels] along the rim of a gap: its direction is looked at over so much
THICK = 5.0  # pen widths from side to side of what is hatched: no two lines beside each other have as much
SHARE = 0.15  # of what is hatched that is bare, at least


def holes(mask: Image) -> list[tuple[NDArray[np.int32], int]]:
    """The holes in the ink: the way around each on the ink, shape (n, 1, 2), and its area [pixels]."""
    import cv2

    ways, nesting = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    if nesting is None:
        return []
    # Pick's theorem: the area of the polygon is the pixels inside and half of those on it, less one
    return [
        (np.asarray(way, np.int32), round(cv2.contourArea(way) - len(way) / 2 + 1))
        for way, (_, _, _, parent) in zip(ways, nesting[0], strict=True)
        if parent >= 0
    ]


def hollow_fills(mask: Image, skeleton: Image, distance: NDArray[Any], pen: float) -> bool:
    """Leave of filled shapes, in place, the outline that a pen `pen` pixels wide would draw; whether there are any.

    skeleton: the ink's lines.  distance: each ink pixel's distance to the paper, shape (h, w).
    """
    import cv2

    if distance.max(initial=0) <= FILL * pen:
        return False
    core = (distance > FILL * pen).view(np.uint8)
    reach = 2 * round(FILL * pen) + 1
    fills = cv2.dilate(core, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach)))
    inside = ((fills > 0) & (distance > pen)).view(np.uint8)
    _, labels, boxes, _ = cv2.connectedComponentsWithStats(inside, connectivity=4)
    reach = round(AWAY * pen) + 1
    for k, (left, top, width, height, area) in enumerate(boxes.tolist()):
        if area < BLOT * pen * pen:
            rows = slice(max(top - reach, 0), top + height + reach)
            columns = slice(max(left - reach, 0), left + width + reach)
            its = labels[rows, columns] == k
            if 1 <= _leading_away(its, skeleton[rows, columns], reach) <= 2:
                inside[rows, columns][its] = 0
    mask[inside > 0] = 0
    return bool(inside.any())


def _leading_away(blot: NDArray[np.bool_], skeleton: Image, reach: int) -> int:
    """How many lines lead away from a blot, `reach` [pixels] from it: at a corner, or a line's end, the pen rested."""
    import cv2

    within, beyond = (cv2.dilate(blot.view(np.uint8), _disc(2 * far)) for far in (reach - 1, reach))
    return int(cv2.connectedComponents((beyond - within) * skeleton)[0]) - 1


def fill_grain(mask: Image, distance: NDArray[Any], pen: float) -> bool:
    """Fill the holes, in place, that the paper's grain leaves within a line; returns whether there were any.

    A hole between lines has a line's width of ink around it, however small it is.  distance: each ink pixel's distance
    to the paper, shape (h, w), likewise.
    """
    import cv2

    small = [(way, area) for way, area in holes(mask) if area < GRAIN * pen * pen]
    if not small:
        return False
    cv2.drawContours(mask, [way for way, _ in small], -1, 1, cv2.FILLED)
    distances(mask, distance)
    rims = [distance[way[:, 0, 1], way[:, 0, 0]] for way, _ in small]
    within = [
        area < PINHOLE * pen * pen or (rim.max() < WITHIN * pen and rim.min() < AROUND * pen)
        for (_, area), rim in zip(small, rims, strict=True)
    ]
    between = [way for (way, _), grain in zip(small, within, strict=True) if not grain]
    for way in between:
        cv2.drawContours(mask, [way], -1, 0, cv2.FILLED)
        cv2.drawContours(distance, [way], -1, 0, cv2.FILLED)
        mask[way[:, 0, 1], way[:, 0, 0]] = 1
    if between:
        distances(mask, distance)
    return any(within)


def fill_hatching(mask: Image, pen: float) -> bool:
    """Fill what is hatched, in place; whether there is any.  pen: its width [pixels].

    As lines, hatching would be hundreds of crossings with what it fills.
    """
    import cv2

    gaps = [way[:, 0] for way, area in holes(mask) if area > PINHOLE * pen * pen and _is_gap(way, area, pen)]
    if len(gaps) < FEWEST:
        return False
    rim = round(2 * GAP * pen)
    ink = cv2.copyMakeBorder(mask, rim, rim, rim, rim, cv2.BORDER_CONSTANT, value=(0,))
    solid = cv2.morphologyEx(ink, cv2.MORPH_CLOSE, _disc(GAP * pen))
    thick = cv2.morphologyEx(solid, cv2.MORPH_OPEN, np.ones((round(THICK * pen),) * 2, np.uint8))
    count, labels = cv2.connectedComponents(thick)
    whole = np.bincount(labels.ravel(), minlength=count)
    bare = np.bincount(labels[(thick > 0) & (ink == 0)], minlength=count)
    hatched = bare > SHARE * whole
    for k in np.flatnonzero(hatched):
        there = [
            way
            for way in gaps
            if 2 * np.count_nonzero(labels[way[:, 1] + rim, way[:, 0] + rim] == k) > len(way)
        ]
        hatched[k] = k > 0 and len(there) >= SOME and _alignment(there) > ALIGNED
    if not hatched.any():
        return False
    # the corners that no square of that size fits into, too
    near = cv2.dilate(hatched[labels].astype(np.uint8), _disc(2 * GAP * pen))
    mask |= np.asarray(cv2.min(solid, near), np.uint8)[rim:-rim, rim:-rim]
    return True


def _is_gap(way: NDArray[np.int32], area: int, pen: float) -> bool:
    """Whether a hole is as narrow as between the lines of hatching, and long."""
    half = len(way) / 2  # the way around is as long as the hole and as wide, twice
    return area < GAP * pen * half and half * half > LONG * area


def _alignment(ways: list[NDArray[np.int32]]) -> float:
    """1 where all ways around holes run one direction, and 0 where they run all directions alike."""
    steps = np.concatenate([np.roll(way, -SIGHT, axis=0) - way for way in ways]).astype(np.float64)
    x, y = steps.T
    return float(np.hypot((x * x - y * y).sum(), (2 * x * y).sum()) / (x * x + y * y).sum())


def _disc(width: float) -> Image:
    import cv2

    side = 2 * round(width / 2) + 1
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)), np.uint8)
