"""Lines that are broken: chalk and graphite leave out what lies deep in the grain, and the noise of a dark room is as
strong as a pencil.

Along itself a line goes on, and neither grain nor noise does: the mean along it is the line's.  One that is whole needs
none of this, and loses a little of its corners by it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains, along_lines, ends
from sketch.typing import Image

__all__ = ["is_broken", "join_skips", "smooth_lines"]

WHOLE = 14.0  # pen widths of line to an end: a drawing has more
BESIDE_PRINT = 28.0  # likewise, where a bit of a printed line is likelier than an end
STROKE = 1.5  # [pixels]: standard deviation of the smoothing before directions are looked at
SKIPS = 4  # gaps in lines of a drawing, at least, whose pen skips: one alone may be meant
MOST_ENDS = 1000  # of lines: a drawing has fewer, and print needs no pen
SKIPPED = 4.0  # pen widths from the middle of a line's end to the next one's, at most
SEEN = 3.0  # pen widths of a line that tell where it would go on
ASIDE = 0.6  # of a pen's width: how far a line that goes on may be off
ONWARD = 0.9  # cosine of the turn where a line goes on, at least
PAPER = 3.0  # times the noise: what is darker may be ink


def is_broken(skeleton: Image, pen: float, *, printed: bool) -> bool:
    """Whether lines end much more often than those of a drawing.

    pen: its width [pixels].  printed: whether printed lines were erased, which left bits or took some along.
    """
    import cv2

    whole = BESIDE_PRINT if printed else WHOLE
    return bool(cv2.countNonZero(skeleton) < whole * pen * ends(skeleton))


def smooth_lines(darkness: Image, noise: float, reach: int) -> Image:
    """Darkness, smoothed along the lines by `reach` pixels to either side; noise: of the bare paper."""
    import cv2

    height, width = (side // 2 for side in darkness.shape)
    half = cv2.resize(darkness[: 2 * height, : 2 * width], (width, height), interpolation=cv2.INTER_AREA)
    half = cv2.GaussianBlur(half, (0, 0), STROKE / 2)
    near = cv2.dilate((half > PAPER * noise).view(np.uint8), np.ones((3, 3), np.uint8))
    x, y = (np.asarray(cv2.Sobel(half, cv2.CV_32F, *way)) for way in ((1, 0), (0, 1)))
    tensor = [np.asarray(cv2.GaussianBlur(part, (0, 0), reach / 4)) for part in (x * x, x * y, y * y)]
    return along_lines(cv2.GaussianBlur(darkness, (3, 3), 0), near, tensor, reach)


def join_skips(mask: Image, chains: Chains, pen: float) -> bool:
    """Draw what a pen left out of its lines, in place; whether it skipped.

    A ballpoint that runs dry leaves gaps of a few widths, beyond which the line goes on as if it were whole.
    chains: of the mask's skeleton.  pen: its width [pixels].
    """
    import cv2

    at, way = _free_ends(chains, pen)
    if not 2 * SKIPS <= len(at) <= MOST_ENDS:
        return False
    apart = at[None] - at[:, None]
    onward = (apart * way[:, None]).sum(axis=2)  # how far each is ahead of another,
    aside = np.abs(apart[..., 0] * way[:, None, 1] - apart[..., 1] * way[:, None, 0])  # and beside its way
    fits = (onward > 0) & (onward < SKIPPED * pen) & (aside < ASIDE * pen) & (way @ way.T < -ONWARD)
    far = np.where(fits & fits.T, np.hypot(*apart.T), np.inf)
    nearest = far.argmin(axis=1)
    pairs = [
        (a, b) for a, b in enumerate(nearest.tolist()) if a < b and nearest[b] == a and np.isfinite(far[a, b])
    ]
    if len(pairs) < SKIPS:
        return False
    for a, b in pairs:
        first, last = (np.round(at[k]).astype(int).tolist() for k in (a, b))
        cv2.line(mask, first, last, (1,), max(round(pen), 1))
    return True


def _free_ends(chains: Chains, pen: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where lines end, and which way they would go on, each shape (n, 2)."""
    at, way = [], []
    for line, both in zip(chains.chains, chains.ends, strict=True):
        for last, end in zip((line[::-1], line), both, strict=True):
            if end == -1 and len(last) > pen:
                some = last[-round(SEEN * pen) :]
                at.append(last[-1])
                way.append(some[len(some) // 2 :].mean(axis=0) - some[: len(some) // 2].mean(axis=0))
    ways = np.array(way, np.float64).reshape(-1, 2)
    return np.array(at, np.float64).reshape(-1, 2), ways / np.maximum(np.hypot(*ways.T), 1e-9)[:, None]
