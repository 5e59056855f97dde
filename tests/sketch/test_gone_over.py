"""Lines and arrows that were gone over, or drawn with the pen lifted on the way, or with a tap beside them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import box, kinds, read

from sketch.synthetic import HANDS, arrow, line, outline

HAND = HANDS["neat"]


@pytest.mark.parametrize("length", [70, 150, 300])
@pytest.mark.parametrize("seed", range(4))
def test_a_line_drawn_twice_is_one_rod(length: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ends = [(300.0, 200.0), (300 + length * math.cos(0.4), 200 + length * math.sin(0.4))]
    assert kinds(read(line(ends, HAND, rng) + line(ends, HAND, rng))) == ["bar"]


@pytest.mark.parametrize("seed", range(6))
def test_an_arrow_drawn_twice_is_one_arrow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = arrow((200, 150), (210, 300), HAND, rng)
    again = [s + rng.normal(0, 1.5, 2) for s in first]
    seen = read(outline(box(700, 400, 300, 160), HAND, rng), first, again)
    assert sum(r.kind == "gravity" for r in seen.readings) == 1
    assert seen.scene.gravity[1] < -9


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_an_arrow_whose_shaft_was_drawn_in_two_goes_all_the_way(share: float) -> None:
    rng = np.random.default_rng(1)
    tail, tip = np.array([200.0, 150.0]), np.array([215.0, 330.0])
    middle = tail + share * (tip - tail)
    strokes = [*line([tail, middle], HAND, rng), *line([middle + 1.5, tip], HAND, rng)]
    strokes += line([(190, 300), tip, (244, 304)], HAND, rng)
    seen = read(outline(box(700, 400, 300, 160), HAND, rng), strokes)
    (found,) = (r for r in seen.readings if r.kind == "gravity")
    assert math.dist(found.outline[0], tail) < 8
    assert len(seen.scene.bodies) == 1


@pytest.mark.parametrize("at", [(262, 205), (380, 290)])
def test_a_tap_beside_a_line_makes_it_no_letter(at: tuple[float, float]) -> None:
    rng = np.random.default_rng(2)
    tap = at + rng.normal(0, 0.5, (4, 2))
    seen = read(outline(box(800, 400, 600, 60), HAND, rng), line([(260, 200), (400, 300)], HAND, rng), [tap])
    assert [r.kind for r in seen.readings if r.solid][-1:] == ["bar"]
    assert len(seen.scene.bodies) == 2
