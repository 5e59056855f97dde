"""Small marks under a wide pen, where ink closes over itself: Xs in one stroke, hairpins, the corners of hexagons."""

from __future__ import annotations

import math
from itertools import pairwise

import cv2
import numpy as np
import pytest
from sheets import HEIGHT, WIDTH, drawn, encoded, even, ink
from test_tangles import BOX, circle, inked, kinds, read

from sketch.recognize import recognize
from sketch.scan import read_picture
from sketch.scan.binding import distances, thin, trace
from sketch.scan.paper.faint import drop_faint_marks
from sketch.scan.skeleton.corners import sharpen_corners
from sketch.scan.skeleton.graph import Edge, Graph, build_graph
from sketch.scan.skeleton.junctions import find_junctions
from sketch.scan.strokes.hidden import going_on
from sketch.scan.strokes.rings import find_rings
from sketch.scan.strokes.ways import Way, Ways

Line = list[tuple[float, float]]


def x_with_a_side(x: float, y: float, half: float, bow: float) -> Line:
    """One stroke: a bar, a side that bows out by so much, the other bar."""
    t = np.linspace(-1, 1, 9)[1:-1]
    side = [(x + half + bow * float(1 - v * v), y + half * float(v)) for v in t]
    return [(x - half, y + half), (x + half, y - half), *side, (x + half, y + half), (x - half, y - half)]


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("half", [10, 12, 15])
@pytest.mark.parametrize("bow", [0, 0.25])
def test_a_small_x_in_one_stroke_anchors_its_box(pen: float, half: float, bow: float) -> None:
    scene = read([BOX, x_with_a_side(250, 250, half, bow * half)], pen)
    assert kinds(scene) == ["rectangle"]
    assert scene.bodies[0].anchored
    assert not scene.joints


@pytest.mark.parametrize(("pen", "hook"), [(2.5, 1.5), (3.0, 1.0)])
def test_a_corner_where_the_pen_rested_is_no_body(pen: float, hook: float) -> None:
    """A slow pen draws more than twice as wide: its ink is no filled shape of which the outline would be a body."""
    (x, y), size = BOX[0], hook * pen
    slow = inked([[(x + size, y + 0.9 * size), (x, y), (x + 0.2 * size, y + size)]], 2.6 * pen)
    ink = np.maximum(inked([BOX], pen), slow)
    scene = recognize(read_picture(encoded(drawn(ink, noise=1.5)))).scene
    assert kinds(scene) == ["rectangle"]
    assert not scene.joints


@pytest.mark.parametrize("pen", [2.5, 4.0, 5.5])
def test_a_ring_in_a_box_is_no_x(pen: float) -> None:
    scene = read([BOX, circle(250, 250, 12)], pen)
    assert not scene.bodies[0].anchored


def test_what_has_a_ring_in_it_is_no_ring() -> None:
    """However round it is: a pivot drawn in haste within a small wheel is the ring, and keeps its ink."""
    turn = np.linspace(0, 2 * np.pi, 41)
    hasty = 9 * (1 + 0.1 * np.cos(4 * turn))
    pivot: Line = [(200 + r * np.cos(a), 200 + r * np.sin(a)) for r, a in zip(hasty, turn, strict=True)]
    mask = (inked([circle(200, 200, 22), pivot], 5.0) > 0.5).astype(np.uint8)
    (ring,) = find_rings(mask, cv2.distanceTransform(mask, cv2.DIST_L2, 3), 5.0)
    radius = np.hypot(*(ring.points - 200).T)
    assert radius.max() < 12


@pytest.mark.parametrize(("pen", "back"), [(4.0, 8), (4.0, 14), (5.5, 8)])
def test_an_arrow_whose_pen_came_back_beside_a_barb_is_one_arrow(pen: float, back: float) -> None:
    arrow: Line = [(450, 60), (450, 250), (488, 165), (470 + back, 275), (415, 190)]
    scene = read([BOX, arrow], pen)
    assert kinds(scene) == ["rectangle"]
    assert abs(np.arctan2(scene.gravity[0], -scene.gravity[1])) < 0.2


