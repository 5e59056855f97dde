"""A scene as a figure: what stands still is drawn once, what moves is a list of parts to fill."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from cli.render.camera import Camera
from cli.render.canvas import BLOOM, ONE, SHIFT, Box, Canvas, Points, fixed, paint
from cli.render.outline import inset, is_convex, segment
from cli.render.style import RGB, Style, body_colors, mix
from cli.render.text import lettering
from sim.scene import Body, Circle, Joint, Scene

if TYPE_CHECKING:
    from sketch.ink import Sketch

__all__ = ["Figure", "Part", "length_label", "round_length"]

Array = NDArray[np.float64]

SMOOTH = 4  # pixels that a smoothed edge may reach over the outline: two in the planes of half the resolution


@dataclass(frozen=True, eq=False)
class Part:
    """One fill of one colour that moves with a body.

    Attributes:
        body: index in the scene.
        points: in the body's frame [m], shape (n, 2); of a disc its centre alone.
        radius: of a disc [fixed-point pixels]; 0 for a polygon.
    """

    body: int
    points: Array
    color: RGB
    radius: int = 0
    convex: bool = True


class Figure:
    """A scene, ready to be drawn at any poses.

    The background holds all that never moves: paper, the ink as drawn, anchored bodies, scale, gravity.
    """

    def __init__(self, scene: Scene, camera: Camera, style: Style, sketch: Sketch | None = None) -> None:
        self.scene, self.camera, self.style = scene, camera, style
        self.unit = min(camera.size) / 720  # lengths of lines and letters follow the picture's size
        self.line = max(style.line * self.unit, 1.3)
        self.colors = body_colors(scene)
        self.index = {body.id: k for k, body in enumerate(scene.bodies)}
        self.parts = [
            part for k, body in enumerate(scene.bodies) if not body.anchored for part in self.body(k)
        ]
        for joint in scene.joints:
            self.parts += self.pivot(joint)
        self._points = np.concatenate([part.points for part in self.parts] or [np.zeros((0, 2))])
        self._owners = np.repeat([p.body for p in self.parts], [len(p.points) for p in self.parts]).astype(
            int
        )
        ends = np.cumsum([len(p.points) for p in self.parts]).tolist()
        self._slices = [slice(end - len(p.points), end) for p, end in zip(self.parts, ends, strict=True)]
        self._paints: dict[tuple[bool, float], list[list[Any]]] = {}
        self.background = self._draw_background(sketch)

    # ------------------------------------------------------------ what moves

    def body(self, k: int) -> list[Part]:
        """Outline, filling and, on a disc, the mark that shows it turning."""
        body = self.scene.bodies[k]
        filling, edge = self.body_paints(k)
        if isinstance(body.shape, Circle):
            return self._disc_parts(k, body.shape.radius, edge, filling)
        v = np.array(body.shape.vertices)
        bloom, line = BLOOM / self.camera.scale, self.line / self.camera.scale
        outer, inner = inset(v, bloom), inset(v, bloom + line)
        convex = is_convex(v)
        return [Part(k, outer, edge, convex=convex), Part(k, inner, filling, convex=convex)]

    def body_paints(self, k: int) -> tuple[RGB, RGB]:
        """The colours of a body's filling and outline; anchored bodies are paler."""
        pale = 0.72 if self.scene.bodies[k].anchored else 0.12
        return mix(self.colors[k], self.style.paper, pale), mix(self.colors[k], self.style.ink, 0.62)

    def _disc_parts(self, k: int, radius: float, edge: RGB, filling: RGB) -> list[Part]:
        middle, pixels = np.zeros((1, 2)), radius * self.camera.scale
        outer, inner = (max(1, round((pixels - d) * ONE)) for d in (BLOOM, BLOOM + self.line))
        parts = [Part(k, middle, edge, outer)]
        if pixels > 1.5 * self.line:
            parts.append(Part(k, middle, filling, inner))
        if pixels > 3 * self.line:
            width = max(self.line - 2 * BLOOM, 0.4) / self.camera.scale
            end = radius * (1 - self.line / pixels)
            parts.append(Part(k, segment(np.zeros(2), np.array([end, 0.0]), width), edge))
        return parts

    def pivot(self, joint: Joint) -> list[Part]:
        """Rings about the pivot, on whichever of its bodies moves; none where nothing moves."""
        for name in joint.bodies:
            if name is not None and not self.scene.bodies[self.index[name]].anchored:
                k = self.index[name]
                body = self.scene.bodies[k]
                c, s = math.cos(body.angle), math.sin(body.angle)
                x, y = (joint.position[i] - body.position[i] for i in (0, 1))
                local = np.array([[c * x + s * y, c * y - s * x]])
                rings = zip(
                    self._pivot_radii(), (self.style.ink, self.style.paper, self.style.ink), strict=True
                )
                return [Part(k, local, color, round((r - BLOOM) * ONE)) for r, color in rings]
        return []

    def _pivot_radii(self) -> tuple[float, float, float]:
        return 7.0 * self.unit + 0.5, 7.0 * self.unit + 0.5 - self.line, max(2.4 * self.unit, 1.4)

    def place(self, positions: Array, angles: Array) -> Points:
        """Every part's points for bodies at positions (..., bodies, 2) [m] and angles (..., bodies) [rad].

        Returns fixed-point coordinates, shape (..., points, 2).
        """
        c, s = np.cos(angles)[..., self._owners], np.sin(angles)[..., self._owners]
        x, y = self._points[:, 0], self._points[:, 1]
        world = positions[..., self._owners, :] + np.stack([c * x - s * y, s * x + c * y], axis=-1)
        return fixed(self.camera.pixels(world))

    def visible(self, placed: Points) -> NDArray[np.bool_]:
        """Which parts are in the picture, shape (..., parts), placed at (..., points, 2)."""
        if not self.parts:
            return np.zeros((*placed.shape[:-2], 0), bool)
        low, high = self._extent(placed)
        limit = np.array(self.camera.size) * ONE
        return np.asarray(np.all((high > 0) & (low < limit), axis=-1))

    def _extent(self, placed: Points) -> tuple[Points, Points]:
        """Least and greatest coordinates of every part, shape (..., parts, 2), smoothed edges included."""
        starts = [where.start for where in self._slices]
        around = np.array([part.radius for part in self.parts], np.int32)[:, None] + SMOOTH * ONE
        low = np.minimum.reduceat(placed, starts, axis=-2) - around
        return low, np.maximum.reduceat(placed, starts, axis=-2) + around

    def changes(self, placed: Points) -> NDArray[np.bool_]:
        """Whether each placed frame (n, points, 2) but the first looks different from the one before."""
        if not self.parts:
            return np.zeros(len(placed) - 1, bool)
        starts = [where.start for where in self._slices]
        moved = np.any(placed[1:] != placed[:-1], axis=2)
        parts_moved = np.logical_or.reduceat(moved, starts, axis=1)
        seen = self.visible(placed)
        return np.asarray(np.any(parts_moved & (seen[1:] | seen[:-1]), axis=1))

    def boxes(self, placed: Points) -> list[Box]:
        """For each placed frame (n, points, 2) a box of even sides around all parts in the picture."""
        if not self.parts:
            return [(0, 0, 0, 0)] * len(placed)
        limit = np.array(self.camera.size)
        low, high = (np.clip(x >> SHIFT, 0, limit) for x in self._extent(placed))
        seen = self.visible(placed)[..., None]
        low, high = np.where(seen, low, limit).min(axis=1), np.where(seen, high, 0).max(axis=1)
        corners = np.concatenate([low & ~1, (high + 2) & ~1], axis=1)
        return [
            (left, top, max(left, right), max(top, bottom)) for left, top, right, bottom in corners.tolist()
        ]

    def fill(self, canvas: Canvas, placed: Points, fade: float = 0.0) -> None:
        """Draw the parts where `place` put them, shape (points, 2); `fade` mixes in the paper's colour."""
        import cv2

        values = self._values(canvas.is_yuv, fade)
        for (plane, points, shift), colors in zip(canvas.views(placed), values, strict=False):
            for part, where, value in zip(self.parts, self._slices, colors, strict=True):
                if part.radius:
                    cv2.circle(
                        plane, points[where.start].tolist(), part.radius, value, -1, cv2.LINE_AA, shift
                    )
                elif part.convex:
                    cv2.fillConvexPoly(plane, points[where], value, cv2.LINE_AA, shift)
                else:
                    cv2.fillPoly(plane, [points[where]], value, cv2.LINE_AA, shift)

    def _values(self, yuv: bool, fade: float) -> list[list[Any]]:
        """Each plane's value for every part."""
        if (yuv, fade) not in self._paints:
            colors = [mix(part.color, self.style.paper, fade) for part in self.parts]
            paints = [paint(color, yuv) for color in colors]
            self._paints[yuv, fade] = [list(plane) for plane in zip(*paints, strict=True)]
        return self._paints[yuv, fade]

    def caption(self, canvas: Canvas, text: str) -> Box:
        """Write in the upper left corner; returns the box that was written on."""
        return self._write(canvas, text, (24 * self.unit, 20 * self.unit), 17)

    # ------------------------------------------------------------ what stands still

    def _draw_background(self, sketch: Sketch | None) -> Canvas:
        canvas = Canvas.plain(self.camera.size, self.style.paper)
        if sketch is not None:
            self._draw_ink(canvas, sketch)
        for k, body in enumerate(self.scene.bodies):
            if body.anchored:
                self._draw_anchored(canvas, k, body)
        for joint in self.scene.joints:
            self._draw_support(canvas, joint)
        self._draw_scale(canvas)
        self._draw_gravity(canvas)
        return canvas

    def _draw_ink(self, canvas: Canvas, sketch: Sketch) -> None:
        """The person's strokes, faintly, where they were drawn."""
        import cv2

        view = self.scene.view
        if view is None:
            return
        lines = [fixed(self.camera.page(s.points, view.pixels_per_metre)) for s in sketch.strokes]
        thick = max(1, round(self.unit))
        cv2.polylines(canvas.planes[0], lines, False, self.style.drawn[::-1], thick, cv2.LINE_AA, SHIFT)

    def _draw_anchored(self, canvas: Canvas, k: int, body: Body) -> None:
        """A pale body with the hatching that engineers draw for what is fixed."""
        filling, edge = self.body_paints(k)
        outline = self.camera.pixels(np.array(body.outline()))
        canvas.polygon(fixed(inset(outline, BLOOM)), edge)
        inner = fixed(inset(outline, BLOOM + self.line))
        canvas.polygon(inner, filling)
        self._hatch(canvas, inner, mix(self.colors[k], self.style.ink, 0.12))

    def _hatch(self, canvas: Canvas, outline: Points, color: RGB) -> None:
        """Stripes at 45 degrees within an outline (fixed-point)."""
        import cv2

        width, height = self.camera.size
        left, top = np.clip(outline.min(axis=0) // ONE - 1, 0, (width, height)).tolist()
        right, bottom = np.clip(outline.max(axis=0) // ONE + 2, 0, (width, height)).tolist()
        if right <= left or bottom <= top:
            return
        mask = np.zeros((bottom - top, right - left), np.uint8)
        cv2.fillPoly(mask, [outline - np.array([left, top], np.int32) * ONE], 255, cv2.LINE_AA, SHIFT)
        period = 11.0 * self.unit
        diagonal = np.arange(left + top, right + bottom) / math.sqrt(2)
        from_stripe = np.abs(diagonal % period - period / 2)
        profile = (np.clip(0.75 * self.unit + 0.5 - from_stripe, 0, 1) * 255).astype(np.uint8)
        # A pixel's stripe follows from its row plus its column: rows of the profile, each one further on.
        stripes = sliding_window_view(profile[: sum(mask.shape) - 1], mask.shape[1])
        striped: Any = cv2.multiply(mask, np.ascontiguousarray(stripes), scale=1 / 255)
        canvas.blend(striped, (left, top), color)

    def _draw_support(self, canvas: Canvas, joint: Joint) -> None:
        """A pivot on the background stands on the support of engineering drawings, a triangle."""
        if None not in joint.bodies:
            return
        x, y = self.camera.pixels(np.array(joint.position))
        u, ink = self.unit, self.style.ink
        half, tall = 15 * u, 24 * u
        triangle = np.array([[x, y], [x + half, y + tall], [x - half, y + tall]])
        canvas.polygon(fixed(inset(triangle, BLOOM)), ink)
        canvas.polygon(fixed(inset(triangle, BLOOM + self.line)), mix(self.style.paper, ink, 0.12))
        ends = np.array([[x - 1.5 * half, y + tall], [x + 1.5 * half, y + tall]])
        self._line(canvas, ends[0], ends[1], self.line, ink)
        for k in range(6):
            top = ends[0] + (ends[1] - ends[0]) * ((k + 0.7) / 6)
            self._line(canvas, top, top + np.array([-6, 8]) * u, 0.7 * self.line, ink)

    def _draw_scale(self, canvas: Canvas) -> None:
        """A bar of a round length, a tenth to a quarter of the picture's width."""
        width, height = self.camera.size
        metres = round_length(0.2 * width / self.camera.scale)
        u, ink = self.unit, mix(self.style.ink, self.style.paper, 0.15)
        left, bottom = 26 * u, height - 24 * u
        right = left + metres * self.camera.scale
        plate = np.full((round(48 * u), round(right - left + 28 * u)), 200, np.uint8)
        canvas.blend(plate, (round(left - 14 * u), round(bottom - 36 * u)), self.style.paper)
        self._line(canvas, np.array([left, bottom]), np.array([right, bottom]), self.line, ink)
        for x in (left, right):
            self._line(canvas, np.array([x, bottom - 5 * u]), np.array([x, bottom + 5 * u]), self.line, ink)
        self._write(canvas, length_label(metres), (left, bottom - 32 * u), 14)

    def _draw_gravity(self, canvas: Canvas) -> None:
        """The arrow of gravity in the upper right corner, or that there is none."""
        width = self.camera.size[0]
        u, ink = self.unit, mix(self.style.ink, self.style.paper, 0.15)
        g = np.array(self.scene.gravity) * (1, -1)
        size = float(np.hypot(*g))
        if size == 0:
            self._write(canvas, "no gravity", (width - 130 * u, 20 * u), 14)
            return
        along = g / size
        middle = np.array([width - 48 * u, 52 * u])
        tail, head = middle - along * 26 * u, middle + along * 26 * u
        across = np.array([-along[1], along[0]])
        neck = head - along * 15 * u
        self._line(canvas, tail, neck + along * u, 1.4 * self.line, ink)
        arrow = np.array([head, neck + across * 7.5 * u, neck - across * 7.5 * u])
        canvas.polygon(fixed(inset(arrow, BLOOM)), ink)
        beside = middle + np.array([-30 * u, -8 * u]) + (abs(along[0]) > 0.7) * np.array([24 * u, 26 * u])
        self._write(canvas, "g", (float(beside[0]), float(beside[1])), 14)

    def _line(self, canvas: Canvas, a: Array, b: Array, width: float, color: RGB) -> None:
        canvas.polygon(fixed(segment(a, b, max(width - 2 * BLOOM, 0.3))), color)

    def _write(self, canvas: Canvas, text: str, corner: tuple[float, float], height: float) -> Box:
        x, y = (2 * round(c / 2) for c in corner)
        mask = lettering(text, max(8, round(height * self.unit)))
        canvas.blend(mask, (x, y), self.style.ink)
        right, bottom = x + mask.shape[1], y + mask.shape[0]
        return (x, y, min(right, self.camera.size[0]), min(bottom, self.camera.size[1]))


def round_length(metres: float) -> float:
    """The longest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** math.floor(math.log10(metres))
    return next(n * power for n in (5, 2, 1) if n * power <= metres * (1 + 1e-9))


def length_label(metres: float) -> str:
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)):
        if metres >= size * (1 - 1e-9):
            return f"{metres / size:g} {unit}"
    return f"{metres:g} m"
