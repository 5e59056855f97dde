"""Where a sheet ends: ink on its last few pixels, which is told from the table by the bare paper between.

What is dark from the table on is the table, its shadow, or a line that was drawn along the edge: nobody can tell.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.typing import Image

__all__ = ["drop_at_edges", "drop_table", "lit_from_within", "table_around"]

REACH = 8  # [pixels] of the reduced picture, around what is certainly on the sheet: there the sheet ends
GONE = 128  # of 255: marks what is erased
THIN = 0.3  # of its length: a line is thinner, and what holds the sheet is not
FINE = 10  # [pixels] that the shortest line has, where it is looked for
SPREAD = 2  # likewise, from what is dark at the picture's edge: there light is less than it is on paper


def lit_from_within(light: Image, paper: Image | None, margin: int) -> tuple[Image, Image]:
    """The light on a sheet, going on beyond its edges as it is within, and 255 on what is certainly the sheet.

    light: reduced; what is dark near an edge may darken it.  paper: 255 on the sheet, or None where it fills the
    picture.  margin: along the picture's edges where a sheet may end [pixels].
    """
    import cv2

    inside, by = np.zeros_like(light), min(margin + SPREAD, (min(light.shape) - 1) // 2)
    within = (slice(margin, -margin),) * 2
    inside[within] = 255 if paper is None else paper[within]

    def across(some: Image) -> Image:  # the picture's edges, where a shadow leads beyond them
        far = some[by : some.shape[0] - by, by : some.shape[1] - by]
        return np.asarray(cv2.copyMakeBorder(far, by, by, by, by, cv2.BORDER_REPLICATE))

    light = across(light)
    if paper is not None:
        lit = across(paper)
        light = np.where(lit > 0, light, _grown(np.asarray(cv2.min(light, lit)), REACH + SPREAD))
    return light, inside


def table_around(small: Image, light: Image, inside: Image, floor: float) -> tuple[Image, Image]:
    """255 on what is certainly off the sheet, and on what is about its edge.

    Where what is beyond is as bright as the sheet all that is about the edge counts as off: a shadow there would
    pass for a line.  small: the picture, reduced.  light, inside: as of `lit_from_within`.  floor: what is darker is
    no paper.
    """
    import cv2

    sheet = _grown(inside, REACH)
    rim = _grown(inside, REACH + 1) > sheet
    bright = rim & (255.0 * small >= (255.0 - floor) * _grown(light, 1))
    about = cv2.min(sheet, 255 - inside)
    return cv2.max(255 - sheet, cv2.min(_grown(bright * np.uint8(255), 2 * REACH + 1), about)), about


def drop_table(
    darkness: Image, beside: Image, table: Image, about: Image, rim: int, floor: float, long: float
) -> float:
    """Erase the table, and what is dark from there or from the picture's edges on, in place.

    table, about: as of `table_around`.  beside: darkness, about the edge as beside what is darker, sheet or table.
    rim, floor, long, and what it returns: as of `drop_at_edges`.
    """
    import cv2

    np.minimum(darkness, 255 - table, out=darkness)
    along = drop_at_edges(darkness.copy(), rim, floor, long)
    dark = np.asarray(cv2.max(table, cv2.min(_darker(darkness, floor), about)), np.uint8)
    whole = cv2.copyMakeBorder(dark, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=(255,))
    cv2.floodFill(whole, None, (0, 0), (GONE,), flags=8)
    gone = np.equal(whole[1:-1, 1:-1], GONE).view(np.uint8) * np.uint8(255)
    np.minimum(darkness, 255 - gone, out=darkness)
    return max(along, _darkest_line(np.asarray(cv2.min(cv2.min(beside, about), gone), np.uint8), floor, long))


def _darkest_line(darkness: Image, floor: float, long: float) -> float:
    """How dark the darkest piece is that is a line so long [pixels]; 0 without any."""
    import cv2

    step = max(int(long / FINE), 1)  # the darkest of some pixels says enough
    some = cv2.dilate(darkness, np.ones((step, step), np.uint8))[::step, ::step]
    # a dark table's own noise is as dark as faint ink
    half = max(floor, float(some.max(initial=0)) / 2)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(_darker(np.ascontiguousarray(some), half))
    span = np.hypot(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT])
    area = np.maximum(stats[:, cv2.CC_STAT_AREA], 1)
    lines = (span >= long / step) & (area < THIN * span * span)
    lines[0] = False
    if not lines.any():
        return 0.0
    return float((np.bincount(labels.ravel(), some.ravel(), count) / area)[lines].max())


def _grown(image: Image, by: int) -> Image:
    import cv2

    return np.asarray(cv2.dilate(image, np.ones((2 * by + 1,) * 2, np.uint8)))


def _darker(image: Image, floor: float) -> Image:
    import cv2

    return np.asarray(cv2.threshold(image, floor, 255, cv2.THRESH_BINARY)[1])


def drop_at_edges(darkness: Image, rim: int, floor: float, long: float) -> float:
    """Erase what is dark from the picture's edges on, as far as `rim` pixels, in place: a table may be seen there.

    floor: what is darker is seen as ink.  Returns how dark the darkest of what was erased is that runs along an edge
    for `long` pixels; 0 without any.
    """
    strips = darkness[:rim], darkness[: -rim - 1 : -1], darkness.T[:rim], darkness.T[: -rim - 1 : -1]
    return max((_drop_from_first_row(strip, floor, long) for strip in strips if strip.size), default=0.0)


def _drop_from_first_row(strip: NDArray[Any], floor: float, long: float) -> float:
    """As in drop_at_edges, along one edge."""
    import cv2

    if strip[0].max() <= floor:
        return 0.0
    count, labels = cv2.connectedComponents(np.asarray(strip > floor, np.uint8))
    beyond = np.zeros(count, bool)
    beyond[labels[0]] = True
    beyond[0] = False
    gone = np.flatnonzero(beyond[labels].ravel())
    y, x = np.divmod(gone, strip.shape[1])
    left_out = strip[y, x]
    strip[y, x] = 0
    if len(gone) < long:
        return 0.0
    only = np.zeros(strip.shape, np.uint8)
    only[y, x] = left_out
    return _darkest_line(only, floor, long)
