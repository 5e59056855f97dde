"""Pivots at the ends of rods: rings that other lines run into, run along and run across."""

from __future__ import annotations

from itertools import count, pairwise

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from sheets import even
from test_tangles import BOX, Line, circle, inked, kinds, read

from sketch.scan.binding import thin, trace
from sketch.scan.skeleton.graph import Edge, Graph, build_graph
from sketch.scan.strokes.rings import find_rings, is_part, take_rings
from sketch.scan.strokes.ways import Way, Ways


def rings(lines: list[Line], pen: float) -> list[tuple[NDArray[np.float64], float]]:
    """The middle and the radius of each ring that is found."""
    mask = (inked(lines, pen) > 0.5).astype(np.uint8)
    found = find_rings(mask, cv2.distanceTransform(mask, cv2.DIST_L2, 3), pen)
    middles = [(ring.points.min(axis=0) + ring.points.max(axis=0)) / 2 for ring in found]
    return [
        (middle, float(np.hypot(*(ring.points - middle).T).mean()))
        for middle, ring in zip(middles, found, strict=True)
    ]


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("gap", [1.3, 1.5, 1.7])
def test_what_lies_between_a_ring_and_a_corner_beside_it_is_no_ring(pen: float, gap: float) -> None:
    radius, near = 2 * pen, (2 + gap) * pen
    corner: Line = [(200 - near, 100), (200 - near, 200 + near), (330, 200 + near)]
    brace: Line = [(200 - near, 200 + 0.2 * pen), (200 - 0.2 * pen, 200 + near)]
    ((middle, size),) = rings([circle(200, 200, radius), corner, brace], pen)
    assert np.hypot(*(middle - 200)) < 1.5
    assert abs(size - radius) < 1.5


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("low", [0.0, 0.5, 0.8])
def test_half_of_a_ring_that_a_line_crosses_is_no_ring(pen: float, low: float) -> None:
    radius = 2.6 * pen
    line: Line = [(100, 200 + low * pen), (300, 202 + low * pen)]
    ((middle, size),) = rings([circle(200, 200, radius), line], pen)
    assert np.hypot(*(middle - 200)) < 2
    assert abs(size - radius) < 2


def test_two_lines_that_run_beside_each_other_are_no_ring() -> None:
    pen, wide = 4.8, 8.0  # it was slow there
    mask = (inked([[(60, 200), (340, 204)], [(200, 208), (206, 208)]], wide) > 0.5).astype(np.uint8)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    edges = build_graph(trace(*thin(mask)), distance, pen).edges
    assert find_rings(mask, distance, pen)
    assert not find_rings(mask, distance, pen, edges)


def test_what_a_line_across_a_ring_cuts_off_is_part_of_it() -> None:
    ring = np.array(circle(200, 200, 10))
    part = np.concatenate([ring[10:35], ring[10:11]])
    assert is_part(Way(part, {}), [ring], 4.0)
    assert not is_part(Way(part[:-1], {}), [ring], 4.0)
    assert not is_part(Way(ring, {}), [ring], 4.0)
    assert not is_part(Way(part + 40, {}), [ring], 4.0)


def test_a_rod_that_ends_in_a_hook_within_its_ring_has_no_side_of_the_ring() -> None:
    """What the hook cuts off of the ring would be a pivot, and the ring's other half a side of the rod."""
    pen, middle = 2.5, (250.0, 190.0)
    hook = [(0.7, 7.0), (0.3, 2.6), (-0.6, 0.5), (1.9, -2.2), (3.6, -3.2)]
    rod: Line = [(middle[0] + pen * x, middle[1] + pen * y) for x, y in hook]
    rod += [(343.7, 305.8), (325.1, 318.5), (244.9, 201.3)]
    scene = read([BOX, circle(*middle, 2.7 * pen), rod], pen)
    assert len(scene.joints) == 1
    assert kinds(scene) == ["rectangle", "rectangle"]


def test_a_ring_at_which_lines_meet_beyond_its_belt_is_taken_out_of_them() -> None:
    middle, tip, end = np.array([[200.0, 200.0], [200.0, 216.0], [200.0, 300.0]])
    turn = np.linspace(0.3, 2 * np.pi - 0.3, 60)
    around = middle + 8 * np.stack([np.sin(turn), np.cos(turn)], axis=1)
    loop = np.concatenate([even(tip, around[0]), around, even(around[-1], tip)])
    ring = Way(np.array(circle(200, 200, 8)), {})
    graph = Graph(tip[None], np.array([2.0]), [Edge(loop, (0, 0)), Edge(even(tip, end), (0, -1))])
    _, taken = take_rings(graph, [ring], 4.0, count())
    assert len(taken) == 1
    _, alone = take_rings(Graph(tip[None][:0], np.zeros(0), [Edge(around, (-1, -1))]), [ring], 4.0, count())
    assert not alone