@pytest.mark.parametrize("pen", [4.0, 5.5, 9.0])
@pytest.mark.parametrize("gap", [0.7, 1.0])
@pytest.mark.parametrize("turn", [0.0, 0.15])
def test_an_x_of_a_few_pen_widths_that_touches_a_side_anchors_its_box(
    pen: float, gap: float, turn: float
) -> None:
    """Its arms are two pen widths long: no ink of the side, nor a tail of the box's outline."""
    half = 2 * pen
    middle = np.array([250.0, 204 + gap * pen + half * np.sin(np.pi / 4)])
    arms = half * np.array([[np.cos(a), np.sin(a)] for a in turn + np.pi / 4 * np.array([1, 3])])
    bars: list[Line] = [[tuple(middle - arm), tuple(middle + arm)] for arm in arms]
    scene = read([BOX, *bars], pen)
    assert kinds(scene) == ["rectangle"]
    assert scene.bodies[0].anchored


@pytest.mark.parametrize(("pen", "barb", "open_"), [(4.0, 3.0, 0.9), (7.0, 2.5, 0.7)])
@pytest.mark.parametrize("shaft", [70, 100])
def test_a_barb_of_a_few_pen_widths_is_no_overshoot(
    pen: float, barb: float, open_: float, shaft: float
) -> None:
    tip = (450.0, 60.0 + shaft)
    ends = [
        (tip[0] + side * long * np.sin(a), tip[1] - long * np.cos(a))
        for side, long, a in ((-1, barb * pen, open_), (1, 1.05 * barb * pen, open_ + 0.1))
    ]
    scene = read([BOX, [(452, 60), tip], [ends[0], tip, ends[1]]], pen)
    assert kinds(scene) == ["rectangle"]
    assert abs(np.arctan2(scene.gravity[0], -scene.gravity[1])) < 0.2


def traced(lines: list[Line], pen: float, *, sharpened: bool = True) -> Graph:
    mask = (inked(lines, pen) > 0.5).astype(np.uint8)
    skeleton, size = thin(mask)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    graph = build_graph(trace(skeleton, size), distance, pen)
    if sharpened:
        sharpen_corners(graph, distance, pen)
    return graph


@pytest.mark.parametrize("pen", [4.0, 5.5])
def test_the_corners_of_a_hexagon_are_where_its_sides_meet(pen: float) -> None:
    turn = np.linspace(0, 2 * np.pi, 7) + 0.2
    corners = [(250 + 60 * float(np.cos(a)), 200 + 60 * float(np.sin(a))) for a in turn]
    (edge,) = traced([corners], pen).edges
    for corner in corners:
        assert np.hypot(*(edge.points - corner).T).min() < 1.0


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("radius", [2.5, 4.0, 6.0])
def test_a_small_circle_has_no_corners(pen: float, radius: float) -> None:
    ring = [circle(250, 200, radius * pen)]
    (as_thinned,), (edge,) = traced(ring, pen, sharpened=False).edges, traced(ring, pen).edges
    assert {*map(tuple, edge.points)} == {*map(tuple, as_thinned.points)}


@pytest.mark.parametrize("pen", [4.0, 5.5])
@pytest.mark.parametrize("graze", [20, 35])
def test_an_x_whose_bar_begins_under_a_side_anchors_its_plank(pen: float, graze: int) -> None:
    corners = np.array([(-170, -22), (170, -22), (170, 22), (-170, 22), (-170, -22)])
    crossing = np.array([0, -22 + pen / 2])
    grazing, steep = ([np.cos(a), np.sin(a)] for a in (np.radians(graze), np.radians(graze) + 1.6))
    bars = [np.outer([-1.5 * pen, 30], grazing) + crossing, np.outer([-22, 22], steep) + crossing]
    turned = np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
    lines: list[Line] = [list(map(tuple, line @ turned + (320, 220))) for line in (corners, *bars)]
    scene = read(lines, pen)
    assert kinds(scene) == ["rectangle"]
    assert scene.bodies[0].anchored


def test_a_line_that_ends_at_another_goes_on_to_the_far_edge_of_its_ink_alone() -> None:
    mask = np.zeros((60, 80), np.uint8)
    mask[10:20] = 1
    mask[20:50, 38:43] = 1
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    y = np.arange(50.0, 14.0, -1)
    line = Way(np.stack([np.full(len(y), 40.0), y], axis=1), {0: np.zeros((1, 2))}, 1.0)
    (found,) = going_on([line], distance, 5.0)
    assert 12 <= found.points[-1][1] <= 13  # half a pen from the ink's edge
    assert np.array_equal(found.points[: len(y)], line.points)
    assert going_on([Way(line.points, line.ink, 0.0)], distance, 5.0) == []  # it ends at no other ink


