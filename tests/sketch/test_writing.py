"""Words, numbers and dimension lines beside a machine: no letter is a body, and nothing else is changed by them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import box, page, read
from test_machines import cart, meaning

from sim.scene import Circle
from sketch.ink import Sketch, Stroke
from sketch.recognize import recognize
from sketch.synthetic import HANDS, arrow, circle, line, outline

Array = np.ndarray
Path = list[tuple[float, float]]
HAND = HANDS["neat"]


def arc(x: float, y: float, a: float, b: float, first: float, last: float) -> Path:
    """Part of an ellipse with half axes a and b; angles in degrees, clockwise as y goes down."""
    t = np.radians(np.linspace(first, last, 24))
    return [(x + a * math.cos(u), y + b * math.sin(u)) for u in t]


LETTERS: dict[str, list[Path]] = {
    "0": [arc(0.3, 0.5, 0.22, 0.5, -90, -450)],
    "1": [[(0.1, 0.2), (0.3, 0), (0.3, 1)]],
    "N": [[(0.05, 1), (0.05, 0), (0.5, 1), (0.5, 0)]],
    "a": [arc(0.25, 0.75, 0.2, 0.25, -30, -390), [(0.45, 0.5), (0.47, 1)]],
    "e": [[(0.08, 0.75), (0.5, 0.75), *arc(0.3, 0.75, 0.2, 0.25, 0, -310)]],
    "h": [[(0.1, 0), (0.1, 1)], [(0.1, 0.7), *arc(0.28, 0.72, 0.17, 0.22, -180, 0), (0.45, 1)]],
    "l": [[(0.25, 0), (0.25, 1)]],
    "m": [[(0.0, 0.5), (0.0, 1)], [(0.0, 0.66), *arc(0.3, 0.66, 0.13, 0.16, -180, 0), (0.43, 1)]],
    "o": [arc(0.28, 0.75, 0.2, 0.25, -90, -455)],
    "p": [[(0.1, 0.5), (0.1, 1.35)], arc(0.1, 0.75, 0.28, 0.25, -90, 90)],
    "s": [[*arc(0.28, 0.62, 0.17, 0.12, -30, -270), *arc(0.28, 0.87, 0.17, 0.13, -90, 150)]],
    "v": [[(0.06, 0.5), (0.26, 1), (0.46, 0.5)]],
    " ": [],
}


def word(text: str, x: float, y: float, height: float, rng: np.random.Generator) -> list[Array]:
    strokes = []
    for k, letter in enumerate(text):
        for path in LETTERS[letter]:
            at = [(x + height * (0.75 * k + u), y + height * v) for u, v in path]
            strokes += line(at, HAND, rng)
    return strokes


@pytest.mark.parametrize("text", ["hello", "10 N", "v0", "mass", "slope", "100 m"])
@pytest.mark.parametrize("height", [20, 40])
@pytest.mark.parametrize("angle", [0.0, 1.1])
def test_a_word_beside_a_machine_is_no_body(text: str, height: float, angle: float) -> None:
    rng = np.random.default_rng(len(text))
    sketch = cart(HAND, rng)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    first = len(sketch.strokes)
    beside = [
        p @ turn for p in [*(q.points[:, :2] for q in sketch.strokes), *word(text, 980, 120, height, rng)]
    ]
    seen = recognize(Sketch([Stroke(p) for p in beside]))
    assert meaning(seen) == meaning(recognize(sketch))
    assert all(max(b.strokes) < first for b in seen.scene.bodies)
    notes = " ".join(seen.scene.notes)
    assert all(str(k) in notes for k in range(first, len(beside)))


@pytest.mark.parametrize("radius", [12, 30])
def test_small_balls_beside_one_another_are_balls(radius: float) -> None:
    """Rings alone are no writing, and a long line beside them makes them none."""
    rng = np.random.default_rng(3)
    rings = [circle((500 + 2.5 * radius * k, 300), radius, HAND, rng) for k in range(4)]
    ground = line([(300, 300 + 1.5 * radius), (900, 300 + 1.5 * radius)], HAND, rng)
    scene = read(*rings, ground).scene
    assert sum(isinstance(b.shape, Circle) for b in scene.bodies) == 4


@pytest.mark.parametrize("ends", ["bars", "heads"])
@pytest.mark.parametrize("seed", range(3))
def test_a_dimension_line_is_no_rod(ends: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    body = outline(box(600, 400, 240, 120), HANDS["quick"], rng) + arrow((150, 200), (150, 340), HAND, rng)
    measure = line([(480, 540), (720, 540)], HAND, rng)
    for x, inward in ((480, 14), (720, -14)):
        if ends == "bars":
            measure += line([(x, 528), (x, 552)], HAND, rng)
        else:
            measure += line([(x + inward, 531), (x, 540), (x + inward, 549)], HAND, rng)
    assert len(read(body).scene.bodies) == 1
    scene = read(body, measure, word("1 m", 590, 560, 26, rng)).scene
    assert len(scene.bodies) == 1
    assert scene.gravity[1] < -9
    rod = read(body, measure[:1]).scene  # without its marks it is one
    assert len(rod.bodies) == 2


@pytest.mark.parametrize("seed", range(4))
def test_hatching_under_a_box_leaves_its_corners_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = box(640, 500, 900, 60)
    sides = [line([a, b], HAND, rng)[0] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    hatching = [line([(x, 534), (x - 18, 556)], HAND, rng)[0] for x in np.linspace(200, 1085, 24)]
    scene = recognize(page(sides, hatching)).scene
    assert [len(b.outline()) for b in scene.bodies] == [4]


def test_eyes_in_a_ball_are_no_pivots() -> None:
    rng = np.random.default_rng(5)
    face = circle((500, 300), 45, HAND, rng)
    eyes = [*circle((486, 286), 5, HAND, rng), *circle((514, 286), 5, HAND, rng)]
    floor = outline(box(640, 500, 900, 60), HAND, rng)
    scene = read(floor, face, eyes, line(arc(500, 305, 22, 22, 20, 160), HAND, rng)).scene
    assert (len(scene.bodies), scene.joints) == (2, [])
