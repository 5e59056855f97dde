"""Drawings of other programs, in small files that are the tests' own."""

from __future__ import annotations

import json
import math

import pytest

from sim.scene import InputError
from sketch import load_sketch, recognize


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
    assert "left out: 1 elements of type text" in recognition.scene.notes
    slope = next(b for b in recognition.scene.bodies if type(b.shape).__name__ == "Rectangle")
    assert math.remainder(slope.angle + 0.2, math.pi) == pytest.approx(0, abs=0.02)


@pytest.mark.parametrize(
    ("data", "path"),
    [
        (b'{"type": "excalidraw", "elements": 3}', "elements"),
        (excalidraw({"type": "line", "points": 3}), "elements[0]"),
        (excalidraw({"type": "text"}), "strokes"),
    ],
)
def test_bad_excalidraw(data: bytes, path: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(data)
    assert e.value.path == path
