"""Pins by a hand that trembles by a pixel however small it draws: a small ring is hardly round, and still a pin."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from pages import box, read

from sim import simulate
from sketch.synthetic import HANDS, Hand, arrow, circle, cross, line, outline

Point = tuple[float, float]
HAND = Hand(tremor=0.002, drift=0.008, rounding=0.02, overshoot=0.02, spacing=0.03, unsteady=0.7)
MARK = Hand(drift=0.03, overshoot=0.03, spacing=0.11, unsteady=0.7)  # the same, drawing pins: 8 points or so
SEEDS = range(8)


def rod(a: Point, b: Point, rng: np.random.Generator) -> list[np.ndarray]:
    """An outline along two pins and a little beyond."""
    (ax, ay), (bx, by) = a, b
    along = complex(bx - ax, by - ay)
    middle = (ax + bx) / 2, (ay + by) / 2
    return outline(box(*middle, abs(along) + 30, 26, float(np.angle(along))), HAND, rng)


def pins(at: list[Point], rng: np.random.Generator) -> list[np.ndarray]:
    return [stroke for p in at for stroke in circle(p, 8, MARK, rng)]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rough_ring_over_two_rods_joins_them(seed: int) -> None:
    """A four-bar linkage."""
    rng = np.random.default_rng(seed)
    at: list[Point] = [(380, 612), (440, 480), (830, 330), (880, 612)]
    rods = [stroke for a, b in itertools.pairwise(at) for stroke in rod(a, b, rng)]
    base = outline(box(640, 620, 700, 50), HAND, rng) + cross((640, 620), 30, HAND, rng)
    scene = read(base, rods, pins(at, rng), arrow((1150, 120), (1150, 240), HAND, rng)).scene
    assert len(scene.bodies) == 4
    joined = [("b1", "b2"), ("b1", "b4"), ("b2", "b3"), ("b3", "b4")]
    assert sorted(joint.bodies for joint in scene.joints) == joined


@pytest.mark.parametrize("seed", SEEDS)
def test_a_line_between_two_pins_is_a_rope_and_no_slip_of_the_pen(seed: int) -> None:
    """A crane's, from its long arm to a crate."""
    rng = np.random.default_rng(seed)
    arm = outline(box(640, 280, 640, 34), HAND, rng) + cross((400, 280), 24, HAND, rng)
    crate = outline(box(930, 520, 80, 70), HAND, rng)
    rope = line([(930, 280), (930, 500)], HAND, rng)
    scene = read(arm, crate, rope, pins([(930, 280), (930, 500)], rng)).scene
    assert len(scene.bodies) == 3
    assert sorted(joint.bodies for joint in scene.joints) == [("b1", "b3"), ("b2", "b3")]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_pin_through_three_bodies_joins_all(seed: int) -> None:
    """The sails of a windmill, and its tower; a wall behind the whole is no part of it."""
    rng = np.random.default_rng(seed)
    wall = outline(box(640, 380, 1000, 660), HAND, rng)
    tower = outline([(560, 690), (610, 330), (670, 330), (720, 690)], HAND, rng) + cross(
        (640, 600), 36, HAND, rng
    )
    sails = rod((430, 260), (850, 440), rng) + rod((550, 560), (730, 140), rng)
    for behind in ([], wall):
        scene = read(behind, tower, sails, pins([(640, 350)], rng)).scene
        first = len(scene.bodies) - 3
        assert [b.anchored for b in scene.bodies[first:]] == [True, False, False]
        tower_id, *sail_ids = (b.id for b in scene.bodies[first:])
        pairs = [(tower_id, sail_ids[0]), (tower_id, sail_ids[1]), tuple(sail_ids)]
        assert sorted(joint.bodies for joint in scene.joints) == pairs


