"""Single pictures: the strobe picture of a whole motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import ONE, Canvas
from cli.render.figure import Figure, round_length

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["png", "strobe"]

FLASHES = 7  # at least so many ghosts; at most 2.5 times as many, because their interval is a round number
FADE = 0.62  # how pale a ghost is


def png(canvas: Canvas) -> bytes:
    """A BGR canvas as a PNG file's bytes."""
    import cv2

    done, data = cv2.imencode(".png", canvas.planes[0], [cv2.IMWRITE_PNG_COMPRESSION, 6])
    if not done:
        raise RuntimeError("the PNG encoder failed")
    return bytes(data)


def strobe(figure: Figure, motion: Trajectory) -> Canvas:
    """All of a motion in one picture, as physics books print it: ghosts at equal times, then the end.

    The flashes stop when the motion does, or when everything that moves has left the picture.
    """
    canvas = Canvas.plain(figure.camera.size, figure.style.paper)
    canvas.copy_from(figure.background)
    placed = figure.place(motion.positions, motion.angles)
    end = _last_change(figure, placed)
    if end == 0:
        figure.fill(canvas, placed[0])
        figure.caption(canvas, "at rest")
        return canvas
    interval = float(motion.times[1] - motion.times[0])
    step = max(1, round(round_length(end * interval / FLASHES) / interval))
    for k in range(0, end, step):
        figure.fill(canvas, placed[k], FADE)
    figure.fill(canvas, placed[end])
    figure.caption(canvas, f"every {step * interval:.3g} s, to {motion.times[end]:.1f} s")
    return canvas


def _last_change(figure: Figure, placed: NDArray[np.int32]) -> int:
    """The last sample that shows something in the picture that was not there before."""
    if placed.shape[1] == 0:
        return 0
    moved = np.any(placed[1:] != placed[:-1], axis=2)
    after = placed[1:] // ONE
    seen = np.all((after >= 0) & (after < figure.camera.size), axis=2)
    changes = np.flatnonzero((moved & seen).any(axis=1))
    return int(changes[-1]) + 1 if len(changes) else 0
