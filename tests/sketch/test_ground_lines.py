"""Ground drawn as one line, and what is drawn at it: the hand strays further over a long line than what stands on it
is large."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import Array, box, read

from sim.scene import Polygon
from sketch.ink import Sketch, Stroke
from sketch.kernel import depth
from sketch.recognize import Recognizer, recognize
from sketch.synthetic import HANDS, Hand, arrow, circle, cross, curve, line, outline

HAND = Hand(tremor=0.002, drift=0.008, rounding=0.02, overshoot=0.02, spacing=0.03, unsteady=0.7)
SEEDS = range(6)


def bowed(height: float, rng: np.random.Generator) -> list[Array]:
    """A line across the page, at 650 px where it begins and ends, and so much higher in the middle."""
    at = np.linspace(-1, 1, 60)
    return curve(np.stack([640 + 580 * at, 650 - height * (1 - at**2)], axis=1), HAND, rng)


def fall(rng: np.random.Generator) -> list[Array]:
    return arrow((1150, 120), (1150, 240), HAND, rng)


@pytest.mark.parametrize("seed", SEEDS)
def test_an_x_is_on_the_ink_of_a_line_that_bends(seed: int) -> None:
    """Where that is as far from the straight line nearest to it as the X is large."""
    rng = np.random.default_rng(seed)
    ground, x = bowed(34, rng), cross((90, 648), 22, HAND, rng)
    crate = outline(box(640, 560, 110, 90), HAND, rng)
    scene = read(ground, x, crate, fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", SEEDS)
def test_an_x_on_a_line_is_not_of_the_wedge_that_stands_there(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ground, x = line([(60, 650), (1220, 650)], HAND, rng), cross((420, 651), 44, HAND, rng)
    wedge = outline([(300, 655), (800, 655), (620, 430)], HAND, rng)
    scene = read(ground, x, wedge, fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", SEEDS)
def test_an_x_on_a_line_is_no_letter_beside_another(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ground, x = line([(60, 650), (1220, 650)], HAND, rng), cross((200, 650), 30, HAND, rng)
    letter = curve(
        np.array([(196, 590), (196, 622), (197, 610), (206, 604), (212, 610), (212, 622)]), HAND, rng
    )
    crate = outline(box(640, 600, 110, 90), HAND, rng)
    scene = read(ground, x, letter, crate, fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", range(8))
def test_a_careless_x_near_the_end_of_a_line_is_no_head_of_an_arrow(seed: int) -> None:
    """It begins further from the line's end than it is large."""
    rng = np.random.default_rng(seed)
    stroke = [(-27, -24), (1, 10), (25, 25), (14, 4), (8, -17), (10, -31), (-6, 3), (-27, 25)]
    x = line([(190 + u, 650 + v) for u, v in stroke], HAND, rng)
    crate = outline(box(700, 600, 110, 90), HAND, rng)
    scene = read(line([(60, 650), (1220, 650)], HAND, rng), x, crate, fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_wedge_whose_ends_cross_on_a_line_is_no_large_x(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ground = line([(60, 650), (1220, 650)], HAND, rng)
    sides = [(660, 380), (330, 640), (860, 640), (600, 390)]
    wedge = line(sides, Hand(rounding=0.12), rng)
    ball = circle((630, 350), 36, HAND, rng)
    bodies = read(ground, wedge, ball, fall(rng)).scene.bodies
    assert len(bodies) == 3
    assert not any(body.anchored for body in bodies)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rope_past_the_edge_of_a_long_shelf_is_no_slip_at_it(seed: int) -> None:
    """From a wheel beside the shelf to a crate, 40 px from the shelf; it is pinned to the crate alone."""
    rng = np.random.default_rng(seed)
    shelf = outline(box(440, 470, 700, 56), HANDS["neat"], rng) + cross((440, 470), 36, HAND, rng)
    wheel = circle((782, 396), 44, HAND, rng)
    rope, crate = line([(830, 410), (830, 530)], HAND, rng), outline(box(830, 576, 120, 110), HAND, rng)
    ring = circle((830, 530), 7, HANDS["neat"], rng)
    scene = read(shelf, wheel, rope, crate, ring, fall(rng)).scene
    assert len(scene.bodies) == 4
    assert [joint.bodies for joint in scene.joints] == [("b3", "b4")]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_ring_drawn_over_twice_at_the_end_of_a_rope_is_a_pin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    beam = outline(box(640, 200, 600, 50), HAND, rng) + cross((800, 200), 30, HAND, rng)
    rope = curve(
        np.array([(500 - 14 * math.sin(t), 204 + 40 * t) for t in np.linspace(0, 3.14, 30)]), HAND, rng
    )
    ring = circle((500, 206), 7, Hand(drift=0.03, spacing=0.11, unsteady=0.6), rng)
    ball, pin = circle((500, 340), 34, HAND, rng), circle((500, 326), 7, HANDS["neat"], rng)
    again = [stroke + 0.3 for stroke in ring]
    scene = read(beam, rope, ring, again, ball, pin, fall(rng)).scene
    assert len(scene.bodies) == 3
    assert sorted(joint.bodies for joint in scene.joints) == [("b1", "b2"), ("b2", "b3")]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rope_that_a_ring_holds_is_no_slip_where_it_ends_at_a_wheel(seed: int) -> None:
    """From a block on a wedge, up along it, to a wheel at the top."""
    rng = np.random.default_rng(seed)
    wedge = outline([(200, 640), (900, 640), (900, 340)], HAND, rng) + cross((700, 580), 40, HAND, rng)
    wheel = circle((890, 330), 40, HANDS["neat"], rng)
    block = outline(box(600, 432, 110, 70, -0.405), HAND, rng)
    rope = line([(640, 424), (846, 340)], HAND, rng)
    ring = circle((641, 423), 7, HANDS["neat"], rng)
    scene = read(wedge, wheel, block, rope, ring, fall(rng)).scene
    assert len(scene.bodies) == 4
    assert [joint.bodies for joint in scene.joints] == [("b3", "b4")]


def walls(rng: np.random.Generator) -> list[list[Array]]:
    """Four lines around a room, which all but meet, an X on each, and a ball within."""
    corners = [(140, 80), (1140, 80), (1140, 640), (140, 640)]
    out = []
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        sx, sy = np.sign([bx - ax, by - ay]) * 16
        out.append(line([(ax + sx, ay + sy), (bx - sx, by - sy)], HAND, rng))
        t = rng.uniform(0.25, 0.75)
        out.append(cross((ax + t * (bx - ax), ay + t * (by - ay)), 36, HAND, rng))
    return [*out, circle((500, 300), 40, HAND, rng)]


@pytest.mark.parametrize("seed", SEEDS)
def test_walls_with_an_x_on_each_are_no_box(seed: int) -> None:
    """A box has no use for four, and what is in a room is not in a body."""
    scene = read(*walls(np.random.default_rng(seed))).scene
    assert [body.anchored for body in scene.bodies] == [True, True, True, True, False]


def test_walls_are_walls_in_whatever_order_their_x_come() -> None:
    """What an X says of an outline is told of all of its sides, however far from it."""
    ink = [Stroke(points) for part in walls(np.random.default_rng(1)) for points in part]
    for seed in range(3):
        sketch = Sketch([ink[k] for k in np.random.default_rng(seed).permutation(len(ink))], 1280, 720)
        drawing = Recognizer(Sketch([], 1280, 720))
        for count, stroke in enumerate(sketch.strokes, start=1):
            drawing.add(stroke)
            so_far = Sketch(sketch.strokes[:count], 1280, 720)
            assert drawing.recognition().scene.to_json() == recognize(so_far).scene.to_json(), count


@pytest.mark.parametrize("seed", SEEDS)
def test_a_box_of_four_strokes_with_an_x_in_it_is_a_box(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = [(300, 400), (900, 400), (900, 480), (300, 480)]
    sides = [line([a, b], HAND, rng) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    marks = [cross((x, 440), 40, HAND, rng) for x in (380, 820)]
    scene = read(*sides, *marks, circle((600, 200), 50, HAND, rng), fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", SEEDS)
def test_an_x_on_a_line_that_bends_sharply_fixes_it(seed: int) -> None:
    """A funnel's sides and a bin, which by themselves are no rods; and an X by itself is no mark."""
    rng = np.random.default_rng(seed)
    left = line([(340, 150), (590, 380), (592, 480)], HAND, rng)
    right = line([(940, 150), (690, 380), (688, 480)], HAND, rng)
    bin_ = line([(480, 540), (484, 690), (800, 690), (804, 540)], HAND, rng)
    marks = [cross(at, 28, HAND, rng) for at in ((465, 265), (815, 265), (600, 690))]
    scene = read(left, marks[0], right, marks[1], bin_, marks[2], circle((640, 200), 30, HAND, rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, True, True, False]
    assert len(scene.bodies) == 4
    assert not any("left out" in note for note in scene.notes)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_shelf_keeps_the_stop_at_its_end(seed: int) -> None:
    """A tenth of its length: as a straight line it would say the rest in fewer words."""
    rng = np.random.default_rng(seed)
    stop, end = (340, 250), (860, 390)
    shelf, x = line([stop, (344, 302), end], HAND, rng), cross((600, 344), 32, HAND, rng)
    scene = read(shelf, x, circle((400, 270), 30, HAND, rng), fall(rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False]
    shape, at = scene.bodies[0].shape, scene.bodies[0].position
    assert isinstance(shape, Polygon)
    corners = (np.array(shape.vertices) + np.array(at)) * (128, -128)
    for drawn in (stop, end):
        assert np.hypot(*(corners - drawn).T).min() < 12


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rope_along_a_wedge_is_no_slip_at_it(seed: int) -> None:
    """From a block on it to the wheel at its top, a block's half height off, and down from there: none of it is
    pinned."""
    rng = np.random.default_rng(seed)
    wedge = outline([(220, 640), (850, 640), (850, 330)], HAND, rng) + cross((740, 590), 36, HAND, rng)
    wheel = circle((860, 322), 46, HANDS["neat"], rng)
    block = outline(box(588, 411, 100, 80, -0.457), HAND, rng)
    ropes = [line([(634, 388), (838, 276)], HAND, rng), line([(906, 322), (906, 520)], HAND, rng)]
    load = outline(box(906, 556, 80, 72), HAND, rng)
    scene = read(wedge, wheel, block, *ropes, load, fall(rng)).scene
    assert len(scene.bodies) == 6
    assert not any("left out" in note for note in scene.notes)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_track_that_curves_has_no_corner(seed: int) -> None:
    """By itself it would be two straight sides; with an X on it, it is ground as it was drawn."""
    rng = np.random.default_rng(seed)
    u = np.linspace(0, 1, 50)
    track = np.stack([130 + 1000 * u, 190 + 470 * (1 - np.exp(-2.6 * u))], axis=1)
    x = cross(track[30].tolist(), 34, HAND, rng)
    (body,) = read(curve(track, HAND, rng), x, fall(rng)).scene.bodies
    assert isinstance(body.shape, Polygon)
    corners = (np.array(body.shape.vertices) + np.array(body.position)) * (128, -128)
    assert max(abs(depth(a, b, corners)) for a, b in track.tolist()) < 14
