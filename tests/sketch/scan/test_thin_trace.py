"""Thinning and tracing in C: exact shapes, and random masks that must neither crash nor tear."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketch.scan.binding import belt, crests, distances, pieces, thin, trace
from sketch.scan.skeleton.corners import sharpen_corners
from sketch.scan.skeleton.graph import build_graph
from sketch.scan.strokes.ways import Ways

PEN = 5


def canvas() -> np.ndarray:
    return np.zeros((120, 160), np.uint8)


def line(mask: np.ndarray, *points: tuple[int, int], closed: bool = False) -> None:
    cv2.polylines(mask, [np.array(points, np.int32)], closed, 1, PEN)


def strokes_of(mask: np.ndarray) -> list[np.ndarray]:
    skeleton, count = thin(mask)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    graph = build_graph(trace(skeleton, count), distance, PEN)
    sharpen_corners(graph, distance, PEN)
    return [way.points for way in Ways(graph, PEN).likeliest()]


def is_closed(points: np.ndarray) -> bool:
    return bool(np.array_equal(points[0], points[-1]))


def farthest_from_segment(points: np.ndarray, a: tuple[int, int], b: tuple[int, int]) -> float:
    start, side = np.array(a, float), np.array(b, float) - a
    along = np.clip((points - start) @ side / (side @ side), 0, 1)
    return float(np.hypot(*(points - start - along[:, None] * side).T).max())


@pytest.mark.parametrize(
    "ends", [((20, 30), (140, 30)), ((70, 15), (70, 100)), ((20, 20), (140, 95)), ((25, 100), (120, 20))]
)
def test_a_line_stays_a_line_with_its_ends(ends: tuple[tuple[int, int], tuple[int, int]]) -> None:
    mask = canvas()
    line(mask, *ends)
    (stroke,) = strokes_of(mask)
    assert farthest_from_segment(stroke, *ends) < 1.5
    for end in ends:
        assert np.hypot(*(stroke[[0, -1]] - end).T).min() <= PEN / 2


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("between", [1.57, 1.0, 0.6])
def test_two_lines_that_cross_are_two_strokes(turn: float, between: float) -> None:
    mask, lines = canvas(), []
    for angle in (turn, turn + between):
        d = np.array([np.cos(angle), np.sin(angle)])
        a, b = (tuple(np.round(np.array([80, 60]) + k * 52 * d).astype(int).tolist()) for k in (-1, 1))
        lines.append((a, b))
        line(mask, a, b)
    strokes = strokes_of(mask)
    assert len(strokes) == 2
    for a, b in lines:
        assert min(farthest_from_segment(s, a, b) for s in strokes) < 2.5
        assert min(np.hypot(*(s[[0, -1]] - a).T).min() for s in strokes) <= PEN


def test_a_ring_is_one_closed_stroke() -> None:
    mask = canvas()
    cv2.circle(mask, (80, 60), 40, 1, PEN)
    (ring,) = strokes_of(mask)
    assert is_closed(ring)
    assert np.abs(np.hypot(*(ring - [80, 60]).T) - 40).max() < 1.5


def test_a_line_that_ends_at_another_ends_there() -> None:
    mask = canvas()
    line(mask, (20, 40), (140, 40))
    line(mask, (80, 40), (80, 100))
    through, stem = sorted(strokes_of(mask), key=lambda s: np.ptp(s[:, 1]))
    assert np.ptp(through[:, 0]) > 115
    assert np.abs(through[:, 1] - 40).max() < 2
    assert stem[:, 1].min() == pytest.approx(40, abs=PEN)
    assert stem[:, 1].max() == pytest.approx(100, abs=PEN / 2)


def test_circles_that_touch_stay_circles() -> None:
    mask = canvas()
    for x in (50, 110):
        cv2.circle(mask, (x, 60), 30, 1, PEN)
    strokes = strokes_of(mask)
    assert len(strokes) == 2
    for x in (50, 110):
        off = min(np.abs(np.hypot(*(s - [x, 60]).T) - 30).max() for s in strokes)
        assert off < PEN


def test_a_wheel_that_crosses_its_frame_stays_a_wheel() -> None:
    mask = canvas()
    cv2.rectangle(mask, (15, 20), (145, 70), 1, PEN)
    cv2.circle(mask, (80, 72), 28, 1, PEN)
    strokes = strokes_of(mask)
    assert len(strokes) == 2
    assert all(is_closed(s) for s in strokes)
    assert min(np.abs(np.hypot(*(s - [80, 72]).T) - 28).max() for s in strokes) < 3


def test_a_ball_on_a_plank_is_not_part_of_it() -> None:
    mask = canvas()
    cv2.rectangle(mask, (10, 80), (150, 105), 1, PEN)
    cv2.circle(mask, (80, 52), 27, 1, PEN)
    strokes = strokes_of(mask)
    assert len(strokes) == 2
    assert min(np.abs(np.hypot(*(s - [80, 52]).T) - 27).max() for s in strokes) < PEN


def test_a_box_that_stands_on_a_line_is_closed_by_it() -> None:
    mask = canvas()
    line(mask, (10, 95), (150, 95))
    line(mask, (55, 95), (55, 45), (105, 45), (105, 95))
    ground, box = sorted(strokes_of(mask), key=lambda s: np.ptp(s[:, 1]))
    assert np.ptp(ground[:, 0]) > 130
    assert is_closed(box)


def test_corners_are_where_the_sides_meet() -> None:
    corners = [(20, 100), (80, 20), (140, 100)]
    mask = canvas()
    line(mask, *corners, closed=True)
    (triangle,) = strokes_of(mask)
    assert is_closed(triangle)
    for corner in corners:
        assert np.hypot(*(triangle - corner).T).min() < 2.5


@pytest.mark.parametrize("shape", [(1, 1), (2, 9), (3, 3), (9, 2)])
@pytest.mark.parametrize("fill", [0, 1])
def test_tiny_masks(shape: tuple[int, int], fill: int) -> None:
    skeleton, count = thin(np.full(shape, fill, np.uint8))
    assert count == np.count_nonzero(skeleton)
    assert len(trace(skeleton, count).chains) <= 1


def random_mask(seed: int, height: int, width: int, share: float, grain: float) -> np.ndarray:
    noise = np.random.default_rng(seed).random((height, width)).astype(np.float32)
    if grain > 0:
        noise = cv2.GaussianBlur(noise, (0, 0), grain)
    return (noise < np.quantile(noise, share)).astype(np.uint8)


def framed(mask: np.ndarray) -> np.ndarray:
    mask = mask.copy()
    mask[[0, -1]] = 0
    mask[:, [0, -1]] = 0
    return mask


masks = st.builds(
    random_mask,
    st.integers(0, 10_000),
    st.integers(3, 70),
    st.integers(3, 70),
    st.floats(0.02, 0.98),
    st.sampled_from([0.0, 0.8, 2.0, 4.0]),
)


@settings(max_examples=80, deadline=None, derandomize=True)
@given(masks)
def test_thinning_tears_nothing_and_closes_nothing(mask: np.ndarray) -> None:
    mask = framed(mask)
    skeleton, count = thin(mask)
    assert count == np.count_nonzero(skeleton)
    assert not np.any(skeleton & ~mask & 1)
    assert (
        cv2.connectedComponents(skeleton, connectivity=8)[0]
        == cv2.connectedComponents(mask, connectivity=8)[0]
    )
    holes = [cv2.connectedComponents(1 - m, connectivity=4)[0] for m in (mask, skeleton)]
    assert holes[0] == holes[1]


@settings(max_examples=60, deadline=None, derandomize=True)
@given(masks)
def test_every_pixel_of_a_skeleton_is_in_one_chain_or_node(mask: np.ndarray) -> None:
    skeleton, count = thin(mask)
    chains = trace(skeleton, count)
    pixels = [tuple(p) for chain in chains.chains for p in chain.astype(int).tolist()]
    assert len(pixels) == len(set(pixels))
    crowd = cv2.filter2D(skeleton, -1, np.ones((3, 3)), borderType=cv2.BORDER_CONSTANT)
    junctions = np.count_nonzero(skeleton & (crowd > 3))
    assert len(pixels) + junctions == count
    for chain in chains.chains:
        assert np.abs(np.diff(chain, axis=0)).max(initial=0) <= 1


@settings(max_examples=60, deadline=None, derandomize=True)
@given(masks)
def test_any_mask_gives_finite_strokes(mask: np.ndarray) -> None:
    for stroke in strokes_of(framed(mask)):
        assert stroke.ndim == 2
        assert stroke.shape[1] == 2
        assert np.isfinite(stroke).all()


@settings(max_examples=40, deadline=None, derandomize=True)
@given(masks)
def test_pieces_are_the_connected_components(mask: np.ndarray) -> None:
    mask = framed(mask)
    pixels, start = pieces(mask)
    assert len(pixels) == np.count_nonzero(mask)
    count, labels = cv2.connectedComponents(mask, connectivity=8)
    assert len(start) == count - 1
    for a, b in pairwise([*start, len(pixels)]):
        assert len(set(labels.ravel()[pixels[a:b]])) == 1


@settings(max_examples=40, deadline=None, derandomize=True)
@given(masks)
def test_distances_are_the_chamfer_distances(mask: np.ndarray) -> None:
    """The paper around a picture is as near as the paper in it."""
    inner = framed(mask)
    expected = cv2.distanceTransform(inner, cv2.DIST_L2, 3)
    np.testing.assert_allclose(distances(mask), expected, atol=1e-3)


def test_a_thin_line_beside_a_dark_one_is_a_crest_and_the_dark_ones_edge_is_none() -> None:
    darkness = np.zeros((40, 60), np.uint8)
    darkness[:, 20:24] = 200
    darkness[:, 28] = 70
    darkness = cv2.GaussianBlur(darkness, (0, 0), 0.8)
    mask = (darkness > 100).astype(np.uint8)
    line = crests(darkness, mask, 20, 4, 1.2, 0.6)
    inside = line[4:-4]
    assert np.all(inside[:, 28] == 1)
    assert not np.any(inside[:, :27])
    assert np.count_nonzero(line) == np.count_nonzero(inside)


@pytest.mark.parametrize("radius", [6.0, 9.0, 14.0])
def test_the_belt_of_a_ring_is_met_where_the_pen_went(radius: float) -> None:
    mask = np.zeros((80, 80), np.uint8)
    cv2.circle(mask, (41 * 16, 38 * 16), round(16 * radius), 1, PEN, shift=4)
    found = belt(mask, (40.0, 40.0, radius + 1), PEN)
    assert found is not None
    roundness, middle, size, points = found
    assert roundness > 0.5
    assert np.hypot(*(middle - [41, 38])) < 0.6
    assert abs(size - radius) < 0.6
    assert np.abs(np.hypot(*(points - [41, 38]).T) - radius).max() < 1.2


def test_a_rim_that_is_not_to_be_seen_speaks_for_no_ring() -> None:
    seen = np.zeros((80, 80), np.uint8)
    cv2.circle(seen, (40, 40), 12, 1, PEN)
    around = np.ones((80, 80), np.uint8)
    cv2.circle(around, (40, 40), 12, 0, -1)
    cv2.circle(around, (40, 40), 12, 1, PEN)
    roundness = [found[0] for mask in (seen, around) if (found := belt(mask, (40.0, 40.0, 12.0), PEN))]
    assert roundness[0] > roundness[1] + 0.15


def test_there_is_no_belt_on_bare_paper_or_in_a_blot_or_around_a_triangle() -> None:
    mask = np.zeros((80, 80), np.uint8)
    assert belt(mask, (40.0, 40.0, 9.0), PEN) is None
    cv2.polylines(mask, [np.array([(25, 54), (55, 54), (40, 27)], np.int32)], True, 1, PEN)
    assert belt(mask, (40.0, 40.0, 12.0), PEN) is None
    assert belt(np.ones((80, 80), np.uint8), (40.0, 40.0, 9.0), PEN) is None
