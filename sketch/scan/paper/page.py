"""The page: where the paper is, even light on it, and which pixels are ink."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import crests, crisp_ink, darkness, link, measure_pieces, pieces
from sketch.scan.paper.brink import drop_at_edges, drop_table, lit_from_within, table_around
from sketch.scan.paper.broken import smooth_lines
from sketch.scan.paper.framed import within_frame
from sketch.scan.paper.punched import punched
from sketch.scan.paper.ruling import FEWEST, drop_ruling
from sketch.scan.paper.table import TABLE, closed, darkest_channel, find_sheet
from sketch.scan.paper.typed import without_print
from sketch.scan.quantiles import median, percentile
from sketch.typing import Image

__all__ = [
    "Page",
    "drop_specks",
    "ink_mask",
    "read_page",
]

LIGHT_PIXELS = 120_000  # light is looked at on a picture reduced to this many
WIDEST_LINE = 0.035  # of the picture's size, to either side: what is dark and wider is no pen line
FINGER_MARK = 0.08  # likewise, the largest shadow or nail that is seen of a finger on the sheet
HUNG = 0.2  # likewise, the largest thing that hangs on a board's frame or lies on it
DARK_BOARD = 110  # of 255
COLOURED = 1.25  # times the light in its darkest channel that paper has in its brightest
MARGIN = 2  # [pixels] of the reduced picture: along the edges of the picture that are not looked at
STEEP = 0.85  # of the light beside it: what has less is beyond the edge of a shadow
PEN = 0.008  # of the picture's size, to either side: what is narrower is a pen's line, also at the edge of a shadow
DIMMEST = 24  # of 255: light below this shows nothing but noise
SOLID = 0.6  # of its box: what a disc covers at least, and no outline
HOLE = 0.012  # of the picture's size: a hole punched into the sheet has more from corner to corner of its box
NOISELESS = 1.0  # of 255: what is seen by a camera has more noise
SEEN = 1.5  # of 255: what is seen by a camera counts as so noisy at least, though it was smoothed
GRAINY = 5.0  # of 255: paper noisier than this is made smoother before its ink is looked at
USUAL = 0.6  # of the bare paper's pixels: those that are no darker than twice its noise
LEAST_CONTRAST = 16  # of 255: paper's own texture stays below
STAIN = 0.006  # of the picture's size, to either side: what is wider is a stain or filled
EDGE = 3.0  # [pixels] to either side: ink ends within
SOFT = 0.5  # of a stain's darkness: less than this changes there
SPECK = 3.5  # pen widths: what is smaller from corner to corner of its box is nothing drawn
CRISP = 0.75  # of the ink's darkness: what has more is ink, whatever is around it
FAINT = 0.3  # of the ink's darkness: what is fainter is ruling, the other side of the sheet, or dirt
CREST = 1.2  # of a line's darkness: what is next to it may be as dark
LEAST_LINK = 3.0  # [pixels]: what is shorter and leads nowhere is a bump of an edge
BESIDE = 0.6  # of a line's darkness: beside it the paper is brighter
SMUDGE = 0.5  # likewise, for small pieces: a dirty finger leaves those
RULED = 0.3  # of the picture's height or width: pieces of ruling are longer
SQUARED = 0.7  # likewise, of height and width
ACROSS = 0.85  # of the sheet's height or width: what leads from edge to edge has more, though at a slant
NOTABLE = 0.03  # of the picture's size: pieces smaller than this do not say how dark the ink is


@dataclass(frozen=True, eq=False)
class Page:
    """A page under even light.

    Attributes:
        darkness: 0 is bare paper, 255 is black, shape (h, w); 0 off the paper.
        noise: standard deviation of the bare paper's darkness.
        edge: not 0 off the sheet and near its edge, shape (h, w), or None where the sheet fills the picture.
        rim: width of the strips along the picture's edges where the table may be seen [pixels].
        beside: how dark the darkest line is that may as well be what is beyond the sheet; 0 without any.
        left_out: notes of what was erased from it.
    """

    darkness: Image
    noise: float
    edge: Image | None = None
    rim: int = 0
    beside: float = 0.0
    left_out: tuple[str, ...] = ()

    def smoothed(self, reach: int) -> Page:
        """The page, smoothed along its lines by `reach` pixels to either side."""
        dark = smooth_lines(self.darkness, self.noise, reach)
        paper = None if self.edge is None else (self.edge == 0).view(np.uint8)
        return replace(self, darkness=dark, noise=min(self.noise, max(_noise(dark, paper, 2), SEEN)))


def read_page(picture: Image) -> Page:
    """Divide the light out of a BGR picture.

    What is darker than its surroundings and narrower than WIDEST_LINE counts as drawn: a closing at low
    resolution takes that away and leaves paper and shadows, each with its own light.
    """
    import cv2

    height, width = shape = picture.shape[:2]
    reduced = max(round((width * height / LIGHT_PIXELS) ** 0.5), 1)
    colours = _reduced(picture, reduced)
    small = darkest_channel(colours)
    negative = _is_blackboard(small)
    if negative:
        colours = 255 - colours
        small = darkest_channel(colours)
    paper, around = find_sheet(colours)
    white = None if negative else _balance(colours, paper)
    if white is not None:  # a red pen is hardly darker than yellow paper where that is darkest
        picture, colours = np.asarray(cv2.LUT(picture, white)), np.asarray(cv2.LUT(colours, white))
        before, small = small, darkest_channel(colours)
        around = around * (float(small.mean()) / max(float(before.mean()), 1.0))
    light, edge = closed(small, WIDEST_LINE), None
    if paper is not None:
        # on the sheet, what is dark all over is filled: it has the light of the paper around it
        light = np.where((paper > 0) & (light < TABLE * around), around, light).astype(np.uint8)
    # where light changes at an edge its side is known to a small pixel only: taken as on the dark side
    low = cv2.erode(light, np.ones((3, 3), np.uint8))
    near = _near_shadows(light, low)
    light = cv2.blur(low, (3, 3))
    light = _less_stains(light, small, reduced)
    within, inside = lit_from_within(light, paper, MARGIN)
    if near is not None:
        fine = _fine_light(255 - picture if negative else picture)
        near = np.asarray(cv2.min(near, inside))
    rim, long = MARGIN * reduced, NOTABLE * (width * height) ** 0.5

    def less(light: Image) -> Image:
        lit = _enlarged(light, reduced, shape, cv2.INTER_LINEAR)
        if near is not None:
            edges = _enlarged(near, reduced, shape, cv2.INTER_NEAREST)
            lit = np.asarray(cv2.max(lit, cv2.min(edges, fine)))
        return darkness(picture, lit, dimmest=DIMMEST, negative=negative)

    dark = less(within)
    if paper is None:
        noise = _noise(dark, None, reduced)
        return Page(dark, noise, None, rim, drop_at_edges(dark, rim, _floor(noise), long))
    edge = cv2.dilate(255 - paper, np.ones((5, 5), np.uint8))
    edge, paper = (_enlarged(some, reduced, shape, cv2.INTER_NEAREST) for some in (edge, paper))
    noise = _noise(dark, paper, reduced)
    places = table_around(small, within, inside, _floor(noise))
    table, about = (_enlarged(some, reduced, shape, cv2.INTER_NEAREST) for some in places)
    return Page(dark, noise, edge, rim, drop_table(dark, less(light), table, about, rim, _floor(noise), long))


def _near_shadows(light: Image, low: Image) -> Image | None:
    """255 near where light changes at once, or None without any.  low: the least light around each pixel."""
    import cv2

    high = cv2.dilate(light, np.ones((3, 3), np.uint8))
    steep = (low * np.uint16(100) < high * np.uint16(100 * STEEP)).view(np.uint8)
    return np.asarray(cv2.dilate(steep * np.uint8(255), np.ones((7, 7), np.uint8))) if steep.any() else None


def _fine_light(picture: Image) -> Image:
    """The light on a BGR picture to the pixel, on which no line is seen that is narrower than any pen's."""
    import cv2

    height, width = picture.shape[:2]
    reach = 2 * round(PEN * (height * width) ** 0.5) + 1
    small = cv2.blur(darkest_channel(picture), (3, 3))
    return np.asarray(cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((reach, reach), np.uint8)))


