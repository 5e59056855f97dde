"""What a pen leaves out: gaps in lines that go on beyond them, and lines that end where they were meant to."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from sheets import assert_all, drawn, encoded, ink

from sketch.scan import read_picture
from sketch.scan.binding import ends, thin, trace
from sketch.scan.paper.broken import join_skips

PEN = 4


def lines(gaps: int, wide: int, aside: int) -> NDArray[np.uint8]:
    """A level line with some gaps, each so wide between the ink, beyond which it goes on so far below."""
    mask = np.zeros((200, 600), np.uint8)
    x, y = 40, 60
    for _ in range(gaps + 1):
        cv2.line(mask, (x, y), (x + 60, y), 1, PEN)
        x, y = x + 60 + wide + PEN, y + aside
    return mask


def joined(mask: NDArray[np.uint8]) -> bool:
    return join_skips(mask, trace(*thin(mask)), float(PEN))


@pytest.mark.parametrize("wide", [2, 5, 9])
@pytest.mark.parametrize("aside", [0, 1])
def test_a_line_that_a_pen_skipped_in_is_whole(wide: int, aside: int) -> None:
    mask = lines(5, wide, aside)
    assert joined(mask)
    assert ends(thin(mask)[0]) == 2


@pytest.mark.parametrize(
    ("gaps", "wide", "aside"),
    [(1, 5, 0), (3, 5, 0), (5, 30, 0), (5, 5, 6)],
    ids=["one", "few", "far", "aside"],
)
def test_lines_that_end_are_left_as_they_are(gaps: int, wide: int, aside: int) -> None:
    mask = lines(gaps, wide, aside)
    before = mask.copy()
    assert not joined(mask)
    assert np.array_equal(mask, before)


def test_a_hole_beside_one_that_the_pictures_edge_cuts_is_not_drawn() -> None:
    """The sheet is turned a little, so that one hole of two is seen whole."""
    picture = drawn(ink(), noise=3)
    for x, y in ((6, 400), (15, 160)):
        cv2.circle(picture, (x, y), 10, (60, 75, 95), cv2.FILLED, cv2.LINE_AA)
    assert_all(read_picture(encoded(picture)))
