"""The C fits: shapes that are known, with seeded noise, and ink without a shape."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import box, measured, ngon, page, read

from sketch.kernel import depth, measure
from sketch.shapes.closed import fit_closed
from sketch.synthetic import HANDS, outline


def ring(vertices: list[tuple[float, float]], n: int = 100) -> np.ndarray:
    v = np.array([*vertices, vertices[0]], dtype=float)
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(v, axis=0).T))])
    t = np.linspace(0, along[-1], n)
    return np.stack([np.interp(t, along, v[:, k]) for k in (0, 1)], axis=1)


def fit(points: np.ndarray) -> object:
    return fit_closed([points], 0.5, 24.0, math.inf)


def nearest(found: np.ndarray, wanted: list[tuple[float, float]]) -> float:
    """The greatest distance from a wanted corner to the nearest found."""
    return max(float(np.hypot(*(found - w).T).min()) for w in np.array(wanted))


def rounded(vertices: list[tuple[float, float]], share: float) -> np.ndarray:
    """A polygon's outline whose sides end in arcs that begin at such a share of them."""
    v = np.array(vertices, dtype=float)
    t = np.linspace(0, 1, 12)[:, None]
    arcs = []
    for a, b, c in zip(np.roll(v, 1, axis=0), v, np.roll(v, -1, axis=0), strict=True):
        p, q = b + share * (a - b), b + share * (c - b)
        arcs.append((1 - t) ** 2 * p + 2 * t * (1 - t) * b + t**2 * q)
    ink = np.concatenate([*arcs, arcs[0][:1]])
    return ring([(x, y) for x, y in ink[:-1].tolist()], 200)


@pytest.mark.parametrize("n", [4, 5, 6])
def test_corners_that_the_ink_stays_off_speak_against_a_polygon(n: int) -> None:
    v = ngon(n, 300, 200, 100)
    costs = [fit(rounded(v, share)).cost[n] for share in (0.02, 0.15, 0.3, 0.45)]
    assert costs == sorted(costs)
    assert costs[3] - costs[0] > 12


def test_a_corner_that_was_not_drawn_is_not_round() -> None:
    whole = ring([(0, 0), (200, 0), (200, 200), (0, 200)], 200)
    corner, side = whole[10:190], np.roll(whole[:-1], 25, axis=0)[10:190]
    at_corner, at_side = fit(corner), fit(side)
    assert at_corner.cost[4] - at_side.cost[4] < 1


@pytest.mark.parametrize("n", [3, 4, 5, 6, 8])
def test_corners_of_a_polygon(n: int) -> None:
    v = ngon(n, 300, 200, 100)
    noise = np.random.default_rng(n).normal(0, 0.5, (100, 2))
    result = fit(ring(v) + noise)
    assert nearest(result.vertices(n), v) < 3.5  # between two points a corner is cut
    assert result.residual[n] < 0.02**2
    cost = [result.cost[k] + 8 * k for k in range(3, 11)]
    assert cost.index(min(cost)) + 3 == n


def test_a_long_box_keeps_its_short_sides() -> None:
    v = box(300, 200, 900, 30, 0.4)
    result = fit(ring(v, 400))
    assert nearest(result.vertices(4), v) < 6


def test_circle_and_ellipse() -> None:
    t = np.linspace(0, 2 * math.pi, 80)
    circle = np.stack([300 + 70 * np.cos(t), 200 + 70 * np.sin(t)], axis=1)
    x, y, r = fit(circle).circle
    assert (x, y, r) == pytest.approx((300, 200, 70), abs=0.2)
    # a third missing moves neither centre nor radius much
    x, y, r = fit(circle[:55]).circle
    assert (x, y, r) == pytest.approx((300, 200, 70), abs=1.5)


def test_a_bowed_side_is_one_side() -> None:
    t = np.linspace(0, 1, 60)[:, None]
    bow = np.concatenate([t * [200, 0] + np.sin(math.pi * t) * [0, -14], [[200, 0], [100, 170], [0, 0]]])
    result = fit(bow)
    assert result.cost[3] + 24 < result.cost[4] + 32


def test_depth_is_negative_inside() -> None:
    v = np.array([[0, 0], [10, 0], [10, 10], [5, 4], [0, 10]], dtype=float)
    assert depth(5, 2, v) == pytest.approx(-2)
    assert depth(5, 8, v) > 0
    assert depth(-3, 0, v) == pytest.approx(3)


def test_hooks_are_cut_and_short_sides_are_not() -> None:
    hooked = np.array(
        [[4, 9], [0, 0], *[[k, 0] for k in range(10, 210, 10)], [200, 80], [0, 80], [0, 6]], float
    )
    end = np.array([[0, 0], [900, 0], [900, 30], [0, 30], [0, 2]], float)
    cut, kept = measured(page([hooked, end])).pieces.values()
    assert cut.points[0].tolist() == [0, 0]
    assert len(kept.points) == 5


