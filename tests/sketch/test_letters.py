"""Letters by themselves, and arrows that are no gravity: they are said in fewer nats than outlines of their ink."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import box, read
from test_machines import cart, meaning
from test_writing import HAND, word

from sketch.ink import Sketch, Stroke
from sketch.recognize import recognize
from sketch.synthetic import arrow, circle, cross, curve, line, outline


@pytest.mark.parametrize("letter", "ADagkp4")
@pytest.mark.parametrize("height", [18, 30, 44])
def test_a_letter_beside_a_machine_is_no_body(letter: str, height: float) -> None:
    rng = np.random.default_rng(ord(letter))
    sketch = cart(HAND, rng)
    first = len(sketch.strokes)
    ink = word(letter, 980, 120, height, rng)
    seen = recognize(Sketch([*sketch.strokes, *map(Stroke, ink)]))
    assert meaning(seen) == meaning(recognize(sketch))
    left = {s for r in seen.readings if r.kind == "unread" for s in r.strokes}
    assert left >= set(range(first, first + len(ink)))


@pytest.mark.parametrize("size", [24, 40, 60])
@pytest.mark.parametrize("seed", range(6))
def test_a_d_whose_bow_misses_its_stem_is_a_letter(seed: int, size: float) -> None:
    """Two strokes that go around, with gaps: of no course that a body so small has."""
    rng = np.random.default_rng(seed)
    t = np.linspace(-math.pi / 2, math.pi / 2, 20)
    stem = line([(300, 300), (300, 300 + size)], HAND, rng)
    round_side = np.stack([0.3 + 0.25 * np.cos(t), 0.5 + 0.5 * np.sin(t)], axis=1)
    bow = (300, 300) + size * np.array([(0.12, 0.0), *round_side.tolist(), (0.12, 1.0)])
    sketch = cart(HAND, rng)
    found = recognize(Sketch([*sketch.strokes, *map(Stroke, stem + curve(bow, HAND, rng))]))
    assert meaning(found) == meaning(recognize(sketch))


@pytest.mark.parametrize("seed", range(6))
def test_a_small_outline_of_any_course_is_written(seed: int) -> None:
    """A bean beside a machine; one as large as a wheel is a body."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * math.pi, 60)
    bean = np.stack([np.cos(t), 0.7 * np.sin(t) - 0.5 * np.cos(t) ** 2], axis=1)
    sketch = cart(HAND, rng)
    for radius, bodies in ((20, 0), (60, 1)):
        ink = curve((300, 200) + radius * bean, HAND, rng)
        found = recognize(Sketch([*sketch.strokes, *map(Stroke, ink)]))
        assert len(found.scene.bodies) == len(recognize(sketch).scene.bodies) + bodies


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("size", [24, 40])
def test_small_bodies_are_bodies(seed: int, size: float) -> None:
    """A crate, a wedge and a ball beside something large."""
    rng = np.random.default_rng(seed)
    floor = outline(box(640, 500, 900, 60), HAND, rng)
    crate = outline(box(300, 400, size, size), HAND, rng)
    wedge = outline([(500, 400 + size), (500 + size, 400 + size), (500 + size, 400)], HAND, rng)
    scene = read(floor, crate, wedge, circle((800, 420), size / 2, HAND, rng)).scene
    assert len(scene.bodies) == 4


@pytest.mark.parametrize("seed", range(8))
def test_a_pair_of_axes_is_no_outline(seed: int) -> None:
    """Two arrows from one place, with heads as large as a person draws them."""
    rng = np.random.default_rng(seed)
    ground = outline(box(640, 600, 900, 60), HAND, rng)
    down = arrow((1100, 120), (1100, 260), HAND, rng)
    at, long = np.array([300.0, 300.0]), 90.0
    axes = []
    for way in (1, -1j):
        u = np.array([way.real, way.imag])
        n, tip = np.array([-u[1], u[0]]), at + long * u
        axes += line([at, tip], HAND, rng)
        axes += line([tip - 64 * u + 48 * n, tip, tip - 64 * u - 48 * n], HAND, rng)
    found = read(ground, down, axes)
    assert len(found.scene.bodies) == 1
    assert found.scene.gravity[1] < -9
    assert {s for r in found.readings if r.kind == "unread" for s in r.strokes} == set(
        range(len(found.sketch.strokes) - len(axes), len(found.sketch.strokes))
    )


@pytest.mark.parametrize("seed", range(6))
def test_an_h_in_a_body_is_no_anchor(seed: int) -> None:
    """Its bar crosses one of its stems."""
    rng = np.random.default_rng(seed)
    frame = [*outline(box(500, 400, 260, 160), HAND, rng), *outline(box(640, 600, 900, 60), HAND, rng)]
    stems = [line([(x, 391), (x, 419)], HAND, rng) for x in (492, 510)]
    bar = line([(486, 404), (512, 406)], HAND, rng)
    assert [b.anchored for b in read(frame, *stems, bar).scene.bodies] == [False, False]
    small = cross((500, 405), 40, HAND, rng)
    assert [b.anchored for b in read(frame, small).scene.bodies] == [True, False]


@pytest.mark.parametrize("size", [16, 18])
def test_a_small_rough_ring_around_an_x_is_no_letter(size: float) -> None:
    """A peg: a stroke each, and said together in fewer words as a letter."""
    t, pegs = np.linspace(-1.9, 4.9, 50), 0
    spiral = np.linspace(0.68, 1.1, 50)[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    looped = np.array([(-0.6, -0.65), (0.65, 0.6), (0.8, -0.5), (-0.6, 0.65)])
    for seed in range(8):
        rng = np.random.default_rng(seed)
        ring, x = (curve((300, 300) + size * way, HAND, rng) for way in (spiral, looped))
        floor, ball = outline(box(640, 640, 900, 60), HAND, rng), circle((600, 120), 26, HAND, rng)
        bodies = read(ring, x, floor, ball, arrow((1150, 120), (1150, 240), HAND, rng)).scene.bodies
        pegs += [body.anchored for body in bodies] == [True, False, False]
    assert pegs > 6
