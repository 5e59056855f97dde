"""A frame all around the drawing: a whiteboard's, or a border printed on the sheet.

It is straight as no hand draws it, and neither it nor what is beyond it - the wall, the tray with its pens - was drawn.
"""

from __future__ import annotations

import numpy as np

from sketch.typing import Image

__all__ = ["within_frame"]

STRAIGHT = 0.003  # of the frame's size: how far its sides are off straight lines
MOSTLY = 0.9  # of the sides' length is as straight as that: on the rest hangs what is no part of the frame
ROUND = 0.03  # of the way around a frame: how far it may be off its four corners


def within_frame(piece: Image, least: float) -> Image | None:
    """1 within a frame, shape (h, w), if a piece of ink is one; None otherwise.

    piece: its ink 1, anything else 0.  least: what a frame surrounds at least, as a share of the picture.
    """
    import cv2

    ways, nesting = cv2.findContours(piece, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    inner = [way for way, (_, _, _, parent) in zip(ways, nesting[0], strict=True) if parent >= 0]
    if not inner:
        return None
    way = max(inner, key=cv2.contourArea)
    if cv2.contourArea(way) < least * piece.size:
        return None
    hull = cv2.convexHull(way)
    corners = cv2.approxPolyDP(hull, ROUND * cv2.arcLength(hull, True), True)[:, 0].astype(np.float64)
    if len(corners) != 4:
        return None
    sides = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / np.hypot(*sides.T)[:, None]
    off = np.abs(((way - corners) * normals).sum(axis=2))
    if np.mean(off.min(axis=1) < STRAIGHT * piece.size**0.5) < MOSTLY:
        return None
    inside = cv2.drawContours(np.zeros_like(piece), [way], -1, 1, cv2.FILLED)
    return np.asarray(inside & (1 - piece), np.uint8)
