"""Bodies in a crowd of other ink: each is what its own strokes make, whatever else ends nearby."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pages import box, kinds, read

from sketch.synthetic import HANDS, circle, cross, line, outline

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
