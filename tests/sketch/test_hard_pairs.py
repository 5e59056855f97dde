"""Shapes that are easily taken for one another, each drawn by several hands."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import box, kinds, ngon, page, read, turned

from sim.scene import Circle, Polygon
from sketch import Sketch, Stroke, recognize
from sketch.synthetic import HANDS, Hand, arrow, circle, cross, ellipse, line, outline

Array = NDArray[np.float64]
HAND = [(name, seed) for name in ("neat", "quick", "pieces") for seed in range(3)]
hands = pytest.mark.parametrize(("name", "seed"), HAND)


@pytest.fixture
def hand(name: str):
    return HANDS[name]


@pytest.fixture
def rng(name: str, seed: int):
    return np.random.default_rng([len(name), seed])


@hands
def test_a_long_thin_rectangle_is_no_line(hand, rng) -> None:
    assert kinds(read(outline(box(400, 300, 420, 64, 0.3), hand, rng))) == ["4-gon"]
    assert kinds(read(line([(200, 300), (620, 330)], hand, rng))) == ["bar"]


@hands
def test_an_ellipse_is_no_circle(hand, rng) -> None:
    assert kinds(read(circle((300, 300), 80, hand, rng))) == ["circle"]
    long = read(ellipse((300, 300), (150, 70), 0.5, hand, rng)).readings[0]
    assert long.kind == "polygon"
    assert len(long.outline) > 8


@hands
def test_corners_are_counted(hand, rng) -> None:
    for n in (3, 5):
        assert kinds(read(outline(ngon(n, 300, 300, 110), hand, rng))) == [f"{n}-gon"]


@pytest.mark.parametrize("name", ["neat", "pieces", "shaky"])
@pytest.mark.parametrize("seed", range(4))
def test_a_hexagon_is_no_circle(hand, rng) -> None:
    assert kinds(read(outline(ngon(6, 300, 300, 110), hand, rng))) == ["6-gon"]


@pytest.mark.parametrize("name", ["neat", "pieces", "quick"])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("radius", [50, 150])
def test_an_octagon_is_no_circle(name: str, seed: int, radius: float) -> None:
    rng = np.random.default_rng(seed)
    assert kinds(read(outline(ngon(8, 400, 300, radius), HANDS[name], rng))) == ["8-gon"]


@pytest.mark.parametrize("corners", [3, 4])
def test_sides_that_bow_this_way_and_that_are_sides(corners: int) -> None:
    at = np.array(ngon(corners, 300, 300, 110) if corners == 3 else box(300, 300, 240, 140, 0.3))
    sides = []
    for k, (a, b) in enumerate(zip(at, np.roll(at, -1, axis=0), strict=True)):
        t = np.linspace(0, 1, 20, endpoint=False)[:, None]
        out = np.array([b[1] - a[1], a[0] - b[0]]) * (0.14, -0.14)[k % 2]
        sides.append(a + t * (b - a) + 4 * t * (1 - t) * out)
    assert kinds(read([np.concatenate([*sides, at[:1]])])) == [f"{corners}-gon"]


@pytest.mark.parametrize("angle", [0.0, 0.6, 2.2])
def test_a_hasty_circle_is_a_circle(angle: float) -> None:
    t = np.linspace(0, 2 * math.pi, 60)
    ink = np.column_stack([110 * np.cos(t), 72 * np.sin(t)])
    assert kinds(read([np.array(turned(ink.tolist(), angle, (300, 300)))])) == ["circle"]


@pytest.mark.parametrize("angle", [0.1, 0.35, 0.6])
@pytest.mark.parametrize("size", [30, 110, 200])
def test_a_hexagon_of_rounded_corners_is_no_circle(size: float, angle: float) -> None:
    for seed in range(6):
        hand = replace(HANDS["neat"], rounding=0.2, parts=(1,))
        corners = turned(ngon(6, 0, 0, size), angle, (400, 300))
        assert kinds(read(outline(corners, hand, np.random.default_rng(seed)))) == ["6-gon"]


@hands
def test_rectangle_trapezoid_parallelogram(hand, rng) -> None:
    straight = read(outline(box(300, 300, 240, 130, 0.2), hand, rng)).readings[0]
    trapezoid = read(outline([(0, 0), (260, 0), (190, 130), (70, 130)], hand, rng)).readings[0]
    parallelogram = read(outline([(0, 0), (220, 0), (310, 130), (90, 130)], hand, rng)).readings[0]
    assert straight.kind == "rectangle"
    assert trapezoid.kind == parallelogram.kind == "polygon"
    assert len(trapezoid.outline) == len(parallelogram.outline) == 4


@pytest.mark.parametrize("height", [120, 180, 240])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0])
def test_a_trapezoid_with_a_short_side_is_no_triangle(height: float, angle: float) -> None:
    corners = turned([(0, 0), (300, 0), (187.5, height), (112.5, height)], angle, (400, 300))
    assert kinds(read([np.array([*corners, corners[0]])])) == ["4-gon"]


@hands
def test_concave_outlines(hand, rng) -> None:
    angle_iron = [(0, 0), (200, 0), (200, 80), (80, 80), (80, 220), (0, 220)]
    assert kinds(read(outline(turned(angle_iron, 0.4, (300, 300)), hand, rng))) == ["6-gon"]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", ["neat", "shaky"])
def test_a_short_side_that_closes_an_outline_is_no_hook(seed: int, name: str) -> None:
    """A trough in one stroke from any corner on: the ends of its walls are a thirtieth of its outline."""
    v = [(-100, -100), (-60, -100), (-60, 70), (60, 70), (60, -100), (100, -100), (100, 120), (-100, 120)]
    hand = replace(HANDS[name], parts=(1,), overshoot=0.0)
    corners = [(400.0 + x, 300.0 + y) for x, y in v]
    assert kinds(read(outline(corners, hand, np.random.default_rng(seed)))) == ["8-gon"]


@pytest.mark.parametrize("start", range(8))
def test_a_short_side_that_leads_back_to_the_very_beginning_is_no_hook(start: int) -> None:
    """A trough as programs write it: its ends are one place."""
    v = [(-100, -100), (-60, -100), (-60, 70), (60, 70), (60, -100), (100, -100), (100, 120), (-100, 120)]
    around = np.array([*v[start:], *v[: start + 1]], dtype=float) + 400
    assert kinds(read([around])) == kinds(read([around[::-1]])) == ["8-gon"]


@pytest.mark.parametrize("seed", [433, 691])
def test_a_box_whose_one_corner_is_cut_round_has_four_sides(seed: int) -> None:
    rng = np.random.default_rng(seed)
    box = (
        np.array([(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)])
        + rng.normal(0, 12, (4, 2))
        + (500, 300)
    )
    t, cut = np.linspace(0, 1, 9)[:, None], rng.uniform(0.3, 0.9)
    before, after = box[2] + cut * (box[1] - box[2]), box[2] + cut * (box[3] - box[2])
    corners = [*box[:2], *((1 - t) ** 2 * before + 2 * t * (1 - t) * box[2] + t**2 * after), box[3], box[0]]
    sides = [
        a + (b - a) * np.linspace(0, 1, max(2, int(math.dist(a, b) / 4)))[:, None]
        for a, b in pairwise(corners)
    ]
    ink = np.concatenate(sides)
    assert kinds(read([ink + rng.normal(0, 0.6, ink.shape)])) == ["4-gon"]


@pytest.mark.parametrize("seed", range(6))
def test_rounded_corners_add_no_sides(seed: int) -> None:
    hand = replace(HANDS["neat"], rounding=0.2)
    rng = np.random.default_rng(seed)
    assert kinds(read(outline(box(300, 300, 240, 160), hand, rng))) == ["4-gon"]


@hands
def test_three_lines_are_one_arrow_or_three_bars(hand, rng) -> None:
    assert kinds(read(arrow((200, 150), (210, 310), hand, rng))) == ["gravity"]
    apart = [line([(x, 150), (x + 8, 310)], hand, rng) for x in (200, 400, 600)]
    assert kinds(read(*apart)) == ["bar"] * 3


@hands
def test_the_arrow_points_from_tail_to_head(hand, rng) -> None:
    for angle in np.arange(0, 6.28, 0.7):
        head = (300 + 120 * math.cos(angle), 300 + 120 * math.sin(angle))
        x, y = read(arrow((300, 300), head, hand, rng)).scene.gravity
        assert math.hypot(x, y) == pytest.approx(9.81)
        assert math.cos(math.atan2(-y, x) - angle) > math.cos(math.radians(10))


@hands
def test_a_circle_is_pivot_ball_or_wheel_by_what_is_under_it(hand, rng) -> None:
    beam, rod = outline(box(300, 150, 400, 80), hand, rng), outline(box(300, 300, 60, 380), hand, rng)
    pivot = read(beam, rod, circle((300, 150), 12, hand, rng)).scene
    assert [j.bodies for j in pivot.joints] == [("b1", "b2")]
    assert pivot.joints[0].position == pytest.approx((300 / 128, -150 / 128), abs=4 / 128)
    alone = read(beam, circle((800, 400), 12, hand, rng)).scene
    assert (len(alone.bodies), alone.joints) == (2, [])
    nail = read(outline(box(300, 300, 400, 300), hand, rng), circle((300, 300), 12, hand, rng)).scene
    assert [j.bodies for j in nail.joints] == [("b1", None)]
    wheel = read(outline(box(300, 300, 300, 120), hand, rng), circle((230, 360), 50, hand, rng)).scene
    assert (len(wheel.bodies), wheel.joints) == (2, [])


@hands
def test_an_x_anchors_and_crossing_bars_do_not(hand, rng) -> None:
    ground = outline(box(400, 500, 600, 90), hand, rng)
    scene = read(ground, cross((300, 500), 44, hand, rng)).scene
    assert [b.anchored for b in scene.bodies] == [True]
    rods = read(line([(100, 100), (420, 300)], hand, rng), line([(120, 310), (400, 90)], hand, rng))
    assert kinds(rods) == ["bar", "bar"]
    assert not any(b.anchored for b in rods.scene.bodies)


def test_a_tap_is_no_anchor() -> None:
    for seed in range(12):
        rng = np.random.default_rng(seed)
        body = outline(box(400, 300, 300, 180), HANDS["neat"], rng)
        tap = rng.normal((400, 300), 0.6, (4, 2))
        found = read(body, [tap])
        assert kinds(found) == ["4-gon", "unread"]
        assert not found.scene.bodies[0].anchored
        assert "left out" in " ".join(found.scene.notes)


@hands
def test_an_x_over_two_bodies_anchors_the_last_drawn(hand, rng) -> None:
    first, last = outline(box(300, 300, 300, 160), hand, rng), outline(box(420, 330, 280, 140), hand, rng)
    scene = read(first, last, cross((370, 310), 40, hand, rng)).scene
    assert [b.anchored for b in scene.bodies] == [False, True]
    assert any("b1 and b2: it anchors b2, drawn last" in note for note in scene.notes)
    over = read(first, last, cross((310, 325), 90, hand, rng)).scene  # half of it sticks out of the last
    assert [b.anchored for b in over.bodies] == [False, True]


@hands
def test_an_x_in_a_body_that_a_rod_crosses_anchors_the_body(hand, rng) -> None:
    plate, rod = outline(box(400, 300, 300, 200), hand, rng), line([(350, 300), (750, 300)], hand, rng)
    scene = read(plate, rod, cross((400, 300), 50, hand, rng)).scene
    assert [b.anchored for b in scene.bodies] == [True, False]


@hands
def test_wheels_cross_their_frame(hand, rng) -> None:
    frame = outline(box(400, 300, 340, 120), hand, rng)
    wheels = [circle((x, 350), 48, hand, rng) for x in (300, 500)]
    assert kinds(read(frame, *wheels)) == ["4-gon", "circle", "circle"]


def test_one_side_drawn_twice_is_one_side() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        body = outline(box(400, 300, 300, 180), HANDS["neat"], rng)
        again = line([(258, 212), (545, 209)], HANDS["neat"], rng)
        assert kinds(read(body, again)) == ["4-gon"]
        twice = outline(ngon(3, 400, 300, 120), HANDS["neat"], rng)
        assert kinds(read(twice, [s + 2 for s in twice])) == ["3-gon"]


@pytest.mark.parametrize("times", [2, 3, 4])
def test_a_side_drawn_forth_and_back_is_one_side(times: int) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        corners = turned(box(0, 0, 260, 170), 0.7, (400, 300))
        sides = zip(corners, [*corners[1:], corners[0]], strict=True)
        ink = [
            line([(a, b)[k % 2] for k in range(times + 1)] if j else [a, b], HANDS["neat"], rng)
            for j, (a, b) in enumerate(sides)
        ]
        assert kinds(read(*ink)) == ["4-gon"]
        assert kinds(read(line([(200, 306), (230, 309), (150, 300), (420, 330)], HANDS["neat"], rng))) == [
            "bar"
        ]


def test_a_gap_of_a_tenth_of_the_outline() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        whole = np.concatenate(outline(box(400, 300, 300, 200), HANDS["shaky"].__class__(parts=(1,)), rng))
        open_box = whole[: round(0.9 * len(whole))]
        assert kinds(read([open_box])) == ["4-gon"]
        ring = circle((400, 300), 90, HANDS["neat"], rng)[0]
        assert kinds(read([ring[: round(0.9 * len(ring))]])) == ["circle"]


def test_a_long_box_may_lack_its_end_but_no_box_a_side() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        plank = line(
            turned([(200, 0), (-200, 0), (-200, 70), (200, 70)], 0.4, (500, 300)), HANDS["neat"], rng
        )
        assert kinds(read(plank)) == ["4-gon"]
        end = line(turned([(204, 2), (202, 66)], 0.4, (500, 300)), HANDS["neat"], rng)
        assert [r.strokes for r in read(plank, end).readings] == [(0, 1)]
        cup = line([(200, 200), (200, 400), (400, 400), (400, 200)], HANDS["neat"], rng)
        assert kinds(read(cup)) != ["4-gon"]


def test_hooks_and_overshoots_do_not_move_a_side() -> None:
    careful = replace(HANDS["neat"], tremor=0.0, drift=0.0, rounding=0.0, parts=(4,))
    wild = replace(careful, hook=0.04, overshoot=0.05)
    for seed in range(8):
        found = read(outline(box(400, 300, 300, 180), wild, np.random.default_rng(seed))).readings[0]
        low, high = found.outline.min(axis=0), found.outline.max(axis=0)
        assert len(found.outline) == 4
        assert low == pytest.approx([250, 210], abs=12)
        assert high == pytest.approx([550, 390], abs=12)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("past", [10.0, -8.0], ids=["crosses", "passes by"])
def test_what_runs_on_within_a_closed_outline_is_no_side(past: float, back: bool) -> None:
    corners = [(0.0, past), (0.0, 150.0), (240.0, 150.0), (240.0, 0.0), (-past, 0.0), (50.0, 45.0)]
    at = np.array(turned(corners, 0.4, (300, 300)))
    ink = np.concatenate([a + np.linspace(0, 1, 20)[:, None] * (b - a) for a, b in pairwise(at)])
    assert kinds(read([ink[::-1] if back else ink])) == ["4-gon"]


@pytest.mark.parametrize("seed", range(12))
def test_what_runs_on_out_of_a_closed_outline_is_no_side(seed: int) -> None:
    """A hasty box is no more of any course for its stroke's beginning far out."""
    corners = [(333.0, 256.0), (300.0, 300.0), (300.0, 450.0), (390.0, 450.0), (390.0, 300.0), (303.0, 300.0)]
    ink = line(corners, replace(HANDS["quick"], parts=(1,)), np.random.default_rng(seed))
    assert kinds(read(ink)) == ["4-gon"]