@pytest.mark.parametrize("points", [[], [[1, 1]], [[1, 1], [1, 1]], [[0, 0], [0, 0], [0, 0]]])
def test_ink_without_length_is_no_piece(points: list[list[float]]) -> None:
    dot = np.array(points, dtype=float).reshape(-1, 2)
    line = np.array([[0.0, 0.0], [50.0, 1.0]])
    strokes = measure([dot, line, dot])
    assert strokes.measure[:, 0].tolist() == [0, pytest.approx(50.01, abs=0.01), 0]
    pieces = list(measured(page([dot, line, dot])).pieces.values())
    assert [p.stroke for p in pieces] == [1]


@pytest.mark.parametrize("seed", range(40))
def test_no_ink_gives_nan_or_a_crossing_polygon(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kind = seed % 4
    points = {
        0: rng.normal(0, 100, (rng.integers(3, 60), 2)),
        1: np.repeat(rng.normal(0, 1, (3, 2)), 9, axis=0),
        2: np.outer(np.linspace(-1, 1, 30), [3.0, 1.0]) + rng.normal(0, 1e-9, (30, 2)),
        3: np.concatenate(outline(ngon(5, 0, 0, 1e-3), HANDS["shaky"], rng)),
    }[kind]
    result = fit(points)
    for k in range(3, 13):
        if math.isfinite(result.cost[k]):
            assert np.isfinite(result.vertices(k)).all()
    assert not math.isnan(result.circle_cost)
    assert not math.isnan(result.ellipse_cost)


@pytest.mark.parametrize("name", ["quick", "shaky"])
def test_a_body_lies_where_it_lies_whichever_way_it_was_drawn(name: str) -> None:
    for seed in range(30):
        rng = np.random.default_rng(seed)
        corners = box(400, 300, 240, 110, 0.3) if seed % 2 else ngon(3 + seed % 4, 400, 300, 110)
        strokes = outline(corners, HANDS[name], rng)
        forth, back = (read(ink).readings[0].outline for ink in (strokes, [s[::-1] for s in strokes]))
        assert len(forth) == len(back)
        assert nearest(back, [tuple(corner) for corner in forth]) < 0.03


@pytest.mark.parametrize(
    "corners", [box(400, 300, 240, 110, 0.3), box(400, 300, 40, 140), ngon(3, 400, 300, 110)]
)
def test_it_does_not_matter_where_on_an_outline_the_pen_begins(corners: list[tuple[float, float]]) -> None:
    for seed in range(4):
        tremor = np.random.default_rng(seed).normal(0, 2, (120, 2))
        ink = ring(corners, 121)[:-1] + (tremor + np.roll(tremor, 1, axis=0) + np.roll(tremor, 2, axis=0)) / 3
        for first in range(0, 120, 5):
            for drawn in (np.roll(ink, first, axis=0), np.roll(ink, first, axis=0)[::-1]):
                found = read([drawn]).readings
                assert [len(r.outline) for r in found] == [len(corners)], (seed, first)


def test_a_hexagon_with_a_side_undrawn_is_one() -> None:
    v = ngon(6, 300, 200, 100)
    noise = np.random.default_rng(3).normal(0, 0.5, (100, 2))
    for missing in range(6):
        sides = v[missing + 1 :] + v[: missing + 1]
        ink = ring(sides, 120)[:100] + noise  # five of six sides
        result = fit(ink)
        cost = [result.cost[k] + result.lacks[k] + 8 * k for k in range(3, 11)]
        assert cost.index(min(cost)) + 3 == 6
        assert nearest(result.vertices(6), v) < 5
        assert result.lacks[6] == pytest.approx(4.0 * 24 / 5, rel=0.1)


def test_a_cup_is_open() -> None:
    """Three sides of a box lack the fourth on purpose, however deep: three bars stay three bars."""
    rng = np.random.default_rng(2)
    for width in (300, 200, 120):
        for flare in (0, 40):
            a, b, c, d = (400 - flare, 200), (400, 500), (400 + width, 500), (400 + width + flare, 200)
            t = np.linspace(0, 1, 40)[:, None]
            sides = [
                np.array(p) + t * np.subtract(q, p) + rng.normal(0, 0.4, (40, 2))
                for p, q in ((a, b), (b, c), (c, d))
            ]
            assert [r.kind for r in read(sides).readings] == ["bar"] * 3


def test_a_notched_box_is_the_same_backwards() -> None:
    """Where its last side meets the first, a pen slips; between four sides and five there is little."""
    rng = np.random.default_rng(4)
    corners = [(12, 12), (0, 160), (28, 175), (41, 170), (40, 35), (28, 0), (17, 20), (10, 10)]
    for _ in range(8):
        v = np.array(corners) + rng.normal(0, 1.5, (8, 2))
        ink = ring([(300 + x, 200 + y) for x, y in v.tolist()], 120)[:-4]
        forth, back = (fit(order) for order in (ink, ink[::-1]))
        for k in (4, 5):
            assert forth.cost[k] == pytest.approx(back.cost[k], abs=1.5)
