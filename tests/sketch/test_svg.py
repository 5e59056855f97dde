"""SVG drawings: every shape and transform of the format as strokes, what is no ink, and files that are wrong."""

from __future__ import annotations

import math
import sys
import time

import numpy as np
import pytest

from sim.scene import InputError
from sketch import load_sketch, recognize
from sketch.formats import kind_of

pytest.importorskip("svgelements")

TENFOLD = '<g id="g{1}">' + '<use href="#g{0}"/>' * 10 + "</g>"
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<!-- an <ink> of its own -->\n'


def svg(content: str, attributes: str = 'width="640" height="480"') -> bytes:
    return f'{HEAD}<svg xmlns="http://www.w3.org/2000/svg" {attributes}>\n{content}\n</svg>'.encode()


def ink(content: str, attributes: str = 'width="640" height="480"') -> list[np.ndarray]:
    group = f'<g fill="none" stroke="black">{content}</g>'
    return [stroke.points for stroke in load_sketch(svg(group, attributes)).strokes]


@pytest.mark.parametrize(
    ("content", "corners"),
    [
        ('<line x1="10" y1="20" x2="110" y2="20"/>', [[10, 20], [110, 20]]),
        ('<polyline points="0,0 50,25 50-30"/>', [[0, 0], [50, 25], [50, -30]]),
        ('<polygon points="0 0, 60 0, 60 40"/>', [[0, 0], [60, 0], [60, 40], [0, 0]]),
        ('<rect x="5" y="6" width="70" height="8"/>', [[5, 6], [75, 6], [75, 14], [5, 14], [5, 6]]),
        ('<path d="M10 10h20v30l-20-30z"/>', [[10, 10], [30, 10], [30, 40], [10, 10]]),
        (
            '<g transform="translate(100 50)"><g transform="rotate(90)"><line x2="20"/></g></g>',
            [[100, 50], [100, 70]],
        ),
        ('<line x2="10" y2="0" transform="matrix(2 0 0 3 1 1)"/>', [[1, 1], [21, 1]]),
        ('<line x2="1in" y2="25.4mm"/>', [[0, 0], [96, 96]]),
        ('<defs><path id="p" d="M0 0 5 0"/></defs><use href="#p" x="7" y="8"/>', [[7, 8], [12, 8]]),
    ],
)
def test_straight_lines_are_their_corners(content: str, corners: list[list[float]]) -> None:
    (stroke,) = ink(content)
    np.testing.assert_allclose(stroke, corners, atol=1e-3)


@pytest.mark.parametrize(
    "content",
    [
        '<circle cx="200" cy="100" r="50"/>',
        '<ellipse cx="100" cy="100" rx="25" ry="50" transform="matrix(2 0 0 1 0 0)"/>',
        '<path d="M150 100A50 50 0 0 1 250 100A50 50 0 0 1 150 100"/>',
    ],
)
def test_round_shapes_are_points_on_them(content: str) -> None:
    (stroke,) = ink(content)
    np.testing.assert_allclose(np.hypot(*(stroke - (200, 100)).T), 50, atol=1e-3)
    gaps = np.hypot(*np.diff(stroke, axis=0).T)
    assert gaps.max() < 6
    assert gaps.sum() == pytest.approx(100 * math.pi, rel=1e-2)


def test_bezier_curves_pass_where_they_should() -> None:
    """B(1/2) = (P0 + 3 P1 + 3 P2 + P3) / 8 of a cubic, (P0 + 2 P1 + P2) / 4 of a quadratic."""
    cubic, quadratic = ink('<path d="M0 0C0 80 80 80 80 0M100 0Q140 80 180 0"/>')
    for stroke, middle in ((cubic, (40, 60)), (quadratic, (140, 40))):
        assert np.hypot(*(stroke - middle).T).min() < 2


def test_the_page_has_the_files_size_and_units() -> None:
    attributes = 'width="50mm" height="25mm" viewBox="0 0 100 50"'
    sketch = load_sketch(svg('<path d="M0 0 100 50" stroke="red"/>', attributes))
    assert sketch.width == pytest.approx(50 / 25.4 * 96, rel=1e-4)
    np.testing.assert_allclose(sketch.strokes[0].points[-1], (sketch.width, sketch.height), rtol=1e-4)


@pytest.mark.parametrize(
    "attributes",
    [
        'viewBox="0 0 400 300"',
        'width="100%" height="100%" viewBox="0,0,400,300"',
        'width="400px" height="300"',
    ],
)
def test_the_page_is_known_from_the_view_box_or_the_size(attributes: str) -> None:
    paper = '<rect width="100%" height="100%" fill="white"/>'
    sketch = load_sketch(svg(paper + '<line x2="50%" y2="50%" stroke="red"/>', attributes))
    assert (sketch.width, sketch.height) == pytest.approx((400, 300))
    assert [s.points.tolist() for s in sketch.strokes] == [[[0, 0], [200, 150]]]


