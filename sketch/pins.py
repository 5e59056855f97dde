"""What a pin may join besides bodies: open lines."""

from __future__ import annotations

import math

import numpy as np

from sketch.scoring import Fitted

__all__ = ["PINNED", "is_pinned"]

PINNED = 3.0  # times as large as a pivot is what it joins, at least: the stem of an "a" is shorter
# of a ring's extent: a line so near to its middle goes through it, and is no ground that it lies on
THROUGH = 0.25


def is_pinned(line: Fitted, long: float, ring: Fitted, extent: float) -> bool:
    """Whether an open line of other ink, of extent `long`, ends in a ring of extent `extent` or goes through it
    [pixels]."""
    if PINNED * extent >= long or not set(ring.pieces).isdisjoint(line.pieces):
        return False
    x, y = ring.middle
    gap = min(math.dist((x, y), end) for end in line.outline[[0, -1]].tolist())
    if gap < extent or gap > long + extent:  # no point of the line is further from its ends than it is long
        return gap < extent
    start, side = line.outline[:-1] - (x, y), np.diff(line.outline, axis=0)
    t = np.clip(-(start * side).sum(axis=1) / np.maximum((side * side).sum(axis=1), 1e-9), 0, 1)
    return bool(np.hypot(*(start + t[:, None] * side).T).min() < THROUGH * extent)
