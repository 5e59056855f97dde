"""Dimension lines: a line with a small mark at either end says how long something is, and is no rod."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sketch.page.pieces import Page, Piece
from sketch.scoring import Fitted

__all__ = ["dimension_line"]

MARK = 0.25  # of a line's length: a mark at the end of a dimension line is as large
AT_END = 0.05  # of a line's length: a mark at the end of a dimension line is as near to that
ON = 0.1  # of its extent: strokes so near to a line, but not at its ends, mean something else: hatching, a floor


def dimension_line(page: Page, bar: Fitted, idle: Sequence[Piece]) -> set[int]:
    """A line and the small marks at its ends, if there is one at either end, that means nothing else, and none between
    them: their pieces."""
    ends = bar.outline[[0, -1]]
    long = math.dist(*ends.tolist())
    its = [page.pieces[i] for i in bar.pieces]
    small = [q for q in idle if q.extent < MARK * long and q not in its]
    if not all(any(_may_be_at(q, end, AT_END * long) for q in small) for end in ends.tolist()):
        return set()
    near = [q for q in small if any(p.is_near(q, AT_END * long) for p in its)]
    if len(near) < 2:
        return set()
    inks = [page.strokes.samples[q.stroke] for q in near]
    at = np.array(
        [np.hypot(*(ink[:, None] - ends).transpose(2, 0, 1)).min(axis=0) < AT_END * long for ink in inks]
    )
    (ax, ay), (ux, uy) = ends[0], (ends[1] - ends[0]) / max(long, 1e-9)
    off = np.array([np.abs((ink[:, 1] - ay) * ux - (ink[:, 0] - ax) * uy).min() for ink in inks])
    there, reach = np.asarray(at.any(axis=1)), ON * np.array([q.extent for q in near])
    if not (at.any(axis=0).all() and (there | (off > reach)).all()):
        return set()
    return {*bar.pieces, *(q.index for q, end in zip(near, there, strict=True) if end)}


def _may_be_at(mark: Piece, end: list[float], reach: float) -> bool:
    """Whether a mark may be so near to an end, for all that its box tells."""
    (x, y), (x0, y0, x1, y1) = end, mark.box
    return x0 - reach < x < x1 + reach and y0 - reach < y < y1 + reach
