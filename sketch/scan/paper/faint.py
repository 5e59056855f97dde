"""What is on the paper but was not drawn there: the other side of the sheet, creases, stains of cups.

One pen draws about as darkly everywhere.  What is much fainter than most of the ink, with nothing between, may still be
another pen's; but what light brought there, or liquid, has softer edges than any line before the same camera.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains
from sketch.scan.quantiles import median
from sketch.typing import Image

__all__ = ["drop_faint_marks"]

LONG = 2.0  # pen widths: shorter chains do not say how dark their line is
APART = 1.3  # times that what was drawn is as dark as the darkest of what was not
FAINTER = 0.36  # of the ink's darkness: what has less was not drawn; where its edges are softer, by the square of that,
FAINTEST = 0.7  # of the ink's darkness: what has more was drawn, however soft its edges are
BETWEEN = 0.02  # of the ink's length that may be neither
RIM = 2.0  # [pixels] around a mark's ink that goes with it


def drop_faint_marks(mask: Image, darkness: Image, chains: Chains, distance: NDArray[Any], pen: float) -> int:
    """Erase what was not drawn from a mask of ink, in place; returns how many marks that were.

    darkness: of the page.  chains: of the mask's skeleton.  distance: of its ink to the paper [pixels].  pen: its width
    [pixels].
    """
    import cv2

    lines = [line.astype(np.intp) for line in chains.chains]
    if len(lines) < 2 or max(map(len, lines)) < LONG * pen:
        return 0
    size = np.array([len(line) for line in lines])
    start = np.cumsum(size) - size
    x, y = np.concatenate(lines).T
    # two lines that melt together are as dark as lines are, though not in their middle
    across = cv2.dilate(darkness, np.ones((2 * round(pen / 2) + 1,) * 2, np.uint8))
    strength = np.add.reduceat(across[y, x].astype(np.float64), start) / size
    long = size >= LONG * pen
    bound = _bound(strength[long], size[long])
    if not bound:
        return 0
    faint = strength < bound
    edge = np.add.reduceat(_edges(darkness)[y, x].astype(np.float64), start) / size
    (there, width), (drawn, sharp) = (
        (
            _typical(strength[those], size[those]),
            _typical((strength / np.maximum(edge, 1))[those], size[those]),
        )
        for those in (faint & long, ~faint & long)
    )
    if there > min(FAINTER * (width / sharp) ** 2, FAINTEST) * drawn:
        return 0
    marks, ink = np.zeros_like(mask), np.zeros_like(mask)
    for k, line in enumerate(lines):
        wide = 2 * float(distance[line[:, 1], line[:, 0]].max())
        on, more = (marks, 2 * RIM) if faint[k] else (ink, 0.0)
        cv2.polylines(on, [line.astype(np.int32)], False, 1, max(round(wide + more), 1))
    marks &= mask & (1 - ink)
    mask[marks > 0] = 0
    _, _, stats, _ = cv2.connectedComponentsWithStats(marks)
    longest = stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max(axis=1, initial=0)
    return max(int(np.count_nonzero(longest >= LONG * pen)), 1)


def _bound(strength: NDArray[Any], size: NDArray[Any]) -> float:
    """What the chains that were drawn are darker than, and the others are not; 0 where all are about as dark."""
    order = np.argsort(strength, kind="stable")
    dark, length = strength[order], np.cumsum(size[order])
    ink = np.cumsum(dark * size[order])  # less is faint than was drawn
    for k in range(int(np.searchsorted(2 * ink, ink[-1])), 0, -1):
        after = int(np.searchsorted(length, length[k - 1] + BETWEEN * length[-1]))
        if dark[after] > APART * dark[k - 1] and dark[k - 1] < FAINTEST * _typical(dark[k:], size[order][k:]):
            return float(APART**0.5 * dark[k - 1])
    return 0.0


def _typical(values: NDArray[Any], size: NDArray[Any]) -> float:
    """The median along the chains."""
    return median(np.repeat(values, size)) if len(values) else 0.0


def _edges(darkness: Image) -> NDArray[Any]:
    """How much darkness changes from a pixel to the next, at most, near each."""
    import cv2

    smooth = cv2.GaussianBlur(darkness, (3, 3), 0)
    return np.asarray(
        cv2.dilate(
            cv2.morphologyEx(smooth, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)), np.ones((5, 5), np.uint8)
        )
    )
