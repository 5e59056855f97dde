"""The C that a page's ink is found and followed with, against its own definitions in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketch.scan.binding import (
    along_lines,
    bend,
    coarseness,
    columns,
    course_length,
    crests,
    crisp_ink,
    darkness,
    distances,
    ends,
    heading,
    link,
    measure_pieces,
    nearest,
    pieces,
    smoothed,
    thin,
    through,
    turns,
)
from sketch.scan.paper.fills import fill_grain
from sketch.scoring import misfit


@given(st.integers(0, 2**32), st.booleans())
@settings(max_examples=30, deadline=None, derandomize=True)
def test_darkness_is_a_share_of_the_light(seed: int, negative: bool) -> None:
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 40, 2)
    picture = rng.integers(0, 256, (height, width, 3), dtype=np.uint8)
    light = rng.integers(0, 256, (height, width), dtype=np.uint8)
    dark = darkness(picture, light, dimmest=24, negative=negative)
    grey = (255 - picture if negative else picture).min(axis=2).astype(float)
    share = np.maximum(light - grey, 0) / np.maximum(light, 24.0)
    assert np.abs(dark - 255 * share).max() <= 0.5 + 1e-5


def test_crisp_ink_is_darker_than_half_of_the_darkest() -> None:
    rng = np.random.default_rng(3)
    dark, darkest, mean = (rng.integers(0, 256, (37, 53), dtype=np.uint8) for _ in range(3))
    mask, crisp = crisp_ink(dark, darkest, mean.copy(), 40)
    expected = np.clip(np.rint(dark + 0.5 * (dark.astype(float) - mean)), 0, 255)
    assert np.array_equal(crisp, expected)
    assert np.array_equal(mask, (expected > darkest // 2) & (dark > 40))


def test_crests_are_found_all_over_a_row() -> None:
    dark = np.zeros((20, 150), np.uint8)
    columns = np.arange(4, 146, 9)
    dark[:, columns] = 90
    found = crests(dark, np.zeros_like(dark), 30, 4, 1.2, 0.6)
    assert np.array_equal(np.flatnonzero(found[10]), columns)
    assert not crests(dark, np.zeros_like(dark), 90, 4, 1.2, 0.6).any()


def test_columns_say_how_much_ink_is_near_and_how_far_below() -> None:
    rng = np.random.default_rng(7)
    mask = (rng.random((30, 40)) < 0.4).astype(np.uint8)
    x = np.arange(3, 37, dtype=np.int32)
    middle = rng.integers(4, 26, len(x)).astype(np.int32)
    pixels, below = columns(mask, x, middle, 4)
    for k in range(len(x)):
        ink = mask[middle[k] - 4 : middle[k] + 5, x[k]]
        assert pixels[k] == ink.sum()
        assert below[k] == (ink * np.arange(-4, 5)).sum()


@pytest.mark.parametrize("aside", [-3, -1, 0, 2])
def test_what_leads_through_a_belt_is_told_from_what_lies_along_it(aside: int) -> None:
    belt, drawn = np.zeros((7, 80), np.uint8), np.zeros((7, 80), bool)
    for row in range(7):
        drawn[row, 40 + aside * row : 45 + aside * row] = True
    belt[2:5], belt[:3, 5:9] = 1, 1  # a printed line, and one that ends at it
    belt[drawn] = 1
    found = through(belt, 3) > 0
    assert (found | ~drawn).all()
    assert not (found & ~drawn)[:, : 40 + min(6 * aside, 0) - 1].any()
    assert np.count_nonzero(found & ~drawn) <= 8  # ways that lean a little more, or less
    assert not through(belt, 3)[:, :20].any()
    assert not through(np.zeros((7, 0), np.uint8), 3).size


def test_pieces_are_measured_as_they_lie() -> None:
    rng = np.random.default_rng(5)
    mask = (rng.random((40, 60)) < 0.3).astype(np.uint8)
    dark, edge = rng.integers(0, 256, (2, 40, 60), dtype=np.uint8)
    edge[:, 20:] = 0
    pixels, start = found = pieces(mask)
    extent, strength, at_edge = measure_pieces(found, 60, dark, edge)
    for k, own in enumerate(np.split(pixels, start[1:])):
        y, x = np.divmod(own, 60)
        assert extent[k].tolist() == [np.ptp(y), np.ptp(x)]
        assert strength[k] == pytest.approx(dark[y, x].mean())
        assert at_edge[k] == edge[y, x].any()
    assert 1 < np.count_nonzero(at_edge) < len(start)
    same, nothing, nowhere = measure_pieces(found, 60, None, None)
    assert np.array_equal(same, extent)
    assert not nothing.any()
    assert not nowhere.any()
    assert len(measure_pieces(pieces(np.zeros_like(mask)), 60, dark, edge)[0]) == 0


def test_a_skeleton_ends_where_it_has_one_neighbour() -> None:
    mask = np.zeros((50, 70), np.uint8)
    mask[20:24, 5:60] = mask[5:45, 30:34] = 1  # a cross
    mask[40:43, 50:65] = 1  # and a dash
    assert ends(thin(mask)[0]) == 6


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2, 2.0, 2.9])
def test_darkness_is_averaged_along_its_line(angle: float) -> None:
    y, x = np.mgrid[:64, :80].astype(np.float64)
    off, on = (
        (y - 32) * np.cos(angle) - (x - 40) * np.sin(angle),
        (x - 40) * np.cos(angle) + (y - 32) * np.sin(angle),
    )
    dashes = np.where((np.abs(off) < 3) & (np.floor(on / 2) % 2 == 0), 200, 0).astype(np.uint8)
    # the gradient is across the line
    tensor = [
        np.full((32, 40), v, np.float32)
        for v in (np.sin(angle) ** 2, -np.sin(2 * angle) / 2, np.cos(angle) ** 2)
    ]
    near = np.ones((32, 40), np.uint8)
    near[:, :4] = 0
    smooth = along_lines(dashes, near, (tensor[0], tensor[1], tensor[2]), 8).astype(float)
    inside = (np.abs(off) < 1.5) & (np.abs(on) < 12)
    assert np.abs(smooth[inside] - 100).max() < 40
    assert smooth[(np.abs(off) > 5) & (np.abs(on) < 12)].max() == 0
    assert np.array_equal(smooth[:, :8], dashes[:, :8])  # nothing is near there


def test_where_lines_meet_nothing_is_averaged_along_them() -> None:
    dark = np.random.default_rng(1).integers(0, 256, (20, 30), dtype=np.uint8)
    same, none = np.ones((10, 15), np.float32), np.zeros((10, 15), np.float32)
    assert np.array_equal(along_lines(dark, np.ones((10, 15), np.uint8), (same, none, same), 8), dark)


def test_a_thin_line_between_strokes_links_them_and_a_bump_is_left_out() -> None:
    mask, line = np.zeros((40, 60), np.uint8), np.zeros((40, 60), np.uint8)
    mask[10:13, 5:25] = mask[10:13, 27:50] = 1  # a stroke with a gap of two pixels,
    line[11, 25:27] = 1
    line[14, 10] = line[13, 11] = 1  # a bump beside it,
    line[25, 10:30] = 1  # and a long thin line by itself
    link(line, 3.0, mask)
    assert mask[11, 25:27].all()
    assert mask[25, 10:30].all()
    assert not mask[13:15].any()


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5, -1.8])
def test_a_branch_is_looked_at_where_it_is_clear_of_the_junction(angle: float) -> None:
    way = np.array([np.cos(angle), np.sin(angle)])
    straight = way * np.arange(40)[:, None] + (30, 50)
    bent = straight.copy()
    bent[:6] += 3 * np.array([-way[1], way[0]])  # as thinning bends it
    for points in (bent, np.concatenate([bent[::-1]])[::-1]):  # stored one way or the other
        start, outward = heading(points, straight[0], 6.9, 12.0)
        assert np.allclose(start, straight[7])
        assert np.allclose(outward, way)
    start, _ = heading(straight[:5], straight[0], 6.9, 12.0)
    assert np.allclose(start, straight[2])  # a short one is looked at from half of its length on
    assert np.allclose(heading(straight[:1], straight[0], 6.9, 12.0)[0], straight[0])


def test_the_bend_of_an_arc_is_its_curvature() -> None:
    t = np.linspace(0, 0.6, 61)
    arc = 100 * np.stack([np.cos(t), np.sin(t)], axis=1)
    assert bend(arc, arc[0], 12.0, 0.04) == pytest.approx(1 / 100, rel=0.02)
    assert bend(arc[::-1], arc[-1], 12.0, 0.04) == pytest.approx(-1 / 100, rel=0.02)
    corner = np.array([[k, 0.0] for k in range(12)] + [[12.0, k] for k in range(12)])
    assert bend(corner, corner[0], 11.0, 0.04) == 0
    assert bend(arc[:4], arc[0], 12.0, 0.04) == 0
    assert course_length(arc) == pytest.approx(60, rel=1e-4)


def test_the_nearest_of_some_points_is_the_first_of_several() -> None:
    points = np.random.default_rng(1).integers(0, 9, (200, 2)).astype(np.float64)
    for place in (np.array([4.0, 4.0]), np.array([-3.0, 20.0]), points[150]):
        for some in (points, points[::-1]):
            assert nearest(some, place) == int(np.hypot(*(some - place).T).argmin())


@pytest.mark.parametrize("cut", [1, 4, 9])
def test_a_chain_turns_as_much_as_its_directions_before_and_behind(cut: int) -> None:
    points = np.random.default_rng(cut).uniform(0, 50, (9, 2))
    before, after = points - np.roll(points, cut, axis=0), np.roll(points, -cut, axis=0) - points
    angles = [np.arctan2(way[:, 1], way[:, 0]) for way in (before, after)]
    turn = np.abs((angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi)
    assert np.allclose(turns(points, cut), turn if cut < 9 else 0.0)


@pytest.mark.parametrize("count", [4, 5, 40])
def test_a_closed_chain_is_smoothed_all_around_and_an_open_one_keeps_its_ends(count: int) -> None:
    points = np.random.default_rng(count).uniform(0, 50, (count, 2))
    weights = np.array([0.05, 0.1, 0.2, 0.3, 0.2, 0.1, 0.05])
    around = points[np.arange(-3, count + 3) % count]
    expected = np.stack([np.convolve(around[:, k], weights, "valid") for k in (0, 1)], axis=1)
    assert np.allclose(smoothed(points, weights, closed=True), expected)
    out = smoothed(points, weights, closed=False)
    assert np.allclose(out[[0, -1]], points[[0, -1]])
    assert np.allclose(out[3:-3], expected[3:-3])
    line = np.linspace((2.0, 9.0), (7.0, 3.0), count)
    assert np.allclose(smoothed(line, weights, closed=False)[3:-3], line[3:-3])


def test_a_shape_owes_for_ink_that_something_smaller_would_say_more_precisely() -> None:
    square = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    inside, left = np.array([[5.0, 2], [5, 1]]), np.array([[-3.0, 5]])  # off by the root of 2.5, and by 3
    ink, ends = np.concatenate([inside, left]), np.array([2, 3], dtype=np.int32)
    worth = np.array([[2.0, 4.0, 100.0], [40.0, 4.0, 100.0]])  # the second is part of nothing smaller

    def nats(off: float, size: float) -> float:
        return 4 * misfit((off / size) ** 2, 1)

    owed = coarseness(ink, ends, worth, square, 0.5, 10.0, closed=True)
    assert owed == pytest.approx(nats(np.sqrt(2.5) - 0.5, 2) - nats(np.sqrt(2.5) - 0.5, 10))
    owed = coarseness(ink[2:], ends[:1] - 1, np.array([[1.0, 4.0, 7.0]]), square, 0.5, 10.0, closed=True)
    assert owed == 7.0  # no more than to say it freely
    opened = coarseness(ink[2:], ends[:1] - 1, np.array([[1.0, 4.0, 1e4]]), square, 0.5, 10.0, closed=False)
    off = float(np.sqrt(3**2 + 5**2)) - 0.5  # the side beside it is none
    assert opened == pytest.approx(nats(off, 1) - nats(off, 10))
    assert coarseness(inside, ends[:1], worth[:1], square, 2.0, 10.0, closed=True) == 0.0
    line = coarseness(inside, ends[:1], worth[:1], square, 0.5, 0.0, closed=False)
    assert line == pytest.approx(nats(np.sqrt(2.5) - 0.5, 2))


def test_grain_is_filled_and_distances_stay_those_of_the_mask() -> None:
    mask = np.zeros((60, 60), np.uint8)
    mask[10:18, 5:55] = 1
    mask[13:15, 20:22] = 0  # grain within a line
    mask[28:47, 5:55] = 1
    mask[35:40, 20:25] = 0  # a hole between lines
    distance = distances(mask)
    filled = mask.copy()
    assert fill_grain(filled, distance, 6.0)
    assert filled[10:18, 5:55].all()
    assert not filled[35:40, 20:25].any()
    assert np.array_equal(distance, distances(filled))
