"""Readings of bodies as shapes in metres, and questions about outlines on the page."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim.scene import Body, Circle, Polygon, Rectangle
from sketch import kernel
from sketch.ink import Stroke
from sketch.kernel import depth, is_simple
from sketch.lazy import lazy
from sketch.page.near import Boxes, boxes_around
from sketch.reading import Reading
from sketch.typing import Array, Box, Point

__all__ = ["Bodies", "Drawn", "body", "drawn_body", "ids", "thick", "touch"]

# After Okabe and Ito, and Tol: told apart by colour-blind readers, and by their lightness in print.
PALETTE = [
    *("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee"),
    *("#aa3377", "#e69f00", "#44aa99", "#882255", "#997700"),
]


@dataclass(eq=False)
class Drawn:
    """A body as it lies on the page. Never changed once it is made.

    Attributes:
        kind, forced: of its reading.
        ink: its strokes, in the order of drawing.  last: the last one's key: of what is drawn later it is greater.
        line: its reading's outline [pixels], (n, 2).
        outline: the same, closed, of a bar as thick as the pen.
        box: around that, and the ink of a bar, which bends beside its line: least x and y, greatest x and y.
        size: square root of the area; of a bar its length [pixels].
        shape, position, angle: as of a `Body`.
    """

    kind: str
    forced: str | None
    ink: tuple[Stroke, ...]
    last: int
    line: Array
    outline: Array
    box: Box
    size: float
    shape: Circle | Rectangle | Polygon
    position: Point
    angle: float

    @lazy
    def middle(self) -> Point:
        """Of its corners: of a circle its centre [pixels]."""
        x, y = (np.add.reduce(self.outline, axis=0) / len(self.outline)).tolist()
        return x, y

    @lazy
    def radius(self) -> float:
        """Of a circle, or of one as large [pixels]."""
        return self.size / math.sqrt(math.pi)

    def depth(self, point: Point) -> float:
        """Distance of a point from the outline [pixels], negative inside."""
        return depth(*point, self.outline)

    def off_ink(self, point: Point) -> float:
        """Distance of a point from the ink that it was drawn with [pixels]."""
        inks = (stroke.points[:, :2] for stroke in self.ink)
        there_and_back = (np.concatenate([ink, ink[-2:0:-1]]) for ink in inks)  # closed, around nothing
        return min((abs(depth(*point, ink)) for ink in there_and_back), default=math.inf)


class Bodies:
    """Bodies in the order of drawing, to be asked which of them are at a place.

    Attributes:
        pins: of the circles, those that are pivots, and no bodies.
        fixed: those that are anchored.
    """

    def __init__(
        self, drawn: Sequence[Drawn], pins: Iterable[Drawn] = (), fixed: Iterable[Drawn] = ()
    ) -> None:
        self.drawn, self.pins, self.fixed = drawn, set(pins), set(fixed)
        self._boxes = Boxes(np.array([d.box for d in drawn]).reshape(-1, 4))

    def near(self, at: Point, reach: float) -> list[Drawn]:
        """Those whose bounding box, widened by `reach` [pixels], has the point, in order of drawing."""
        return [self.drawn[k] for k in self.numbers(at, reach)]

    def numbers(self, at: Point, reach: float) -> list[int]:
        """Likewise, as numbers."""
        x, y = at
        return self._boxes.touching((x - reach, y - reach, x + reach, y + reach))


def drawn_body(
    kind: str,
    forced: str | None,
    ink: tuple[Stroke, ...],
    last: int,
    corners: bytes,
    pixels_per_metre: float,
    pen: float,
) -> Drawn:
    """The body of a reading: x = px / ppm, y = -py / ppm; its vertices about its centroid.

    kind, forced, ink, last: as of `Drawn`.  corners: of the reading's outline, as an array has them.
    """
    line = np.frombuffer(corners).reshape(-1, 2).copy()
    outline = line
    if kind == "bar":
        # a line that turns within its own thickness is thinner
        tried = (thick(line, pen / thinner) for thinner in (1, 2, 4, 8))
        outline = next(filter(is_simple, tried), thick(line[[0, -1]], pen))
    world = [complex(x, -y) / pixels_per_metre for x, y in outline.tolist()]
    angle = 0.0
    area, middle = _moments(world)
    shape: Circle | Rectangle | Polygon
    if kind == "circle":
        middle = sum(world) / len(world)
        shape = Circle(sum(abs(z - middle) for z in world) / len(world))
    elif len(world) == 4 and kind in ("rectangle", "bar"):
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
    size = float(np.ptp(outline, axis=0).max()) if kind == "bar" else pixels_per_metre * math.sqrt(abs(area))
    around = [outline, *(stroke.points[:, :2] for stroke in ink if kind == "bar")]
    ((x0, y0, x1, y1),) = boxes_around([np.concatenate(around)]).tolist()
    position = middle.real, middle.imag
    return Drawn(kind, forced, ink, last, line, outline, (x0, y0, x1, y1), size, shape, position, angle)


def body(d: Drawn, name: str, number: int, reading: Reading, anchored: bool) -> Body:
    """What is drawn, as a body of a scene. number: among all that may be one, from 1."""
    return Body(
        id=name,
        shape=Polygon(list(d.shape.vertices)) if isinstance(d.shape, Polygon) else d.shape,
        position=d.position,
        angle=d.angle,
        anchored=anchored,
        color=PALETTE[(number - 1) % len(PALETTE)],
        strokes=list(reading.strokes),
        score=round(reading.score, 4),
    )


def touch(a: Drawn, b: Drawn, ring: Drawn) -> bool:
    """Whether two bodies overlap, or are less than a ring's radius apart, within some radii of its middle."""
    return kernel.touch(a.outline, b.outline, ring.middle, 5 * ring.radius, ring.radius)


def ids(names: Sequence[str]) -> str:
    """Bodies as a note names them."""
    *most, last = names
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
