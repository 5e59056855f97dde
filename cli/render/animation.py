"""The frames of a motion: which ones show anything new, and how each is drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import ONE, Box, Canvas, Points
from cli.render.figure import Figure
from cli.render.style import mix

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["PLAIN", "Extras", "Sheet", "Trails", "changes", "clock", "drawn", "frame_count"]

CHUNK = 64  # frames whose poses are computed at once: memory does not grow with the length

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Extras:
    """What is drawn besides the bodies.

    trails: the paths of the centres.  vectors: velocities and net forces.  follow: a body that stays in the
    middle, or None.
    """

    trails: bool = False
    vectors: bool = False
    follow: int | None = None


PLAIN = Extras()


class Sheet:
    """A canvas that knows what lies under its drawing and where, and whose it is (a frame of the encoder's)."""

    def __init__(self, canvas: Canvas, frame: Any = None) -> None:
        self.canvas, self.frame = canvas, frame
        self._ground: Canvas | None = None
        self._used: list[Box] | None = None

    def clear(self, ground: Canvas, at: tuple[int, int]) -> None:
        """Show nothing but the ground, whose column and row `at` come first."""
        boxes = [None] if self._used is None or self._ground is not ground else self._used
        for box in boxes:
            self.canvas.copy_from(ground, box, at)
        self._ground = ground

    def use(self, boxes: list[Box] | None) -> None:
        """Tell where was drawn since it was clear; None: anywhere."""
        self._used = boxes


def frame_count(motion: Trajectory) -> int:
    """Frames that last as long as the motion: each sample but the last is shown until the next."""
    return max(1, len(motion) - 1)


def drawn(
    figure: Figure,
    motion: Trajectory,
    fps: float,
    take: Callable[[], Sheet],
    extras: Extras = PLAIN,
) -> Iterator[tuple[int, Sheet]]:
    """The number and the sheet of every frame that shows something new, and of the last.

    take: gives a sheet that is free to be drawn on; all are of one kind.
    """
    count = frame_count(motion)
    changed = changes(figure, motion, count, extras)
    times = clock(changed, fps)
    background: Canvas | None = None
    trails = Trails(figure, motion) if extras.trails else None
    for start in range(0, count, CHUNK):
        span = slice(start, min(start + CHUNK, count))
        placed = figure.place(motion.positions[span], motion.angles[span])
        windows = _windows(figure, motion.positions[span], extras)
        # What rests for the whole chunk is drawn once, but not if trails still grow under it.
        live = figure.live(placed) if trails is None else list(range(len(figure.parts)))
        boxes = figure.boxes(placed, live)
        ground: Canvas | None = None
        for k in range(span.start, span.stop):
            if not (changed[k] or times[k] != times[k - 1] or k in (0, count - 1)):
                continue
            sheet = take()
            if background is None:
                background = figure.background.to_yuv() if sheet.canvas.is_yuv else figure.background.copy()
            if ground is None:
                ground = _with_resting(figure, background, placed[0], live)
            if trails is not None:
                trails.extend(background, k)
            at = windows[k - start]
            sheet.clear(ground, at)
            figure.fill(sheet.canvas, placed[k - start] - np.array(at, np.int32) * ONE, only=live)
            if extras.vectors:
                _draw_vectors(figure, sheet.canvas, motion, k, at)
            if extras.follow is not None:
                figure.annotate(sheet.canvas)
            clock_box = figure.caption(sheet.canvas, times[k])
            sheet.use([*boxes[k - start], clock_box] if extras == PLAIN else None)
            yield k, sheet


def _with_resting(figure: Figure, background: Canvas, placed: Points, live: list[int]) -> Canvas:
    """The background with all parts but the live ones on it."""
    resting = sorted(set(range(len(figure.parts))) - set(live))
    if not resting:
        return background
    ground = background.copy()
    figure.fill(ground, placed, only=resting)
    return ground


def changes(
    figure: Figure,
    motion: Trajectory,
    count: int,
    extras: Extras = PLAIN,
) -> NDArray[np.bool_]:
    """Which of the first `count` samples show a picture unlike that of the sample before; the first does."""
    changed = np.ones(count, bool)
    for start in range(1, count, CHUNK):
        span = slice(start - 1, min(start + CHUNK, count))
        placed = figure.place(motion.positions[span], motion.angles[span])
        new = figure.changes(placed)
        if extras.follow is not None:
            windows = np.array(_windows(figure, motion.positions[span], extras))
            new |= np.any(windows[1:] != windows[:-1], axis=1)
        changed[start : span.stop] = new
    return changed


def clock(changed: NDArray[np.bool_], fps: float) -> list[str]:
    """The time that each frame shows: in tenths of a second, in whole ones where nothing moves for so long.

    A clock that ran on in tenths would make every frame of a scene at rest a new one.
    """
    texts: list[str] = []
    edges = [*np.flatnonzero(changed).tolist(), len(changed)]
    for begin, end in pairwise(edges):
        still = end - begin > max(fps, 1)
        first = _tenths(begin, fps)
        for k in range(begin, end):
            tenths = _tenths(k, fps)
            if still:
                tenths = max(first, tenths // 10 * 10)
            texts.append(f"{tenths // 10}.{tenths % 10} s")
    return texts


def _tenths(k: int, fps: float) -> int:
    return math.floor(k / fps * 10 + 1e-6)


def _windows(figure: Figure, positions: Array, extras: Extras) -> list[tuple[int, int]]:
    """For each frame the corner of what the picture shows, in the camera's pixels; even."""
    if extras.follow is None:
        return [(0, 0)] * len(positions)
    middle = figure.camera.pixels(positions[:, extras.follow])
    room = np.array(figure.camera.size) - figure.pen.size
    corners = np.clip(np.rint((middle - np.array(figure.pen.size) / 2) / 2) * 2, 0, room)
    return [(int(x), int(y)) for x, y in corners]


class Trails:
    """The paths of the moving bodies' centres, drawn on the background as they grow."""

    def __init__(self, figure: Figure, motion: Trajectory) -> None:
        self.figure, self.motion, self.drawn = figure, motion, 0
        self.moving = [k for k, body in enumerate(figure.scene.bodies) if not body.anchored]

    def extend(self, background: Canvas, to: int) -> None:
        pen = self.figure.pen
        at = self.figure.camera.pixels(self.motion.positions[self.drawn : to + 1])
        for k in self.moving:
            color = mix(self.figure.paints[k].color, pen.style.paper, 0.35)
            for a, b in pairwise(at[:, k]):
                if not np.array_equal(a, b):
                    pen.line(background, a, b, 0.8 * pen.width, color)
        self.drawn = to


def _draw_vectors(figure: Figure, canvas: Canvas, motion: Trajectory, k: int, at: tuple[int, int]) -> None:
    """Arrows of velocity and net force at each moving body's centre of mass.

    Their lengths saturate: half the greatest length stands for 1 m/s, and for the body's weight.
    """
    pen, scene = figure.pen, figure.scene
    before, after = max(k - 1, 0), min(k + 1, len(motion) - 1)
    span = float(motion.times[after] - motion.times[before]) or 1.0
    accelerations = (motion.velocities[after] - motion.velocities[before]) / span
    g = math.hypot(*scene.gravity) or 1.0
    middles = figure.camera.pixels(motion.positions[k]) - at
    for body, (middle, v, a) in enumerate(zip(middles, motion.velocities[k], accelerations, strict=True)):
        if scene.bodies[body].anchored:
            continue
        for vector, one, color in ((v, 1.0, pen.style.velocity), (a, g, pen.style.force)):
            amount = math.hypot(*vector) / one
            if amount > 1e-3:
                along = vector * np.array([1, -1]) / math.hypot(*vector)
                pen.arrow(
                    canvas, middle, middle + along * 130 * pen.unit * amount / (1 + amount), pen.width, color
                )
