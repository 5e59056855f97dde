"""Whole drawings on made-up paper: all of it is read, nothing is invented, whatever the paper is like."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sketch import load_sketch, recognize
from sketch.scan.paper.page import ink_mask, read_page
from tests.benchmarks.drawings import Drawing, differences
from tests.benchmarks.mechanisms import draw
from tests.sketch.scan.paper import PAPERS, photographed

PENDULUM, CART = 0, 1
APART = 32  # shapes that do not touch, which may be filled
FUNNEL = 24  # without a pivot, and with shapes that nothing holds


def drawing(name: str) -> tuple[int, Drawing]:
    # a marker nearly as wide as a pivot hides what the pivot joins
    wide = name in ("marker", "whiteboard with glare")
    turn = PENDULUM if wide or list(PAPERS).index(name) % 2 else CART
    number = {"filled": APART, "hatched": FUNNEL, "wide marker": FUNNEL}.get(name, turn)
    return number, draw(number, 7, 20)


@pytest.mark.parametrize("name", PAPERS)
def test_a_drawing_is_read_on_every_paper(name: str) -> None:
    number, drawn = drawing(name)
    data, seen = photographed(drawn, PAPERS[name], np.random.default_rng([number, 1]))
    assert differences(seen, recognize(load_sketch(data)).scene) == []


def test_a_page_of_filled_shapes_alone_is_read() -> None:
    """Nothing on it is as thin as a pen."""
    drawn = draw(104, 7, 20)
    data, seen = photographed(drawn, PAPERS["filled"], np.random.default_rng([104, 1]))
    assert differences(seen, recognize(load_sketch(data)).scene) == []


@pytest.mark.parametrize("number", [1, 5, 10])
def test_what_a_ballpoint_skips_is_drawn(number: int) -> None:
    """Else a line is four or five, and a box in as many strokes is none."""
    rng = np.random.default_rng([7440, number, 496188278])
    data, seen = photographed(draw(number, 7444, 20), PAPERS["ballpoint that skips"], rng)
    assert differences(seen, recognize(load_sketch(data)).scene) == []


@pytest.mark.parametrize("number", [11, 29, 47])
def test_the_hole_of_a_pivot_under_a_marker_is_bare(number: int) -> None:
    """A line is not so thick as a ring is all around its hole, and so it is no grain."""
    data, seen = photographed(draw(number, 7416, 20), PAPERS["marker"], np.random.default_rng([7412, number]))
    assert differences(seen, recognize(load_sketch(data)).scene) == []


@pytest.mark.parametrize("name", ["ruled darkly", "squared darkly", "coffee", "on a table, with fingers"])
def test_ink_is_all_that_is_seen(name: str) -> None:
    """The mask covers the strokes, and nothing is far from them."""
    number, drawn = drawing(name)
    data, seen = photographed(drawn, PAPERS[name], np.random.default_rng([number, 1]))
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    mask, *_ = ink_mask(read_page(picture), 4)
    true = np.zeros_like(mask)
    for stroke in seen.strokes:
        cv2.polylines(true, [np.round(stroke).astype(np.int32)], False, 1, 1)
    near = np.ones((9, 9), np.uint8)
    missed = true & (cv2.dilate(mask, near) == 0)
    false = mask & (cv2.dilate(true, near) == 0)
    assert np.count_nonzero(missed) < 0.005 * np.count_nonzero(true)
    assert np.count_nonzero(false) < 0.02 * np.count_nonzero(mask)


def test_lines_of_a_drawing_are_no_ruling() -> None:
    """Four long bars, evenly spaced, are fewer than ruling has; a ladder's are shorter."""
    picture = np.full((700, 900, 3), 240, np.uint8)
    for y in (150, 250, 350, 450):
        cv2.line(picture, (40, y), (860, y), (40, 40, 40), 3, cv2.LINE_AA)
    for y in range(480, 680, 20):
        cv2.line(picture, (400, y), (480, y), (40, 40, 40), 3, cv2.LINE_AA)
    mask, *_ = ink_mask(read_page(picture), 4)
    assert np.count_nonzero(mask[[150, 250, 350, 450], 450]) == 4
    assert np.count_nonzero(mask[480:680:20, 440]) == 10
