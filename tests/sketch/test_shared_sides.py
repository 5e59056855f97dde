"""Bodies of which a side was not drawn, as another has it already: a wedge on its ground's line, boxes in a pile."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pages import box, kinds, read

from sketch.synthetic import HANDS, cross, line, outline

NEAT = HANDS["neat"]
seeds = pytest.mark.parametrize("seed", range(6))


@seeds
def test_a_wedge_of_two_strokes_stands_on_the_ground_s_line(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ground = outline(box(640, 630, 1000, 60), NEAT, rng)
    slopes = [line([(520, 597), (602, 430)], NEAT, rng), line([(610, 440), (700, 597)], NEAT, rng)]
    found = read(ground, *slopes, cross((608, 545), 25, NEAT, rng), cross((300, 630), 18, NEAT, rng))
    assert kinds(found) == ["3-gon", "4-gon", "anchor", "anchor"]
    wedge = next(b for b in found.scene.bodies if b.strokes == [len(ground), len(ground) + 1])
    assert wedge.anchored
    ppm = found.scene.view.pixels_per_metre
    low = max(-wedge.position[1] * ppm - y * ppm for _, y in wedge.shape.vertices)  # type: ignore[union-attr]
    assert low == pytest.approx(600, abs=6)


@seeds
def test_boxes_of_a_pile_stand_on_each_other_s_top(seed: int) -> None:
    """The top of each is drawn once: it is the next one's bottom as well."""
    rng = np.random.default_rng(seed)
    ground = outline(box(640, 630, 1000, 60), NEAT, rng)
    strokes, y = [ground], 600.0
    for k, width in enumerate((180, 135, 100)):
        x, top = 640 - width / 2, y - 90
        left = line([(x, y - 3), (x, top)], NEAT, rng)
        over = line([(x + 2, top), (x + width, top + 2)], NEAT, rng)
        right = line([(x + width, top), (x + width, y - 2)], NEAT, rng)
        strokes += [left, over, right] if k % 2 else [over, right, left]
        y = top
    found = read(*strokes)
    assert kinds(found) == ["4-gon"] * 4
    assert [len(b.strokes or []) for b in found.scene.bodies] == [len(ground), 3, 3, 3]


@seeds
def test_cells_in_a_row_share_the_sides_between_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = outline(box(300, 400, 120, 100), replace(NEAT, parts=(1,)), rng)
    strokes, x = [first], 360.0
    for width in (130.0, 110.0):
        over = line([(x + 2, 350), (x + width, 351)], NEAT, rng)
        rest = line([(x + width, 349), (x + width, 450), (x + 1, 449)], NEAT, rng)
        strokes += [over, rest]
        x += width
    found = read(*strokes)
    assert kinds(found) == ["4-gon"] * 3


@seeds
def test_an_x_lends_no_side(seed: int) -> None:
    """The bars of an X over the ends of two strokes: a wedge would lie on one of them."""
    rng = np.random.default_rng(seed)
    hill = outline(box(600, 500, 400, 260), NEAT, rng)
    mark = cross((600, 470), 70, NEAT, rng)
    (x, y), (u, v) = mark[0][0], mark[0][-1]
    sides = [line([(x, y), (x + 70, y - 55)], NEAT, rng), line([(x + 75, y - 50), (u, v)], NEAT, rng)]
    found = read(hill, mark, *sides)
    assert "anchor" not in kinds(found) or "3-gon" not in kinds(found)
