"""What lies near what, asked of the C library: the same as by looking at every pair."""

from __future__ import annotations

import ctypes
import itertools
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import measured, page

from sketch.kernel import (
    beside,
    course,
    course_around,
    depth,
    depths,
    gap,
    lent,
    measure,
    off_outline,
)
from sketch.library import address, library
from sketch.page.loose import LooseEnds
from sketch.scoring import misfit
from sketch.shapes.closed import fit_closed

Array = NDArray[np.float64]

LOOSE, REACH = 0.3, 0.45  # as in core/chains.c


def scattered(seed: int, count: int) -> list[Array]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(0, 300, (1, 2)) + np.cumsum(rng.normal(0, 25, (9, 2)), axis=0) for _ in range(count)]


def closings(ends: Array, length: Array, start: int, rivals: list[set[int]]) -> dict[tuple[int, ...], float]:
    """Of each set of pieces that closes the gaps of its tightest order, by trying all orders and directions."""
    found: dict[tuple[int, ...], float] = {}
    later = range(start + 1, len(length))
    for count in range(4):
        for names in itertools.permutations(later, count):
            if any(j in rivals[i] for i in (start, *names) for j in (start, *names)):
                continue
            for ways in itertools.product((0, 1), repeat=count):
                gaps, ink, at, ok = 0.0, length[start], ends[start, 1], True
                last = start
                for j, e in zip(names, ways, strict=True):
                    gap = math.dist(at, ends[j, e])
                    gaps, ink = gaps + gap, ink + length[j]
                    ok &= gap <= REACH * (length[last] + length[j]) and gaps <= 2 * LOOSE * ink
                    at, last = ends[j, 1 - e], j
                gaps += math.dist(at, ends[start, 0])
                key = tuple(sorted((start, *names)))
                if ok and gaps <= LOOSE * ink and gaps < found.get(key, math.inf):
                    found[key] = gaps
    return found


