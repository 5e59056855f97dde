"""Where the sheet of paper is on a picture, and the table, fingers and other sheets are not.

All of it on a picture that is reduced to some hundred thousand pixels.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.quantiles import median, percentile
from sketch.typing import Image

__all__ = ["TABLE", "closed", "darkest_channel", "find_sheet"]

TABLE = 0.5  # what is not as bright as this share of the paper is not paper
FEWER = 3  # of these a side one is enough for a mean or a median
SPARSE = 8  # likewise, to tell a colour that most have
COARSER = 5  # of these a side make one where light is smoothed
FINGER = 0.015  # of the picture's size, to either side: what lies on the paper and is no wider is left out
TINGE = 0.75  # of the paper's whiteness: what is more coloured is not paper in a shadow
EDGES = 9  # [pixels]: edges of shadows are narrower
INKED = 99.5  # percent of a sheet that is certainly not ink
HALF = 0.5  # of the ink's contrast: what has more is a line
LINE = 0.2  # of the light: what takes less away is no line
ACROSS = 3  # [pixels]: a line that runs so far to either side of an edge crosses it
DRAWN = 0.05  # of the picture's size: marks that are as large were drawn,
SEVERAL = 2  # where there are as many
NOTABLE = 0.03  # of the picture: smaller regions are no part of the sheet that matters
STEP = 0.04  # of the light: how much of it changes at the edge of a sheet, at least
ROUGH = 4.0  # times what changes everywhere: likewise
LEAST_SHEET = 0.1  # of the picture, that holds what is to be seen
BULKY = 0.85  # of its convex hull that a sheet covers, though fingers hold it
FOUR_SIDED = 0.95  # of its convex hull, and of the quadrilateral around it, that a sheet covers
FOUR = 0.02  # of its convex hull's way around: how far a sheet's outline is off a quadrilateral
SIDES = 3  # of a sheet that are seen, to tell it from a part of a sheet in a shadow
BEYOND = 4  # [pixels] from its edge that a table's light is taken
NEARLY_ALL = 0.9  # of its edge: where a sheet that stands out is brighter than what is beside it
SPREAD = 0.12  # of the picture's size: standard deviation of what light is continued by
SAME = 4  # of 255: a canvas's colours differ by no more from the commonest
INKY = 0.3  # of the most that any colour differs from a canvas's: those of ink differ by more
TOOLS = 0.03  # of a picture that an app's tools take at least
WHOLLY = 0.985  # of its bounding rectangle that a canvas fills
REGIONS = 6  # that may be the sheet, the largest
PARTS = 4  # of these regions, at most, that together are the sheet


def find_sheet(colours: Image) -> tuple[Image | None, NDArray[Any]]:
    """255 on the sheet and 0 off it, or None where the sheet fills the picture; and the light on the sheet.

    Light changes across a sheet, but not at once: a sheet ends where brightness falls below TABLE within
    a few pixels, or whiteness below TINGE.  Of the regions that such edges part, the one with the most light
    is the sheet; the light on it, continued beyond, then tells softer edges too, and its whiteness tells skin
    and wood from shadows.
    """
    import cv2

    bright = closed(darkest_channel(colours), FINGER)
    pale = 255 - darkest_channel(255 - colours)
    whiteness = bright / np.maximum(closed(pale, FINGER), 1).astype(np.float32)
    framed = _framed(colours)
    if framed is not None:
        sheet, *parts = framed
        white = whiteness >= TINGE * median(whiteness[sheet])
        around = _continued(bright, sheet.astype(np.float32))
        for part in parts:
            around = _shaded(around, bright, part.astype(np.uint8))
        return _whole(sheet & white), around
    square = np.ones((5, 5), np.uint8)
    lit = cv2.erode(bright, square) >= TABLE * cv2.dilate(bright, square)
    white = cv2.erode(whiteness, square) >= TINGE * cv2.dilate(whiteness, square)
    inner = (lit & white).astype(np.uint8)
    if inner.all():
        return None, bright
    weight = _brightest_region(inner, bright).astype(np.float32)
    around = _continued(bright, weight)
    for shade in _shadows(inner, weight > 0, bright, darkest_channel(colours), whiteness):
        around = _shaded(around, bright, shade)
        near = cv2.dilate(shade, np.ones((EDGES, EDGES), np.uint8)) > 0
        inner[near & (cv2.dilate(weight, np.ones((EDGES, EDGES), np.uint8)) > 0)] = 1
    lit = bright >= TABLE * around
    white = whiteness >= TINGE * median(whiteness[::FEWER, ::FEWER][weight[::FEWER, ::FEWER] > 0])
    sheet = _brightest_region(inner & lit & white, bright)
    # up to its edge, where light changes for the table alone
    return _whole((cv2.dilate(sheet.astype(np.uint8), square) > 0) & lit & white), around


def _whole(sheet: NDArray[np.bool_]) -> Image:
    """255 on the sheet and what it surrounds, which lies on it: a filled shape, a coin, a blot."""
    import cv2

    beyond = np.pad(_outside(sheet).astype(np.uint8), 1, constant_values=1)
    return np.asarray(255 * (1 - cv2.dilate(beyond, np.ones((5, 5), np.uint8))[1:-1, 1:-1]), np.uint8)


def _shaded(around: NDArray[Any], bright: Image, shade: Image) -> NDArray[Any]:
    """The light around, but in a shadow and near it no more than the shadow's own."""
    import cv2

    near = cv2.dilate(shade, np.ones((EDGES, EDGES), np.uint8)) > 0
    return np.asarray(
        np.where(near, np.minimum(around, _continued(bright, shade.astype(np.float32))), around)
    )