def _balance(colours: Image, paper: Image | None) -> Image | None:
    """For each channel what its values become where paper is grey, shape (256, 1, 3); None where it nearly is.

    The channel in which the paper is darkest is left out: it shows its noise rather than ink.
    """
    some = colours[::3, ::3] if paper is None else colours[::3, ::3][paper[::3, ::3] > 0]
    colour = np.array([max(median(some[..., c]), 1.0) for c in range(3)]) if some.size else np.ones(3)
    if colour.max() < COLOURED * colour.min():
        return None
    table = np.clip(np.arange(256)[:, None, None] * (colour.max() / colour) + 0.5, 0, 255)
    table[:, :, int(colour.argmin())] = 255
    return np.asarray(table, np.uint8)


def _reduced(picture: Image, by: int) -> Image:
    """The means of squares of `by` pixels a side; what is left over at the right and below is left out."""
    import cv2

    height, width = (side // by for side in picture.shape[:2])
    if min(height, width) < 1:
        return np.asarray(cv2.resize(picture, (max(width, 1), max(height, 1)), interpolation=cv2.INTER_AREA))
    whole = picture[: height * by, : width * by]
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA))


def _enlarged(image: Image, by: int, shape: tuple[int, ...], way: int) -> Image:
    """The reverse of `_reduced`, to a picture of some shape."""
    import cv2

    height, width = shape
    whole = cv2.resize(
        image, (min(image.shape[1] * by, width), min(image.shape[0] * by, height)), interpolation=way
    )
    below, beside = height - whole.shape[0], width - whole.shape[1]
    if not below and not beside:
        return np.asarray(whole)
    return np.asarray(cv2.copyMakeBorder(whole, 0, below, 0, beside, cv2.BORDER_REPLICATE))


