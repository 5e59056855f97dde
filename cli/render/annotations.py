"""What a picture says about itself: a scale bar, and which way things fall."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cli.render.camera import Camera
from cli.render.canvas import SHIFT, Canvas, fixed
from cli.render.pen import Pen
from cli.render.style import mix
from sim.scene import Scene

__all__ = ["ScaleBar", "annotate", "round_length", "scale_bar"]

Array = NDArray[np.float64]

# Of the scale bar: from the sides, and how high it is with its text [units of the pen].
MARGIN, TALL = 26.0, 44.0
BELOW = 54.0  # of what stands in the upper corners already [units]
CAPTION = 0.35  # what is written in the upper left corner is no longer [of the picture's width]
COARSE = 4  # the room is looked at in pixels of so many of the picture's


@dataclass(frozen=True)
class ScaleBar:
    """A bar of a round length. left, bottom: of its line [pixels]; long: [pixels]."""

    metres: float
    long: float
    left: float
    bottom: float

    @property
    def label(self) -> str:
        return _length_label(self.metres)


def scale_bar(scene: Scene, camera: Camera, pen: Pen, ink: Sequence[Array] = ()) -> ScaleBar:
    """A bar a tenth to a fifth of the picture's width, where it hides the least.

    The lower left corner, unless another is emptier, or a place between two of them. Bodies count as they lie at
    the start.

    ink: strokes [m], shape (n, 2).
    """
    import cv2

    u, (width, height) = pen.unit, pen.size
    metres = round_length(0.2 * width / camera.scale)
    long = metres * camera.scale
    high, low = (BELOW + TALL) * u, height - 24 * u
    right = width - MARGIN * u - long
    corners = [(MARGIN * u, low), (right, low), (MARGIN * u, high), (right, high)]
    between = np.linspace(CAPTION * width, right, 4)[:-1].tolist()
    places = corners + [(x, low) for x in between] + [(x, TALL * u) for x in between]
    covered = np.zeros((height // COARSE + 1, width // COARSE + 1), np.uint8)
    outlines = [fixed(camera.pixels(np.array(body.outline())) / COARSE) for body in scene.bodies]
    for outline in outlines:
        cv2.fillPoly(covered, [outline], 255, cv2.LINE_8, SHIFT)
    lines = [fixed(camera.pixels(stroke) / COARSE) for stroke in ink]
    cv2.polylines(covered, lines, False, 255, 2, cv2.LINE_8, SHIFT)
    hidden = []
    for left, bottom in places:
        box = [left - 6 * u, bottom - TALL * u, left + long + 6 * u, bottom + 8 * u]
        x, y, x2, y2 = (max(0, round(side / COARSE)) for side in box)
        hidden.append(int(np.count_nonzero(covered[y:y2, x:x2])))
    left, bottom = places[hidden.index(min(hidden))]
    return ScaleBar(metres, long, left, bottom)


def annotate(canvas: Canvas, gravity: tuple[float, float], bar: ScaleBar, pen: Pen) -> None:
    """Draw the scale bar, and gravity in the upper right corner."""
    _draw_scale(canvas, bar, pen)
    _draw_gravity(canvas, gravity, pen)


def _draw_scale(canvas: Canvas, bar: ScaleBar, pen: Pen) -> None:
    u, ink = pen.unit, mix(pen.style.ink, pen.style.paper, 0.15)
    left, right, bottom = bar.left, bar.left + bar.long, bar.bottom
    lines = [
        ((left, bottom), (right, bottom)),
        *(((x, bottom - 5 * u), (x, bottom + 5 * u)) for x in (left, right)),
    ]
    for halo, color in ((2.5 * u, pen.style.paper), (0.0, ink)):
        for a, b in lines:
            pen.line(canvas, np.array(a), np.array(b), pen.width + halo, color)
    pen.write(canvas, bar.label, (left, bottom - 32 * u), 14)


def _draw_gravity(canvas: Canvas, gravity: tuple[float, float], pen: Pen) -> None:
    """An arrow the way things fall, or that they do not."""
    u, ink = pen.unit, mix(pen.style.ink, pen.style.paper, 0.15)
    g = np.array(gravity) * (1, -1)
    size = float(np.hypot(*g))
    if size == 0:
        text = "no gravity"
        pen.write(canvas, text, (pen.size[0] - 24 * u - pen.length(text, 14), 20 * u), 14)
        return
    along = g / size
    middle = np.array([pen.size[0] - 48 * u, 52 * u])
    pen.arrow(canvas, middle - along * 26 * u, middle + along * 26 * u, 1.4 * pen.width, ink)
    beside = middle + np.array([-30 * u, -8 * u]) + (abs(along[0]) > 0.7) * np.array([24 * u, 26 * u])
    pen.write(canvas, "g", (float(beside[0]), float(beside[1])), 14)


def round_length(metres: float) -> float:
    """The longest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** math.floor(math.log10(metres))
    return next(n * power for n in (5, 2, 1) if n * power <= metres * (1 + 1e-9))


def _length_label(metres: float) -> str:
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)):
        if metres >= size * (1 - 1e-9):
            return f"{metres / size:g} {unit}"
    return f"{metres:g} m"
