"""Ink that a program makes itself: what is taken, and what is told of what is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sim.scene import InputError
from sketch import Recognizer, Sketch, Stroke, recognize


def test_points_may_be_any_numbers_in_rows() -> None:
    rows = [[0, 0], [30, 0], [60, 5]]
    for points in (rows, np.array(rows), np.array(rows, np.float32)):
        stroke = Stroke(points)  # type: ignore[arg-type]
        assert stroke.points.dtype == np.float64
        assert stroke.points.tolist() == rows
    assert not Stroke(np.array([])).has_length


@pytest.mark.parametrize(
    ("points", "path"),
    [
        ([1.0, 2.0], "points"),
        ([[1, 2, 3]], "points"),
        ([[1, 2], [3]], "points"),
        ([["a", "b"]], "points"),
        ([[0, 0], [1, np.nan]], "points[1]"),
        ([[0, 0], [1, 0], [np.inf, 0]], "points[2]"),
    ],
)
def test_points_that_are_none_are_told(points: Any, path: str) -> None:
    with pytest.raises(InputError) as e:
        Stroke(points)
    assert e.value.path == path


@pytest.mark.parametrize("name", ["width", "height", "pixels_per_metre"])
@pytest.mark.parametrize("value", [0, -1.0, np.nan])
def test_a_size_is_greater_than_nothing(name: str, value: float) -> None:
    with pytest.raises(InputError, match="greater than 0") as e:
        Sketch([], **{name: value})
    assert e.value.path == name


def test_what_is_no_sketch_is_told_so() -> None:
    with pytest.raises(TypeError, match="load_sketch"):
        recognize("cart.json")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="not the number of a stroke"):
        recognize(Sketch([Stroke(np.array([[0, 0], [9, 9]]))]), overrides={"0": "bar"})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="no stroke 7"):
        Recognizer(Sketch([])).remove(7)
