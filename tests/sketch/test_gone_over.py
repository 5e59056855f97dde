"""Lines and arrows that were gone over, or drawn with the pen lifted on the way, or with a tap beside them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from pages import box, kinds, read

from sketch import Recognition
from sketch.synthetic import HANDS, Hand, arrow, cross, line, outline

Array = NDArray[np.float64]

HAND = HANDS["neat"]


@pytest.mark.parametrize("length", [70, 150, 300])
@pytest.mark.parametrize("seed", range(4))
def test_a_line_drawn_twice_is_one_rod(length: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ends = [(300.0, 200.0), (300 + length * math.cos(0.4), 200 + length * math.sin(0.4))]
    assert kinds(read(line(ends, HAND, rng) + line(ends, HAND, rng))) == ["bar"]


@pytest.mark.parametrize("hand", [HANDS["neat"], HANDS["shaky"]], ids=["neat", "shaky"])
@pytest.mark.parametrize("passes", [(1, 1, 1), (2, 1), (1, 3), (4, 1)])
def test_a_line_gone_over_more_than_twice_is_one_rod(passes: tuple[int, ...], hand: Hand) -> None:
    """passes: of each stroke, how often it goes from one end to the other."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        ends = [(300.0, 200.0), (500.0, 270.0)]
        strokes = [line([ends[k % 2] for k in range(often + 1)], hand, rng) for often in passes]
        (rod,) = read(*strokes).readings
        assert rod.kind == "bar"
        assert sorted(rod.outline.tolist()) == pytest.approx(np.array(ends), abs=8)


def scrawled(ends: list[tuple[float, float]], passes: int, wide: float, rng: np.random.Generator) -> Array:
    """A stroke that goes forth and back between two places, off them by some pixels at each turn."""
    turns = [np.array(ends[k % 2]) + rng.normal(0, wide, 2) for k in range(passes + 1)]
    return np.concatenate([np.linspace(a, b, 25) for a, b in pairwise(turns)])


@pytest.mark.parametrize("passes", [3, 4, 7])
@pytest.mark.parametrize("seed", range(4))
def test_a_stroke_that_goes_forth_and_back_along_a_line_is_a_rod(passes: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    stroke = scrawled([(300, 200), (560, 420)], passes, 4.0, rng)
    (rod,) = read([stroke]).readings
    assert rod.kind == "bar"
    assert sorted(rod.outline.tolist()) == pytest.approx(np.array([(300, 200), (560, 420)]), abs=14)


@pytest.mark.parametrize("length", [90, 250])
def test_a_line_begun_forth_and_back_is_a_rod(length: float) -> None:
    """Where it goes forth it bows aside, by a fiftieth of the line."""
    for share in (0.12, 0.15, 0.2):
        t = np.linspace(0, 1, 20)[:, None]
        forth = np.array([share * length, 0.0]) * (1 - t) + np.array([0.0, 0.02 * length]) * np.sin(
            math.pi * t
        )
        stroke = np.concatenate([forth, np.linspace((0, 0), (length, 0), 40)])
        (rod,) = read([300 + stroke]).readings
        assert rod.kind == "bar"
        assert sorted(rod.outline[:, 0]) == pytest.approx([300, 300 + length], abs=0.02 * length)


@pytest.mark.parametrize("seed", range(4))
def test_shading_to_and_fro_is_no_rod(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = [(300 + 30 * k + rng.normal(0, 3), 200 + 60 * (k % 2) + rng.normal(0, 3)) for k in range(12)]
    assert "bar" not in kinds(read([np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(turns)])]))


def on_a_box(*strokes: list[Array]) -> Recognition:
    return read(outline(box(640, 360, 520, 420), HAND, np.random.default_rng(1)), *strokes)


def cross_of_two(size: float, rng: np.random.Generator) -> list[Array]:
    """An X of so wide a box in the middle of the page, in two strokes."""
    return [
        stroke
        for side in (-1, 1)
        for stroke in line(
            [(640 - size / 2, 360 - side * size / 2), (640 + size / 2, 360 + side * size / 2)], HAND, rng
        )
    ]


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("size", [30, 120])
def test_a_cross_with_a_bar_that_the_pen_was_lifted_in_is_one_anchor(size: float, share: float) -> None:
    for seed in range(4):
        rng = np.random.default_rng(seed)
        a, b = cross_of_two(size, rng)
        at = int(share * len(a))
        seen = on_a_box([a[: at + 1], a[at:] + rng.normal(0, 0.01 * size, 2), b])
        assert [r.strokes for r in seen.readings if r.kind == "anchor"] == [(4, 5, 6)]
        assert [body.anchored for body in seen.scene.bodies] == [True]


@pytest.mark.parametrize("size", [30, 120])
def test_a_cross_drawn_twice_is_one_anchor(size: float) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        first = cross_of_two(size, rng)
        again = [s + rng.normal(0, 0.02 * size, 2) for s in first]
        seen = on_a_box(first, again)
        assert [r.strokes for r in seen.readings if r.kind == "anchor"] == [(4, 5, 6, 7)]


def test_two_crosses_beside_each_other_stay_two() -> None:
    rng = np.random.default_rng(1)
    seen = on_a_box(cross((620, 360), 30, HAND, rng), cross((645, 365), 30, HAND, rng))
    assert sum(r.kind == "anchor" for r in seen.readings) == 2


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
