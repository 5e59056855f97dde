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
from sketch.synthetic import HANDS, arrow, circle, cross, line, outline

THIRTY, THETA = "30°", "θ"
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
    "2": [
        [*arc(0.28, 0.25, 0.2, 0.25, -160, 30), (0.1, 0.95), (0, 1), (-0.05, 0.9), (0.06, 0.82), (0.55, 1)]
    ],
    "3": [[*arc(0.28, 0.26, 0.2, 0.26, -140, 80), *arc(0.28, 0.74, 0.24, 0.26, -80, 140)]],
    "4": [[(0.35, 0), (0.05, 0.65), (0.55, 0.65)], [(0.42, 0.35), (0.42, 1)]],
    "=": [[(0.05, 0.45), (0.5, 0.45)], [(0.05, 0.7), (0.5, 0.7)]],
    "°": [arc(0.15, 0.1, 0.1, 0.1, -90, -450)],
    "θ": [arc(0.3, 0.5, 0.25, 0.5, -90, -450), [(0.06, 0.5), (0.54, 0.5)]],
    "A": [[(0.02, 1), (0.3, 0), (0.58, 1)], [(0.13, 0.62), (0.48, 0.62)]],
    "D": [[(0.08, 0), (0.08, 1)], [(0.08, 0), *arc(0.12, 0.5, 0.45, 0.5, -90, 90), (0.08, 1)]],
    "N": [[(0.05, 1), (0.05, 0), (0.5, 1), (0.5, 0)]],
    "a": [arc(0.25, 0.75, 0.2, 0.25, -30, -390), [(0.45, 0.5), (0.47, 1)]],
    "e": [[(0.08, 0.75), (0.5, 0.75), *arc(0.3, 0.75, 0.2, 0.25, 0, -310)]],
    "g": [
        arc(0.25, 0.72, 0.2, 0.24, -30, -390),
        [(0.45, 0.5), (0.45, 1.15), *arc(0.27, 1.15, 0.18, 0.2, 0, 150)],
    ],
    "h": [[(0.1, 0), (0.1, 1)], [(0.1, 0.7), *arc(0.28, 0.72, 0.17, 0.22, -180, 0), (0.45, 1)]],
    "k": [[(0.1, 0), (0.1, 1)], [(0.45, 0.5), (0.1, 0.78), (0.48, 1)]],
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


@pytest.mark.parametrize("text", ["hello", "10 N", "v0", "mass", "slope", "100 m", THIRTY, THETA])
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


@pytest.mark.parametrize("text", ["a", "g", "D", "k", "A", "ma", "10", "kg", "4", THIRTY, THETA])
@pytest.mark.parametrize("seed", range(3))
def test_what_is_written_in_a_body_is_no_mark_on_it(text: str, seed: int) -> None:
    """No anchor, no pivot, no body; and the marks that are there stay."""
    rng = np.random.default_rng(seed)
    frame, load = (outline(v, HAND, rng) for v in (box(400, 300, 240, 90), box(900, 600, 260, 110)))
    words = [*word(text, 370, 285, 30, rng), *word(text, 940, 585, 30, rng)]
    nail, anchor = circle((310, 300), 8, HAND, rng), cross((830, 600), 48, HAND, rng)
    plain = read(frame, load, words).scene
    assert (len(plain.bodies), plain.joints, [b.anchored for b in plain.bodies]) == (2, [], [False, False])
    scene = read(frame, load, nail, anchor, words).scene
    assert [b.anchored for b in scene.bodies] == [False, True]
    assert [j.bodies for j in scene.joints] == [("b1", None)]


@pytest.mark.parametrize("seed", range(6))
def test_a_looped_digit_beside_a_small_letter_is_no_anchor(seed: int) -> None:
    """Its loop crosses it as the bars of an X in one stroke do; letters are half as high again as the next."""
    rng = np.random.default_rng(seed)
    floor = outline(box(640, 500, 900, 160), HAND, rng)
    name = [*word("a", 600, 470, 42, rng), *word("2", 628, 484, 30, rng)]
    assert [b.anchored for b in read(floor, name).scene.bodies] == [False]


