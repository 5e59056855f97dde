"""Drawings in every format with a few bytes changed: read, or refused with a reason, and never slowly."""

from __future__ import annotations

import importlib.util
import json
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.scene import InputError
from sketch import load_sketch
from sketch.ink import Sketch

SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">
<g id="a" transform="translate(5,5) rotate(20)" style="fill:none;stroke:#000">
<rect x="1" y="2" width="30" height="20" rx="3"/><circle id="c" cx="60" cy="60" r="18"/>
<path d="M 95,20 c 8,8 10,-3 20 5 a 5 6 0 0 1 10 10 z m 0,-8 -8,8" marker-end="url(#m)"/></g>
<use href="#c" x="30"/><polygon points="1,2 30,4 5,60"/></svg>"""
INKML = b"""<ink xmlns="http://www.w3.org/2003/InkML"><context xml:id="c"><traceFormat><channel name="X"/>
<channel name="Y"/><intermittentChannels><channel name="B"/></intermittentChannels></traceFormat></context>
<traceGroup contextRef="#c"><trace>10 10,'5'0,"1"1,* *,!30!40 T</trace></traceGroup></ink>"""
QUICKDRAW = b'{"word": "a", "drawing": [[[0, 200, 200], [0, 0, 100], [0, 9, 60]], [[200, 0], [100, 0]]]}'
EXCALIDRAW = json.dumps(
    {
        "type": "excalidraw",
        "elements": [
            {"type": "rectangle", "x": 10, "y": 4.5, "width": 40, "height": 60, "angle": 0.2},
            {"type": "arrow", "x": 8, "points": [[0, 0], [0, 50], [9, 9]], "roundness": {"type": 2}},
        ],
    }
).encode()
STROKES = (
    b'{"width": 640, "strokes": [{"points": [[0, 0, 1], [1, 5]]}, [[1, 2], [3, 4]], {"x": [1], "y": [2]}]}'
)

TOKENS = (
    b"1e999 -1 0 NaN null \" ' < > /> e % in # * ! T , [] {} true \xff 1e308 a1,1,0,0,1,5,5 matrix(0,0,0,0,0,0) "
    b'scale(1e9) viewBox="0,0,0,0" width="0" href="#a" <use/> id="c" url(#c) contextRef="#c" '
).split(b" ")

CHANGES = st.lists(
    st.tuples(st.integers(0, 2000), st.integers(0, 6), st.sampled_from(TOKENS)), min_size=1, max_size=4
)


@pytest.mark.parametrize("name", ["SVG", "INKML", "QUICKDRAW", "EXCALIDRAW", "STROKES"])
def test_damage_is_refused_or_harmless(name: str) -> None:
    if name == "SVG" and importlib.util.find_spec("svgelements") is None:
        pytest.skip("svgelements is not installed")
    whole: bytes = globals()[name]
    assert isinstance(load_sketch(whole), Sketch)

    @given(CHANGES)
    @settings(max_examples=150, derandomize=True, deadline=None)
    def check(changes: list[tuple[int, int, bytes]]) -> None:
        data = whole
        for where, length, token in changes:
            at = where % (len(data) + 1)
            data = data[:at] + token + data[at + length :]
        began = time.process_time()
        said = "read"
        try:
            load_sketch(data)
        except InputError as e:
            said = e.problem
        assert said
        assert "\n" not in said
        assert time.process_time() - began < 2

    check()