def _less_stains(light: Image, small: Image, reduced: int) -> Image:
    """Light without what stains and tints take of it: they are wider than a line, as fills are, but without an edge,
    or with one that is darker than they.

    reduced: pixels of the picture, each way, to a pixel of these.
    """
    import cv2

    square = np.ones((3, 3), np.uint8)
    line = 2 * max(round(STAIN * small.size**0.5), 2) + 1
    less = cv2.subtract(light, small)
    wide = cv2.morphologyEx(less, cv2.MORPH_OPEN, np.ones((line, line), np.uint8))
    dark = (wide * np.uint16(255) > LEAST_CONTRAST * light.astype(np.uint16)).view(np.uint8)
    if not dark.any():
        return light
    count, labels = cv2.connectedComponents(dark)
    near = np.ones((2 * max(round(EDGE / reduced), 1) + 1,) * 2, np.uint8)
    steps = cv2.subtract(cv2.dilate(wide, near), cv2.erode(wide, near))
    rim = (dark > cv2.erode(dark, square)).astype(np.uint8)
    level = np.zeros(count)
    np.maximum.at(level, labels[dark > 0].astype(np.intp), wide[dark > 0])
    at = labels[rim > 0]
    around = np.maximum(np.bincount(at, minlength=count), 1)
    step, edge = (np.bincount(at, of[rim > 0], count) / around for of in (steps, cv2.dilate(less, near)))
    stains = (step < SOFT * level) | (edge > (1 + SOFT) * level)
    stains[0] = False
    stain = cv2.blur(wide * cv2.dilate(stains[labels].astype(np.uint8), square), (3, 3))
    return np.asarray(cv2.subtract(light, stain))


def _is_blackboard(small: Image) -> bool:
    """Whether most of the picture is dark, and what is narrow on it is bright."""
    import cv2

    if 2 * np.count_nonzero(small > DARK_BOARD) > small.size:
        return False
    kernel = np.ones((5, 5), np.uint8)
    bright = cv2.morphologyEx(small, cv2.MORPH_TOPHAT, kernel)
    dark = cv2.morphologyEx(small, cv2.MORPH_BLACKHAT, kernel)
    return percentile(bright, 99.5) > 1.5 * percentile(dark, 99.5)


def _floor(noise: float) -> float:
    """What is darker than this is no bare paper.  noise: of that."""
    return min(max(LEAST_CONTRAST, 5 * noise), 254)


def _noise(darkness: Image, paper: Image | None, step: int) -> float:
    """From one pixel in `step`, each way: there are many."""
    import cv2

    some = np.ascontiguousarray(darkness[::step, ::step])
    mask = None if paper is None else np.ascontiguousarray(paper[::step, ::step])
    histogram = np.asarray(cv2.calcHist([some], [0], mask, [256], [0, 256])).ravel()
    # light is the brightest around, so that bare paper is darker by as much as it is uneven
    share = np.cumsum(histogram)
    return max(float(np.searchsorted(share, USUAL * share[-1])) / 2, NOISELESS)


