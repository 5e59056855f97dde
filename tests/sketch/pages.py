"""Pages of made-up ink for the tests: shapes by several hands, and what they should be read as."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sketch import Recognition, Sketch, Stroke, recognize
from sketch.page.pieces import Page
from sketch.synthetic import HANDS, Hand, arrow, circle, cross, outline

Array = NDArray[np.float64]
Point = tuple[float, float]


def box(x: float, y: float, width: float, height: float, angle: float = 0.0) -> list[Point]:
    """Corners of a rectangle about (x, y)."""
    return turned(
        [
            (-width / 2, -height / 2),
            (width / 2, -height / 2),
            (width / 2, height / 2),
            (-width / 2, height / 2),
        ],
        angle,
        (x, y),
    )


def ngon(n: int, x: float, y: float, radius: float, angle: float = 0.3) -> list[Point]:
    return [
        (
            x + radius * math.cos(angle + 2 * math.pi * k / n),
            y + radius * math.sin(angle + 2 * math.pi * k / n),
        )
        for k in range(n)
    ]


def turned(points: list[Point], angle: float, to: Point = (0.0, 0.0)) -> list[Point]:
    c, s = math.cos(angle), math.sin(angle)
    return [(to[0] + c * x - s * y, to[1] + s * x + c * y) for x, y in points]


def page(*shapes: list[Array], **keys: float) -> Sketch:
    """A sketch of shapes' strokes in order, without times."""
    return Sketch(
        [Stroke(points) for shape in shapes for points in shape],
        **({"width": 1280.0, "height": 720.0} | keys),
    )


def measured(sketch: Sketch) -> Page:
    """The ink of a sketch as the recognizer sees it, none of its strokes loose."""
    ink = Page(math.hypot(sketch.width or 0.0, sketch.height or 0.0))
    ink.add([s.points for s in sketch.strokes])
    ink.settle()
    return ink


def read(*shapes: list[Array]) -> Recognition:
    return recognize(page(*shapes))


def kinds(recognition: Recognition) -> list[str]:
    """What was read: each reading's kind, a polygon with its sides."""
    return sorted(
        f"{len(r.outline)}-gon" if r.kind in ("rectangle", "polygon") else r.kind
        for r in recognition.readings
    )


def pendulum(hand: Hand, rng: np.random.Generator) -> Sketch:
    """Beam b1 with an X, rod b2 hanging on a pivot, gravity down."""
    return page(
        outline(box(640, 110, 340, 70), hand, rng),
        cross((540, 110), 40, hand, rng),
        outline(box(640, 250, 44, 300), hand, rng),
        circle((640, 118), 11, hand, rng),
        arrow((80, 200), (84, 330), hand, rng),
    )


def cart(hand: Hand, rng: np.random.Generator) -> Sketch:
    """Ground b1 with an X, frame b2, wheels b3 and b4 that cross its lower side, two pivots, gravity down."""
    shapes = [
        outline(box(640, 640, 950, 70), hand, rng),
        cross((700, 640), 42, hand, rng),
        outline(box(600, 480, 320, 100), hand, rng),
    ]
    for x in (500, 700):
        shapes += [circle((x, 520), 46, hand, rng), circle((x, 520), 10, hand, rng)]
    return page(*shapes, arrow((80, 200), (78, 330), hand, rng))


def stack(hand: Hand, rng: np.random.Generator) -> Sketch:
    """Ground b1 with an X, three boxes that touch, a ball, gravity down."""
    return page(
        outline(box(640, 640, 800, 66), hand, rng),
        cross((640, 640), 40, hand, rng),
        outline(box(640, 563, 160, 84), hand, rng),
        outline(box(645, 481, 130, 76), hand, rng),
        outline(box(638, 401, 150, 80), hand, rng),
        circle((930, 570), 36, hand, rng),
        arrow((80, 200), (80, 330), hand, rng),
    )


def machines() -> list[tuple[str, Sketch, int, int]]:
    """Each machine by each hand that draws clearly: name, sketch, bodies, joints."""
    out = []
    for name in ("neat", "quick", "pieces"):
        for k, (machine, bodies, joints) in enumerate(((pendulum, 2, 1), (cart, 4, 2), (stack, 5, 0))):
            for seed in range(4):
                sketch = machine(HANDS[name], np.random.default_rng([k, seed]))
                out.append((f"{machine.__name__}-{name}-{seed}", sketch, bodies, joints))
    return out
