"""What is dark beside a bright sheet: the sheet itself in a deep shadow, or the table."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from sheets import HEIGHT, WIDTH, assert_all, drawn, encoded, ink, lit

from sketch.scan import read_picture

DOWN, ACROSS = np.mgrid[0:HEIGHT, 0:WIDTH] / [[[HEIGHT]], [[WIDTH]]]
DEEP = 0.35  # of the light
LAMP = 0.6 + 0.4 * ACROSS  # light from one side


def test_a_drawing_wholly_within_a_deep_shadow_is_read() -> None:
    """No line leads into it: nobody draws on the table, so what is drawn there tells that it is paper."""
    light = np.where(DOWN + 0.05 * ACROSS < 0.34, 1.0, DEEP)
    assert_all(read_picture(encoded(lit(drawn(ink(), noise=3), light * LAMP))), 2.0)


def test_a_pen_on_a_grey_table_is_not_drawn() -> None:
    """A table may be as white as paper in a shadow; one thing lies on it, and leads nowhere."""
    high = HEIGHT // 2
    sheet, table = (drawn(shown, noise=3) for shown in (ink(), np.zeros((high, WIDTH))))
    picture = np.concatenate([lit(table, DEEP * LAMP[:high]), lit(sheet, LAMP)])
    cv2.line(picture, (200, 90), (420, 140), (10, 10, 10), 6, cv2.LINE_AA)
    sketch = read_picture(encoded(picture))
    for stroke in sketch.strokes:
        stroke.points[:, 1] -= high
    assert_all(sketch)


@pytest.mark.parametrize("off", [4, 7, 10])
def test_a_line_along_the_edge_of_a_shadow_is_read(off: int) -> None:
    """Of light that is known to some pixels only, the line would be hidden by what is less of it beside."""
    beside = ACROSS * WIDTH - 330 - off + 10 * (DOWN * HEIGHT - 220) / 160  # of the box's right side
    edge = 1 / (1 + np.exp(-np.clip(beside, -40, 40) / 1.5))
    picture = lit(drawn(ink(pen=3), pen=(165, 165, 165), noise=2), (1 - 0.45 * edge) * LAMP)
    large = cv2.resize(picture, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
    sketch = read_picture(encoded(large))
    for stroke in sketch.strokes:
        stroke.points[:] = (stroke.points + 0.5) / 2 - 0.5
    assert_all(sketch, 2.0)