def _framed(colours: Image) -> list[NDArray[np.bool_]] | None:
    """A sheet that lies whole on something else as bright: four-sided, brighter than around it, crossed by no ink.

    Its edges may be faint.  On what no camera saw, whose colours are flat, one edge is enough: that of an app's tools.
    Where edges part the sheet itself, as those of shadows do, the whole is four-sided, too, and is given before its
    parts.
    """
    import cv2

    height, width = colours.shape[:2]
    if min(height, width) < 8 * EDGES:
        return None
    canvas = _canvas(colours)
    if canvas is not None:
        return [canvas]
    half = cv2.resize(colours, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
    light = closed(cv2.cvtColor(half, cv2.COLOR_BGR2GRAY), FINGER)
    edges, sides = _edges(light)
    count, labels, stats, _ = cv2.connectedComponentsWithStats((~edges).astype(np.uint8), connectivity=4)
    area = stats[1:, cv2.CC_STAT_AREA]
    if count < 3 or area.max() > (1 - LEAST_SHEET / 2) * light.size:
        return None
    large = [k + 1 for k in np.argsort(-area)[:REGIONS].tolist() if area[k] > NOTABLE * light.size]
    several = [some for n in range(1, PARTS + 1) for some in combinations(large, n)]
    for some in sorted(several, key=lambda some: -sum(area[k - 1] for k in some)):
        way = _around(labels, some)
        if cv2.contourArea(way) < LEAST_SHEET * light.size or not _is_bulky(way, light.shape, sides):
            continue
        sheet = cv2.drawContours(np.zeros_like(light), [way], -1, 1, cv2.FILLED)
        if not _stands_out(sheet, light):
            continue
        if not _is_four_sided(way):
            return None  # it is more than a sheet, or fingers hold it: then a part of it proves nothing
        whole = cv2.resize(sheet, (width, height), interpolation=cv2.INTER_NEAREST)
        if _is_crossed(whole, colours):
            return None
        parts = [(labels == k).astype(np.uint8) for k in _shades(labels, some, cv2.contourArea(way))]
        parts = [cv2.resize(part, (width, height), interpolation=cv2.INTER_NEAREST) for part in parts]
        return [part > 0 for part in (whole, *parts)]
    return None


def _edges(light: Image) -> tuple[NDArray[np.bool_], int]:
    """Where light changes as at the edge of a sheet, and how many sides of a sheet are to be seen."""
    import cv2

    square = np.ones((5, 5), np.uint8)
    step = 1 - cv2.erode(light, square) / np.maximum(cv2.dilate(light, square), 1).astype(np.float32)
    rough = median(step[::FEWER, ::FEWER])
    return step > max(STEP, ROUGH * rough), SIDES if rough else 1


def _shades(labels: NDArray[Any], some: tuple[int, ...], area: float) -> list[int]:
    """Of the regions that make a sheet those that may be a shadow on it: the others do not surround them, as they do
    what is filled. area: of the sheet [pixels]."""
    import cv2

    rests = [(k, tuple(other for other in some if other != k)) for k in some]
    return [k for k, rest in rests if rest and cv2.contourArea(_around(labels, rest)) < (1 - NOTABLE) * area]


def _canvas(colours: Image) -> NDArray[np.bool_] | None:
    """The canvas of an app: a rectangle of one flat colour among tools of other colours, or behind thin pale lines.

    Ink on it differs clearly from the canvas, and tools hardly do.
    """
    import cv2

    some = colours[::SPARSE, ::SPARSE]
    canvas = np.array([median(some[..., channel]) for channel in range(3)]).astype(np.uint8)
    if 2 * np.count_nonzero((some == canvas).all(axis=2)) < some.shape[0] * some.shape[1]:
        return None  # a colour that most pixels have is the median of each channel
    off = cv2.absdiff(colours, np.broadcast_to(canvas, colours.shape)).max(axis=2)
    bare = off <= SAME
    inked = cv2.dilate((off > INKY * off.max()).astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    if bare.all() or off.max() <= SAME:
        return None
    count, labels, stats, _ = cv2.connectedComponentsWithStats(
        (bare | inked).astype(np.uint8), connectivity=4
    )
    largest = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    _, _, wide, high, _ = stats[largest].tolist()
    region = ~_outside(labels == largest)
    if count < 3 or wide * high > (1 - TOOLS) * bare.size or 2 * wide * high < bare.size:
        return None
    return region if np.count_nonzero(region) > WHOLLY * wide * high else None


def _around(labels: NDArray[Any], regions: tuple[int, ...]) -> NDArray[Any]:
    """The outline of several regions, across the edges that part them."""
    import cv2

    square = np.ones((5, 5), np.uint8)
    region = cv2.dilate(np.isin(labels, regions).astype(np.uint8), square)
    if len(regions) > 1:
        region = cv2.morphologyEx(region, cv2.MORPH_CLOSE, square)
    return max(cv2.findContours(region, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[0], key=cv2.contourArea)


def _is_bulky(way: NDArray[Any], shape: tuple[int, ...], sides: int) -> bool:
    """Whether an outline is nearly convex, and so many of its sides may be within the picture."""
    import cv2

    x, y, wide, high = cv2.boundingRect(way)
    beyond = (x, y, shape[1] - x - wide, shape[0] - y - high)
    inside = sum(margin > BEYOND for margin in beyond)
    return inside >= sides and cv2.contourArea(way) > BULKY * cv2.contourArea(cv2.convexHull(way))


def _is_four_sided(way: NDArray[Any]) -> bool:
    """Whether an outline is about a convex quadrilateral."""
    import cv2

    hull = cv2.convexHull(way)
    area = cv2.contourArea(hull)
    corners = cv2.approxPolyDP(hull, FOUR * cv2.arcLength(hull, True), True)
    return (
        cv2.contourArea(way) > FOUR_SIDED * area
        and len(corners) == 4
        and abs(cv2.contourArea(corners) - area) < (1 - FOUR_SIDED) * area
    )


def _stands_out(sheet: Image, light: Image) -> bool:
    """Whether a sheet is brighter than what is around it, nearly everywhere."""
    import cv2

    inner = cv2.erode(light, np.ones((3, 3), np.uint8))
    near, far = (np.ones((2 * reach + 1,) * 2, np.uint8) for reach in (BEYOND, BEYOND + 1))
    rim = cv2.dilate(sheet, far) > cv2.dilate(sheet, near)
    # the brightest within reach is the sheet's light
    within = cv2.dilate(inner * sheet, np.ones((4 * BEYOND + 1,) * 2, np.uint8))
    darker = light[rim] < (1 - STEP / 2) * within[rim]
    return bool(darker.size and darker.mean() > NEARLY_ALL)


def _is_crossed(sheet: Image, colours: Image) -> bool:
    """Whether lines lead from a sheet to what is around it: nobody draws on to the table."""
    import cv2

    small = darkest_channel(colours)
    dark = _inked(small, closed(small, FINGER), sheet > 0)
    _, lines = cv2.connectedComponents(dark.astype(np.uint8), connectivity=8)
    reach = np.ones((2 * BEYOND + 1,) * 2, np.uint8)
    inside, outside = cv2.erode(sheet, reach) > 0, cv2.dilate(sheet, reach) == 0
    total = int(lines.max()) + 1
    both = [np.bincount(lines[part & dark], minlength=total) >= ACROSS for part in (inside, outside)]
    return bool((both[0] & both[1])[1:].any())


def _outside(sheet: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """What is off the sheet, without what it surrounds."""
    import cv2

    rest = np.pad((~sheet).astype(np.uint8), 1, constant_values=1)
    _, labels = cv2.connectedComponents(rest, connectivity=4)
    return np.asarray((labels == labels[0, 0])[1:-1, 1:-1])


def _shadows(
    inner: Image, sheet: NDArray[np.bool_], bright: Image, small: Image, whiteness: NDArray[Any]
) -> list[Image]:
    """The regions beside the sheet that are paper in a deep shadow: as white as it, and lines run into them, or several
    lie within.

    Nobody draws on the table.
    """
    import cv2

    dark = _inked(small, bright, sheet)
    _, lines, boxes, _ = cv2.connectedComponentsWithStats(dark.astype(np.uint8), connectivity=8)
    on_sheet = np.bincount(lines[sheet & dark], minlength=len(boxes)) >= ACROSS
    drawn = np.hypot(boxes[:, cv2.CC_STAT_WIDTH], boxes[:, cv2.CC_STAT_HEIGHT]) > DRAWN * inner.size**0.5
    count, regions, stats, _ = cv2.connectedComponentsWithStats(inner, connectivity=4)
    white = TINGE * median(whiteness[sheet])
    off = _outside(sheet)  # what the sheet surrounds is filled, and no shadow
    found = []
    for k in range(1, count):
        if stats[k, cv2.CC_STAT_AREA] < NOTABLE * inner.size:
            continue
        region = regions == k
        if not off[region].any() or median(whiteness[region]) < white:
            continue
        there = np.bincount(lines[region & dark], minlength=len(on_sheet)) >= ACROSS
        within = cv2.erode(region.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
        beyond = np.bincount(lines[~within & dark], minlength=len(on_sheet)) > 0
        alone = np.count_nonzero((there & drawn & ~beyond)[1:])
        if np.any(on_sheet[1:] & there[1:]) or alone >= SEVERAL:
            found.append(region.astype(np.uint8))
    return found


def _inked(small: Image, bright: Image, sheet: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """What is as dark as the lines on a sheet are at least."""
    contrast = 1 - small / np.maximum(bright, 1).astype(np.float32)
    return np.asarray(contrast > max(HALF * percentile(contrast[sheet], INKED), LINE))


def _continued(values: NDArray[Any], weight: NDArray[np.float32]) -> NDArray[Any]:
    """The values where there is weight, smoothed and continued beyond."""
    import cv2

    height, width = values.shape
    size = (max(width // COARSER, 1), max(height // COARSER, 1))
    total, known = (cv2.resize(v, size, interpolation=cv2.INTER_AREA) for v in (weight * values, weight))
    spread = SPREAD * (size[0] * size[1]) ** 0.5
    everywhere = float(total.sum()) / max(float(known.sum()), 1e-9)  # it is this far from all that has weight
    total, known = cv2.GaussianBlur(total, (0, 0), spread), cv2.GaussianBlur(known, (0, 0), spread)
    smooth = (total + 1e-3 * everywhere) / (known + 1e-3)
    return np.asarray(cv2.resize(smooth, (width, height), interpolation=cv2.INTER_LINEAR))


def _brightest_region(mask: Image, bright: Image) -> NDArray[np.bool_]:
    """The connected region of a mask that has the most light in all."""
    import cv2

    count, labels = cv2.connectedComponents(mask, connectivity=4)
    light = np.bincount(labels[::FEWER, ::FEWER].ravel(), bright[::FEWER, ::FEWER].ravel(), minlength=count)
    light[0] = -1
    return np.asarray(labels == int(np.argmax(light)))


def closed(small: Image, width: float) -> Image:
    """Without what is dark and narrower than `width`, a share of the picture's size, to either side.

    A strip at the picture's edge goes on outside for all one knows: it is no line.
    """
    import cv2

    reach = max(int(width * (small.shape[0] * small.shape[1]) ** 0.5), 2)
    wide = cv2.copyMakeBorder(small, reach, reach, reach, reach, cv2.BORDER_REPLICATE)
    closed = cv2.morphologyEx(wide, cv2.MORPH_CLOSE, np.ones((2 * reach + 1, 2 * reach + 1), np.uint8))
    return np.asarray(closed[reach:-reach, reach:-reach])


def darkest_channel(picture: Image) -> Image:
    """A pen of any colour is dark in one channel at least."""
    import cv2

    blue, green, red = cv2.split(picture)
    return np.asarray(cv2.min(cv2.min(blue, green), red))
