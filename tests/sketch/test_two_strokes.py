"""Shapes that the pen was lifted in, and what looks like them: two things in line."""

from __future__ import annotations

import numpy as np
import pytest
from pages import box, page

from sketch import recognize
from sketch.synthetic import HANDS, Hand, cross, line, outline

NEAT = HANDS["neat"]


def cut_at(share: float, corners: list[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """A closed outline in two paths: the first goes so far around, the second the rest."""
    ring = np.array([*corners, corners[0]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    at = share * along[-1]
    here = tuple(float(np.interp(at, along, ring[:, k])) for k in (0, 1))
    before, after = ring[along < at], ring[along > at]
    return [[*map(tuple, before.tolist()), here], [here, *map(tuple, after.tolist())]]  # type: ignore[list-item]


@pytest.mark.parametrize("share", [0.6, 0.8, 0.87, 0.93])
@pytest.mark.parametrize("size", [(300, 200), (400, 90)])
def test_the_last_of_an_outline_in_a_stroke_of_its_own_belongs_to_it(
    size: tuple[float, float], share: float
) -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        strokes = [line(path, NEAT, rng) for path in cut_at(share, box(500, 300, *size))]
        (reading,) = recognize(page(*strokes)).readings
        assert (reading.kind, reading.strokes) == ("rectangle", (0, 1))


@pytest.mark.parametrize(("missing", "beyond"), [(0.21, 0.0), (0.3, 0.15)])
def test_a_gap_that_a_further_stroke_closes_is_a_part_of_the_outline(missing: float, beyond: float) -> None:
    """That stroke goes along a triangle's first side, up to its top or beyond it by a share of that side."""
    floor, quick = (
        box(640, 600, 1200, 50),
        Hand(tremor=0.004, drift=0.01, rounding=0.03, spacing=0.05, unsteady=0.5),
    )
    top, left, right = np.array([[640.0, 290.0], [600.0, 360.0], [675.0, 365.0]])
    begins, ends = top + missing * (left - top), top + 0.05 * (right - top)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        ink = line([tuple(p) for p in (begins, left, right, ends)], quick, rng)
        added = line([tuple(begins), tuple(top - beyond * (left - top))], Hand(spacing=0.2), rng)
        readings = recognize(page(outline(floor, quick, rng), ink, added)).readings
        assert [len(r.outline) for r in readings] == [4, 3]


@pytest.mark.parametrize("top", [80, 100, 120])
@pytest.mark.parametrize("height", [160, 260])
def test_a_short_side_in_a_stroke_of_its_own_closes_an_outline(top: float, height: float) -> None:
    (a, b), (c, d) = ((500 - top / 2, 300), (500 + top / 2, 300)), ((725, 300 + height), (275, 300 + height))
    for seed in range(3):
        rng = np.random.default_rng(seed)
        strokes = [*line([a, b], NEAT, rng), *line([b, c, d, a], NEAT, rng)]
        (reading,) = recognize(page(strokes)).readings
        assert (len(reading.outline), reading.strokes) == (4, (0, 1))


@pytest.mark.parametrize("turn", [0.0, 0.8, 1.57])
def test_two_floors_in_line_with_a_hole_between_them_are_two(turn: float) -> None:
    c, s = np.cos(turn), np.sin(turn)
    for seed in range(3):
        rng = np.random.default_rng(seed)

        def at(x: float) -> tuple[float, float]:
            return (400 + c * x, 300 + s * x)

        floors = [line([at(a), at(b)], NEAT, rng) for a, b in ((-220, -20), (20, 220))]
        marks = [cross(at(x), 30, NEAT, rng) for x in (-120, 120)]
        bodies = recognize(page(*floors, *marks)).scene.bodies
        assert len(bodies) == 2
        assert all(body.anchored for body in bodies)
