"""A page that is read while it is drawn: the same scene as from scratch, at the cost of the neighbourhood."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pages import box, cart, ngon, pendulum, stack

from sim.scene import InputError
from sketch import Recognizer, Sketch, Stroke, recognize
from sketch.page.loose import Chain
from sketch.page.pieces import Page
from sketch.scoring import Fitted
from sketch.shapes.outlines import read_outline
from sketch.shapes.proposals import Proposals
from sketch.synthetic import HANDS, arrow, circle, cross, line, outline, scribble


def ink() -> list[Stroke]:
    """Strokes that mean something with one another and little alone, and some that change the page as a whole."""
    rng = np.random.default_rng(8)
    hand = HANDS["pieces"]
    shapes = [
        outline(box(300, 400, 260, 120), hand, rng),
        outline(ngon(3, 300, 290, 70), hand, rng),
        circle((260, 400), 9, hand, rng),
        circle((380, 460), 40, hand, rng),
        cross((340, 400), 40, hand, rng),
        arrow((560, 120), (565, 250), hand, rng),
        line([(120, 480), (620, 490)], hand, rng),
        outline(box(310, 395, 255, 125), hand, rng),  # the first once more
        outline(box(0, 600, 900, 3), HANDS["neat"], rng),  # as thin as the pen
        scribble((560, 400), 60, rng),
        [np.array([[500.0, 300.0], [502.0, 303.0], [503.0, 301.0]])],  # a dot
        [np.array([[10.0, 20.0]]), np.empty((0, 2))],
        [np.array([[-4000.0, 100.0], [-3990.0, 140.0]])],  # far away: another page
    ]
    return [Stroke(s) for shape in shapes for s in shape]


INK = ink()
MOVES = st.lists(st.integers(0, len(INK) - 1), min_size=1, max_size=24)


@pytest.mark.parametrize("canvas", [(900.0, 640.0), (None, None)])
@settings(max_examples=25, deadline=None, derandomize=True)
@given(first=MOVES, moves=MOVES)
def test_any_way_to_a_page_gives_the_same_scene(
    canvas: tuple[float | None, float | None], first: list[int], moves: list[int]
) -> None:
    """A move adds a stroke, or takes it away where it is there."""
    width, height = canvas
    drawn = dict(enumerate(dict.fromkeys(first)))  # key of the stroke, which of INK
    page = Recognizer(Sketch([INK[i] for i in drawn.values()], width, height))
    for k, i in enumerate(moves):
        there = [key for key, j in drawn.items() if j == i]
        if there:
            page.remove(there[0])
            del drawn[there[0]]
        else:
            drawn[page.add(INK[i])] = i
        if k % 5 == 4:
            page.recognition()
    at_once = recognize(Sketch([INK[i] for i in drawn.values()], width, height))
    one_by_one = page.recognition()
    assert one_by_one.scene.to_dict() == at_once.scene.to_dict()
    for a, b in zip(one_by_one.readings, at_once.readings, strict=True):
        assert (a.kind, a.strokes, a.score, a.alternatives) == (b.kind, b.strokes, b.score, b.alternatives)


def drawings(count: int, hand: str = "pieces") -> list[list[Stroke]]:
    """The strokes of so many machines side by side."""
    out = []
    for k in range(count):
        machine = (cart, pendulum, stack)[k % 3](HANDS[hand], np.random.default_rng([k, 5]))
        place = np.array([1400.0 * (k % 4), 800.0 * (k // 4)])
        out.append([Stroke(s.points + place) for s in machine.strokes])
    return out


@settings(max_examples=10, deadline=None, derandomize=True)
@given(data=st.data())
def test_strokes_come_and_go_on_a_page_of_several_drawings(data: st.DataObject) -> None:
    strokes = [s for machine in drawings(5, data.draw(st.sampled_from(["pieces", "quick"]))) for s in machine]
    page = Recognizer(Sketch(strokes, 5600.0, 1700.0))
    page.recognition()
    drawn = dict(enumerate(strokes))
    for _ in range(data.draw(st.integers(2, 12))):
        if data.draw(st.booleans()):
            key = data.draw(st.sampled_from(sorted(drawn)))
            page.remove(key)
            del drawn[key]
        else:
            again = data.draw(st.sampled_from(strokes)).points + data.draw(
                st.sampled_from([4.0, 60.0, 900.0])
            )
            drawn[page.add(Stroke(again))] = Stroke(again)
        if data.draw(st.booleans()):
            page.recognition()
    at_once = recognize(Sketch(list(drawn.values()), 5600.0, 1700.0))
    one_by_one = page.recognition()
    assert one_by_one.scene.to_dict() == at_once.scene.to_dict()
    assert one_by_one.explain() == at_once.explain()


def test_a_stroke_is_the_same_work_on_a_page_of_any_size() -> None:
    """What is reckoned anew for a stroke more lies around it: on a page of twelve machines it is as much as of four."""
    work = {}
    corners = {0, 3, 8, 11}
    machines = drawings(12)
    for few in (True, False):
        strokes = [s for k, its in enumerate(machines) for s in its if not few or k in corners]
        page = Recognizer(Sketch(strokes, 5600.0, 2600.0))
        page.recognition()
        before = page.made
        page.add(Stroke(machines[11][0].points + 30.0))
        page.recognition()
        work[few] = page.made - before
    assert 0 < work[False] <= work[True]


def test_overrides_count_the_strokes_that_are_there() -> None:
    sketch = pendulum(HANDS["neat"], np.random.default_rng(1))
    page = Recognizer(sketch)
    page.remove(0)
    rest = Sketch(sketch.strokes[1:], sketch.width, sketch.height)
    last = len(rest.strokes) - 1
    forced = {(last,): "ignore"}
    assert (
        page.recognition(overrides=forced).scene.to_dict()
        == recognize(rest, overrides=forced).scene.to_dict()
    )
    assert page.recognition().scene.to_dict() == recognize(rest).scene.to_dict(), "and they are not kept"


def test_a_stroke_that_is_not_there_cannot_be_removed() -> None:
    page = Recognizer(Sketch([]))
    key = page.add(INK[0])
    page.remove(key)
    with pytest.raises(InputError, match="no stroke"):
        page.remove(key)
    assert page.recognition().scene.bodies == []


def test_a_stroke_costs_what_its_neighbourhood_does() -> None:
    """On a page of two hundred strokes a further one takes a small part of what the page takes."""
    rng = np.random.default_rng(0)
    tile = [s.points for m in (cart, pendulum, stack) for s in m(HANDS["pieces"], rng).strokes]
    places = [np.array([1400.0 * (k % 3), 800.0 * (k // 3)]) for k in range(math.ceil(200 / len(tile)))]
    strokes = [Stroke(p + place) for place in places for p in tile]
    begin = time.process_time()
    page = Recognizer(Sketch(strokes[:-12], 4200.0, 3000.0))
    page.recognition()
    whole = time.process_time() - begin
    times = []
    for stroke in strokes[-12:]:
        begin = time.process_time()
        page.add(stroke)
        page.recognition()
        times.append(time.process_time() - begin)
    assert sorted(times)[len(times) // 2] < 0.2 * whole


def test_a_million_points_are_read_as_a_few_are() -> None:
    t = np.linspace(0, 2 * math.pi, 1_000_000)
    ring = Stroke(np.stack([300 + 100 * np.cos(t), 300 + 100 * np.sin(t)], axis=1))
    begin = time.process_time()
    (body,) = recognize(Sketch([ring], 600.0, 600.0)).scene.bodies
    assert time.process_time() - begin < 1
    assert body.shape.radius * 60 == pytest.approx(100, rel=1e-3)


@pytest.mark.parametrize("size", [1e-310, 1e-170, 1e-12])
def test_a_stroke_whose_size_vanishes_is_left_out_and_named(size: float) -> None:
    speck = Stroke(np.array([[0.0, 0.0], [size, size], [0.0, 0.0]]))
    square = Stroke(np.array([[9.0, 9.0], [90.0, 9.0], [90.0, 90.0], [9.0, 90.0], [9.0, 9.0]]))
    for strokes in ([speck], [speck, square]):
        scene = recognize(Sketch(strokes)).scene
        assert len(scene.bodies) == len(strokes) - 1
        assert any("stroke 0" in note for note in scene.notes)


def test_strokes_that_go_the_same_way_are_read_once_and_gain_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A picture's ink may be said by many strokes of one course, of which at most one is true."""
    read = list[int]()

    def counted(page: Page, chain: Chain) -> list[Fitted]:
        read.append(chain[0][0])
        return read_outline(page, chain)

    monkeypatch.setattr("sketch.shapes.proposals.read_outline", counted)
    rings = [
        circle((300.0, 300.0), 80.0, HANDS["neat"], np.random.default_rng(seed))[0] for seed in (1, 1, 2)
    ]
    found = Proposals(800.0, [{1, 2}, {0, 2}, {0, 1}])
    found.add(rings)
    once, again, other = found.all()
    assert read == [0, 2]
    assert once.gains == again.gains != other.gains
    assert {c.pieces for c in once.candidates} == {(0,)}
    assert {c.pieces for c in again.candidates} == {(1,)}
