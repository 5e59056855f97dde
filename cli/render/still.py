"""Single pictures: the strobe picture of a whole motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cli.render.animation import CHUNK, Trails
from cli.render.annotations import round_length
from cli.render.canvas import ONE, Canvas
from cli.render.figure import Figure
from sim.scene import Circle

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["png", "strobe"]

FLASHES = 12  # at least so many; at most 2.5 times as many, because their interval is a round number
WIDTHS, CLOSEST = 0.35, 10.0  # between two ghosts: of a body's width, and [units of the pen]
FADE = 0.62  # how pale a ghost is


def png(canvas: Canvas) -> bytes:
    """A BGR canvas as a PNG file's bytes."""
    import cv2

    done, data = cv2.imencode(".png", canvas.planes[0], [cv2.IMWRITE_PNG_COMPRESSION, 6])
    if not done:
        raise RuntimeError("the PNG encoder failed")
    return bytes(data)


def strobe(figure: Figure, motion: Trajectory, trails: bool = False) -> Canvas:
    """All of a motion in one picture, as physics books print it: ghosts at equal times, then the end.

    A machine, the bodies that joints hold together, leaves no ghost where it lies nearly as in one that is there
    already: what hardly moves, or comes the same way again, would cover what it shows.  The flashes stop when the
    motion does, or when everything that moves has left the picture.

    trails: whether the paths of the bodies' centres are drawn over the ghosts.
    """
    canvas = Canvas.plain(figure.camera.size, figure.style.paper)
    canvas.copy_from(figure.background)
    end = _last_change(figure, motion)
    interval = float(motion.times[1] - motion.times[0]) if len(motion) > 1 else 1.0
    step = max(1, round(round_length(max(end, 1) * interval / FLASHES) / interval))
    final = figure.place(motion.positions[end], motion.angles[end])
    machines = [(parts, _apart(figure, parts), [final]) for parts in _machines(figure)]
    for k in range(0, end, step):
        placed = figure.place(motion.positions[k], motion.angles[k])
        for parts, apart, shown in machines:
            if all(figure.differences(placed, other)[parts].max() > apart for other in shown):
                shown.append(placed)
                figure.fill(canvas, placed, FADE, parts)
    if trails:
        Trails(figure, motion).extend(canvas, end)
    figure.fill(canvas, final)
    moved = any(len(shown) > 1 for _, _, shown in machines)
    figure.caption(
        canvas, f"every {step * interval:.3g} s, to {motion.times[end]:.3g} s" if moved else "at rest"
    )
    return canvas


def _machines(figure: Figure) -> list[list[int]]:
    """The parts of each machine: of the moving bodies that joints hold together."""
    scene = figure.scene
    moving = {body.id: k for k, body in enumerate(scene.bodies) if not body.anchored}
    machine = {k: k for k in moving.values()}
    for joint in scene.joints:
        pair = [machine[moving[name]] for name in joint.bodies if name in moving]
        for k in machine if len(pair) == 2 else ():
            if machine[k] == pair[1]:
                machine[k] = pair[0]
    return [
        [i for i, part in enumerate(figure.parts) if machine[part.body] == first]
        for first in sorted(set(machine.values()))
    ]


def _apart(figure: Figure, parts: list[int]) -> float:
    """How far a point of a machine has to move for another ghost [fixed-point]: a share of its narrowest body."""
    widths = []
    for k in {figure.parts[i].body for i in parts}:
        shape = figure.scene.bodies[k].shape
        if isinstance(shape, Circle):
            widths.append(2 * shape.radius)
        else:
            widths.append(float(np.ptp(np.array(shape.vertices), axis=0).min()))
    least = min(widths, default=0.0) * figure.camera.scale
    return max(WIDTHS * least, CLOSEST * figure.pen.unit) * ONE


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