@pytest.mark.parametrize("seed", range(3))
def test_a_truss_carries_itself_and_rests_on_what_it_overlaps(seed: int) -> None:
    """Seven rods, of which two to four meet at a pin, on two supports that its ends were drawn a little into."""
    rng = np.random.default_rng(seed)
    a, b, c, d, e = at = [(300.0, 500.0), (500.0, 500.0), (700.0, 500.0), (400.0, 330.0), (600.0, 330.0)]
    ends = ((a, b), (b, c), (a, d), (d, b), (b, e), (e, c), (d, e))
    rods = [stroke for p, q in ends for stroke in rod(p, q, rng)]
    supports = [
        stroke
        for x in (290, 710)
        for stroke in outline(box(x, 560, 120, 110), HAND, rng) + cross((x, 575), 30, HAND, rng)
    ]
    scene = read(supports, rods, pins(at, rng), arrow((1150, 120), (1150, 240), HAND, rng)).scene
    assert (len(scene.bodies), [b.anchored for b in scene.bodies[:2]]) == (9, [True, True])
    run = simulate(scene, duration=3.0)
    assert np.abs(run.positions[-1] - [b.position for b in scene.bodies]).max() < 0.2
    assert run.profile["let_overlap"] == 0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rod_on_the_rim_of_a_wheel_leaves_its_frame_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frame = outline(box(500, 400, 260, 300), HAND, rng) + cross((400, 520), 30, HAND, rng)
    wheel = circle((540, 380), 100, HAND, rng)
    scene = read(frame, wheel, rod((580, 330), (900, 330), rng), pins([(540, 380), (580, 330)], rng)).scene
    assert sorted(joint.bodies for joint in scene.joints) == [("b1", "b2"), ("b2", "b3")]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_pin_may_join_two_lines(seed: int) -> None:
    """A pendulum of one line that hangs from another; the ball on the ground beside it is pinned to nothing."""
    rng = np.random.default_rng(seed)
    ceiling = line([(300, 100), (900, 104)], HAND, rng) + cross((450, 102), 28, HAND, rng)
    rope, bob = line([(640, 102), (560, 400)], HAND, rng), circle((555, 430), 36, HAND, rng)
    ground = line([(700, 600), (1200, 602)], HAND, rng) + cross((1100, 600), 28, HAND, rng)
    ball = circle((800, 560), 40, HAND, rng)
    rings = circle((640, 102), 9, HAND, rng) + circle((560, 404), 9, HAND, rng)
    scene = read(ceiling, rope, bob, ground, ball, rings).scene
    assert sorted(joint.bodies for joint in scene.joints) == [("b1", "b2"), ("b2", "b3")]
    assert len(scene.bodies) == 5


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("x", [326, 321])
def test_a_rod_that_ends_short_of_its_pin_is_none_that_the_wheel_turns_on(x: int, seed: int) -> None:
    """A crank wheel nailed to the page: its rod begins beside the middle of the pin on the wheel's rim."""
    rng = np.random.default_rng(seed)
    wheel = circle((330, 400), 96, HAND, rng)
    block = outline(box(800, 400, 140, 90), HAND, rng)
    con_rod = outline(box(568, 370, 480, 26, 0.13), HAND, rng)
    rings = [circle(at, 8, HAND, rng) for at in ((330, 400), (x, 338), (790, 400))]
    scene = read(wheel, block, con_rod, *rings).scene
    assert sorted(tuple(map(str, joint.bodies)) for joint in scene.joints) == [
        ("b1", "None"),
        ("b1", "b3"),
        ("b2", "b3"),
    ]


def test_a_note_of_a_ring_that_may_be_a_ball_names_the_body_as_the_scene_does() -> None:
    rng, hand = np.random.default_rng(1), HANDS["neat"]
    pinned = [
        outline(box(250, 300, 300, 200), hand, rng),
        outline(box(300, 420, 60, 320), hand, rng),
        circle((300, 320), 9, hand, rng),  # a pivot, and no body: the third is the box after it
    ]
    alone = [outline(box(850, 300, 200, 200), hand, rng), circle((850, 300), 20, hand, rng)]
    scene = read(*pinned, *alone).scene
    (note,) = (text for text in scene.notes if "small circle" in text)
    assert f" {scene.bodies[2].id} " in note


@pytest.mark.parametrize("seed", SEEDS)
def test_a_ring_aside_of_a_wheel_s_middle_joins_it_to_what_it_all_but_reaches(seed: int) -> None:
    """A cart whose wheels hang below its frame, by pins near their rims; a wheel nailed to the page has its nail in the
    middle."""
    rng = np.random.default_rng(seed)
    neat = HANDS["neat"]
    frame = outline(box(640, 400, 400, 90), HAND, rng)
    wheels = [circle((x, 507), 52, HAND, rng) for x in (520, 760)]
    free = circle((200, 300), 60, HAND, rng)
    rings = [stroke for at in ((520, 462), (760, 462), (200, 300)) for stroke in circle(at, 8, neat, rng)]
    scene = read(frame, *wheels, free, rings).scene
    assert len(scene.bodies) == 4
    assert [joint.bodies for joint in scene.joints] == [("b1", "b2"), ("b1", "b3"), ("b4", None)]


@pytest.mark.parametrize("seed", range(20))
def test_a_pin_with_a_stray_dash_is_no_letter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    beam = outline(box(640, 200, 420, 60), HAND, rng) + cross((760, 200), 24, HAND, rng)
    rod = outline(box(600, 360, 40, 360), HAND, rng)
    pin = circle((600, 205), 12, HANDS["neat"], rng) + line([(610.8, 211.6), (625.8, 207.4)], MARK, rng)
    scene = read(beam, rod, pin, arrow((1150, 120), (1150, 240), HAND, rng)).scene
    assert [joint.bodies for joint in scene.joints] == [("b1", "b2")]
    assert [b.anchored for b in scene.bodies] == [True, False]
