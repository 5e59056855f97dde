"""Holes that were punched into a sheet for a binder: alike and round, along an edge of it, with nothing beyond.

One that the picture's edge cuts need be neither round nor one of two: nobody fills half a shape, dark to that edge.
It may be the other one of two.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sketch.typing import Image

__all__ = ["punched"]

ROUND = 0.12  # of its width: what a hole's height may differ, and of a disc's area, its own
ALIKE = 0.15  # of a hole's width: what that of another may differ
IN_LINE = 0.1  # of how far two holes are apart: what their distances to the edge may differ
RIM = 0.07  # of the picture's size: holes are nearer to the edge


def punched(mask: Image, edge: Image | None, margin: int, pixels: list[NDArray[np.int32]]) -> list[int]:
    """Which pieces of ink are such holes.

    mask: of the ink.  edge: not 0 off the sheet and near its edge, or None where the sheet fills the picture.
    margin: width of the strips along the picture's edges that count as paper [pixels].
    pixels: of each piece, as indices into the mask.
    """
    rim = RIM * (mask.shape[0] * mask.shape[1]) ** 0.5
    discs, cut = [], dict[int, tuple[int, set[int]]]()  # of what an edge cuts: how wide it is, at which sides
    height, width = mask.shape
    within = max(margin, 1)
    for k, piece in enumerate(pixels):
        y, x = np.divmod(piece, mask.shape[1])
        (left, right), (top, bottom) = ((int(v.min()), int(v.max())) for v in (x, y))
        wide, high = right - left + 1, bottom - top + 1
        margins = (left, width - 1 - right, top, height - 1 - bottom)
        if min(margins) <= within and max(wide, high) < 2 * rim:
            cut[k] = max(wide, high), {side for side, free in enumerate(margins) if free <= within}
            continue
        full = np.pi / 4 * wide * high
        if abs(wide - high) > ROUND * wide or abs(len(piece) - full) > ROUND * full:
            continue
        x0, y0 = (left + right) // 2, (top + bottom) // 2
        ways = (
            (slice(y0, y0 + 1), slice(left - 1, None, -1)) if left else None,
            (slice(y0, y0 + 1), slice(right + 1, None)),
            (slice(top - 1, None, -1), slice(x0, x0 + 1)) if top else None,
            (slice(bottom + 1, None), slice(x0, x0 + 1)),
        )
        for side, way in enumerate(ways):
            if way is None:
                continue
            beyond = mask[way].ravel()
            free = len(beyond) if edge is None else int(np.argmax(np.append(edge[way].ravel() > 0, True)))
            if free < rim and not beyond[:free].any():
                discs.append((side, k, wide, free, y0 if side < 2 else x0))
    return sorted(
        cut.keys()
        | {
            k
            for side, k, wide, _, _ in discs
            for width, sides in cut.values()
            if side in sides and abs(width - wide) < ALIKE * wide
        }
        | {
            k
            for side, k, wide, free, at in discs
            for other, n, width, clear, place in discs
            if n != k and other == side and abs(width - wide) < ALIKE * wide
            if abs(clear - free) < IN_LINE * abs(place - at)
        }
    )