@hands
def test_bodies_that_share_a_drawn_side(hand, rng) -> None:
    first = outline(box(300, 300, 200, 140), hand, rng)
    beside = line([(400, 232), (540, 230), (540, 370), (400, 368)], replace(hand, parts=(1,)), rng)
    bodies = read(first, beside).scene.bodies
    assert [len(b.strokes or []) for b in bodies] == [len(first), 1]
    for body, x in zip(bodies, (300, 470), strict=True):
        assert body.position == pytest.approx((x / 128, -300 / 128), abs=16 / 128)


WAVES = [(150 + 10 * k, 400 + 110 * math.sin(k / 9)) for k in range(80)]
VALLEY = [(150, 200), (420, 520), (760, 500), (1000, 220)]


@hands
@pytest.mark.parametrize("course", [WAVES, VALLEY], ids=["waves", "valley"])
def test_a_line_of_any_course_is_ground_under_an_x(course, hand, rng) -> None:
    x, y = course[len(course) // 2]
    ground, mark = line(course, hand, rng), cross((x, y), 45, hand, rng)
    bodies = read(ground, mark, circle((300, 120), 40, hand, rng)).scene.bodies
    assert [(type(b.shape), b.anchored) for b in bodies] == [(Polygon, True), (Circle, False)]
    drawn = np.concatenate(ground)
    track = np.array(read(ground, mark).readings[0].outline)
    assert max(np.hypot(*(drawn - p).T).min() for p in track) < 25


@hands
def test_small_xs_on_long_open_lines_are_no_letters(hand, rng) -> None:
    ground = [*line([(120, 620), (1160, 630)], hand, rng), *cross((560, 624), 50, hand, rng)]
    slope = [*line([(180, 260), (560, 420)], hand, rng), *cross((370, 340), 44, hand, rng)]
    ball = circle((240, 225), 34, hand, rng)
    sketch = Sketch([Stroke(s) for s in (*ground, *slope, *ball)], 1280.0, 720.0)
    assert [body.anchored for body in recognize(sketch).scene.bodies] == [True, True, False]


def test_a_wavy_line_by_itself_is_left_out() -> None:
    found = read(line(WAVES, HANDS["neat"], np.random.default_rng(0)))
    assert kinds(found) == ["unread"]
    assert "left out" in found.scene.notes[-1]


HOOKED = [(0, 0), (12, 14), (24, 28), (38, 33), (47, 37), (44, 33), (35, 24), (31, 14), (32, 3), (38, -15)]
INWARDS = [(0, 9), (8, 17), (23, 33), (36, 34), (37, 37), (27, 31), (24, 22), (26, 12), (31, -1), (25, 9)]


@pytest.mark.parametrize("course", [[*HOOKED, (28, 0), (14, 21), (0, 40)], [*INWARDS, (13, 25), (0, 40)]])
def test_what_joins_the_bars_of_an_x_may_go_any_way(course: list[tuple[float, float]]) -> None:
    """Down one bar, on in a hook or a bow to the head of the other, and down that: in one stroke."""
    for seed in range(12):
        rng = np.random.default_rng(seed)
        body = outline(box(400, 300, 460, 240), HANDS["neat"], rng)
        mark = line((1.5 * (np.array(course) - [20, 12]) + [400, 300]).tolist(), HANDS["neat"], rng)
        assert kinds(read(body, mark)) == ["4-gon", "anchor"]


@pytest.mark.parametrize("second", [(0.52, 1.0), (0.0, 1.0), (0.3, 0.7), (0.45, 1.2)])
def test_a_line_in_two_strokes_is_one_bar(second: tuple[float, float]) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        a, b = np.array([200.0, 200.0]), np.array([500.0, 330.0])
        first = line([tuple(a), tuple(a + (0.5 if second[0] > 0.4 else 1) * (b - a))], HANDS["neat"], rng)
        rest = line([tuple(a + k * (b - a)) for k in second], HANDS["neat"], rng)
        assert kinds(read(first, rest)) == ["bar"]
        assert kinds(read(rest, [s[::-1] for s in first])) == ["bar"]


def test_two_rods_in_line_that_a_ring_joins_are_two() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        rods = [line([(x, 300), (x + 222, 303)], HANDS["neat"], rng) for x in (200, 400)]
        found = read(*rods, circle((411, 302), 14, HANDS["neat"], rng))
        assert kinds(found) == ["bar", "bar", "pivot"]
        assert [j.bodies for j in found.scene.joints] == [("b1", "b2")]


def test_a_rod_is_straight() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        assert kinds(read(line([(200, 200), (420, 330)], HANDS["quick"], rng))) == ["bar"]
        t = np.linspace(0, 1, 40)
        arc = np.stack([200 + 220 * t, 300 + 88 * t * (1 - t)], axis=1)
        (bent,) = read(line(arc.tolist(), HANDS["neat"], rng)).readings
        assert len(bent.outline) > 2


def test_a_scrawl_at_a_corner_is_no_gravity() -> None:
    rng = np.random.default_rng(5)
    body = outline(box(400, 300, 400, 240), HANDS["neat"], rng)
    small = arrow((585, 405), (600, 418), HANDS["neat"], rng)
    assert read(body, small).scene.gravity == (0.0, 0.0)
    assert read(body, arrow((100, 100), (104, 220), HANDS["neat"], rng)).scene.gravity != (0.0, 0.0)


def _pairs(hand: Hand, rng: np.random.Generator) -> dict[str, tuple[list[list[Array]], list[str]]]:
    """Hard pairs, each as what is drawn, and as what that is."""
    rod, plank = line([(200, 300), (600, 320)], hand, rng), outline(box(400, 300, 420, 40), hand, rng)
    long = ellipse((300, 300), (150, 80), 0.5, hand, rng)
    board, post = outline(box(300, 150, 400, 80), hand, rng), outline(box(300, 300, 60, 380), hand, rng)
    frame = outline(box(400, 300, 340, 120), hand, rng)
    rods = [
        *line([(100, 100), (420, 300)], hand, rng),
        *line([(120, 310), (400, 90)], hand, rng),
    ]
    ring = circle((400, 300), 90, hand, rng)[0]
    return {
        "a line": ([rod], ["bar"]),
        "a long thin rectangle": ([plank], ["4-gon"]),
        "a circle": ([[ring]], ["circle"]),
        "a circle with a gap": ([[ring[: round(0.9 * len(ring))]]], ["circle"]),
        "an ellipse": ([long], ["24-gon"]),
        "a hexagon": ([outline(ngon(6, 300, 300, 110), hand, rng)], ["6-gon"]),
        "a parallelogram": ([outline([(0, 0), (220, 0), (310, 130), (90, 130)], hand, rng)], ["4-gon"]),
        "an arrow": ([arrow((200, 150), (210, 310), hand, rng)], ["gravity"]),
        "a pivot": ([board, post, circle((300, 150), 12, hand, rng)], ["4-gon", "4-gon", "pivot"]),
        "a ball": ([board, circle((700, 400), 12, hand, rng)], ["4-gon", "circle"]),
        "wheels over a frame": (
            [frame, *(circle((x, 350), 48, hand, rng) for x in (300, 500))],
            ["4-gon", "circle", "circle"],
        ),
        "an X": ([frame, cross((380, 300), 40, hand, rng)], ["4-gon", "anchor"]),
        "crossing bars": ([rods], ["bar", "bar"]),
        "a side drawn twice": ([frame, line([(250, 241), (550, 238)], hand, rng)], ["4-gon"]),
    }


@pytest.mark.parametrize("name", ["neat", "pieces"])
@pytest.mark.parametrize("scale", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, 4.4])
def test_hard_pairs_of_any_size_and_turned_by_any_angle(name: str, scale: float, angle: float) -> None:
    way = scale * np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    pairs = _pairs(HANDS[name], np.random.default_rng([len(name), round(10 * angle)]))
    for what, (drawn, meant) in pairs.items():
        strokes = [s @ way for shape in drawn for s in shape]
        low = np.concatenate(strokes).min(axis=0) - 20 * scale
        found = recognize(page([s - low for s in strokes], width=1280 * scale, height=720 * scale))
        assert kinds(found) == meant, what