def ink_mask(page: Page, reach: int) -> tuple[Image, Page, list[str]]:
    """The pixels that are ink, 1, shape (h, w), the page without print, and notes of what is as dark and was not drawn.

    A pixel of ink is at least half as dark as the darkest within `reach` pixels, which finds a line's edges
    however dark it is, or nearly as dark as full ink.  Of the pieces that those make, the ones count that are about
    as dark as full ink; what is at the edge of the sheet and no larger than a finger is what holds it.
    Of a board, what is at its frame hangs on that.
    """
    import cv2

    floor = _floor(page.noise)
    dark = page.darkness
    if page.noise > GRAINY:
        dark = np.asarray(cv2.GaussianBlur(dark, (3, 3), 0))
    near = (2 * reach + 1, 2 * reach + 1)
    darkest, mean = np.asarray(cv2.dilate(dark, np.ones(near, np.uint8))), np.asarray(cv2.blur(dark, near))
    # blurred ink makes the paper that it encloses grey: there it takes more to be ink
    mask, crisp = crisp_ink(dark, darkest, mean, int(floor))
    size = (mask.shape[0] * mask.shape[1]) ** 0.5
    found = _measure(mask, page)
    notable = (found.span >= NOTABLE * size) & ~found.at_edge
    if not notable.any():
        notable = found.span >= 0
    if not len(notable):
        return np.zeros_like(mask), page, []
    full = found.strength[notable].max()
    mask |= (crisp > np.uint8(max(floor, CRISP * full))).view(np.uint8)
    # beside darker ink a thin line is less than half as dark as the darkest around, as the blurred edge of that ink
    # is; but from a line darkness falls to both sides, and along an edge to one
    link(crests(dark, mask, max(floor, FAINT * full), reach, CREST, BESIDE), LEAST_LINK, mask)
    found = _measure(mask, page)
    photographed, ruled, margins = page.noise > NOISELESS, False, 0
    if _may_be_ruled(found, page):
        before, bare = mask.copy(), page.darkness.copy()
        ruled, margins = drop_ruling(mask, bare, page.edge, photographed)
    if ruled or margins:
        found = _measure(mask, page)
        if ruled and page.edge is not None:  # as dark as ink, and all around the drawing
            mask = found.without(mask, found.wholly(page.edge))
            found = _measure(mask, page)
        page = _without_print(page, bare, before & (1 - mask), ruled, margins)
        full = found.strength[found.span >= min(NOTABLE * size, found.span.max(initial=0))].max(initial=0)
    dark, rows = without_print(mask, page.darkness, *found.darker(_faintest(found, full, size)), reach)
    if rows:  # pen and paper are not to be told from it
        note = f"left out {rows} {'row' if rows == 1 else 'rows'} of print or writing"
        return ink_mask(replace(page, darkness=dark, left_out=(*page.left_out, note)), reach)
    frame = None if ruled or not photographed else _drop_frame(mask, found, reach)
    sheet = page
    if frame is not None:
        sheet = replace(page, edge=frame if page.edge is None else np.asarray(cv2.max(frame, page.edge)))
        found = _measure(mask, sheet)
        full = found.strength[found.span >= min(NOTABLE * size, found.span.max(initial=0))].max(initial=0)
    left_out = ["left out a frame all around, and what is beyond it"] if frame is not None else []
    left_out += page.left_out
    faintest = _faintest(found, full, size)
    is_solid = (found.area > SOLID * found.extent.prod(axis=1)) & (found.span > HOLE * size)
    solid = np.flatnonzero(is_solid & (found.strength >= faintest))
    if photographed and len(solid):
        ends = np.cumsum(found.area)
        discs = [found.pixels[ends[k] - found.area[k] : ends[k]] for k in solid]
        holes = solid[punched(mask, sheet.edge, page.rim, discs)]
        found.strength[holes] = 0
        left_out += [f"left out {len(holes)} holes along an edge of the sheet"] if len(holes) else []
    held = found.at_edge & (found.span < (FINGER_MARK if frame is None else HUNG) * size)
    if frame is None and page.edge is not None:  # the sheet bends there, and has a shade along its edge
        held |= found.wholly(page.edge) & (found.strength < SMUDGE * full)
    seen = (found.strength >= faintest) & (found.span >= 2 * reach)
    keep = seen & ~held
    if frame is None:
        leads = (keep & found.at_edge).any() or page.beside > SMUDGE * full
        left_out += _at_edge(int(np.count_nonzero(seen & held)), bool(leads))
    return found.without(mask, ~keep), page, left_out


def _faintest(found: _Pieces, full: float, size: float) -> NDArray[np.float64]:
    """How dark ink is at least, piece by piece, where full ink is so dark on a picture of some size."""
    return np.asarray(full * np.where(found.span < NOTABLE * size, SMUDGE, FAINT))


