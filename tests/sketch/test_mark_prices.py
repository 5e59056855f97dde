"""What marks cost where their ink is known: closed forms of the nats."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import measured

from sketch.ink import Sketch, Stroke
from sketch.page.pieces import Page
from sketch.scoring import FREE, misfit, strange
from sketch.shapes.bars import STRAIGHT, read_bar_of_two
from sketch.shapes.marks import read_cross

Point = tuple[float, float]


def page_with(*bars: tuple[Point, Point]) -> Page:
    """Straight strokes from point to point."""
    return measured(Sketch([Stroke(np.linspace(a, b, 60)) for a, b in bars], width=1280, height=720))


def cross_of(share: float, ratio: float) -> float:
    """Nats of two upright bars that cross at a share of both; one is `ratio` times as long."""
    across, up = 200.0, 200.0 * ratio
    bars = (
        ((300 - share * across, 300), (300 + (1 - share) * across, 300)),
        ((300, 300 - share * up), (300, 300 + (1 - share) * up)),
    )
    found = read_cross(page_with(*bars), (0, 1))
    assert found is not None
    return found.cost


@pytest.mark.parametrize("share", [0.35, 0.7])
@pytest.mark.parametrize("ratio", [0.8, 1.5])
def test_an_x_costs_how_far_from_its_middle_it_crosses_and_how_unlike_its_bars_are(
    share: float, ratio: float
) -> None:
    """Normal deviates: each bar's share with a spread of 0.12, the log of their ratio with one of 0.3."""
    plain = cross_of(0.5, 1.0)
    assert cross_of(share, 1.0) - plain == pytest.approx(((share - 0.5) / 0.12) ** 2, abs=0.05)
    assert cross_of(0.5, ratio) - plain == pytest.approx(0.5 * (math.log(ratio) / 0.3) ** 2, abs=0.05)


@pytest.mark.parametrize("off", [2.0, 5.0])
def test_a_bar_gone_over_costs_how_far_both_strokes_are_off_it(off: float) -> None:
    """Two parallel strokes are each half of their distance off the bar between them."""

    def cost(by: float) -> tuple[float, Page]:
        page = page_with(((100, 200 - by), (500, 200 - by)), ((100, 200 + by), (500, 200 + by)))
        found = read_bar_of_two(page, page.pieces[0], page.pieces[1])
        assert found is not None
        assert np.sort(found.outline, axis=0) == pytest.approx(np.array([[100, 200], [500, 200]]), abs=1e-6)
        return found.cost, page

    (apart, page), (over, _) = cost(off), cost(0.0)
    count = sum(p.observations for p in page.pieces.values())
    scale = math.sqrt(3) / 4 * 400
    bowed = 0.5 * (off / (STRAIGHT * scale)) ** 2
    assert apart - over == pytest.approx(misfit((off / scale) ** 2, count) + bowed, rel=1e-6)


@pytest.mark.parametrize("way", [((400, 200), (300, 150)), ((300, 200), (400, 150))])
def test_ink_that_an_x_does_not_need_leaves_it_rough(way: tuple[Point, Point]) -> None:
    """Two bars, of which one goes on elsewhere for as long: a letter's stroke."""
    bars = [((300, 300), (400, 200)), ((300, 200), (400, 300))]
    plain = read_cross(page_with(*bars), (0, 1))
    longer = [np.linspace(a, b, 60) for a, b in bars]
    k = 0 if way[0][0] == 400 else 1
    longer[k] = np.concatenate([longer[k] if k == 0 else longer[k][::-1], np.linspace(*way, 40)[1:]])
    page = measured(Sketch([Stroke(p) for p in longer], width=1280, height=720))
    found = read_cross(page, (0, 1))
    assert plain is not None
    assert found is not None
    spare = math.dist(*way) / sum(p.length for p in page.pieces.values())
    count = spare * sum(p.observations for p in page.pieces.values())
    assert found.rough == pytest.approx(plain.rough + (strange(count) + FREE * count), rel=0.03)
