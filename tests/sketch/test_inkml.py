"""InkML as its specification writes it: explicit values and differences, channels, contexts, groups; errors."""

from __future__ import annotations

import numpy as np
import pytest

from sim.scene import InputError
from sketch import load_sketch, recognize


def inkml(content: str) -> bytes:
    return f'<ink xmlns="http://www.w3.org/2003/InkML">\n{content}\n</ink>'.encode()


def points(content: str) -> list[list[list[float]]]:
    return [s.points.tolist() for s in load_sketch(inkml(content)).strokes]


@pytest.mark.parametrize(
    ("trace", "expected"),
    [
        ("10 0, 9 14, 8 28, 7 42", [[10, 0], [9, 14], [8, 28], [7, 42]]),
        ("10 0,9 14,\n 8 28,", [[10, 0], [9, 14], [8, 28]]),
        ("10.5 -2, 1e1 .5", [[10.5, -2], [10, 0.5]]),
        ("10-5,11-6", [[10, -5], [11, -6]]),
        ("100 50,'3'4,5-6", [[100, 50], [103, 54], [108, 48]]),
        # first differences (2, 3), then second ones: (2 + 1, 3 - 1), (3 + 2, 2 - 2)
        ("""0 0,'2'3,"1"-1,2-2""", [[0, 0], [2, 3], [5, 5], [10, 5]]),
        ("""0 0,'2'3,"1"-1,!7!8,9 9""", [[0, 0], [2, 3], [5, 5], [7, 8], [9, 9]]),
        ("""0 0,'2"0""", None),  # a second difference of a channel without a first one: as if that were 0
        ("5 5,* 6,'1'2,**,* 3", [[5, 5], [5, 6], [6, 8], [7, 10], [8, 13]]),
        ("#A #10, #-1 1", None),
        ("#A #10, -#1 1", [[10, 16], [-1, 1]]),
        ("1 1, ? 2, 3 3", [[1, 1], [3, 3]]),
    ],
)
def test_values_of_points(trace: str, expected: list[list[float]] | None) -> None:
    if expected is None:
        if '"' in trace:
            assert points(f"<trace>{trace}</trace>") == [[[0, 0], [2, 0]]]
            return
        with pytest.raises(InputError):
            points(f"<trace>{trace}</trace>")
        return
    assert points(f"<trace>{trace}</trace>") == [expected]


def test_channels_give_the_order_and_intermittent_ones_may_be_missing() -> None:
    content = """<definitions><context id="pen"><inkSource><traceFormat>
      <channel name="T" type="integer" units="s"/><channel name="Y" type="decimal"/>
      <channel name="X" type="decimal"/><channel name="F" type="integer"/>
      <intermittentChannels><channel name="B" type="boolean"/></intermittentChannels>
    </traceFormat></inkSource></context></definitions>
    <trace contextRef="#pen">0 20 10 99 T, 1 21 11 98, 2 22 12 97 F</trace>"""
    (stroke,) = load_sketch(inkml(content)).strokes
    assert stroke.points.tolist() == [[10, 20], [11, 21], [12, 22]]
    assert stroke.times is not None
    assert stroke.times.tolist() == [0, 1000, 2000]