@pytest.mark.parametrize("pen", [4.0, 5.5])
def test_a_ring_with_hardly_a_hole_is_one_among_the_lines_of_its_rod(pen: float) -> None:
    radius = 1.2 * pen
    sides: list[Line] = [[(200 + side * 1.2 * radius, 80), (200 + side * radius, 204)] for side in (-1, 1)]
    ((middle, _),) = rings([circle(200, 200, radius), *sides], pen)
    assert np.hypot(*(middle - 200)) < 2


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("angle", [0.1, 0.2])
def test_a_ring_that_the_ends_of_its_rods_are_all_around_is_one(pen: float, angle: float) -> None:
    """No paper is beside it: its hole alone shows it."""
    radius = 1.35 * pen

    def rod(turn: float) -> Line:
        end = [(60.0, -2.0), (-2.0, -2.0), (-2.0, 2.0), (60.0, 2.0)]
        x, y, c, s = *(pen * np.array(end)).T, np.cos(turn), np.sin(turn)
        return [(250 + float(a), 200 + float(b)) for a, b in zip(x * c - y * s, x * s + y * c, strict=True)]

    ((middle, size),) = rings([circle(250, 200, radius), rod(angle), rod(np.pi - angle)], pen)
    assert np.hypot(*(middle - [250, 200])) < 0.3 * pen
    assert abs(size - radius) < 0.3 * pen


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("far", [40.0, 60.0])
def test_a_ring_whose_hole_two_sides_closed_is_where_their_ink_is_deepest(pen: float, far: float) -> None:
    """The sides lie on each other to the right of it, so that thick ink goes on there."""
    sides: list[Line] = [
        [(100, 200 - 0.5 * pen), (200 + far, 200)],
        [(100, 205), (200 + far, 200 + 0.6 * pen)],
    ]
    ((middle, _),) = rings([circle(200, 200, 1.2 * pen), *sides], pen)
    assert np.hypot(*(middle - 200)) < 0.5 * pen


@pytest.mark.parametrize("pen", [4.0, 5.5])
def test_rods_that_end_in_their_rings_are_rods_however_many_they_are(pen: float) -> None:
    """Their short sides are ink of the rings, or lost in it; each long side has its other beside it."""
    beam: Line = [(20, 30), (500, 32), (498, 84), (22, 82), (20, 30)]
    lines: list[Line] = [beam]
    for x in (80, 170, 260, 350, 440):
        top, low = 56.0, 290.0
        lines.append([(x - 13, top + 3), (x - 13, low), (x + 13, low), (x + 13, top), (x - 13, top + 3)])
        lines += [circle(x, top + 1, 13), circle(x, low, 13), circle(x, low, 38)]
    scene = read(lines, pen)
    assert kinds(scene) == ["circle"] * 5 + ["rectangle"] * 6
    assert len(scene.joints) == 10


def test_two_sides_are_closed_to_an_outline_where_rings_are_between_their_ends() -> None:
    pen, top, low = 4.0, 90.0, 350.0
    lines: list[Line] = [[(200 + side, top), (200 + side, low)] for side in (-15, 15)]
    lines += [[(60, 150), (400, 152)], [(60, 300), (400, 302)]]
    pivots = [circle(200, y, 9) for y in (top + 8, low - 8)]
    mask = (inked(lines + pivots, pen) > 0.5).astype(np.uint8)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    graph = build_graph(trace(*thin(mask)), distance, pen)
    found = [ring.points for ring in find_rings(mask, distance, pen)]

    def closed(rings: list[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
        ways = [way.points for way in Ways(graph, pen, rings).others()]
        tall = [points for points in ways if np.ptp(points[:, 1]) > 240 and np.ptp(points[:, 0]) < 40]
        return [points for points in tall if np.array_equal(points[0], points[-1])]

    assert len(found) == 2
    assert not closed([])
    (outline,) = closed(found)
    x, y = outline.min(axis=0), outline.max(axis=0)
    assert np.allclose([x, y], [(185, top), (215, low)], atol=3)


def test_lines_across_a_rope_that_a_ring_holds_are_lines() -> None:
    """The rope goes on beyond the picture, and none of its stretches between them is much of it."""
    rope: Line = [(60, 200), (740, 204)]
    across: list[Line] = [[(x, 150.0), (x + 3.0, 250.0)] for x in np.linspace(110, 690, 14).tolist()]
    scene = read([rope, *across, circle(60, 200, 9)], 3.0)
    assert kinds(scene).count("rectangle") > 7


def rod(a: NDArray[np.float64], b: NDArray[np.float64], wide: float) -> Line:
    """A rectangle that reaches beyond two places on its axis."""
    u = (b - a) / np.hypot(*(b - a))
    side, over = np.array([-u[1], u[0]]) * wide / 2, 0.7 * wide * u
    corners = [a - over + side, b + over + side, b + over - side, a - over - side]
    return [(float(x), float(y)) for x, y in [*corners, corners[0]]]


@pytest.mark.parametrize("pen", [2.5, 4.0])
@pytest.mark.parametrize("seed", range(10))
def test_the_rods_of_a_chain_have_ink_in_common_where_they_are_joined(pen: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ways = rng.uniform(-0.2, 0.6) + np.cumsum(rng.uniform(-0.7, 0.7, 3))
    joints = np.cumsum([(0.0, 0.0), *(115 * np.array([np.cos(t), np.sin(t)]) for t in ways)], axis=0)
    joints += np.array([260, 210]) - (joints.min(axis=0) + joints.max(axis=0)) / 2
    rods = [rod(a, b, 34) for a, b in pairwise(joints)]
    scene = read([*rods, *(circle(x, y, 8) for x, y in joints[1:-1].tolist())], pen)
    assert kinds(scene) == ["rectangle"] * 3
    assert len(scene.joints) == 2
