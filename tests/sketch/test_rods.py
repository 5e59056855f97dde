"""Open lines on pins: rods and ropes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from pages import Array, box, ngon, read

from sketch.synthetic import HANDS, Hand, arrow, circle, cross, curve, line, outline

Point = tuple[float, float]
SEEDS = range(4)


@pytest.mark.parametrize("hand", ["neat", "pieces", "shaky"])
@pytest.mark.parametrize("seed", SEEDS)
def test_lines_with_a_pin_at_each_end_are_rods_though_they_go_around(hand: str, seed: int) -> None:
    """A four-bar linkage: with the base's side its three lines would close."""
    rng = np.random.default_rng(seed)
    base = outline(box(640, 620, 760, 80), HANDS[hand], rng) + cross((640, 620), 40, HANDS[hand], rng)
    at: list[Point] = [(370, 604), (350, 430), (920, 310), (900, 604)]
    rods = [s for a, b in itertools.pairwise(at) for s in line([a, b], HANDS[hand], rng)]
    pins = [s for p in at for s in circle(p, 9, HANDS[hand], rng)]
    scene = read(base, rods, pins, arrow((90, 150), (90, 270), HANDS[hand], rng)).scene
    assert len(scene.bodies) == 4
    joined = [("b1", "b2"), ("b1", "b4"), ("b2", "b3"), ("b3", "b4")]
    assert sorted(tuple(sorted(map(str, joint.bodies))) for joint in scene.joints) == joined


