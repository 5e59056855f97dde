"""Bodies in a crowd of other ink: each is what its own strokes make, whatever else ends nearby."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import box, kinds, read

from sketch.synthetic import HANDS, circle, cross, line, outline

Array = NDArray[np.float64]
NEAT, PIECES = HANDS["neat"], HANDS["pieces"]
seeds = pytest.mark.parametrize("seed", range(4))


@seeds
def test_walls_that_meet_in_a_corner_are_bodies_of_their_own(seed: int) -> None:
    """Their four long sides go around too, as one thin outline that turns the corner."""
    rng = np.random.default_rng(seed)
    steady = replace(NEAT, tremor=0.0005, drift=0.001)  # for their length
    floor = [
        line([(114, 639), (1158, 638)], steady, rng),
        line([(108, 640), (102, 660), (1150, 661), (1162, 641)], steady, rng),
    ]
    wall = [
        line([(1189, 170), (1188, 600)], steady, rng),
        line([(1186, 172), (1206, 164), (1208, 592), (1190, 606)], steady, rng),
    ]
    marks = cross((500, 650), 15, NEAT, rng), cross((1198, 380), 15, NEAT, rng)
    found = read(*floor, *wall, *marks)
    assert kinds(found) == ["4-gon", "4-gon", "anchor", "anchor"]
    assert [b.anchored for b in found.scene.bodies] == [True, True]


@seeds
def test_two_strokes_close_beside_an_anchor_and_pivots(seed: int) -> None:
    """A tower whose left side lacks an end, with the ends of an X and of an arm nearer to it than its other stroke."""
    rng = np.random.default_rng(seed)
    left = line([(200, 250), (195, 520)], NEAT, rng)
    rest = line([(206, 210), (310, 208), (312, 650), (186, 648)], NEAT, rng)
    mark = cross((225, 500), 44, NEAT, rng)
    arm = outline(box(440, 205, 520, 50), replace(PIECES, parts=(4,)), rng)
    found = read(left, rest, mark, arm, circle((225, 207), 9, NEAT, rng), circle((285, 205), 9, NEAT, rng))
    assert kinds(found) == ["4-gon", "4-gon", "anchor", "pivot", "pivot"]
    assert [b.anchored for b in found.scene.bodies] == [True, False]


@seeds
def test_a_stray_line_within_is_no_side(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hill = [(420, 600), (790, 610), (610, 440)]
    sides = [line([hill[2], hill[0], hill[1]], NEAT, rng), line([hill[1], hill[2]], NEAT, rng)]
    stray = line([(657, 505), (607, 490), (557, 508)], NEAT, rng)
    found = read(*sides, stray)
    assert "3-gon" in kinds(found)
    assert (0, 1) in [r.strokes for r in found.readings]


@seeds
def test_rings_over_one_another_are_one_pivot(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frame, wheel = outline(box(400, 300, 340, 120), NEAT, rng), circle((300, 340), 55, NEAT, rng)
    hub, pin = circle((306, 334), 15, NEAT, rng), circle((299, 341), 8, NEAT, rng)
    scene = read(frame, wheel, hub, pin).scene
    assert len(scene.bodies) == 2
    (joint,) = scene.joints
    assert joint.position == pytest.approx((299 / 128, -341 / 128), abs=3 / 128)


@seeds
def test_a_pivot_where_a_body_reaches_with_its_ink(seed: int) -> None:
    """The sides of a foot run on beyond its tip, into the circle on the plank."""
    rng = np.random.default_rng(seed)
    foot = line([(650, 415), (700, 470), (760, 600), (560, 600), (668, 440)], NEAT, rng)
    plank = outline(box(650, 425, 600, 50), NEAT, rng)
    scene = read(foot, plank, circle((652, 420), 7, NEAT, rng)).scene
    assert [j.bodies for j in scene.joints] == [("b1", "b2")]


@seeds
def test_a_small_circle_where_two_bodies_meet_is_a_pivot_and_a_ball_that_lies_on_both_is_none(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    tower, arm = outline(box(250, 450, 120, 400), NEAT, rng), outline(box(420, 250, 400, 52), NEAT, rng)
    pin = read(tower, arm, circle((216, 247), 9, NEAT, rng)).scene
    assert [j.bodies for j in pin.joints] == [("b1", "b2")]
    ball = read(tower, arm, circle((207, 236), 12, NEAT, rng)).scene
    assert (len(ball.bodies), ball.joints) == (3, [])


@seeds
def test_a_wheel_that_its_frame_cuts_turns_on_it(seed: int) -> None:
    """A pin at the centre of a wheel beside the frame joins the two; one that only touches is pinned to the page."""
    rng = np.random.default_rng(seed)
    frame, wheel, pin = outline(box(400, 300, 340, 120), NEAT, rng), 384, 6
    cut = read(frame, circle((300, wheel), 50, NEAT, rng), circle((300, wheel), pin, NEAT, rng)).scene
    assert [j.bodies for j in cut.joints] == [("b1", "b2")]
    free = read(frame, circle((300, 408), 50, NEAT, rng), circle((300, 408), 5, NEAT, rng)).scene
    assert [j.bodies for j in free.joints] == [("b2", None)]


def rod(a: tuple[float, float], b: tuple[float, float], rng: np.random.Generator) -> list[list[Array]]:
    """A rod 40 thick in five strokes, of which each is up to 18 too long or too short at either end."""
    (x, y), (u, v) = a, (np.array(b) - a) / np.hypot(*np.subtract(b, a))
    long = math.dist(a, b)
    corners = [(-20.0, 20.0), (0.6 * long, 20.0), (long + 20, 20.0), (long + 20, -20.0), (-20.0, -20.0)]
    strokes = []
    for p, q in pairwise([*corners, corners[0]]):
        way = np.subtract(q, p) / math.dist(p, q)
        aside = rng.uniform(-2, 2) * np.array([-way[1], way[0]])
        ends = [np.add(e, rng.uniform(-18, 18) * way) + aside for e in (p, q)]
        strokes.append(line([(x + u * s - v * t, y + v * s + u * t) for s, t in ends], NEAT, rng))
    return strokes


@pytest.mark.parametrize("seed", range(16))
def test_rods_that_meet_end_to_end_are_each_their_own(seed: int) -> None:
    """The long sides of two go around as well, there and back, with smaller gaps."""
    rng = np.random.default_rng(seed)
    joints = [(300.0, 560.0), (340.0, 320.0), (800.0, 240.0), (860.0, 560.0)]
    rods = [stroke for a, b in pairwise(joints) for stroke in rod(a, b, rng)]
    found = read(*rods, *(circle(at, 9, NEAT, rng) for at in joints[1:3]))
    assert kinds(found) == ["4-gon"] * 3 + ["pivot"] * 2


@seeds
def test_a_clumsy_x_that_slips_off_its_body_anchors_it(seed: int) -> None:
    """Drawn in one stroke, with its middle below the hill, and with a bar that begins in it."""
    rng = np.random.default_rng(seed)
    hill = outline([(400, 600), (800, 600), (600, 400)], NEAT, rng)
    mark = [(-30, -20), (-2, 4), (30, 36), (18, -34), (0, 10), (-26, 32)]
    for below, anchored in ((8.0, True), (60.0, False)):
        found = read(hill, line([(600 + x, 600 + below + y) for x, y in mark], NEAT, rng))
        assert [b.anchored for b in found.scene.bodies] == [anchored]
        assert ("anchor" in kinds(found)) == anchored


@seeds
def test_a_hasty_ring_at_the_middle_of_a_wheel_is_its_axle(seed: int) -> None:
    """The pen went on into the ring, nearly as it would in an X drawn in one stroke."""
    rng = np.random.default_rng(seed)
    wheel = circle((400, 300), 90, NEAT, rng)
    ring = [(-4, 5), (6, 5), (12, -1), (9, -8), (2, -10), (-6, -5), (-6, 1), (-1, 6), (8, 7)]
    found = read(wheel, line([(400 + x, 300 + y) for x, y in ring], NEAT, rng))
    assert kinds(found) == ["circle", "pivot"]


@seeds
def test_a_rod_that_is_pinned_to_a_wheel_is_not_what_that_turns_on(seed: int) -> None:
    rng = np.random.default_rng(seed)
    wheel = circle((400, 360), 150, NEAT, rng)
    rod = outline(box(600, 360, 260, 30), NEAT, rng)
    axle, crank = circle((400, 360), 9, NEAT, rng), circle((485, 360), 8, NEAT, rng)
    joints = read(wheel, rod, axle, crank).scene.joints
    assert sorted((j.bodies for j in joints), key=str) == [("b1", "b2"), ("b1", None)]


@pytest.mark.parametrize("seed", range(8))
def test_two_rods_that_cross_under_a_pin_are_no_anchor_on_it(seed: int) -> None:
    """A scissor lift: the long sides of its rods cross like the bars of an X, and end on the base."""
    rng, hand = np.random.default_rng(seed), HANDS["shaky"]
    a, b, c, d = box(640, 540, 398, 30, -0.464)
    rods = [*line([d, a], hand, rng), *line([a, b], hand, rng), *line([b, c, d], hand, rng)]
    a, b, c, d = box(640, 540, 398, 30, 0.464)
    rods += [*line([d, a], hand, rng), *line([a, b], hand, rng), *line([b, c, d], hand, rng)]
    base = outline(box(640, 660, 500, 56), hand, rng)
    scene = read(base, rods, circle((640, 540), 8, hand, rng)).scene
    assert len(scene.bodies) == 3
    assert [joint.bodies for joint in scene.joints] == [("b2", "b3")]
