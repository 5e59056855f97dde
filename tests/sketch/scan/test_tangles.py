"""Ink that touches, crosses and rests on other ink: read from paper as it would be read from strokes."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from sheets import drawn, encoded

from sim.scene import Polygon, Scene
from sketch.recognize import recognize
from sketch.scan import read_picture
from sketch.scan.binding import thin, trace
from sketch.scan.skeleton.graph import build_graph
from sketch.scan.strokes.ways import Ways

Line = list[tuple[float, float]]
PENS = [2.5, 4.0, 5.5]
BOX: Line = [(100, 200), (400, 206), (397, 300), (103, 296), (100, 200)]


def circle(x: float, y: float, radius: float) -> Line:
    turn = np.linspace(0, 2 * np.pi, 60)
    return [(x + radius * float(np.cos(a)), y + radius * float(np.sin(a))) for a in turn]


def inked(lines: list[Line], pen: float, size: tuple[int, int] = (420, 520)) -> NDArray[np.float64]:
    """1 where there is ink, 0 on paper, shape `size`, smooth between."""
    image = np.zeros((size[0] * 4, size[1] * 4), np.uint8)
    for line in lines:
        at = np.round((np.array(line) + 0.5) * 4 - 0.5).astype(np.int32)
        cv2.polylines(image, [at], False, 255, round(4 * pen))
    return cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA) / 255.0


def read(lines: list[Line], pen: float) -> Scene:
    return recognize(read_picture(encoded(drawn(inked(lines, pen), noise=1.5)))).scene


def kinds(scene: Scene) -> list[str]:
    found = []
    for body in scene.bodies:
        shape = body.shape
        corners = f"{len(shape.vertices)} sides" if isinstance(shape, Polygon) else ""
        found.append(corners or type(shape).__name__.lower())
    return sorted(found)


@pytest.mark.parametrize("pen", PENS)
def test_a_ball_on_the_tip_of_a_ramp_is_no_figure_of_eight(pen: float) -> None:
    ramp: Line = [(80, 360), (255, 200), (440, 364), (80, 360)]
    scene = read([ramp, circle(256, 168, 32)], pen)
    assert kinds(scene) == ["3 sides", "circle"]


@pytest.mark.parametrize("turn", np.arange(0.0, 6.2, 0.8))
def test_a_tail_beside_an_outline_is_no_part_of_it(turn: float) -> None:
    """A hasty ball, whose end is closed along its tail: the tip of that is where its stroke begins."""
    tail = [(-29, -3), (-22, -11), (-17, -16), (-11, -21), (-5, -22), (4, -23), (10, -22)]
    ball = [(16, -18), (20, -12), (22, -5), (23, 3), (22, 10), (19, 18), (15, 24), (9, 27), (6, 27), (0, 23)]
    back = [(-6, 18), (-11, 12), (-16, 3), (-18, -3), (-20, -10)]
    at = np.array([*tail, *ball, *back]) @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    assert kinds(read([[(x, y) for x, y in (at + 200).tolist()]], 3.4)) == ["circle"]


@pytest.mark.parametrize("pen", PENS)
def test_a_ball_on_an_overshot_corner_is_no_large_x_with_a_loop(pen: float) -> None:
    apex, left, right, over = np.array([255.0, 200]), np.array([80.0, 360]), np.array([440.0, 364]), 70.0
    first, last = ((over * (apex - foot) / np.hypot(*(apex - foot))) + apex for foot in (left, right))
    turn = np.linspace(-1.8, 2 * np.pi - 1.1, 70)
    spiral = 36 * (1 - 0.4 * np.maximum(turn - turn[0] - 2 * np.pi + 0.2, 0))  # its end is a tail inside
    middle = last - np.array([10.0, 36])
    ball = middle[:, None] + spiral * (np.cos(turn), np.sin(turn))
    scene = read([[(x, y) for x, y in line] for line in ([first, left, right, last], ball.T)], pen)
    assert kinds(scene) == ["3 sides", "circle"]


@pytest.mark.parametrize("pen", PENS)
def test_a_box_without_a_lid_has_the_bottom_of_the_box_on_it(pen: float) -> None:
    upper: Line = [(130, 80), (370, 84), (366, 200), (134, 196), (130, 80)]
    lower: Line = [(160, 197), (163, 320), (330, 322), (333, 199)]
    scene = read([upper, lower], pen)
    assert kinds(scene) == ["rectangle", "rectangle"]


@pytest.mark.parametrize("pen", PENS)
def test_a_box_in_two_strokes_may_lean_on_another(pen: float) -> None:
    upper: Line = [(130, 80), (370, 84), (366, 200), (134, 196), (130, 80)]
    left: Line = [(160, 197), (163, 318)]
    scene = read([upper, left, [(160, 322), (330, 322), (333, 199)]], pen)
    assert kinds(scene) == ["rectangle", "rectangle"]


@pytest.mark.parametrize("pen", PENS)
@pytest.mark.parametrize("shift", [0, 18, 34])
def test_a_cross_anchors_the_box_whose_side_it_touches(pen: float, shift: float) -> None:
    bars: list[Line] = [[(228, 228 - shift), (272, 272 - shift)], [(272, 228 - shift), (228, 272 - shift)]]
    scene = read([BOX, *bars], pen)
    assert kinds(scene) == ["rectangle"]
    assert scene.bodies[0].anchored


@pytest.mark.parametrize("pen", PENS)
@pytest.mark.parametrize("radius", [7.0, 10.0])
@pytest.mark.parametrize("up", [-6, 0, 14])
def test_a_small_ring_at_the_tip_of_a_foot_is_a_pivot(pen: float, radius: float, up: float) -> None:
    foot: Line = [(160, 380), (250, 215), (345, 384), (160, 380)]
    scene = read([BOX, foot, circle(250, 240 - up, radius)], pen)
    assert kinds(scene) == ["3 sides", "rectangle"]
    assert len(scene.joints) == 1
    pixels = np.array(scene.joints[0].position) * (1, -1) * 52  # the longer side is ten metres
    assert np.hypot(*(pixels - (250, 240 - up))) < pen


@pytest.mark.parametrize("pen", PENS)
def test_a_wheel_that_runs_along_a_frame_keeps_its_roundness(pen: float) -> None:
    scene = read([BOX, circle(170, 300, 40), circle(330, 300, 40)], pen)
    assert kinds(scene) == ["circle", "circle", "rectangle"]


def test_the_likeliest_strokes_share_no_ink_and_take_all_of_it() -> None:
    mask = (inked([BOX, circle(170, 300, 40), [(60, 180), (420, 330)]], 4.0) > 0.5).astype(np.uint8)
    skeleton, size = thin(mask)
    graph = build_graph(trace(skeleton, size), cv2.distanceTransform(mask, cv2.DIST_L2, 3), 4.0)
    for name, edge in enumerate(graph.edges):
        edge.ink = {name: edge.points}
    ways = Ways(graph, 4.0)
    inks = [set(way.ink) for way in ways.likeliest()]
    everything = set().union(*inks)
    assert sum(map(len, inks)) == len(everything)
    length = {name: edge.length for name, edge in enumerate(graph.edges)}
    assert sum(length[name] for name in everything) > 0.97 * sum(length.values())
    others = ways.others()
    assert others
    assert all(set(way.ink) <= set(length) for way in others)
    half = frozenset(list(everything)[::2])
    left = set().union(*(way.ink for way in ways.likeliest(without=half)))
    assert left.isdisjoint(half)


@pytest.mark.parametrize("pen", PENS)
def test_boxes_that_stand_on_one_another_are_whole(pen: float) -> None:
    boxes: list[Line] = [
        [(x, y), (x + w, y), (x + w, y + 70), (x, y + 70), (x, y)]
        for x, y, w in ((60, 300, 400), (150, 230, 200), (170, 160, 150), (185, 90, 120))
    ]
    scene = read([[(px, py + 2 * (k % 2)) for px, py in box] for k, box in enumerate(boxes)], pen)
    assert kinds(scene) == ["rectangle"] * 4
    assert not scene.notes[0].startswith("left out")


@pytest.mark.parametrize("pen", PENS)
def test_an_arrow_whose_barb_was_gone_over_is_one_arrow(pen: float) -> None:
    tip = (250.0, 220.0)
    arrow: Line = [(250, 60), tip, (225, 190), (214, 160), (226, 158), (236, 190), (252, 223), (285, 175)]
    scene = read([arrow, [(x, y + 80) for x, y in BOX]], pen)
    assert kinds(scene) == ["rectangle"]
    assert scene.gravity[1] < -9


@pytest.mark.parametrize("pen", PENS)
def test_a_tail_where_an_outline_ends_is_the_outline_s(pen: float) -> None:
    ring = circle(250, 200, 90)
    tail: Line = [(318, 200), (330, 192), ring[0]]
    scene = read([[*tail, *ring[1:]]], pen)
    assert kinds(scene) == ["circle"]
    assert not any("left out" in note for note in scene.notes)


def test_the_least_movement_along_all_lines_goes_over_the_shortest_twice() -> None:
    ink = inked([[(100, 20), (100, 320)], [(100, 320), (60, 360)], [(100, 320), (180, 400)]], 4.0) > 0.5
    mask = ink.astype(np.uint8)
    skeleton, size = thin(mask)
    graph = build_graph(trace(skeleton, size), cv2.distanceTransform(mask, cv2.DIST_L2, 3), 4.0)
    lengths = [np.hypot(*np.diff(way.points, axis=0).T).sum() for way in Ways(graph, 4.0).others()]
    all_lines = 300 + 56.6 + 113.1
    assert next(long for long in lengths if long > all_lines) == pytest.approx(all_lines + 56.6, abs=12)


def test_every_brick_of_a_wall_is_a_body() -> None:
    rows = [(100, 260, 420), (100, 180, 420), (100, 300, 420), (100, 220, 420)]
    bricks: list[Line] = []
    for k, ends in enumerate(rows):
        top, low = 100 + 50 * k, 150 + 50 * k
        for a, b in pairwise(ends):
            bricks.append([(a, top + 1), (b, top), (b + 1, low), (a + 1, low - 1), (a, top + 1)])
    floor: Line = [(60, 300), (460, 302), (459, 340), (61, 338), (60, 300)]
    assert kinds(read([*bricks, floor], 3.2)) == ["rectangle"] * 9


@pytest.mark.parametrize("pen", PENS)
def test_a_foot_under_a_plank_stands_on_the_ground_s_line(pen: float) -> None:
    ground: Line = [(20, 330), (500, 332), (499, 380), (21, 378), (20, 330)]
    foot: Line = [(260, 176), (345, 332), (175, 328), (260, 176)]
    plank: Line = [(60, 150), (470, 230), (465, 258), (55, 178), (60, 150)]
    scene = read([ground, foot, plank, circle(259, 206, 9)], pen)
    assert kinds(scene) == ["3 sides", "rectangle", "rectangle"]
    assert len(scene.joints) == 1


@pytest.mark.parametrize("pen", [6.0, 7.5])
def test_strokes_have_a_point_for_each_third_of_a_pens_width_and_their_ends(pen: float) -> None:
    """More would say nothing of the ink; a mark of few points would be taken for samples that cut its corners."""
    rod, mark = [(60.0, 80.0), (460.0, 80.0), (460.0, 300.0)], [(100.0, 200.0), (140.0, 224.0)]
    sketch = read_picture(encoded(drawn(inked([rod, mark], pen), noise=1.5)))
    small, long = sorted((stroke.points for stroke in sketch.strokes), key=lambda p: float(np.ptp(p)))
    steps = np.hypot(*np.diff(long, axis=0).T)
    assert pen / 4 < np.median(steps) < pen / 2
    for corner in rod:
        assert np.hypot(*(long - np.array(corner)).T).min() < pen / 2
    assert len(small) > 24
