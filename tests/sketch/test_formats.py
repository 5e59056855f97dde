"""Stroke JSON in its layouts, told by content; and input that is wrong, named by its place."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.scene import InputError
from sketch import load_sketch
from sketch.formats import kind_of

SQUARE = [[0, 0], [100, 0], [100, 100], [0, 100], [0, 0]]


def load(d: Any) -> Any:
    return load_sketch(json.dumps(d).encode())


def test_minimal() -> None:
    sketch = load({"strokes": [{"points": SQUARE}]})
    assert len(sketch.strokes) == 1
    np.testing.assert_array_equal(sketch.strokes[0].points, SQUARE)
    assert sketch.strokes[0].times is None
    assert sketch.width is sketch.height is sketch.pixels_per_metre is None


@pytest.mark.parametrize(
    "stroke",
    [
        {"points": SQUARE},
        SQUARE,
        {"x": [p[0] for p in SQUARE], "y": [p[1] for p in SQUARE]},
        {"points": [[*p, 7 * k] for k, p in enumerate(SQUARE)]},
        {"x": [p[0] for p in SQUARE], "y": [p[1] for p in SQUARE], "t": [0, 1, 2, 3, 4]},
        {"points": [[*p, 5, 0.4, "pen"][: 2 + k] if k < 2 else [*p] for k, p in enumerate(SQUARE)]},
        {"points": [[*p, None] for p in SQUARE], "color": "red", "id": {"a": [1]}},
    ],
)
def test_layouts(stroke: Any) -> None:
    sketch = load({"width": 640, "height": 480, "pixels_per_metre": 50, "strokes": [stroke], "app": {"x": 1}})
    np.testing.assert_array_equal(sketch.strokes[0].points, SQUARE)
    assert (sketch.width, sketch.height, sketch.pixels_per_metre) == (640, 480, 50)


def test_times_are_kept_where_every_point_has_one() -> None:
    sketch = load({"strokes": [{"points": [[0, 0, 30], [1, 1, 10], [2, 0, 10]]}]})
    assert sketch.strokes[0].times is not None
    np.testing.assert_array_equal(sketch.strokes[0].times, [30, 10, 10])


def test_pages_and_stages_are_those_of_pictures() -> None:
    data = json.dumps({"strokes": [SQUARE]}).encode()
    for options in ({"page": 2}, {"index": 1}, {"stages": "seen"}):
        with pytest.raises(InputError, match=r"there (is|are) no"):
            load_sketch(data, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", "empty"),
        ('{"strokes": []}', "empty"),
        ('{"strokes": [', "format"),
        ("a drawing", "format"),
        ('{"format": "sketchsim-strokes", "version": 2, "strokes": []}', "format"),
        ('{"strokes": [[[0, 0], [1, NaN]]]}', "value"),
        ('{"strokes": [' + "[[0, 0], [1, 1]]," * 20_000 + "[]]}", "size"),
    ],
)
def test_errors_have_a_kind(text: str, kind: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(text.encode())
    assert e.value.kind == kind


def test_file_and_bytes_are_the_same(tmp_path: Path) -> None:
    path = tmp_path / "no-ending"
    path.write_bytes(json.dumps({"strokes": [SQUARE]}).encode())
    np.testing.assert_array_equal(load_sketch(path).strokes[0].points, SQUARE)


@pytest.mark.parametrize(
    ("text", "path", "problem"),
    [
        ("", "", "empty"),
        ("  \n", "", "empty"),
        ("a drawing", "line 1 column 1", "not JSON"),
        ('{"strokes": [', "line 1 column 14", "not JSON"),
        ('{"lines": []}', "strokes", "missing"),
        ('{"strokes": {}}', "strokes", "not a list"),
        ('{"strokes": []}', "strokes", "no strokes"),
        ('{"strokes": [7]}', "strokes[0]", "not a stroke"),
        ('{"strokes": [{"pts": []}]}', "strokes[0].points", "missing"),
        ('{"strokes": [{"points": 3}]}', "strokes[0].points", "not a list"),
        ('{"strokes": [{"points": []}]}', "strokes[0].points", "no points"),
        ('{"strokes": [{"points": [[1, 2]]}]}', "strokes[0].points", "only one point"),
        ('{"strokes": [{"points": [[1, 2], [1, 2]]}]}', "strokes[0].points", "at one place"),
        ('{"strokes": [[[0,0],[1,1]], [[0,0],[1,NaN]]]}', "strokes[1][1]", "y is not a finite number"),
        ('{"strokes": [{"points": [[0,0],[Infinity,1]]}]}', "strokes[0].points[1]", "x is not a finite number"),
        ('{"strokes": [{"points": [[0,0],["1",1]]}]}', "strokes[0].points[1]", "x is not a number"),
        ('{"strokes": [{"points": [[0,0],[true,1]]}]}', "strokes[0].points[1]", "x is not a number"),
        ('{"strokes": [{"points": [[0,0],[1]]}]}', "strokes[0].points[1]", "not a point"),
        ('{"strokes": [{"points": [[0,0],{"x":1}]}]}', "strokes[0].points[1]", "not a point"),
        ('{"strokes": [{"points": [[0,0],[1e300,1]]}]}', "strokes[0].points[1]", "beyond"),
        ('{"strokes": [{"x": [0, 1]}]}', "strokes[0].y", "missing"),
        ('{"strokes": [{"x": [0, 1], "y": [0]}]}', "strokes[0]", "2 values of x but 1 of y"),
        ('{"strokes": [{"x": [0, null], "y": [0, 1]}]}', "strokes[0].x[1]", "x is not a number"),
        ('{"strokes": [[[0,0],[1,1]]], "width": -5}', "width", "not greater than 0"),
        ('{"strokes": [[[0,0],[1,1]]], "pixels_per_metre": "9"}', "pixels_per_metre", "not a number"),
        ('{"strokes": [[[0,0],[1,1]]], "height": NaN}', "height", "not a finite number"),
        ('{"format": "other", "strokes": [[[0,0],[1,1]]]}', "format", "is not 'sketchsim-strokes'"),
        ('{"version": 2, "strokes": [[[0,0],[1,1]]]}', "version", "is not 1"),
        ('{"bodies": []}', "", "this is a scene"),
        ("[" * 100_000, "", "nested"),
    ],
)  # fmt: skip
def test_bad_input_is_named(text: str, path: str, problem: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(text.encode())
    assert e.value.path == path
    assert problem in e.value.problem
    assert "\n" not in str(e.value)


@pytest.mark.parametrize("point", ["[0,0],", "[0.123,4.567],", "0,"])
def test_ten_million_points_are_refused_at_once(point: str) -> None:
    data = b'{"strokes":[[' + point.encode() * 10_000_000
    start = time.process_time()
    with pytest.raises(InputError, match=r"at most|more than"):
        load_sketch(data)
    assert time.process_time() - start < 1


def test_a_dot_among_strokes_is_no_error() -> None:
    sketch = load({"strokes": [SQUARE, [[5, 5]], []]})
    assert [len(s.points) for s in sketch.strokes] == [5, 1, 0]


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b'{"strokes": []}', "strokes"),
        (b"[[[0, 0], [1, 1]]]", "strokes"),
        (b'\xef\xbb\xbf {"bodies": []}', "scene"),
        (b'{"format": "sketchsim-scene"}', "scene"),
        (b'{"bodies": [{"strokes": [1]}]}', "scene"),
        (b'{"strokes": [], "bodies": 3}', "strokes"),
        (b"\x89PNG\r\n\x1a\n....", "picture"),
        (b"\xff\xd8\xff\xe0....", "picture"),
        (b"RIFF....WEBPVP8 ", "picture"),
        (b"hello", "unknown"),
        (b"", "unknown"),
    ],
)
def test_kinds_are_told_by_content(data: bytes, kind: str) -> None:
    assert kind_of(data) == kind