def test_a_context_holds_for_what_follows_and_a_group_for_what_is_in_it() -> None:
    swapped = '<traceFormat><channel name="Y"/><channel name="X"/></traceFormat>'
    up = '<traceFormat><channel name="X"/><channel name="Y" orientation="-ve"/></traceFormat>'
    content = f"""<definitions><context xml:id="up">{up}</context></definitions>
      <trace>1 2,3 4</trace>
      <context>{swapped}</context><trace>1 2,3 4</trace>
      <traceGroup contextRef="#up"><trace>1 2,3 4</trace><traceGroup><trace>5 6,7 8</trace></traceGroup></traceGroup>
      <trace>1 2,3 4</trace>"""
    assert points(content) == [
        [[1, 2], [3, 4]],
        [[2, 1], [4, 3]],
        [[1, -2], [3, -4]],
        [[5, -6], [7, -8]],
        [[2, 1], [4, 3]],
    ]


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (("100", "1/mm"), ("500", "1/cm")),
        (("2540", "1/in"), ("500", "1/cm")),
        (("1", "1/pt"), ("36", "1/in")),
        (("1000", "1/m"), ("0.5", "1/mm")),
    ],
)
def test_channels_of_different_resolution_have_one_scale(x: tuple[str, str], y: tuple[str, str]) -> None:
    """X has twice the resolution of Y."""
    properties = "".join(
        f'<channelProperty channel="{name}" name="resolution" value="{value}" units="{units}"/>'
        for name, (value, units) in (("X", x), ("Y", y))
    )
    content = f"""<context id="pen"><inkSource>
      <traceFormat><channel name="X"/><channel name="Y"/></traceFormat>
      <channelProperties>{properties}</channelProperties>
      </inkSource></context><trace>0 0,10 10</trace>"""
    ((begin, end),) = points(content)
    assert (begin, end) == ([0, 0], pytest.approx([10, 20]))


def test_traces_go_on_and_lifted_pens_leave_no_ink() -> None:
    content = """<trace id="a" continuation="begin">0 0,1 1</trace><trace type="penUp">1 1,9 9</trace>
      <trace id="b" continuation="middle" priorRef="#a">2 2</trace><trace>50 50,60 60</trace>
      <trace continuation="end" priorRef="#b">3 3,4 4</trace>"""
    assert points(content) == [[[0, 0], [1, 1], [2, 2], [3, 3], [4, 4]], [[50, 50], [60, 60]]]


def test_a_drawing() -> None:
    turns = np.linspace(0, 2 * np.pi, 50)
    ball = ",".join(f"{300 + 60 * np.cos(t):.1f} {200 + 60 * np.sin(t):.1f}" for t in turns)
    box = "100 400,700 400,700 450,100 450,100 400"
    sketch = load_sketch(inkml(f"<trace>{ball}</trace><trace>{box}</trace>"))
    assert [r.kind for r in recognize(sketch).readings] == ["circle", "rectangle"]


@pytest.mark.parametrize(
    ("content", "path", "problem"),
    [
        ("<trace>1 2, 3</trace>", "line 2: <trace> point 1", "1 values of 2 channels"),
        ("<trace>1 2 3</trace>", "line 2: <trace> point 0", "more values than its 2 channels"),
        ("<trace>1 2,,3 4</trace>", "line 2: <trace> point 1", "there is none between two commas"),
        ("<trace>1 2,3 four</trace>", "line 2: <trace> point 1", "'four' is no value"),
        (
            "<trace>'1 '2</trace>",
            "line 2: <trace> point 0",
            "a trace begins with explicit values, not with differences",
        ),
        (
            '<trace contextRef="#no">1 2</trace>',
            "line 2: <trace>",
            "contextRef: there is no '#no' in this file",
        ),
        (
            '<trace continuation="end" priorRef="#z">1 2</trace>',
            "line 2: <trace>",
            "there is no trace 'z' before it",
        ),
        (
            '<context><traceFormat><channel name="X"/></traceFormat></context>',
            "line 2: <traceFormat>",
            "there is no channel X, or none Y",
        ),
        (
            '<context id="a" contextRef="#b"/><context id="b" contextRef="#a"/>',
            "line 2: <context>",
            "contexts refer to each other in a circle",
        ),
        (
            "<trace>1 2,1 2</trace>",
            "strokes[0].points",
            "2 points at one place: a stroke goes from one place to another",
        ),
        ("<trace>1 2,9e99 2</trace>", "strokes[0][1]", "x is beyond 1e+07 pixels"),
        ("", "", "there are no traces: nothing was drawn"),
        ("<trace>", "line 3 column 3", "not XML: mismatched tag"),
    ],
)
def test_bad_files_name_the_place(content: str, path: str, problem: str) -> None:
    with pytest.raises(InputError) as e:
        load_sketch(inkml(content))
    assert (e.value.path, e.value.problem) == (path, problem)
