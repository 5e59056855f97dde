"""Contact points of convex pieces against distances and depths found by brute force."""

import ctypes
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


class Found:
    def __init__(self, out, count):
        self.normal = np.array(out[:2])
        self.gap = out[2]
        rows = np.array(out[3 : 3 + 3 * count]).reshape(count, 3)
        self.points, self.separations = rows[:, :2], rows[:, 2]


@pytest.fixture(scope="session")
def manifold(probe):
    def find(a, b, margin=0.0):
        (va, ra), (vb, rb) = a, b
        arrays = [(ctypes.c_double * (2 * len(v)))(*np.ravel(v)) for v in (va, vb)]
        out = (ctypes.c_double * 9)()
        count = probe.probe_manifold(
            arrays[0],
            len(va),
            ctypes.c_double(ra),
            arrays[1],
            len(vb),
            ctypes.c_double(rb),
            ctypes.c_double(margin),
            out,
        )
        return Found(list(out), count)

    return find


def disk(x, y, r):
    return np.array([[x, y]]), r


def polygon(points, x=0.0, y=0.0, angle=0.0):
    c, s = math.cos(angle), math.sin(angle)
    return np.array(points) @ np.array([[c, s], [-s, c]]) + (x, y), 0.0


def box(w, h, x=0.0, y=0.0, angle=0.0):
    return polygon([(-w / 2, -h / 2), (w / 2, -h / 2), (w / 2, h / 2), (-w / 2, h / 2)], x, y, angle)


def segment_distance(p, a, b):
    d = b - a
    t = np.clip(np.dot(p - a, d) / np.dot(d, d), 0, 1)
    return np.linalg.norm(p - a - t * d)


def sides(v):
    return list(zip(v, np.roll(v, -1, 0), strict=True))


def distance(a, b):
    """Between two shapes that do not overlap."""
    (va, ra), (vb, rb) = a, b
    if len(va) == 1 and len(vb) == 1:
        return np.linalg.norm(va[0] - vb[0]) - ra - rb
    best = math.inf
    for u, v in ((va, vb), (vb, va)):
        if len(v) > 1:
            best = min(best, *(segment_distance(p, *s) for p in u for s in sides(v)))
    return best - ra - rb


def depth(a, b):
    """The least way that parts two overlapping polygons, or a polygon and a disk; negative when apart."""
    (va, ra), (vb, rb) = a, b
    if len(va) == len(vb) == 1:
        return ra + rb - np.linalg.norm(va[0] - vb[0])
    axes = []
    for v in (va, vb):
        if len(v) > 1:
            e = np.roll(v, -1, 0) - v
            n = np.stack([e[:, 1], -e[:, 0]], 1) / np.linalg.norm(e, axis=1)[:, None]
            axes += [n if v is va else -n]
    for p, q in ((va, vb), (vb, va)):
        if len(p) == 1 and len(q) > 1:
            d = q[np.argmin(np.linalg.norm(q - p[0], axis=1))] - p[0]
            if np.linalg.norm(d) > 0:
                axes.append((d if p is va else -d)[None] / np.linalg.norm(d))
    n = np.concatenate(axes)
    return np.min((n @ va.T).max(1) + ra - (n @ vb.T).min(1) + rb)


def test_a_box_flat_on_a_box_touches_at_two_points(manifold):
    m = manifold(box(4, 1), box(1, 1, 0.3, 1.0))
    assert m.gap == pytest.approx(0, abs=1e-15)
    assert m.normal == pytest.approx([0, 1])
    assert sorted(m.points.tolist()) == [pytest.approx([-0.2, 0.5]), pytest.approx([0.8, 0.5])]


def test_only_the_overhang_is_clipped(manifold):
    m = manifold(box(2, 1), box(2, 1, 1.5, 0.99))
    assert sorted(m.points[:, 0]) == pytest.approx([0.5, 1.0])
    assert m.separations == pytest.approx([-0.01, -0.01])


@pytest.mark.parametrize(("x", "y"), [(2.0, 0.1), (-1.8, 0.4), (0.1, -1.2), (1.2, 1.3), (-1.5, -0.9)])
def test_a_disk_near_a_box(manifold, x, y):
    a, b = box(2, 1), disk(x, y, 0.3)
    for first, second, sign in ((a, b, 1), (b, a, -1)):
        m = manifold(first, second, margin=10)
        assert m.gap == pytest.approx(distance(a, b), abs=1e-12)
        assert len(m.points) == 1
        nearest = np.clip([x, y], [-1, -0.5], [1, 0.5])
        normal = sign * (np.array([x, y]) - nearest)
        assert m.normal == pytest.approx(normal / np.linalg.norm(normal))


def test_a_disk_whose_centre_is_in_the_box_leaves_by_the_nearest_side(manifold):
    m = manifold(box(4, 2), disk(0.3, 0.9, 0.5))
    assert m.normal == pytest.approx([0, 1])
    assert m.gap == pytest.approx(-0.6)


def test_concentric_disks_have_some_normal(manifold):
    m = manifold(disk(1, 1, 0.5), disk(1, 1, 0.25))
    assert m.gap == pytest.approx(-0.75)
    assert np.linalg.norm(m.normal) == pytest.approx(1)


convex = st.builds(
    lambda angles, stretch: [(stretch * math.cos(t), math.sin(t)) for t in sorted(angles)],
    st.lists(st.floats(0, 6.2), min_size=3, max_size=24, unique_by=lambda t: round(t, 1)),
    st.floats(0.1, 3),
).filter(lambda v: len(v) >= 3 and area(v) > 1e-3)


def area(v):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(v, [*v[1:], v[0]], strict=True)) / 2


@settings(max_examples=120, deadline=None, derandomize=True)
@given(convex, convex, st.floats(-5, 5), st.floats(-5, 5), st.floats(0, 6.3))
def test_polygons_against_brute_force(manifold, u, v, x, y, angle):
    a, b = polygon(u), polygon(v, x, y, angle)
    check(manifold, a, b)
    check(manifold, b, a)


@settings(max_examples=80, deadline=None, derandomize=True)
@given(convex, st.floats(-4, 4), st.floats(-4, 4), st.floats(0.05, 1))
def test_disks_on_polygons_against_brute_force(manifold, u, x, y, r):
    a, b = polygon(u), disk(x, y, r)
    check(manifold, a, b)
    check(manifold, b, a)


def check(manifold, a, b):
    m = manifold(a, b, margin=100.0)
    d = depth(a, b)
    assert np.linalg.norm(m.normal) == pytest.approx(1)
    if d > 1e-9:
        assert m.gap == pytest.approx(-d, rel=3e-3, abs=1e-9)  # near a tie either side will do
    elif d < -1e-9:
        true = distance(a, b)
        assert m.gap <= true + 1e-9  # a lower bound always
        if len(m.points):
            assert min(m.separations) == pytest.approx(m.gap)
            assert m.gap >= 0.99 * true
        # moved together along the normal by the gap they touch, and are not in each other
        moved = (b[0] - (m.gap - 1e-9) * m.normal, b[1])
        assert depth(a, moved) <= 1e-8