def _without_print(page: Page, bare: Image, gone: Image, ruled: bool, margins: int) -> Page:
    """The page without what was printed on it.

    bare: its darkness without lines from edge to edge.  gone: 1 where there was ink of print.  ruled: whether some of
    it was ruling, which is along the edges, too.  margins: how many lines were none.
    """
    left_out = ["left out what is printed from edge to edge of the sheet, or a crease"] if margins else []
    return replace(
        page,
        darkness=bare * (1 - gone),
        beside=0.0 if ruled else page.beside,
        left_out=(*page.left_out, *left_out),
    )


def _at_edge(held: int, leads: bool) -> list[str]:
    """Notes of what is not seen at the edge of the sheet.  held: pieces of ink there that are left out.
    leads: whether other ink is there."""
    notes = [f"left out {held} marks at the edge of the sheet, as of what holds it"] if held else []
    if leads:
        notes.append("ink leads to the edge of the sheet: what is drawn along that may be missing")
    return notes


def _drop_frame(mask: Image, found: _Pieces, reach: int) -> Image | None:
    """Erase a frame around nearly all of the sheet, and what is beyond, in place; returns 255 beyond it and within
    `reach` pixels, shape (h, w), or None without any."""
    import cv2

    ends = np.cumsum(found.area)
    for k in np.flatnonzero((found.extent >= SQUARED * np.array(mask.shape)).all(axis=1)):
        piece = np.zeros_like(mask)
        piece.ravel()[found.pixels[ends[k] - found.area[k] : ends[k]]] = 1
        inside = within_frame(piece, SQUARED**2)
        if inside is not None:
            mask &= inside
            return np.asarray(
                255 * (1 - cv2.erode(inside, np.ones((4 * reach + 1,) * 2, np.uint8))), np.uint8
            )
    return None


def _may_be_ruled(found: _Pieces, page: Page) -> bool:
    """Whether many pieces are nearly as long as the sheet, as of ruling, or one leads from edge to edge or all over
    it, as of squares."""
    size = np.array(page.darkness.shape)
    long, all_over = found.extent >= RULED * size, found.extent >= SQUARED * size
    if long.sum(axis=0).max(initial=0) >= FEWEST or all_over.all(axis=1).any():
        return True
    sheet = size
    if page.edge is not None:
        sheet = np.array([np.count_nonzero((page.edge[::4, ::4] == 0).any(axis=k)) * 4 for k in (1, 0)])
    return bool((found.extent >= ACROSS * sheet).any())


def drop_specks(mask: Image, distance: NDArray[Any], pen: float) -> int:
    """Drop the pieces, in place, that are too small for anything drawn; returns how many there were.

    distance: each ink pixel's distance to the paper, shape (h, w), likewise.
    """
    found = _measure(mask, None)
    specks = found.span < SPECK * pen
    gone = found.pixels[np.repeat(specks, found.area)]
    mask.ravel()[gone] = 0
    distance.ravel()[gone] = 0
    return int(np.count_nonzero(specks))


@dataclass(frozen=True, eq=False)
class _Pieces:
    """The connected pieces of a mask, with the mean darkness, height and width [pixels] and place of each."""

    pixels: NDArray[np.int32]
    area: NDArray[np.int64]
    strength: NDArray[np.float64]
    extent: NDArray[np.int32]
    at_edge: NDArray[np.bool_]

    @property
    def span(self) -> NDArray[np.float64]:
        return np.hypot(self.extent[:, 0], self.extent[:, 1])

    def darker(
        self, least: NDArray[np.float64]
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
        """The pixels of those at least so dark each, how far they go, and their areas."""
        dark = self.strength >= least
        return self.pixels[np.repeat(dark, self.area)], self.extent[dark], self.area[dark]

    def wholly(self, place: Image) -> NDArray[np.bool_]:
        """Which of them are within what is not 0 of a place, shape (h, w)."""
        start = np.cumsum(self.area) - self.area
        return np.asarray(np.minimum.reduceat(place.ravel()[self.pixels], start) > 0)

    def without(self, mask: Image, dropped: NDArray[np.bool_]) -> Image:
        mask = mask.copy()
        mask[[0, -1]] = 0
        mask[:, [0, -1]] = 0
        mask.ravel()[self.pixels[np.repeat(dropped, self.area)]] = 0
        return mask


def _measure(mask: Image, page: Page | None) -> _Pieces:
    pixels, start = found = pieces(mask)
    dark, edge = (None, None) if page is None else (page.darkness, page.edge)
    extent, strength, at_edge = measure_pieces(found, mask.shape[1], dark, edge)
    area = np.diff(np.append(start, len(pixels)))
    return _Pieces(pixels, area, strength, extent, at_edge)
