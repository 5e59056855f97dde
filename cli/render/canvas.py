"""Pixels to draw on: RGB for stills, or a video frame's own planes, which saves converting each frame.

Coordinates are fixed-point: 1/16 pixel, counted from the centre of the upper left pixel (cv2's convention).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cli.render.outline import is_convex
from cli.render.style import RGB

__all__ = ["BLOOM", "ONE", "THIN", "Box", "Canvas", "Stamp", "fixed", "paint", "stamp"]

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Points = NDArray[np.int32]
Stamp: TypeAlias = tuple[tuple[NDArray[np.uint16], NDArray[np.uint16]], ...]
Box: TypeAlias = tuple[int, int, int, int]  # left, top, right, bottom [pixels], right and bottom outside

SHIFT = 4
ONE = 1 << SHIFT
LEVELS = np.arange(256, dtype=np.uint8)  # the opacities that a pixel of a mask can have
FAR = 1 << 26  # nothing is drawn farther out, where cv2's integers would run over

# cv2's anti-aliased fills reach this far over the outline [pixels] (measured: 0.59 to 0.77, by direction);
# whatever is filled is drawn smaller by it.
BLOOM = 0.67
THIN = 2 * BLOOM + 0.3  # lines of less [pixels] are too thin to be filled as polygons

_HALF_A_ROW = np.array([0, ONE // 2], np.int32)

# Columns: blue, green, red, 1 (BT.601, 8 bits, limited range).
_Y = np.array([[24.966, 128.553, 65.481, 16 * 255]]) / 255
_UV = np.array([[112.0, -74.203, -37.797, 128 * 255], [-18.214, -93.786, 112.0, 128 * 255]]) / 255


def fixed(pixels: Array) -> Points:
    """Points [pixels], a pixel's centre at a half, as fixed-point coordinates."""
    return np.rint(np.clip((pixels - 0.5) * ONE, -FAR, FAR)).astype(np.int32, order="C")