@pytest.mark.parametrize("scale", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_page_cut_close_to_its_ink_has_the_same_nails(scale: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ink = [*outline(box(310, 220, 600, 420), HANDS["neat"], rng), *circle((310, 220), 13, HANDS["neat"], rng)]
    for width, height in ((1280, 720), (620, 440)):
        sketch = Sketch([Stroke(scale * s) for s in ink], scale * width, scale * height)
        assert [j.bodies for j in recognize(sketch).scene.joints] == [("b1", None)]


@hands
def test_balls_in_a_frame_are_not_nailed_to_it(hand, rng) -> None:
    frame = outline(box(640, 380, 950, 560), hand, rng)
    balls = [circle((400 + 160 * k, 300 + 60 * (k % 2)), 46, hand, rng) for k in range(4)]
    scene = read(frame, *balls).scene
    assert [type(b.shape) for b in scene.bodies[1:]] == [Circle] * 4
    assert scene.joints == []


@pytest.mark.parametrize("times", [0.3, 1.0, 4.0])
def test_a_pin_stays_one_at_any_size_on_the_same_page(times: float) -> None:
    hand, rng = HANDS["neat"], np.random.default_rng(3)
    ink = outline(box(600, 350, 80, 600), hand, rng) + circle((600, 90), 11, hand, rng)
    sketch = Sketch([Stroke(times * stroke) for stroke in ink], 1280, 720)
    assert [j.bodies for j in recognize(sketch).scene.joints] == [("b1", None)]


@pytest.mark.parametrize("seed", range(4))
def test_a_drawing_is_read_alike_on_any_page_that_it_is_not_a_speck_on(seed: int) -> None:
    hand, rng = HANDS["quick"], np.random.default_rng(seed)
    ink = outline(box(640, 400, 420, 90), hand, rng) + arrow((1100, 120), (1100, 190), hand, rng)
    ink += [s for x in (500, 780) for r in (70, 11) for s in circle((x, 425), r, hand, rng)]
    strokes = [Stroke(s) for s in ink]
    said = [[(r.kind, r.score) for r in recognize(Sketch(strokes, w, w / 2)).readings] for w in (1280, 4000)]
    assert said[0] == said[1]


def test_a_ring_within_a_pivot_is_that_pivot() -> None:
    hand, rng = HANDS["neat"], np.random.default_rng(4)
    rod, load = outline(box(400, 300, 500, 120), hand, rng), outline(box(850, 300, 600, 120), hand, rng)
    rings = [circle((640, 300), 36, hand, rng), circle((671, 300), 7, hand, rng)]  # the second beside the rod
    scene = read(rod, load, *rings).scene
    assert (len(scene.bodies), len(scene.joints)) == (2, 1)


def test_small_marks_at_an_end_do_not_hide_where_a_side_goes_on() -> None:
    """The sides of a beam overlap by an X's width, and the X's four ends are nearer than the side's."""
    hand, rng = HANDS["neat"], np.random.default_rng(2)
    below = [(940.0, 95.0), (940.0, 145.0), (340.0, 145.0), (340.0, 95.0), (498.0, 95.0)]
    beam = line([(940.0, 93.0), (430.0, 95.0)], hand, rng) + line(below, hand, rng)
    sides = [[(465.0, 105.0), (465.0, 395.0)], [(465.0, 395.0), (495.0, 395.0)]]
    sides += [[(495.0, 395.0), (495.0, 105.0)], [(495.0, 105.0), (465.0, 105.0)]]
    rod = [s for side in sides for s in line(side, hand, rng)]
    scene = read(beam, cross((392, 120), 26, hand, rng), rod, circle((480, 122), 8, hand, rng)).scene
    assert [b.anchored for b in scene.bodies] == [True, False]
    assert len(scene.joints) == 1