def test_what_is_not_seen_is_not_read_and_what_is_no_line_is_noted() -> None:
    content = """
      <defs><clipPath id="c"><rect width="9" height="9"/></clipPath></defs>
      <rect width="100%" height="100%" fill="#fff"/>
      <g display="none"><circle r="9" stroke="black"/></g>
      <circle r="9" stroke="black" visibility="hidden"/>
      <circle r="9" fill="none"/>
      <symbol id="s"><circle r="9" stroke="black"/></symbol><mask><circle r="9" stroke="black"/></mask>
      <text>a word</text><image href="a.png" width="5" height="5"/>
      <path d="M20 20h50v50" fill="blue"/>"""
    sketch = load_sketch(svg(content))
    assert [s.points.tolist() for s in sketch.strokes] == [[[20, 20], [70, 20], [70, 70], [20, 20]]]
    assert sketch.notes == ["left out: 1 x image", "left out: 1 x text"]


def test_a_machine() -> None:
    content = """<g fill="none" stroke="black"><rect x="50" y="400" width="500" height="40" rx="3"/>
      <path d="M280 405l30 30m0-30l-30 30"/><circle cx="100" cy="100" r="40"/>
      <line x1="600" y1="50" x2="600" y2="200" marker-end="url(#head)"/></g>
      <marker id="head"><path d="M0 0 10 5 0 10z"/></marker>"""
    recognition = recognize(load_sketch(svg(content)))
    assert [r.kind for r in recognition.readings] == ["rectangle", "anchor", "circle", "gravity"]
    assert recognition.scene.gravity == pytest.approx((0, -9.81), abs=0.05)


@pytest.mark.parametrize(
    ("data", "path", "problem"),
    [
        (svg('<path d="M0 0L10 5 xx"/>'), "line 4: <path>", "d cannot be read from 'xx' on"),
        (svg('<path d="M0 0L10z"/>'), "line 4: <path>", "d has 1 numbers after L, which takes them by 2"),
        (svg('<path d="L0 0"/>'), "line 4: <path>", "d cannot be read from 'L0 0' on"),
        (svg('<g>\n<circle r="wide"/></g>'), "line 5: <circle>", "r is not a length: 'wide'"),
        (svg('<polygon points="0,0 a,b"/>'), "line 4: <polygon>", "points cannot be read from 'a,b' on"),
        (
            svg(f'<path d="M0 0{"l1 1" * 600_000}"/>'),
            "",
            "2400004 characters of paths; at most 2000000 are taken",
        ),
        (svg("<g>"), "line 5 column 3", "not XML: mismatched tag"),
        (svg("<text>hello</text>"), "", "nothing is drawn in this SVG file"),
        (svg('<line x2="1e300" stroke="red"/>'), "strokes[0][1]", "x is beyond 1e+07 pixels"),
        (
            b'<!DOCTYPE svg [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n<svg>&b;</svg>',
            "line 1",
            "the entity 'a' is not taken",
        ),
        (b"<html><svg/></html>", "line 1 column 1", "not JSON, SVG or InkML, and no picture either"),
        (b"<svg" + b"><g" * 300, "line 1", "elements nested too deeply"),
        (
            svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'),
            "line 4: <g>",
            "it is used in itself",
        ),
        (
            svg('<path id="g0" d="M0 0 9 9"/>' + "".join(TENFOLD.format(k, k + 1) for k in range(9))),
            "line 4: <g>",
            "more than 20000 elements are used",
        ),
    ],
)
def test_bad_files_name_the_place(data: bytes, path: str, problem: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(data)
    assert (e.value.path, e.value.problem) == (path, problem)


def test_an_entity_bomb_takes_no_time() -> None:
    levels = "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(12))
    bomb = f'<!DOCTYPE svg [<!ENTITY e0 "lol">{levels}]><svg>&e12;</svg>'.encode()
    began = time.process_time()
    with pytest.raises(InputError, match="entity"):
        load_sketch(bomb)
    assert time.process_time() - began < 1


def test_without_the_extra_the_error_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "svgelements", None)
    with pytest.raises(InputError) as e:
        load_sketch(svg('<circle r="9"/>'))
    assert e.value.problem == "SVG drawings need the package svgelements"
    assert e.value.hint == "pip install svgelements"


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"<svg/>", "svg"),
        (b"\xef\xbb\xbf \n<svg:svg xmlns:svg='x'/>", "svg"),
        (b'<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "a.dtd">\n<svg>', "svg"),
        (b"<?xml version='1.0'?><!-- <svg> --><ink/>", "inkml"),
        ("<?xml version='1.0' encoding='UTF-16'?><ink/>".encode("utf-16"), "inkml"),
        (b"<html><svg/>", "unknown"),
        (b"<", "unknown"),
        (b"<!DOCTYPE" + b"[]" * 2000 + b"<svg>", "unknown"),
        (b"<!DOCTYPE svg [<!ELEMENT a (b)> <!-- <ink> -->]> <svg>", "svg"),
    ],
)
def test_told_by_content(data: bytes, kind: str) -> None:
    began = time.process_time()
    assert kind_of(data) == kind
    assert time.process_time() - began < 1
