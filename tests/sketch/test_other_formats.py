"""Drawings of other programs, in small files that are the tests' own."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from sim.scene import InputError
from sketch import load_sketch, recognize
from sketch.formats import arrowheads

Point = tuple[float, float]


def quickdraw(*drawings: list[list[list[float]]]) -> bytes:
    return b"\n".join(json.dumps({"word": "box", "drawing": d}).encode() for d in drawings)


def test_quickdraw() -> None:
    box = [[[0, 200, 200], [0, 0, 100], [0, 90, 160]], [[200, 0, 0], [100, 100, 0], [300, 380, 440]]]
    sketch = load_sketch(quickdraw(box))
    assert [s.points.tolist() for s in sketch.strokes] == [
        [[0, 0], [200, 0], [200, 100]],
        [[200, 100], [0, 100], [0, 0]],
    ]
    assert [r.kind for r in recognize(sketch).readings] == ["rectangle"]
    assert load_sketch(quickdraw(box, box)).notes == ["the first of 2 drawings was read"]


def test_quickdraw_has_the_drawing_that_is_asked_for() -> None:
    """Raw drawings have times in a third column, simplified ones none; both are counted from 0."""
    raw, simple = [[[5.5, 60], [5, 5], [0, 8]]], [[[7, 70], [7, 7]]]
    data = quickdraw(raw, simple)
    first, second = (load_sketch(data, index=k) for k in (0, 1))
    assert first.strokes[0].points.tolist() == [[5.5, 5], [60, 5]]
    assert first.strokes[0].times is not None
    assert second.strokes[0].points.tolist() == [[7, 7], [70, 7]]
    assert second.notes == []
    with pytest.raises(InputError) as e:
        load_sketch(data, index=2)
    assert (str(e.value), e.value.hint) == ("there is no drawing 2", "drawings are 0 to 1")
    with pytest.raises(InputError, match="line 2 column"):
        load_sketch(quickdraw(raw) + b'\n{"drawing": [', index=1)


@pytest.mark.parametrize(
    ("data", "path"),
    [
        (b'{"drawing": 5}', "drawing"),
        (b'{"drawing": [[1]]}', "drawing[0]"),
        (b'{"drawing": [[[0, 1], [0]]]}', "strokes[0]"),
        (b'{"drawing": []}', "strokes"),
    ],
)
def test_bad_quickdraw(data: bytes, path: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(data)
    assert e.value.path == path


def excalidraw(*elements: dict[str, object]) -> bytes:
    return json.dumps({"type": "excalidraw", "version": 2, "elements": list(elements)}).encode()


def test_excalidraw() -> None:
    data = excalidraw(
        {"type": "rectangle", "x": 100, "y": 400, "width": 400, "height": 60, "angle": 0.2},
        {"type": "ellipse", "x": 200, "y": 100, "width": 90, "height": 90},
        {"type": "diamond", "x": 400, "y": 100, "width": 120, "height": 90},
        {"type": "arrow", "x": 800, "y": 100, "points": [[0, 0], [0, 150]]},
        {"type": "freedraw", "x": 600, "y": 300, "points": [[0, 0], [70, 120], [-70, 120], [0, 2]]},
        {"type": "text", "x": 0, "y": 0, "text": "hello"},
        {"type": "line", "x": 0, "y": 0, "points": [[0, 0], [5, 5]], "isDeleted": True},
    )
    sketch = load_sketch(data)
    recognition = recognize(sketch)
    kinds = [r.kind for r in recognition.readings if r.kind != "gravity"]
    assert sorted(kinds) == ["circle", "polygon", "polygon", "rectangle"]
    assert recognition.scene.gravity == pytest.approx((0, -9.81), abs=0.2)
    assert "left out: 1 x text" in recognition.scene.notes
    slope = next(b for b in recognition.scene.bodies if type(b.shape).__name__ == "Rectangle")
    assert math.remainder(slope.angle + 0.2, math.pi) == pytest.approx(0, abs=0.02)


def points(*elements: dict[str, object]) -> list[np.ndarray]:
    return [stroke.points for stroke in load_sketch(excalidraw(*elements)).strokes]


def test_lines_of_excalidraw_turn_about_the_middle_of_what_is_drawn() -> None:
    """Their points count from the first one, wherever in the box that is."""
    line = {"type": "line", "x": 100, "y": 100, "points": [[0, 0], [-40, 0], [-40, -20]], "angle": math.pi}
    (turned,) = points(line)
    np.testing.assert_allclose(turned, [[60, 80], [100, 80], [100, 100]], atol=1e-9)


def test_rounded_lines_of_excalidraw_are_curves_through_their_points() -> None:
    through = [[0, 0], [50, 80], [100, 0], [150, -80]]
    (curve,) = points({"type": "line", "points": through, "roundness": {"type": 2}})
    for point in through:
        assert np.hypot(*(curve - point).T).min() < 1e-9
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(curve, axis=0).T)))
    assert np.abs(turns).max() < 0.7  # the points themselves turn by 2


@pytest.mark.parametrize(
    ("heads", "tips"),
    [
        ({}, [[100, 0]]),
        ({"endArrowhead": "triangle"}, [[100, 0]]),
        ({"endArrowhead": None}, []),
        ({"startArrowhead": "arrow", "endArrowhead": "arrow"}, [[0, 0], [100, 0]]),
    ],
)
def test_arrows_of_excalidraw_have_the_heads_that_are_shown(
    heads: dict[str, object], tips: list[list[float]]
) -> None:
    shaft, *barbs = points({"type": "arrow", "points": [[0, 0], [100, 0]], **heads})
    np.testing.assert_allclose(shaft, [[0, 0], [100, 0]])
    assert [barb[1].tolist() for barb in barbs] == tips


@pytest.mark.parametrize("shaft", [((0, 0), (100, 0)), ((10, 20), (70, 100)), ((5, 5), (0, -7))])
def test_a_head_lies_alike_on_both_sides_of_its_shaft(shaft: tuple[Point, Point]) -> None:
    before, tip = (complex(*point) for point in shaft)
    left, middle, right = (complex(*point) for point in arrowheads.head(*shaft))
    assert middle == tip
    turns = [(barb - tip) / (before - tip) for barb in (left, right)]  # from the shaft, and of its length
    assert [abs(turn) for turn in turns] == pytest.approx([min(30 / abs(tip - before), 0.5)] * 2)
    angles = sorted(math.degrees(math.atan2(turn.imag, turn.real)) for turn in turns)
    assert angles == pytest.approx([-25, 25])


def test_a_clipboard_of_excalidraw() -> None:
    data = excalidraw({"type": "line", "points": [[0, 0], [9, 9]]}).replace(
        b'"excalidraw"', b'"excalidraw/clipboard"'
    )
    assert len(load_sketch(data).strokes) == 1


@pytest.mark.parametrize(
    ("data", "path"),
    [
        (b'{"type": "excalidraw", "elements": 3}', "elements"),
        (excalidraw({"type": "line", "points": 3}), "elements[0].points"),
        (excalidraw({"type": "line", "points": [[0, 0], [1, "2"]]}), "elements[0].points[1][1]"),
        (excalidraw({"type": "rectangle", "x": float("nan")}), "elements[0].x"),
        (excalidraw({"type": "text"}), "strokes"),
    ],
)
def test_bad_excalidraw(data: bytes, path: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(data)
    assert e.value.path == path