@pytest.mark.parametrize("text", ["A", "N", "10"])
@pytest.mark.parametrize("seed", range(3))
def test_an_x_stays_an_anchor_beside_a_name(text: str, seed: int) -> None:
    """A mark is set apart from what is written: as far as letters of one word never are."""
    rng = np.random.default_rng(seed)
    floor = outline(box(640, 500, 900, 100), HAND, rng)
    scene = read(floor, cross((600, 500), 40, HAND, rng), word(text, 636, 480, 40, rng)).scene
    assert [b.anchored for b in scene.bodies] == [True]


@pytest.mark.parametrize("seed", range(3))
def test_a_small_ball_with_its_name_is_a_ball(seed: int) -> None:
    rng = np.random.default_rng(seed)
    floor = outline(box(640, 500, 900, 60), HAND, rng)
    for name in (word("m", 536, 412, 20, rng), word("m", 490, 405, 20, rng)):  # beside it, and in it
        scene = read(floor, circle((500, 420), 24, HAND, rng), name).scene
        assert [isinstance(b.shape, Circle) for b in scene.bodies] == [False, True]


def test_spokes_leave_a_hub_a_pivot() -> None:
    rng = np.random.default_rng(4)
    frame, wheel = outline(box(500, 350, 300, 60), HAND, rng), circle((500, 400), 55, HAND, rng)
    spokes = [
        line(
            [
                (500 + 11 * math.cos(a), 400 + 11 * math.sin(a)),
                (500 + 54 * math.cos(a), 400 + 54 * math.sin(a)),
            ],
            HAND,
            rng,
        )
        for a in np.arange(5) * 2 * math.pi / 5
    ]
    scene = read(frame, wheel, circle((500, 400), 8, HAND, rng), *spokes).scene
    assert (len(scene.bodies), len(scene.joints)) == (2, 1)


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
@pytest.mark.parametrize(("gap", "count"), [(4, 24), (0, 24), (-1, 40)])
def test_hatching_under_a_box_leaves_its_corners_alone(seed: int, gap: float, count: int) -> None:
    """Wherever it begins: below the box, or on its side."""
    rng = np.random.default_rng(seed)
    corners = box(640, 500, 900, 60)
    sides = [line([a, b], HAND, rng)[0] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    top = 530 + gap
    hatching = [line([(x, top), (x - 18, top + 22)], HAND, rng)[0] for x in np.linspace(196, 1088, count)]
    scene = recognize(page(sides, hatching)).scene
    assert [len(b.outline()) for b in scene.bodies] == [4]


@pytest.mark.parametrize("strokes", [1, 4])
def test_thin_boxes_side_by_side_are_no_hatching(strokes: int) -> None:
    rng = np.random.default_rng(strokes)
    floor = outline(box(640, 600, 1100, 60), HAND, rng)
    dominoes = []
    for x in np.linspace(300, 900, 9):
        v = box(float(x), 539, 14, 60)
        pairs = zip(v, v[1:] + v[:1], strict=True)
        dominoes += outline(v, HAND, rng) if strokes == 1 else [line([a, b], HAND, rng)[0] for a, b in pairs]
    assert len(read(floor, dominoes).scene.bodies) == 10


def test_eyes_in_a_ball_are_no_pivots() -> None:
    rng = np.random.default_rng(5)
    face = circle((500, 300), 45, HAND, rng)
    eyes = [*circle((486, 286), 5, HAND, rng), *circle((514, 286), 5, HAND, rng)]
    floor = outline(box(640, 500, 900, 60), HAND, rng)
    scene = read(floor, face, eyes, line(arc(500, 305, 22, 22, 20, 160), HAND, rng)).scene
    assert (len(scene.bodies), scene.joints) == (2, [])


@pytest.mark.parametrize("scale", [0.4, 0.6, 0.8])
def test_a_loose_side_of_an_x_makes_no_letter_of_it(scale: float) -> None:
    """One that is drawn, or traced, apart from the bars: a small X on a long beam."""
    beam = outline([(60, 280), (1220, 280), (1220, 370), (60, 370)], HAND, np.random.default_rng(3))
    bars = [[(80, 20), (68, 50), (24, 88)], [(24, 40), (62, 78), (92, 84)]]
    loose = [(67, 42), (69, 60), (77, 80)]
    x = [(500, 300) + scale * np.array(path, float) for path in (*bars, loose)]
    found = read(beam, x)
    assert [body.anchored for body in found.scene.bodies] == [True]
