"""Convex pieces: they cover the polygon, they are convex, and they do not overlap."""

import math
import random
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.reference import convex_pieces
from sim.scene import InputError, Polygon, Scene, area_properties


def area(v):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(v, [*v[1:], v[0]], strict=True)) / 2


def check(v):
    """The pieces of v: counter-clockwise and convex, of v's vertices, their areas adding up to v's.

    Pieces that left something out, or overlapped, would differ in area or in its moments.
    """
    pieces = convex_pieces(v)
    known = set(v)
    size = max(math.dist(v[0], p) for p in v)
    for piece in pieces:
        assert len(piece) >= 3
        assert set(piece) <= known
        assert area(piece) > 0
        for a, b, c in zip(piece, [*piece[1:], piece[0]], [*piece[2:], *piece[:2]], strict=True):
            assert (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) >= -1e-12 * size * size
    assert sum(map(area, pieces)) == pytest.approx(abs(area(v)), rel=1e-9, abs=1e-12 * size * size)
    whole_x, whole_y = moments([v if area(v) > 0 else v[::-1]])
    x, y = moments(pieces)
    reach = size + math.hypot(*v[0])
    assert abs(x - whole_x) <= 1e-9 * size * size * reach
    assert abs(y - whole_y) <= 1e-9 * size * size * reach
    return pieces


def moments(pieces):
    x = y = 0.0
    for v in pieces:
        for a, b in zip(v, [*v[1:], v[0]], strict=True):
            cross = a[0] * b[1] - a[1] * b[0]
            x += cross * (a[0] + b[0]) / 6
            y += cross * (a[1] + b[1]) / 6
    return x, y


def inside(p, v):
    count = 0
    for a, b in zip(v, [*v[1:], v[0]], strict=True):
        if (a[1] > p[1]) != (b[1] > p[1]) and p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]):
            count += 1
    return count % 2 == 1


def star(radii, start=0.0):
    n = len(radii)
    return [
        (r * math.cos(start + 2 * math.pi * k / n), r * math.sin(start + 2 * math.pi * k / n))
        for k, r in enumerate(radii)
    ]


def test_a_convex_polygon_stays_whole():
    assert len(check(star([1.0] * 200))) == 1
    assert len(check([(0, 0), (4, 0), (4, 3)])) == 1


@pytest.mark.parametrize(
    ("outline", "most"),
    [
        ([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 3),  # L
        ([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], 3),  # U
        (
            [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 1.5), (1, 2), (0, 2), (0, 1)],
            3,
        ),  # L with vertices on its sides
        (star([2, 1] * 5), 8),
        ([(-1, 0), (0, -1e-9), (1, 0), (0, 1e-9)], 1),  # a sliver
        ([(0, 0), (10, 0), (10, 1), (5, 1e-6), (0, 1)], 3),  # nearly cut in two
        ([(0, 0), (1, 0), (1, 1), (0.5, 1 - 1e-13), (0, 1)], 2),  # concave by rounding alone
    ],
)
def test_few_pieces(outline, most):
    outline = [(float(x), float(y)) for x, y in outline]
    assert len(check(outline)) <= most
    assert len(check(outline[::-1])) <= most


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.lists(st.floats(0.01, 1.0), min_size=3, max_size=60), st.floats(0, 7), st.floats(-1e3, 1e3))
def test_stars_are_covered(radii, start, offset):
    check([(x + offset, y) for x, y in star(radii, start)])


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=4, max_size=24))
def test_lattice_polygons_are_covered(points):
    """Collinear runs, needles, corners on sides: as far as the scene's check lets them pass."""
    polygon = [(float(x), float(y)) for x, y in dict.fromkeys(points)]
    if len(polygon) < 3:
        return
    body = {"id": "b", "shape": {"type": "polygon", "vertices": polygon}, "position": [0, 0]}
    try:
        Scene.from_dict({"bodies": [body]})
    except InputError:
        polygon = untangled(polygon)
    if area_properties(Polygon(polygon))[0] > 0:
        check(polygon)


def untangled(points):
    """The same points in order about a point inside: a star-shaped polygon."""
    cx = sum(p[0] for p in points) / len(points) + 1e-3
    cy = sum(p[1] for p in points) / len(points) + 2e-3
    return sorted(points, key=lambda p: math.atan2(p[1] - cy, p[0] - cx))


def test_pieces_lie_inside():
    """No point of the plane is in two pieces, and each is in one just when it is in the polygon."""
    rng = random.Random(5)
    for _ in range(20):
        v = star([rng.uniform(0.2, 1) for _ in range(rng.randrange(5, 40))])
        pieces = check(v)
        for _ in range(100):
            p = (rng.uniform(-1, 1), rng.uniform(-1, 1))
            assert sum(inside(p, piece) for piece in pieces) == inside(p, v)


def test_thousands_of_vertices_are_quick():
    rng = random.Random(1)
    v = star([rng.uniform(0.9, 1.0) for _ in range(5000)])
    began = time.process_time()
    pieces = check(v)
    assert time.process_time() - began < 2
    assert len(pieces) < 5000
    spiral = [(t * math.cos(t), t * math.sin(t)) for t in (k / 50 for k in range(50, 1500))]
    check(
        spiral
        + [((t + 1) * math.cos(t), (t + 1) * math.sin(t)) for t in (k / 50 for k in range(1499, 49, -1))]
    )
