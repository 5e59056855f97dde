"""Readings of bodies as shapes in metres, and questions about outlines on the page."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim.scene import Body, Circle, Polygon, Rectangle
from sketch import kernel
from sketch.kernel import depth, is_simple
from sketch.lazy import lazy
from sketch.page.near import Boxes, boxes_around
from sketch.reading import Reading
from sketch.typing import Array, Point

__all__ = ["Bodies", "Drawn", "draw_body", "ids", "thick", "touch"]

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

    @lazy
    def middle(self) -> Point:
        """Of its corners: of a circle its centre [pixels]."""
        x, y = (np.add.reduce(self.outline, axis=0) / len(self.outline)).tolist()
        return x, y

    @property
    def radius(self) -> float:
        """Of a circle, or of one as large [pixels]."""
        return self.size / math.sqrt(math.pi)

    def depth(self, point: Point) -> float:
        """Distance of a point from the outline [pixels], negative inside."""
        return depth(*point, self.outline)


class Bodies:
    """All bodies of a page, to be asked which of them are at a place."""

    def __init__(self, drawn: list[Drawn]) -> None:
        self.drawn = drawn
        self._boxes = Boxes(boxes_around([d.outline for d in drawn]))

    def near(self, at: Point, reach: float) -> list[Drawn]:
        """Those whose bounding box, widened by `reach` [pixels], has the point, in order of drawing."""
        x, y = at
        return [self.drawn[k] for k in self._boxes.touching((x - reach, y - reach, x + reach, y + reach))]


def draw_body(reading: Reading, number: int, pixels_per_metre: float, pen: float) -> Drawn:
    """The body of a reading: x = px / ppm, y = -py / ppm; its vertices about its centroid."""
    outline = np.ascontiguousarray(reading.outline)
    if reading.kind == "bar":
        outline = thick(outline, pen)
        if not is_simple(outline):  # a line that turns within its own thickness
            outline = thick(reading.outline[[0, -1]], pen)
    world = [complex(x, -y) / pixels_per_metre for x, y in outline.tolist()]
    angle = 0.0
    area, middle = _moments(world)
    shape: Circle | Rectangle | Polygon
    if reading.kind == "circle":
        middle = sum(world) / len(world)
        shape = Circle(sum(abs(z - middle) for z in world) / len(world))
    elif len(world) == 4 and reading.kind in ("rectangle", "bar"):
        middle = sum(world) / 4
        along = world[1] - world[0]
        sides = abs(along), abs(world[2] - world[1])
        angle = cmath.phase(along)
        quarter = round(angle / (math.pi / 2))  # as upright as a rectangle can be said
        angle -= quarter * math.pi / 2
        shape = Rectangle((sides[1], sides[0]) if quarter % 2 else sides)
    else:
        local = [(z.real - middle.real, z.imag - middle.imag) for z in world]
        if area < 0:
            local.reverse()
        shape = Polygon(local)
    body = Body(
        id=f"b{number}",
        shape=shape,
        position=(middle.real, middle.imag),
        angle=angle,
        color=PALETTE[(number - 1) % len(PALETTE)],
        strokes=list(reading.strokes),
        score=round(reading.score, 4),
    )
    size = (
        float(np.ptp(outline, axis=0).max())
        if reading.kind == "bar"
        else pixels_per_metre * math.sqrt(abs(area))
    )
    return Drawn(reading, outline, size, body)


def touch(a: Drawn, b: Drawn, ring: Drawn) -> bool:
    """Whether two bodies overlap, or are less than a ring's radius apart, within some radii of its middle."""
    return kernel.touch(a.outline, b.outline, ring.middle, 5 * ring.radius, ring.radius)


def ids(bodies: list[Drawn]) -> str:
    """Bodies as a note names them."""
    *most, last = [d.body.id for d in bodies]
    return f"{', '.join(most)} and {last}" if most else last


def _moments(corners: list[complex]) -> tuple[float, complex]:
    """The signed area and the centroid of a polygon, by the shoelace formula about its first corner."""
    area, first = 0.0, 0j
    at = corners[0]
    for a, b in pairwise(corners[1:]):
        twice = ((a - at).conjugate() * (b - at)).imag
        area += twice / 2
        first += twice * (a + b - 2 * at) / 6
    return area, at + first / area if area else sum(corners) / len(corners)


def thick(line: Array, pen: float) -> Array:
    """A polyline as an outline of the pen's width, mitred at its corners."""
    steps = np.diff(line, axis=0)
    u = steps / np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 1e-9)[:, None]
    normals = np.stack([-u[:, 1], u[:, 0]], axis=1)
    mitre = np.concatenate([normals[:1], normals[:-1] + normals[1:], normals[-1:]])
    mitre[1:-1] /= np.maximum((mitre[1:-1] ** 2).sum(axis=1), 0.5)[:, None] / 2
    side = mitre * pen / 2
    return np.ascontiguousarray(np.concatenate([line + side, (line - side)[::-1]]))