@pytest.mark.parametrize("seed", range(12))
def test_chains_are_those_of_all_orders(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = 4  # so few that each end sees all others
    ends = rng.uniform(0, 60, (count, 2, 2))
    length = rng.uniform(40, 120, count)
    rivals: list[set[int]] = [set() for _ in range(count)]
    if seed % 2:
        rivals[1], rivals[2] = {2}, {1}
    loose = LooseEnds(rivals if seed % 2 else ())
    loose.add(ends, length)
    for piece in range(count):
        loose.loosen(piece)
    for start in range(count):
        chains, _ = loose.chains(start)
        found = {tuple(sorted(i for i, _ in chain)): gap for gap, _, _, chain in chains}
        assert found == pytest.approx(closings(ends, length, start, rivals))


def test_chains_after_pieces_came_and_went_are_those_from_scratch() -> None:
    rng = np.random.default_rng(5)
    ends, length = rng.uniform(0, 400, (30, 2, 2)), rng.uniform(30, 150, 30)
    grown = LooseEnds()
    for k in range(30):
        grown.add(ends[k : k + 1], length[k : k + 1])
        grown.loosen(k)
        for start in range(k):
            grown.chains(start)
    for k in range(0, 30, 3):
        grown.tighten(k)
    at_once = LooseEnds()
    at_once.add(ends, length)
    for k in set(range(30)) - set(range(0, 30, 3)):
        at_once.loosen(k)
    for start in range(30):
        assert grown.chains(start) == at_once.chains(start)


def test_who_looked_at_an_end_hears_of_new_neighbours() -> None:
    loose = LooseEnds()
    loose.add(np.array([[[0.0, 0], [100, 0]], [[104, 0], [104, 80]]]), np.array([100.0, 80]))
    loose.loosen(0)
    assert loose.chains(0)[1] == {1}
    assert loose.loosen(1) == {1}
    loose.chains(0)
    assert 1 in loose.tighten(1)


def test_heads_are_the_nearest_small_strokes() -> None:
    ink = measured(page(scattered(1, 60)))
    shaft = ink.pieces[0]
    for limits in ((40.0, 120.0, 90.0), (80.0, 200.0, 200.0)):
        reach, span, size = limits
        for tip, near in zip(shaft.ends, ink.heads(shaft, shaft.ends, *limits), strict=True):
            gaps = {i: np.hypot(*(p.points - tip).T) for i, p in ink.pieces.items() if i and p.extent <= size}
            fit = sorted((d.min(), i) for i, d in gaps.items() if d.min() < reach and d.max() < span)
            assert near == [i for _, i in fit[:4]]


def test_ink_along_an_outline_and_its_distance() -> None:
    t = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = np.stack([150 + 140 * np.cos(t), 150 + 140 * np.sin(t)], axis=1)
    along = [(ring[k : k + 7] - 150) * (1 + k / 150) + 150 for k in range(0, 16, 2)]
    ink = measured(page([*scattered(2, 80), *along]))
    own, scale = len(ink.pieces) - 1, 40.0  # the last is what the outline is of
    again = ink.again(ring, 30.0, (own,), scale)
    off = off_outline(ink.strokes, list(ink.pieces), ring)
    for p, square, greatest in zip(ink.pieces.values(), *off, strict=True):
        samples = ink.strokes.samples[p.index]
        sides = np.roll(ring, -1, axis=0) - ring
        to = samples[:, None] - ring
        share = np.clip((to * sides).sum(axis=2) / (sides**2).sum(axis=1), 0, 1)
        d2 = ((to - share[..., None] * sides) ** 2).sum(axis=2).min(axis=1)
        assert (square, greatest) == pytest.approx((d2.mean(), d2.max()))
        x0, y0, x1, y1 = p.box
        inside = min(x0, y0) >= 150 - 170 and max(x1, y1) <= 150 + 170
        places = math.sqrt(d2[[0, 16, 31, 47]].mean()) < 0.3 * max(p.scale, p.extent / 2)
        cost = 4 + p.observations + misfit(square / min(scale, p.scale) ** 2, p.observations)
        near = inside and places and p.index != own
        assert (p.index in again) == (near and cost < p.unread)
        assert again.get(p.index, cost) == pytest.approx(cost)
    assert 2 < len(again) < 8
    for i in list(ink.pieces):
        ink.remove(i)
    assert ink.again(ring, 30.0, (), scale) == {}


def test_pieces_near_a_place_are_those_whose_boxes_are() -> None:
    ink = measured(page(scattered(4, 60)))
    ink.remove(7)
    some, both = set(), set()
    for p in ink.pieces.values():
        x0, y0, x1, y1 = p.box
        if x0 <= 160 and y0 <= 130 and x1 >= 90 and y1 >= 120:
            some.add(p.index)
        # a step of its samples beyond the reach, and with a point within it
        reach = 25 + p.length / 48
        beyond = max(x0 - 100, y0 - 110, 150 - x1, 140 - y1)
        if beyond <= reach and max(x0 - 150, y0 - 140, 100 - x1, 110 - y1) <= 25:
            both.add(p.index)
    assert {p.index for p in ink.touching(90, 120, 160, 130)} == some
    assert {p.index for p in ink.reaching((150, 110), (100, 140), 25)} == both
    assert 0 < len(both) < len(some) < len(ink.pieces)


def test_a_course_around_ends_where_it_closes() -> None:
    t = np.linspace(-0.2, 2 * math.pi + 0.1, 200)
    spiral = np.stack([np.cos(t), np.sin(t)], axis=1) * (100 + 3 * t[:, None])
    outline = course_around([spiral])
    assert outline is not None
    angles = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    assert np.all(np.diff(angles) > 0)
    assert angles[-1] - angles[0] < 2 * math.pi < angles[-1] - angles[0] + 0.4
    eight = np.stack([100 * np.sin(t), 50 * np.sin(2 * t)], axis=1)
    assert course_around([eight]) is None


def test_a_course_has_its_corners_where_the_ink_turns() -> None:
    t = np.linspace(0, 1, 70)[:, None]
    a, b, c = np.array([[0.0, 0.0], [310.0, 140.0], [500.0, 20.0]])
    valley = np.concatenate([a + t * (b - a), b + t[1:] * (c - b)])
    np.testing.assert_allclose(course(valley, 2.0), [a, b, c])
    step = np.array(
        [(0, 0), (500, 0), (500, 40), (430, 40), (430, 90), (370, 90), (370, 170), (0, 170)], float
    )
    sides = [p + t[:-1] * (q - p) for p, q in zip(step, np.roll(step, -1, axis=0), strict=True)]
    np.testing.assert_allclose(course_around([np.concatenate([*sides, step[:1]])]), step)


def test_a_course_leaves_out_a_loop_that_is_no_larger_than_a_slip() -> None:
    """Where a pen turns a corner; one that is larger was drawn, and nothing runs through itself."""
    t = np.linspace(0, 1, 70)[:, None]
    for loop, points in ((3.0, 3), (40.0, 0)):
        turns = [(0, 0), (300, 0), (300 + loop, loop), (300 + loop, -loop), (300 - loop, -loop), (300, 300)]
        line = course(np.concatenate([a + t * (b - a) for a, b in itertools.pairwise(np.array(turns))]), 2.0)
        assert (0 if line is None else len(line)) == points


def test_a_course_of_something_round_is_close_to_it_with_few_sides() -> None:
    t = np.linspace(0, 2 * math.pi, 400)
    hills = 100 * (1 + 0.3 * np.cos(5 * t))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    outline = course_around([hills])
    assert outline is not None
    assert len(outline) <= 32
    assert max(abs(depth(x, y, outline)) for x, y in hills.tolist()) < 3


def test_bodies_beside_marks_however_many() -> None:
    rng = np.random.default_rng(3)
    low = rng.uniform(0, 100, (40, 2))
    boxes = np.concatenate([low, low + rng.uniform(0, 60, (40, 2))], axis=1)
    boxes[7] = (math.inf, math.inf, -math.inf, -math.inf)  # where nothing is proposed
    low = rng.uniform(0, 100, (70, 2))
    high = low + rng.uniform(0, 300, (70, 2))
    extent = np.hypot(*(high - low).T)
    bodies = np.column_stack([low, high, extent])
    wanted = []
    for m, (x0, y0, x1, y1) in enumerate(boxes.tolist()):
        for b, (left, top, right, bottom, long) in enumerate(bodies.tolist()):
            r = max(0.1 * long, math.hypot(x1 - x0, y1 - y0))
            if m != 7 and left - r <= x1 and top - r <= y1 and right + r >= x0 and bottom + r >= y0:
                wanted.append([m, b])
    assert len(wanted) > 16 * len(boxes)  # more than there is room for at first
    assert beside(boxes, bodies) == wanted


def drawn(corners: Array) -> Array:
    """A closed outline through some corners, 40 points a side."""
    t = np.linspace(0, 1, 40, endpoint=False)[:, None]
    return np.concatenate([a + t * (b - a) for a, b in itertools.pairwise([*corners, corners[0]])])


@pytest.mark.parametrize("angle", np.linspace(0, 2 * math.pi, 7))
def test_the_nearest_rectangle_goes_through_the_sides_middles(angle: float) -> None:
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    ink = drawn(np.array([[0.0, 0], [200, 0], [200, 110], [0, 90]]))
    fit = fit_closed([(ink - (100, 50)) @ turn + 500], 0.5, 30.0, math.inf)
    box = (fit.rectangle - 500) @ turn.T + (100, 50)
    sides = np.hypot(*(np.roll(box, -1, axis=0) - box).T)
    assert sorted(sides) == pytest.approx([100, 100, 200, 200], rel=0.03)
    assert np.dot(box[1] - box[0], box[2] - box[1]) == pytest.approx(0, abs=1e-6)
    assert 0 < fit.extra < 0.02


def test_a_lozenge_is_far_from_every_rectangle() -> None:
    fit = fit_closed([drawn(np.array([[0.0, 0], [100, 30], [200, 0], [100, -30]]))], 0.5, 30.0, math.inf)
    assert fit.extra > 0.1


def lending(points: Array, ends: list[tuple[float, float]], *, several: bool = False) -> Array | None:
    strokes = measure([points])
    found = lent(strokes, 0, strokes.points, np.array(ends, dtype=float), 6.0, several=several)
    if found is None:
        return None
    side, step = found
    assert np.hypot(*np.diff(side, axis=0).T) == pytest.approx(np.full(len(side) - 1, step), rel=0.05)
    return side


def test_a_line_lends_its_ink_between_the_ends_of_others_from_the_last_to_the_first() -> None:
    line = np.stack([np.linspace(0, 480, 481), np.full(481, 7.0)], axis=1)
    side = lending(line, [(100, 5), (200, 10)])
    assert side is not None
    assert side[[0, -1]] == pytest.approx(np.array([[200.0, 7.0], [100.0, 7.0]]), abs=6.0)
    short = lending(line, [(100, 5), (112, 5)])  # a step of its samples is nearly as long
    assert short is not None
    assert short[[0, -1]] == pytest.approx(np.array([[112.0, 7.0], [100.0, 7.0]]), abs=1.0)
    assert lending(line, [(100, 5), (200, 20)]) is None  # out of reach
    assert lending(line, [(10, 7), (470, 7)]) is not None
    assert lending(line, [(10, 7), (470, 7)], several=True) is None  # it is one of theirs


def test_what_goes_around_lends_the_shorter_way_and_no_detour() -> None:
    t = np.linspace(0, 2 * math.pi, 300)
    circle = 100 * np.stack([np.cos(t), np.sin(t)], axis=1)
    side = lending(circle, [(70.7, -70.7), (70.7, 70.7)])  # a quarter, through where the pen began
    assert side is not None
    assert side[:, 0].min() > 60
    assert lending(circle, [(100, 0), (-98, 5)]) is None  # half of it is more than half as long again


def test_the_gap_between_open_lines_is_as_of_their_points() -> None:
    from scipy.spatial import cKDTree

    def dense(line: Array) -> Array:
        t = np.linspace(0, 1, 200)[:, None, None]
        return np.asarray((line[:-1] + t * np.diff(line, axis=0)).reshape(-1, 2))

    crossing = 0
    lines = [line[: 2 + n % 4] for n, line in enumerate(scattered(9, 30))]
    for one, other in itertools.combinations(lines, 2):
        wide, at = gap(one, other)
        nearest, _ = cKDTree(dense(one)).query(dense(other))
        step = max(np.hypot(*np.diff(line, axis=0).T).max() for line in (one, other)) / 199
        assert wide - 1e-9 <= nearest.min() <= wide + step
        assert max(np.hypot(*(dense(line) - at).T).min() for line in (one, other)) <= wide + step
        crossing += wide == 0
    assert 5 < crossing < 400
    # along one line, and of a single place
    assert gap(np.array([[0.0, 0], [10, 0]]), np.array([[14.0, 0], [20, 0]])) == (4, (10, 0))
    assert gap(np.array([[3.0, 4], [3, 4]]), np.array([[0.0, 0], [10, 0]]))[0] == 4


def test_what_is_within_a_triangle_whichever_way_it_goes() -> None:
    strokes = scattered(11, 60)
    ink = measured(page(strokes))
    triangle = np.array([[40.0, 30.0], [290.0, 80.0], [90.0, 280.0]])
    steps = np.roll(triangle, -1, axis=0) - triangle
    normals = np.stack([-steps[:, 1], steps[:, 0]], axis=1) / np.hypot(*steps.T)[:, None]
    beyond = {
        i: float(-((ink.strokes.samples[i, :, None] - triangle) * normals).sum(axis=2).min())
        for i in ink.pieces
    }
    samples, within = ctypes.c_void_p(address(ink.strokes.samples)), library().ink_within
    for reach in (0.0, 25.0):
        its = [
            {
                i
                for i in ink.pieces
                if within(samples, i, ctypes.c_void_p(address(way)), ctypes.c_double(reach))
            }
            for way in (triangle, triangle[::-1].copy())
        ]
        assert its[0] == its[1] == {i for i, far in beyond.items() if far <= reach}
        assert 2 < len(its[0]) < 40


def test_depths_are_those_of_each_place() -> None:
    outline, places = scattered(12, 2)
    assert depths(places, outline) == [depth(x, y, outline) for x, y in places.tolist()]
