"""What stands still in a picture: paper, ink, anchored bodies, supports."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from cli.render.annotations import round_length
from cli.render.camera import Camera
from cli.render.canvas import BLOOM, ONE, SHIFT, THIN, Canvas, Points, fixed
from cli.render.outline import inset, rim
from cli.render.pen import Pen
from cli.render.style import RGB, body_paints, mix
from sim.scene import Joint, Scene

__all__ = ["backdrop", "grid_step"]

Array = NDArray[np.float64]


def backdrop(scene: Scene, camera: Camera, pen: Pen, still: list[Array], moved: list[Array]) -> Canvas:
    """The background of every frame.

    still: the person's strokes that stay where they are, moved: those that a body takes along, both on the
    page's world [m], shape (n, 2).
    """
    canvas = Canvas.plain(camera.size, pen.style.paper)
    if pen.style.grid is not None:
        _draw_grid(canvas, camera, pen, pen.style.grid)
    if pen.style.moves_ink:
        _draw_bodies(canvas, scene, camera, pen)
        _draw_strokes(canvas, camera, pen, still, pen.style.ink)
    else:
        _draw_strokes(canvas, camera, pen, still + moved, pen.style.drawn)
        _draw_bodies(canvas, scene, camera, pen)
        for joint in scene.joints:
            _draw_support(canvas, camera, pen, joint)
    return canvas


def _draw_strokes(canvas: Canvas, camera: Camera, pen: Pen, strokes: list[Array], color: RGB) -> None:
    import cv2

    lines = [fixed(camera.pixels(stroke)) for stroke in strokes]
    cv2.polylines(canvas.planes[0], lines, False, color[::-1], max(1, round(pen.unit)), cv2.LINE_AA, SHIFT)


def grid_step(camera: Camera) -> float:
    """The side of a square of the grid [m]."""
    return round_length(0.2 * min(camera.size) / camera.scale)


def _draw_grid(canvas: Canvas, camera: Camera, pen: Pen, color: RGB) -> None:
    """Squares of a round length, 5 to 12 of them in the picture's height."""
    width, height = camera.size
    step = grid_step(camera) * camera.scale
    left, top = (-camera.corner[0] * camera.scale) % step, (camera.corner[1] * camera.scale) % step
    for x in np.arange(left, width, step):
        pen.line(canvas, np.array([x, 0.0]), np.array([x, float(height)]), 1.0, color)
    for y in np.arange(top, height, step):
        pen.line(canvas, np.array([0.0, y]), np.array([float(width), y]), 1.0, color)


def _draw_bodies(canvas: Canvas, scene: Scene, camera: Camera, pen: Pen) -> None:
    """Anchored bodies: pale, with the hatching that engineers draw for what is fixed."""
    for body, paints in zip(scene.bodies, body_paints(scene, pen.style), strict=True):
        if not body.anchored:
            continue
        outline = camera.pixels(np.array(body.outline()))
        if pen.style.moves_ink:
            canvas.polygon(fixed(inset(outline, BLOOM)), paints.filling)
            continue
        canvas.polygon(fixed(inset(outline, BLOOM)), paints.edge)
        inner = fixed(inset(outline, BLOOM + pen.width))
        canvas.polygon(inner, paints.filling)
        _hatch(canvas, inner, pen.unit, paints.stripes)
        for side in rim(outline, BLOOM, pen.width - BLOOM) if pen.width > THIN else ():
            canvas.polygon(fixed(side), paints.edge)  # smoother than where cv2 fills a concave polygon


def _hatch(canvas: Canvas, outline: Points, unit: float, color: RGB) -> None:
    """Stripes at 45 degrees within an outline (fixed-point)."""
    import cv2

    height, width = canvas.planes[0].shape[:2]
    left, top = np.clip(outline.min(axis=0) // ONE - 1, 0, (width, height)).tolist()
    right, bottom = np.clip(outline.max(axis=0) // ONE + 2, 0, (width, height)).tolist()
    if right <= left or bottom <= top:
        return
    mask = np.zeros((bottom - top, right - left), np.uint8)
    cv2.fillPoly(mask, [outline - np.array([left, top], np.int32) * ONE], 255, cv2.LINE_AA, SHIFT)
    period = 11.0 * unit
    diagonal = np.arange(left + top, right + bottom) / math.sqrt(2)
    from_stripe = np.abs(diagonal % period - period / 2)
    profile = (np.clip(0.75 * unit + 0.5 - from_stripe, 0, 1) * 255).astype(np.uint8)
    # A pixel's stripe follows from its row plus its column: rows of the profile, each one further on.
    stripes = sliding_window_view(profile[: sum(mask.shape) - 1], mask.shape[1])
    striped: Any = cv2.multiply(mask, np.ascontiguousarray(stripes), scale=1 / 255)
    canvas.blend(striped, (left, top), color)


def _draw_support(canvas: Canvas, camera: Camera, pen: Pen, joint: Joint) -> None:
    """A pivot on the background stands on the support of engineering drawings, a triangle."""
    if None not in joint.bodies:
        return
    x, y = camera.pixels(np.array(joint.position))
    u, ink = pen.unit, pen.style.ink
    half, tall = 15 * u, 24 * u
    triangle = np.array([[x, y], [x + half, y + tall], [x - half, y + tall]])
    canvas.polygon(fixed(inset(triangle, BLOOM)), ink)
    canvas.polygon(fixed(inset(triangle, BLOOM + pen.width)), mix(pen.style.paper, ink, 0.12))
    ends = np.array([[x - 1.5 * half, y + tall], [x + 1.5 * half, y + tall]])
    pen.line(canvas, ends[0], ends[1], pen.width, ink)
    for k in range(6):
        top = ends[0] + (ends[1] - ends[0]) * ((k + 0.7) / 6)
        pen.line(canvas, top, top + np.array([-6, 8]) * u, 0.7 * pen.width, ink)