def test_crumbs_alone_are_as_dark_as_they_are() -> None:
    """Noise: no line is long enough to say how dark the pen's is, and so nothing is fainter."""
    mask = np.zeros((60, 60), np.uint8)
    mask[10:13, 10:15] = mask[30:33, 30:36] = 1
    distance = distances(mask)
    before = mask.copy()
    assert drop_faint_marks(mask, 200 * mask, trace(*thin(mask)), distance, 8.0) == 0
    assert np.array_equal(mask, before)


@pytest.mark.parametrize("gap", [5, 6])
def test_two_lines_that_melt_together_are_no_faint_mark(gap: int) -> None:
    """Between them the ink is pale, and soft: they are as dark as their own middles."""
    fine = np.zeros((4 * HEIGHT, 4 * WIDTH), np.uint8)
    for y in (1800, 1800 + 4 * gap):
        cv2.line(fine, (480, y), (1600, y), 255, 13, cv2.LINE_AA)
    beside = cv2.resize(fine, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA) / 255
    picture = cv2.GaussianBlur(drawn(np.maximum(ink(pen=3.2), beside)).astype(np.float32), (0, 0), 1.5)
    noise = np.random.default_rng(1).normal(0, 2, (HEIGHT, WIDTH, 1))
    assert read_picture(encoded(np.clip(picture + noise, 0, 255).astype(np.uint8))).notes == []


@pytest.mark.parametrize("radius", [8.9, 9.3])
def test_a_ring_that_hides_all_of_another_way_around_it(radius: float) -> None:
    """Under a wide pen: nothing is left of the graph but closed lines, which end nowhere."""
    scene = read([BOX, circle(330.3, 252.15, radius)], 9.0)
    assert kinds(scene) == ["rectangle"]
    assert len(scene.joints) == 1


@pytest.mark.parametrize(
    ("pen", "half", "bow", "tip"),
    [(4.0, 8, -0.2, 2), (4.5, 8, -0.1, 6), (5.5, 10, -0.2, 4), (5.5, 11, -0.2, 2)],
)
def test_the_way_around_a_hole_is_no_ink_of_lines_that_run_into_each_other(
    pen: float, half: float, bow: float, tip: float
) -> None:
    x = x_with_a_side(250, 250, half, bow * half)
    x[1] = (250 + half, 250 - half - tip)
    graph = traced([x], pen, sharpened=False)
    for junction in find_junctions(graph, pen):
        for edge in map(graph.edges.__getitem__, junction.bridges):
            across = math.dist(*graph.nodes[list(edge.ends)].tolist())
            assert edge.length < max(1.5 * across, 1.6 * pen)


def length(way: Way) -> float:
    return float(np.hypot(*np.diff(way.points, axis=0).T).sum())


@pytest.mark.parametrize(("pen", "half"), [(2.5, 28), (4.0, 14), (4.0, 20), (4.0, 28)])
def test_a_mark_in_one_stroke_may_touch_an_outline(pen: float, half: float) -> None:
    mark = x_with_a_side(250, 298 - half - pen, half, 0)
    drawn = sum(math.dist(a, b) for a, b in pairwise(mark))
    found = [
        way for way in Ways(traced([BOX, mark], pen), pen).others() if np.ptp(way.points[:, 0]) < 2.6 * half
    ]
    assert max(map(length, found)) > 0.92 * drawn


def test_a_loop_of_a_stroke_may_be_drawn_either_way() -> None:
    cross, top = (100.0, 100.0), (108.0, 94.0)
    lines = [even(top, (113, 82)), even(top, (110, 103), cross), even(top, cross)]
    lines += [even(cross, (90, 88)), even(cross, (89, 110))]
    ends = [(1, -1), (1, 0), (1, 0), (0, -1), (0, -1)]
    edges = [Edge(points, its, {k: points}) for k, (points, its) in enumerate(zip(lines, ends, strict=True))]
    ways = Ways(Graph(np.array([cross, top]), np.array([3.0, 3.0]), edges), 4.5).others()
    assert len([way for way in ways if len(way.ink) == len(lines)]) == 2
