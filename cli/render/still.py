"""Single pictures: the strobe picture of a whole motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cli.render.animation import CHUNK
from cli.render.backdrop import round_length
from cli.render.canvas import ONE, Canvas
from cli.render.figure import Figure

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["png", "strobe"]

FLASHES = 9  # at least so many ghosts; at most 2.5 times as many, because their interval is a round number
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
    end = _last_change(figure, motion)
    if end == 0:
        figure.fill(canvas, figure.place(motion.positions[0], motion.angles[0]))
        figure.caption(canvas, "at rest")
        return canvas
    interval = float(motion.times[1] - motion.times[0])
    step = max(1, round(round_length(end * interval / FLASHES) / interval))
    for k in range(0, end, step):
        figure.fill(canvas, figure.place(motion.positions[k], motion.angles[k]), FADE)
    figure.fill(canvas, figure.place(motion.positions[end], motion.angles[end]))
    figure.caption(canvas, f"every {step * interval:.3g} s, to {motion.times[end]:.3g} s")
    return canvas


def _last_change(figure: Figure, motion: Trajectory) -> int:
    """The first sample from which on nothing in the picture moves by more than a pixel."""
    if not figure.parts:
        return 0
    end = figure.place(motion.positions[-1:], motion.angles[-1:])
    for stop in range(len(motion), 0, -CHUNK):
        span = slice(max(0, stop - CHUNK), stop)
        placed = figure.place(motion.positions[span], motion.angles[span])
        away = figure.differences(placed, end) > ONE
        seen = figure.visible(placed) | figure.visible(end)
        moved = np.flatnonzero((away & seen).any(axis=1))
        if len(moved):
            return min(span.start + int(moved[-1]) + 1, len(motion) - 1)
    return 0