@dataclass(frozen=True, eq=False)
class Canvas:
    """One picture: planes of pixels that are drawn on alike.

    Attributes:
        planes: a single BGR plane (h, w, 3); or brightness Y (h, w) and colours UV (h/2, w/2, 2) (NV12).
    """

    planes: tuple[Bytes, ...]

    @classmethod
    def plain(cls, size: tuple[int, int], color: RGB) -> Canvas:
        """A BGR canvas of one colour."""
        plane = np.empty((size[1], size[0], 3), np.uint8)
        plane[0] = color[::-1]
        plane[1:] = plane[0]  # whole rows are copied ten times as fast as pixels
        return cls((plane,))

    @property
    def is_yuv(self) -> bool:
        return len(self.planes) == 2

    def to_yuv(self) -> Canvas:
        """The same picture as Y and UV, a colour for every 2x2 pixels, sited on their left as in H.264."""
        import cv2

        (bgr,) = self.planes
        half = (bgr.shape[1] // 2, bgr.shape[0] // 2)
        shifted = cv2.copyMakeBorder(bgr[:, :-1], 0, 0, 1, 0, cv2.BORDER_REPLICATE)
        left, right = (cv2.resize(x, half, interpolation=cv2.INTER_AREA) for x in (shifted, bgr))
        smooth = cv2.addWeighted(left, 0.5, right, 0.5, 0)  # columns weigh 1, 2, 1 about an even one
        colors: Any = cv2.transform(smooth, _UV)
        brightness: Any = cv2.transform(bgr, _Y)
        return Canvas((brightness, colors))

    def copy(self) -> Canvas:
        return Canvas(tuple(plane.copy() for plane in self.planes))

    def copy_from(self, other: Canvas, box: Box | None = None, at: tuple[int, int] = (0, 0)) -> None:
        """Take over, within a box, the pixels of another canvas of the same kind.

        at: the column and row of the other that this one's first are; all of these are even.
        """
        left, top, right, bottom = box or (0, 0, *self.planes[0].shape[1::-1])
        for k, (mine, its) in enumerate(zip(self.planes, other.planes, strict=True)):
            half = k > 0
            x, y = at[0] >> half, at[1] >> half
            left_, top_, right_, bottom_ = left >> half, top >> half, right >> half, bottom >> half
            np.copyto(mine[top_:bottom_, left_:right_], its[top_ + y : bottom_ + y, left_ + x : right_ + x])

    def views(self, points: Points) -> Iterator[tuple[Bytes, Points, int]]:
        """Every plane with `points` (..., 2) in its own fixed-point coordinates and their bits of fraction.

        The colours' rows lie midway between two rows of brightness; half the resolution is one bit more
        of fraction.
        """
        yield self.planes[0], points, SHIFT
        if self.is_yuv:
            between = points - _HALF_A_ROW
            yield self.planes[1], between, SHIFT + 1

    def polygon(self, points: Points, color: RGB) -> None:
        """Fill a polygon; points: fixed-point, shape (n, 2)."""
        import cv2

        convex = is_convex(points)
        for (plane, where, shift), value in zip(self.views(points), paint(color, self.is_yuv), strict=True):
            if convex:  # cv2 smooths the sides of convex polygons better
                cv2.fillConvexPoly(plane, where, value, cv2.LINE_AA, shift)
            else:
                cv2.fillPoly(plane, [where], value, cv2.LINE_AA, shift)

    def blend(self, mask: Bytes, corner: tuple[int, int], color: RGB) -> None:
        """Lay a colour over the picture through a mask (h, w) of opacity, its corner at a column and row.

        On a video frame the corner has to be even.
        """
        # The arithmetic is done once for each opacity that a pixel can have, not for every pixel.
        tables = (_over([LEVELS], [value]) for value in paint(color, self.is_yuv))
        masks = (_sized_for(plane, mask) for plane in range(len(self.planes)))
        self.put(
            tuple(
                (kept.take(m, 0), added.take(m, 0)) for m, (kept, added) in zip(masks, tables, strict=True)
            ),
            corner,
        )

    def put(self, stamp: Stamp, corner: tuple[int, int]) -> None:
        """Lay a stamp over the picture, its corner at a column and row: even ones on a video frame."""
        for k, (plane, (share, color)) in enumerate(zip(self.planes, stamp, strict=True)):
            column, row = corner[0] >> (k > 0), corner[1] >> (k > 0)
            height, width = plane.shape[:2]
            left, top = max(0, -column), max(0, -row)
            inside = slice(top, max(top, height - row)), slice(left, max(left, width - column))
            share, color = share[inside], color[inside]
            y, x = row + top, column + left
            at = plane[y : y + share.shape[0], x : x + share.shape[1]]
            at[:] = (at * share + color) >> 8


def stamp(layers: Sequence[tuple[Bytes, RGB]], yuv: bool) -> Stamp:
    """Colours over one another, each through its mask (h, w) of opacity: what `Canvas.put` lays on pictures.

    For every plane what is left of a pixel [1/256], and what is added to that [1/256].
    """
    values = zip(*(paint(color, yuv) for _, color in layers), strict=True)
    return tuple(
        _over([_sized_for(plane, mask) for mask, _ in layers], colors) for plane, colors in enumerate(values)
    )


def _sized_for(plane: int, mask: Bytes) -> Bytes:
    """A mask at the resolution of a plane: half of it for the colours of a video frame."""
    import cv2

    if plane == 0:
        return mask
    half = (mask.shape[1] // 2, mask.shape[0] // 2)
    return np.asarray(cv2.resize(mask, half, interpolation=cv2.INTER_AREA), np.uint8)


def _over(
    masks: Sequence[Bytes], values: Sequence[Sequence[float]]
) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """One plane of a stamp: what layers of one opacity (...) and value (channels,) each keep and add."""
    share: Any = 1.0
    added: Any = 0.0
    for mask, value in zip(masks, values, strict=True):
        opacity = mask.reshape(mask.shape + (1,) * (len(value) > 1)) / 255
        share, added = share * (1 - opacity), added * (1 - opacity) + np.array(value, float) * opacity
    kept = np.rint(256 * share).astype(np.uint16)
    return kept, np.rint(256 * added + 127.5 * (kept < 256)).astype(np.uint16)


def paint(color: RGB, yuv: bool) -> tuple[Any, ...]:
    """A colour as the value for each plane."""
    return _yuv(color) if yuv else (color[::-1],)


@lru_cache(maxsize=1024)
def _yuv(color: RGB) -> tuple[tuple[int], tuple[int, int]]:
    bgr1 = np.array([*color[::-1], 1.0])
    y, u, v = (round(float(row @ bgr1)) for row in (*_Y, *_UV))
    return (y,), (u, v)