@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_of_three_strokes_that_hangs_by_one_pin_is_a_body(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners: list[Point] = [(640, 200), (860, 560), (420, 560)]
    sides = [
        s for a, b in itertools.pairwise([*corners, corners[0]]) for s in line([a, b], HANDS["neat"], rng)
    ]
    scene = read(sides, circle(corners[0], 9, HANDS["neat"], rng)).scene
    assert len(scene.bodies) == 1


@pytest.mark.parametrize("seed", SEEDS)
def test_ropes_pinned_to_a_wheel_are_not_what_it_turns_on(seed: int) -> None:
    """A wheel nailed to the page, and two weights on ropes from its rim."""
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    strokes = [*circle((640, 200), 80, hand, rng), *circle((640, 200), 9, hand, rng)]
    for x, low in ((574, 430), (706, 520)):
        strokes += line([(x, 204), (x, low)], hand, rng) + circle((x, 204), 8, hand, rng)
        strokes += outline(box(x, low + 40, 100, 90), hand, rng) + circle((x, low + 4), 8, hand, rng)
    scene = read(strokes).scene
    assert len(scene.bodies) == 5
    joined = [("b1", "None"), ("b1", "b2"), ("b1", "b4"), ("b2", "b3"), ("b4", "b5")]
    assert sorted(tuple(map(str, joint.bodies)) for joint in scene.joints) == sorted(joined)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_bob_at_the_end_of_a_line_is_no_pin_of_it(seed: int) -> None:
    """Two pendulums that touch; each line ends in its bob's own pin."""
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    strokes = outline(box(640, 110, 600, 56), hand, rng) + cross((420, 110), 34, hand, rng)
    for x in (602, 678):
        strokes += line([(x, 114), (x, 420)], hand, rng) + circle((x, 114), 8, hand, rng)
        strokes += circle((x, 420), 37, hand, rng) + circle((x, 420), 8, hand, rng)
    scene = read(strokes).scene
    joined = [("b1", "b2"), ("b1", "b4"), ("b2", "b3"), ("b4", "b5")]
    assert sorted(tuple(map(str, joint.bodies)) for joint in scene.joints) == joined


@pytest.mark.parametrize("gap", [4, 11])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_ring_in_an_anchored_beam_joins_what_hangs_below_it(seed: int, gap: float) -> None:
    """The ring misses the rod, at most by twice its radius; to the page it would pin what is anchored already."""
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    beam = outline(box(640, 140, 600, 56), hand, rng) + cross((420, 140), 34, hand, rng)
    top = 168 + gap
    rod = outline(box(640, top + 120, 30, 240), hand, rng)
    scene = read(beam, rod, circle((640, 160), 9, hand, rng)).scene
    assert [tuple(map(str, joint.bodies)) for joint in scene.joints] == [("b1", "b2")]


def leg(top: Point, foot: Point, bow: float, hand: Hand, rng: np.random.Generator) -> list[Array]:
    """A line that the hand bends to one side and to the other, with a ring at its upper end."""
    t = np.linspace(0, 1, 40)
    aside = rng.choice([-bow, bow]) * np.sin(2 * np.pi * t)
    path = np.stack([top[0] + (foot[0] - top[0]) * t + aside, top[1] + (foot[1] - top[1]) * t], axis=1)
    return curve(path, hand, rng) + circle(top, 8, HANDS["neat"], rng)


@pytest.mark.parametrize(
    ("name", "pair", "astride", "bow"),
    [("neat", True, 20, 8), ("neat", False, 75, 14), ("shaky", False, 75, 8)],
)
def test_a_beam_on_legs_that_are_lines_is_no_box_with_the_ground(
    name: str, pair: bool, astride: float, bow: float
) -> None:
    """A ring holds each leg; a leg bends by more than the ring is large."""
    right, hand = 0, HANDS[name]
    for seed in range(8):
        rng = np.random.default_rng(seed)
        beam, legs = outline(box(640, 130, 800, 46), hand, rng), list[Array]()
        for x, side in ((280, -1), (280, 1), (1000, -1), (1000, 1)):
            if pair or (side > 0) == (x > 640):
                legs += leg((x + 14 * side, 132), (x + astride * side, 668), bow, hand, rng)
        ground = line([(60, 670), (1220, 672)], hand, rng) + cross((180, 671), 44, hand, rng)
        scene = read(ground, beam, legs, arrow((110, 170), (110, 300), hand, rng)).scene
        fixed = [body.anchored for body in scene.bodies]
        right += fixed == [True, False, *[False] * (4 if pair else 2)] and len(scene.joints) == len(fixed) - 2
    assert right >= 7, right  # of 8


@pytest.mark.parametrize("name", ["neat", "shaky"])
@pytest.mark.parametrize("seed", SEEDS)
def test_three_lines_with_a_ring_where_each_two_meet_are_rods(name: str, seed: int) -> None:
    """And a triangle of three strokes without rings, or with one ring at a corner, is a body."""
    hand, rng = HANDS[name], np.random.default_rng(seed)
    corners = [(640.0, 130.0), (400.0, 400.0), (880.0, 405.0)]
    sides = [line(list(pair), hand, rng) for pair in itertools.combinations(corners, 2)]
    rings = [circle(corner, 9, HANDS["neat"], rng) for corner in corners]
    assert [r.kind for r in read(*sides, *rings).readings] == ["bar"] * 3 + ["pivot"] * 3
    for some in ([], rings[:1]):
        assert len(read(*sides, *some).readings[0].strokes) == 3


@pytest.mark.parametrize("seed", SEEDS)
def test_a_beam_of_two_strokes_between_two_weights_is_no_pair_of_rods(seed: int) -> None:
    """Each stroke is a long side and a short one, and ends in a weight: that is no ring which holds it."""
    hand, rng = HANDS["neat"], np.random.default_rng(seed)
    upper = line([(300, 333), (300, 300), (860, 300)], hand, rng)
    lower = line([(300, 333), (860, 333), (860, 300)], hand, rng)
    weights = [outline(ngon(5, x, 318, 60), hand, rng) for x in (285, 875)]
    assert next(body.strokes for body in read(upper, lower, *weights).scene.bodies) == [0, 1]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_beam_with_legs_pinned_under_it_is_no_box_with_the_ground(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    ground = line([(250, 600), (1030, 602)], hand, rng) + cross((650, 600), 34, hand, rng)
    beam = line([(350, 260), (930, 262)], hand, rng)
    legs = [s for x, foot in ((440, 420), (840, 860)) for s in line([(x, 261), (foot, 520)], hand, rng)]
    pins = [s for x in (440, 840) for s in circle((x, 261), 9, hand, rng)]
    scene = read(ground, beam, legs, pins, arrow((90, 150), (90, 270), hand, rng)).scene
    assert [body.anchored for body in scene.bodies] == [True, False, False, False]
    assert [tuple(joint.bodies) for joint in scene.joints] == [("b2", "b3"), ("b2", "b4")]


@pytest.mark.parametrize("seed", SEEDS)
def test_rods_that_cross_under_a_pin_are_no_x(seed: int) -> None:
    """Their ends come near to a floor, as those of an X drawn beside it would."""
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    floor = outline(box(640, 655, 1000, 60), hand, rng)
    rods = line([(450, 630), (830, 330)], hand, rng) + line([(830, 632), (450, 330)], hand, rng)
    scene = read(floor, rods, circle((640, 480), 9, hand, rng)).scene
    assert [tuple(joint.bodies) for joint in scene.joints] == [("b2", "b3")]
    assert not any(body.anchored for body in scene.bodies)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_wheel_with_an_axle_is_no_pin_however_long_its_cart_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand = HANDS["neat"]
    strokes = outline(box(640, 600, 1000, 60), hand, rng) + outline(box(640, 480, 520, 110), hand, rng)
    for x in (460, 640, 820):
        strokes += circle((x, 530), 38, hand, rng) + circle((x, 530), 8, hand, rng)
    scene = read(strokes).scene
    assert [tuple(joint.bodies) for joint in scene.joints] == [("b2", "b3"), ("b2", "b4"), ("b2", "b5")]
