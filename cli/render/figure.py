"""A scene as a figure: what stands still is drawn once, what moves is a list of parts to fill."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cli.render.annotations import annotate, scale_bar
from cli.render.backdrop import backdrop
from cli.render.camera import Camera
from cli.render.canvas import BLOOM, ONE, SHIFT, THIN, Box, Canvas, Points, fixed, paint
from cli.render.ink import Ink
from cli.render.outline import inset, is_convex, rim, ring, segment
from cli.render.pen import Pen
from cli.render.style import RGB, Style, body_paints, mix
from sim.scene import Body, Circle, Joint, Scene

__all__ = ["Figure", "Part", "carried"]

Array = NDArray[np.float64]

COPY = 10_000  # pixels that are copied in the time that it takes to begin
SMOOTH = 4  # pixels that a smoothed edge may reach over the outline: two in the planes of half the resolution


@dataclass(frozen=True, eq=False)
class Part:
    """One fill or line of one colour that moves with a body.

    Attributes:
        body: index in the scene.
        points: in the body's frame [m], shape (n, 2); of a disc its centre alone.
        radius: of a disc [fixed-point pixels]; 0 for a polygon.
        thick: of an open line [pixels]; 0 for what is filled.
    """

    body: int
    points: Array
    color: RGB
    radius: int = 0
    convex: bool = True
    thick: int = 0


class Figure:
    """A scene, ready to be drawn at any poses.

    The background holds all that never moves: paper, the ink as drawn, anchored bodies, scale, gravity.

    size: of the picture [pixels], where the camera takes in more than one picture shows (see follow).
    """

    def __init__(
        self,
        scene: Scene,
        camera: Camera,
        style: Style,
        ink: Ink | None = None,
        size: tuple[int, int] | None = None,
    ) -> None:
        self.scene, self.camera, self.style = scene, camera, style
        self.pen = Pen(style, size or camera.size)
        self.paints = body_paints(scene, style)
        ink = ink or []
        still = [stroke for body, stroke in ink if body is None]
        moved = [(body, stroke) for body, stroke in ink if body is not None]
        self.parts = [
            part for k, body in enumerate(scene.bodies) if not body.anchored for part in self._body(k)
        ]
        if style.moves_ink:
            self.parts += [self._stroke(k, stroke) for k, stroke in moved]
        if not (style.moves_ink and moved):
            self.parts += [part for joint in scene.joints for part in self._pivot(joint)]
        self._points = np.concatenate([part.points for part in self.parts] or [np.zeros((0, 2))])
        lengths = [len(part.points) for part in self.parts]
        self._owners = np.repeat([part.body for part in self.parts], lengths).astype(int)
        ends = np.cumsum(lengths).tolist()
        self._slices = [slice(end - length, end) for length, end in zip(lengths, ends, strict=True)]
        self._paints: dict[tuple[bool, float], list[list[Any]]] = {}
        # What lies in a corner of a camera that follows a body changes all the time: any is as good.
        followed = size is not None
        drawn = [stroke for _, stroke in ink]
        self.bar = scale_bar(Scene() if followed else scene, camera, self.pen, () if followed else drawn)
        self.background = backdrop(scene, camera, self.pen, still, [stroke for _, stroke in moved])
        if size is None:
            self.annotate(self.background)

    def annotate(self, canvas: Canvas) -> None:
        """The scale bar and gravity."""
        annotate(canvas, self.scene.gravity, self.bar, self.pen)

    def caption(self, canvas: Canvas, text: str) -> Box:
        """Write in the upper left corner; returns the box that was written on."""
        return self.pen.write(canvas, text, (24 * self.pen.unit, 20 * self.pen.unit), 17)

    def _body(self, k: int) -> list[Part]:
        """Outline, filling and, on a disc, the mark that shows it turning."""
        shape, paints = self.scene.bodies[k].shape, self.paints[k]
        line = 0.0 if self.style.moves_ink else self.pen.width
        if isinstance(shape, Circle):
            return self._disc(k, shape.radius, line)
        v = np.array(shape.vertices)
        convex = is_convex(v)
        pixel = 1 / self.camera.scale
        if line > THIN and not convex:
            # cv2 smooths the sides of convex polygons alone well: a concave one's outline is put on in pieces.
            sides = rim(v, BLOOM * pixel, (line - BLOOM) * pixel)
            filling = Part(k, inset(v, (line / 2 + BLOOM) * pixel), paints.filling, convex=False)
            return [filling, *(Part(k, side, paints.edge) for side in sides)]
        parts = []
        if line:
            parts.append(Part(k, inset(v, BLOOM * pixel), paints.edge, convex=convex))
        return [*parts, Part(k, inset(v, (BLOOM + line) * pixel), paints.filling, convex=convex)]

    def _disc(self, k: int, radius: float, line: float) -> list[Part]:
        paints, middle, pixels = self.paints[k], np.zeros((1, 2)), radius * self.camera.scale
        outer, inner = (max(1, round((pixels - d) * ONE)) for d in (BLOOM, BLOOM + line))
        parts = [Part(k, middle, paints.edge, outer)] if line else []
        if pixels > 1.5 * line:
            parts.append(Part(k, middle, paints.filling, inner))
        width = max(self.pen.width - 2 * BLOOM, 0.4)
        if pixels > 3 * self.pen.width:
            end = radius - self.pen.width / self.camera.scale
            mark = segment(np.zeros(2), np.array([end, 0.0]), width / self.camera.scale)
            parts.append(Part(k, mark, paints.edge))
        return parts

    def _stroke(self, k: int, stroke: Array) -> Part:
        """A stroke of the person's, in the frame of the body that takes it along."""
        return Part(
            k, carried(self.scene.bodies[k], stroke), self.style.ink, thick=max(1, round(self.pen.unit))
        )

    def _pivot(self, joint: Joint) -> list[Part]:
        """Rings about the pivot, on whichever of its bodies moves; none where nothing moves."""
        moving = [k for k, b in enumerate(self.scene.bodies) if b.id in joint.bodies and not b.anchored]
        if not moving:
            return []
        u, style = self.pen.unit, self.style
        at = carried(self.scene.bodies[moving[0]], np.array([joint.position]))
        radii = (7.0 * u + 0.5, 7.0 * u + 0.5 - self.pen.width, max(2.4 * u, 1.4))
        rings = zip(radii, (style.ink, style.paper, style.ink), strict=True)
        # Polygons: cv2's circles of a few pixels are squares and crosses.
        return [
            Part(moving[0], at + ring(max(r - BLOOM, 0.5)) / self.camera.scale, color) for r, color in rings
        ]

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
        seen = self.visible(placed)
        moved = self.differences(placed[1:], placed[:-1]) > 0
        return np.asarray(np.any(moved & (seen[1:] | seen[:-1]), axis=1))

    def differences(self, placed: Points, other: Points) -> Points:
        """How far each part's farthest point lies between two placings (..., points, 2), by column or row."""
        starts = [where.start for where in self._slices]
        return np.maximum.reduceat(np.abs(placed - other).max(axis=-1), starts, axis=-1)

    def live(self, placed: Points) -> list[int]:
        """The parts that placed frames (n, points, 2) cannot share: those that move, and what lies over them.

        All others may be drawn once, under these.
        """
        starts = [where.start for where in self._slices]
        if not starts:
            return []
        moving = np.logical_or.reduceat((placed != placed[0]).any(axis=(0, 2)), starts)
        low, high = self._extent(placed)
        low, high = low.min(axis=0), high.max(axis=0)
        live = np.zeros(len(starts), bool)
        for i in range(len(starts)):
            below = live[:i] & np.all((low[:i] < high[i]) & (high[:i] > low[i]), axis=1)
            live[i] = moving[i] or below.any()
        return np.flatnonzero(live).tolist()

    def boxes(self, placed: Points, parts: Sequence[int]) -> list[list[Box]]:
        """For each placed frame (n, points, 2) boxes of even sides that hold some parts, as far as in the picture.

        One box a body, or one for all where that is less to copy.
        """
        if not parts:
            return [[] for _ in placed]
        limit = np.array(self.camera.size)
        chosen = sorted(parts, key=lambda i: self.parts[i].body)
        owners = np.array([self.parts[i].body for i in chosen])
        starts = np.flatnonzero(np.diff(owners, prepend=-1))
        low, high = (x[:, chosen] >> SHIFT for x in self._extent(placed))
        low, high = np.minimum.reduceat(low, starts, axis=1), np.maximum.reduceat(high, starts, axis=1)
        seen = np.all((high >= 0) & (low < limit), axis=-1)
        low = np.where(seen[..., None], low.clip(0) & ~1, limit)
        high = np.where(seen[..., None], (high.clip(max=limit) + 2) & ~1, 0)
        all_low, all_high = low.min(axis=1), high.max(axis=1)
        apart = ((high - low).clip(0).prod(axis=-1) + COPY * seen).sum(axis=1)
        together = (all_high - all_low).clip(0).prod(axis=-1) + COPY
        each = np.concatenate([low, high], axis=-1)
        whole = np.concatenate([all_low, all_high], axis=-1)
        return [
            [tuple(box) for box in (each[k][seen[k]] if apart[k] < together[k] else whole[k, None]).tolist()]
            for k in range(len(placed))
        ]

    def fill(
        self, canvas: Canvas, placed: Points, fade: float = 0.0, only: Sequence[int] | None = None
    ) -> None:
        """Draw the parts where `place` put them, shape (points, 2); `fade` mixes in the paper's colour.

        only: the parts to draw, by their indices.
        """
        import cv2

        values = self._values(canvas.is_yuv, fade)
        for (plane, points, shift), colors in zip(canvas.views(placed), values, strict=False):
            for i in range(len(self.parts)) if only is None else only:
                part, where, value = self.parts[i], self._slices[i], colors[i]
                if part.thick:
                    cv2.polylines(plane, [points[where]], False, value, part.thick, cv2.LINE_AA, shift)
                elif part.radius:
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


def carried(body: Body, world: Array) -> Array:
    """World points (n, 2) [m] in the frame of a body as the scene has it."""
    c, s = math.cos(body.angle), math.sin(body.angle)
    local: Array = (world - np.array(body.position)) @ np.array([[c, -s], [s, c]])
    return local
