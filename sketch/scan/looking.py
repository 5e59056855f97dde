"""What is seen on a picture: the page, its ink and the ink's lines, in the resolution that suits the pen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains, distances, thin, trace
from sketch.scan.paper.broken import is_broken, join_skips
from sketch.scan.paper.faint import drop_faint_marks
from sketch.scan.paper.fills import FILL, fill_grain, fill_hatching, hollow_fills
from sketch.scan.paper.grain import smoothed_grain
from sketch.scan.paper.lying import drop_things
from sketch.scan.paper.page import Page, drop_specks, ink_mask, read_page
from sketch.scan.quantiles import percentile
from sketch.typing import Image

__all__ = ["Seen", "look"]

WORK_PIXELS = 2_500_000  # more than this are not looked at before the pen's width is known
MOST_PIXELS = 16_000_000  # that are ever looked at: no pen is as thin as a pixel of these
DOTTED = 0.12  # of the picture's pixels: lines of a drawing are farther apart than eight pixels
FEWEST_DOTS = 10_000  # [pixels] unless the picture is as small as a stamp
LEAST_SIDE = 8  # [pixels] of a picture that can show anything
FINEST = 0.5  # picture pixels to a pixel: the thinnest pens are thinned at twice the picture's resolution
NARROWEST_PEN = 3.0  # [pixels]: a thinner pen is thinned at twice the resolution
WIDEST_PEN = 8.0  # [pixels]: a wider pen is thinned at half the resolution
ANY_PEN = 6.4  # [pixels]: taken where there are no lines to tell
FILLED = 0.025  # of the picture's size: no pen is as wide, so that all shapes are filled
NEARBY = 4  # [pixels] within which ink is compared with the darkest


@dataclass(eq=False)
class Seen:
    """What was seen on a picture, stage by stage.

    Attributes:
        scale: picture pixels to a pixel of the stages' pictures.
        page: darkness under even light.  mask: ink 1, paper 0.  skeleton: its lines.  distance: of the ink to the
            paper.
        pen: width of the pen [pixels of the stages' pictures]; 0 where there is no ink.
        specks: how many pieces were too small to be anything.
        left_out: notes of what is on the paper and was not drawn.
    """

    scale: float
    page: Page
    mask: Image
    skeleton: Image
    distance: NDArray[np.float32]
    pen: float
    specks: int = 0
    left_out: list[str] = field(default_factory=list)

    @property
    def is_dotted(self) -> bool:
        """Whether the ink is the dots of a dithered or printed grey, which is looked at from farther off."""
        return bool(np.count_nonzero(self.skeleton) > max(DOTTED * self.skeleton.size, FEWEST_DOTS))

    def lines(self) -> Chains:
        """The lines of the skeleton, without what was not drawn as a line: fills, shading, faint marks, specks.

        What was seen is as it is without these, then.
        """
        import cv2

        mask, skeleton, distance, pen = self.mask, self.skeleton, self.distance, self.pen
        self.specks = drop_specks(mask, distance, pen)
        if fill_hatching(mask, pen):
            distance = distances(mask)
        if hollowed := hollow_fills(mask, skeleton, distance, pen):
            distance = distances(mask)
        if fill_grain(mask, distance, pen) or hollowed:
            skeleton, size = thin(mask)
        else:
            skeleton &= mask
            size = cv2.countNonZero(skeleton)
        chains = trace(skeleton, size)
        if faint := drop_faint_marks(mask, self.page.darkness, chains, distance, pen):
            self.left_out.append(f"left out {faint} marks that are far fainter than the pen's")
            distance = distances(mask)
            drop_specks(mask, distance, pen)
            skeleton, size = thin(mask)
            chains = trace(skeleton, size)
        if join_skips(mask, chains, pen):
            distance = distances(mask)
            skeleton, size = thin(mask)
            chains = trace(skeleton, size)
        self.skeleton, self.distance = skeleton, distance
        return chains


def look(picture: Image) -> Seen | None:
    """What is seen on a BGR picture; None where it is too small to show anything."""
    scale = 1.0
    while picture.shape[0] * picture.shape[1] > WORK_PIXELS * scale * scale:
        scale *= 2
    tried: set[float] = set()
    while True:
        seen = _look(picture, scale)
        if seen is None or not seen.pen:
            return seen
        tried.add(scale)
        if seen.pen > WIDEST_PEN or seen.is_dotted:
            scale *= 2
        elif seen.pen < NARROWEST_PEN:
            scale /= 2
        pixels = picture.shape[0] * picture.shape[1] / scale**2
        if scale in tried or scale < FINEST or pixels > MOST_PIXELS or min(picture.shape[:2]) < 100 * scale:
            return seen


def _look(picture: Image, scale: float) -> Seen | None:
    """Likewise, at one picture pixel in `scale`."""
    import cv2

    work = picture
    if scale > 1:
        work = cv2.resize(picture, None, fx=1 / scale, fy=1 / scale, interpolation=cv2.INTER_AREA)
    work = smoothed_grain(work)
    if scale < 1:
        work = cv2.resize(work, None, fx=1 / scale, fy=1 / scale, interpolation=cv2.INTER_LINEAR)
    if min(work.shape[:2]) < LEAST_SIDE:
        return None
    page = read_page(work)
    seen = _inked(page, scale)
    printed = seen.page is not page
    if seen.pen and is_broken(seen.skeleton, seen.pen, printed=printed):
        return _inked(seen.page.smoothed(NEARBY if printed else 2 * NEARBY), scale)
    return seen


def _inked(page: Page, scale: float) -> Seen:
    """The stages behind the page."""
    mask, page, left_out = ink_mask(page, NEARBY)
    skeleton, size = thin(mask)
    distance = distances(mask)
    if size and page.edge is not None and (things := drop_things(mask, skeleton, distance, page.edge)):
        left_out.append(f"left out {things} things that lie across the edge of the sheet")
    pen = _pen_width(mask, skeleton, distance) if size else 0.0
    return Seen(scale, page, mask, skeleton, distance, pen, left_out=left_out)


def _pen_width(mask: Image, skeleton: Image, distance: NDArray[np.float32]) -> float:
    """The width of the pen: the ink's area over its length, without what is filled."""
    import cv2

    thickness = distance[skeleton.view(np.bool_)]
    core = 2 * FILL * percentile(thickness, 20)
    pen = cv2.countNonZero(mask) / len(thickness)
    if (thick := float(thickness.max())) > core:
        side = 2 * round(2 * core) + 1  # also into its corners
        filled = cv2.dilate((distance > core).view(np.uint8), np.ones((side, side), np.uint8))
        area, length = (int(np.count_nonzero(some > filled)) for some in (mask, skeleton))
        without = area / length if length else ANY_PEN
        pen = without if thick > FILL * without else pen  # a blot is not filled
    return pen if pen < FILLED * mask.size**0.5 else ANY_PEN
