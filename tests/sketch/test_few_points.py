"""Strokes of few points: corners that lie between two of them come back, and nothing else does."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pages import box, kinds, ngon, read

from sketch.page.pieces import Page
from sketch.page.sampling import arced, sampled, unevenness
from sketch.shapes.outlines import read_outline
from sketch.synthetic import HANDS, Hand, circle, ellipse, outline
from tests.benchmarks.drawings import overlap


def in_steps(path: np.ndarray, count: int) -> np.ndarray:
    """So many points along a path, (n, 2), at equal distances."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    t = np.linspace(0, along[-1], count)
    return np.stack([np.interp(t, along, path[:, k]) for k in (0, 1)], axis=1)


def closed(corners: list[tuple[float, float]], start: float) -> np.ndarray:
    """Once around a polygon, begun at a share of its first side."""
    ring = np.array([*corners, corners[0]])
    first = ring[0] + start * (ring[1] - ring[0])
    return np.concatenate([[first], ring[1:], [first]])


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    start=st.floats(0.0, 0.9),
    wide=st.floats(1.0, 2.2),
    turn=st.floats(0, 6.2),
)
def test_the_cut_corners_of_a_box_come_back(start: float, wide: float, turn: float) -> None:
    corners = box(400, 300, 160 * wide, 160, turn)
    few = in_steps(closed(corners, start), 10)
    assert kinds(read([few])) == ["4-gon"]
    more = sampled(few).points
    for corner in corners[1:]:  # a corner right beside a point may be that point
        assert np.hypot(*(more - corner).T).min() < 0.12 * 160


def test_a_sharp_corner_is_one_and_the_end_of_a_bar_two() -> None:
    wedge = [(100.0, 400.0), (600.0, 400.0), (100.0, 200.0)]
    beam = box(500, 300, 800, 60)
    for start in np.linspace(0, 0.9, 10):
        assert kinds(read([in_steps(closed(wedge, start), 10)])) == ["3-gon"]
        assert kinds(read([in_steps(closed(beam, start), 10)])) == ["4-gon"]


def test_few_points_of_a_triangle_with_rounded_corners() -> None:
    read_right = 0
    for start in np.linspace(0.05, 0.95, 19):
        for wide in (420.0, 500.0, 580.0):
            dense = in_steps(
                closed([(100.0, 400.0), (100.0 + wide, 400.0), (100.0 + 0.5 * wide, 230.0)], start), 400
            )
            around = np.concatenate([dense[-18:-1], dense, dense[1:18]])
            blunt = np.stack(
                [np.convolve(around[:, k], np.full(35, 1 / 35), "valid") for k in (0, 1)], axis=1
            )
            read_right += kinds(read([in_steps(blunt, 10)])) == ["3-gon"]
    assert read_right >= 48  # of 57: where a point lies on the tip, nothing says that it is one


@pytest.mark.parametrize("hand", ["neat", "quick", "shaky"])
def test_ten_points_of_a_circle_are_a_circle(hand: str) -> None:
    for seed in range(10):
        ring = circle((400, 300), 90, HANDS[hand], np.random.default_rng(seed))
        assert kinds(read([in_steps(s, 10) for s in ring])) == ["circle"]


@pytest.mark.parametrize("count", [9, 10, 11, 12])
def test_even_steps_are_round_and_uneven_ones_cornered(count: int) -> None:
    rng = np.random.default_rng(count)
    for seed in range(8):
        wide, angle = rng.uniform(1.0, 1.15), np.linspace(0, 6.3, 200) + rng.uniform(0, 6.3)
        ring = np.column_stack([400 + 90 * wide * np.cos(angle), 300 + 90 * np.sin(angle)])
        assert kinds(read([in_steps(ring, count)])) == ["circle"], seed
        if count == 9:  # too few for what has five corners
            continue
        five = ngon(5, 400, 300, 100, rng.uniform(0, 6.3))
        assert kinds(read([in_steps(closed(five, rng.uniform(0, 0.9)), count)])) == ["5-gon"], seed


def test_steps_are_even_along_what_is_round_and_uneven_around_corners() -> None:
    middle = np.array([400.0, 300.0])
    for axes in (np.diag([90.0, 90.0]), np.array([[120.0, -30.0], [70.0, 50.0]])):
        angle = np.linspace(0.4, 6.7, 400)
        ring = middle + np.column_stack([np.cos(angle), np.sin(angle)]) @ axes.T
        assert unevenness([in_steps(ring, 10)], middle, axes) < 0.03
        five = middle + 1.1 * (np.array(ngon(5, 0, 0, 1)) @ axes.T)
        corners = [(x, y) for x, y in five.tolist()]
        assert unevenness([in_steps(closed(corners, 0.3), 10)], middle, axes) > 0.06


