"""Readings of bodies as shapes in metres, and questions about outlines on the page."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.scene import Body, Circle, Polygon, Rectangle
from sketch.kernel import depth, is_simple
from sketch.reading import Reading

__all__ = ["Drawn", "draw_body", "touch"]

Array = NDArray[np.float64]

# After Okabe and Ito, and Tol: told apart by colour-blind readers, and by their lightness in print.
PALETTE = [
    *("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee"),
    *("#aa3377", "#e69f00", "#44aa99", "#882255", "#997700"),
]


@dataclass(eq=False)
class Drawn:
    """A body as it lies on the page.

    Attributes:
        outline: closed, of a bar as thick as the pen, [pixels], (n, 2).
        size: square root of the area; of a bar its length [pixels].
    """

    reading: Reading
    outline: Array
    size: float
    body: Body

    def depth(self, point: Array) -> float:
        """Distance of a point from the outline [pixels], negative inside."""
        return depth(float(point[0]), float(point[1]), self.outline)


def draw_body(reading: Reading, number: int, pixels_per_metre: float, pen: float) -> Drawn:
    """The body of a reading: x = px / ppm, y = -py / ppm; its vertices about its centroid."""
    outline = np.ascontiguousarray(reading.outline)
    if reading.kind == "bar":
        outline = _thick(outline, pen)
        if not is_simple(outline):  # a line that turns within its own thickness
            outline = _thick(reading.outline[[0, -1]], pen)
    world = outline * (np.array([1.0, -1.0]) / pixels_per_metre)
    angle = 0.0
    shape: Circle | Rectangle | Polygon
    if reading.kind == "circle":
        centre = world.mean(axis=0)
        shape = Circle(float(np.hypot(*(world - centre).T).mean()))
    elif len(outline) == 4 and reading.kind in ("rectangle", "bar"):
        centre = world.mean(axis=0)
        (ax, ay), (bx, by) = (world[1] - world[0]).tolist(), (world[2] - world[1]).tolist()
        sides = math.hypot(ax, ay), math.hypot(bx, by)
        angle = math.atan2(ay, ax)
        quarter = round(angle / (math.pi / 2))  # as upright as a rectangle can be said
        angle -= quarter * math.pi / 2
        shape = Rectangle((sides[1], sides[0]) if quarter % 2 else sides)
    else:
        centre = _centroid(world)
        local = (world - centre).tolist()
        if _area(world) < 0:
            local.reverse()
        shape = Polygon([(x, y) for x, y in local])
    body = Body(
        id=f"b{number}",
        shape=shape,
        position=(float(centre[0]), float(centre[1])),
        angle=angle,
        color=PALETTE[(number - 1) % len(PALETTE)],
        strokes=list(reading.strokes),
        score=round(reading.score, 4),
    )
    size = float(np.ptp(outline, axis=0).max()) if reading.kind == "bar" else math.sqrt(abs(_area(outline)))
    return Drawn(reading, outline, size, body)


def touch(a: Drawn, b: Drawn, at: Array, radius: float) -> bool:
    """Whether two bodies overlap, or are less than `radius` apart, within some radii of a point."""
    steps = np.linspace(0, 1, 64, endpoint=False)[:, None, None]
    for one, other in ((a, b), (b, a)):
        along = np.roll(one.outline, -1, axis=0) - one.outline
        dense = (one.outline + steps * along).reshape(-1, 2)
        close = dense[np.hypot(dense[:, 0] - at[0], dense[:, 1] - at[1]) < 5 * radius]
        if any(other.depth(p) < radius for p in close):
            return True
    return False


def _area(p: Array) -> float:
    """Signed, by the shoelace formula."""
    x, y = p[:, 0] - p[0, 0], p[:, 1] - p[0, 1]
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _centroid(p: Array) -> Array:
    x, y = p[:, 0] - p[0, 0], p[:, 1] - p[0, 1]
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    total = 3 * float(cross.sum())
    if total == 0:
        return np.asarray(p.mean(axis=0))
    cx = float(((x + np.roll(x, -1)) * cross).sum()) / total
    cy = float(((y + np.roll(y, -1)) * cross).sum()) / total
    return np.asarray(p[0] + [cx, cy])


def _thick(line: Array, pen: float) -> Array:
    """A polyline as an outline of the pen's width, mitred at its corners."""
    steps = np.diff(line, axis=0)
    u = steps / np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 1e-9)[:, None]
    normals = np.stack([-u[:, 1], u[:, 0]], axis=1)
    mitre = np.concatenate([normals[:1], normals[:-1] + normals[1:], normals[-1:]])
    mitre[1:-1] /= np.maximum((mitre[1:-1] ** 2).sum(axis=1), 0.5)[:, None] / 2
    side = mitre * pen / 2
    return np.ascontiguousarray(np.concatenate([line + side, (line - side)[::-1]]))