def test_between_points_of_something_round_the_ink_goes_along_its_arcs() -> None:
    middle, axes = np.array([400.0, 300.0]), np.array([[120.0, -30.0], [70.0, 50.0]])
    angle = np.linspace(0.4, 6.9, 10)
    points = middle + np.column_stack([np.cos(angle), np.sin(angle)]) @ axes.T
    ink = arced(points, middle, axes)
    assert np.allclose(ink[::6], points)
    off = np.hypot(*np.linalg.solve(axes, (ink - middle).T))
    assert len(ink) == 55
    assert np.allclose(off, 1)


def test_few_points_of_an_oval_have_no_corners() -> None:
    read_right = 0
    for seed, count, drift in itertools.product(range(40), (9, 10), (0.045, 0.06)):
        rng, hand = np.random.default_rng([seed, count]), Hand(drift=drift, overshoot=0.03)
        oval = ellipse((400, 300), (130, 62), rng.uniform(0, 6.3), hand, rng)
        few, many = kinds(read([in_steps(s, count) for s in oval])), kinds(read(oval))
        # an outline of any course has as many corners as there are points, where these are few
        read_right += few == many or {*few, *many} <= {f"{n}-gon" for n in range(count, 33)}
    assert read_right >= 148, read_right  # of 160


def test_a_part_of_which_one_point_was_given_says_nothing_of_steps() -> None:
    angle = np.linspace(0, 6.0, 41)
    ring = np.column_stack([400 + 90 * np.cos(angle), 300 + 90 * np.sin(angle)])
    arc, rest = ring[:33:4], ring[32:]
    page = Page(1000.0)
    page.add([arc, rest], [arc, rest[:1]])
    page.settle()
    best = min(read_outline(page, [(0, False), (1, False)]), key=lambda f: f.cost)
    assert best.kind == "circle"


def test_a_hexagon_said_by_its_corners_is_one() -> None:
    assert kinds(read([closed(ngon(6, 400, 300, 100), 0.0)])) == ["6-gon"]


def test_a_shaky_box_has_no_full_step() -> None:
    along = np.linspace(0, 1, 400)
    read_right = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        course = in_steps(closed(box(400, 300, 170, 160), 0.93), 400)
        shake = np.stack(
            [np.convolve(rng.normal(0, 9, 440), np.full(41, 1 / 41), "valid")[:400] for _ in "xy"], axis=1
        )
        course += shake + 6 * np.sin(90 * along)[:, None]
        read_right += kinds(read([in_steps(course, 10)])) == ["4-gon"]
    assert read_right >= 18, read_right


def test_a_hook_bends_no_circle() -> None:
    angle = np.linspace(0, 5.6, 10)
    ring = np.column_stack([400 + 90 * np.cos(angle), 300 + 90 * np.sin(angle)])
    ring[0] += 0.2 * (ring[1] - ring[0]) + (-8, 0)  # the pen went down a little within it
    assert np.array_equal(sampled(ring).points, ring)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10**6), count=st.integers(5, 24))
def test_points_in_unequal_steps_stay_as_they_are(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(0, 30, (count, 2)), axis=0)
    steps = np.sort(np.hypot(*np.diff(points, axis=0).T))
    if (steps > 0.9 * steps[-1]).sum() < max(3, (count - 1) / 3):
        assert np.array_equal(sampled(points).points, points)


def test_many_points_are_thinned_and_others_kept() -> None:
    hexagon = outline(ngon(6, 300, 300, 100), HANDS["neat"], np.random.default_rng(1))[0]
    assert np.array_equal(sampled(hexagon).points, hexagon)
    long = in_steps(closed(box(0, 0, 300, 200), 0.3), 100_000)
    assert len(sampled(long).points) < 5000


@pytest.mark.parametrize("first", range(5))
@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (200, 0), (200, 200), (100, 300), (0, 200)],
        [(0, 0), (150, 0), (200, 100), (150, 200), (0, 200), (-50, 100)],
    ],
    ids=["house", "hexagon"],
)
def test_corners_alone_are_the_outline_between_them(corners: list[tuple[float, float]], first: int) -> None:
    """Though some of the sides are equally long: fewer points than this are no samples of a course."""
    meant = np.array([300, 200]) + np.roll(np.array(corners, float), first, axis=0)
    (reading,) = read([np.concatenate([meant, meant[:1]])]).readings
    assert overlap(meant, reading.outline) > 0.99
