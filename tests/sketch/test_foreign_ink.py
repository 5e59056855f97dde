"""Ink that has no meaning here: by itself it is nothing, and beside a machine it changes nothing."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from pages import page
from test_machines import cart, meaning

from sketch.ink import Sketch, Stroke
from sketch.kernel import depth
from sketch.recognize import Recognition, recognize
from sketch.synthetic import HANDS, curve, line

HAND = HANDS["neat"]
Path = list[tuple[float, float]]


def spiral(turns: float, count: int = 60) -> Path:
    t = np.linspace(0, 2 * math.pi * turns, count)
    r = 0.1 + 0.4 * t / t[-1]
    return [(0.5 + a * math.cos(b), 0.5 + a * math.sin(b)) for a, b in zip(r, t, strict=True)]


def wave(turns: float) -> Path:
    return [(x, 0.5 + 0.25 * math.sin(2 * math.pi * turns * x)) for x in np.linspace(0, 1, 50)]


def coil(turns: int) -> Path:
    t = np.linspace(0, 2 * math.pi * turns, 30 * turns)
    return [(0.1 + 0.8 * b / t[-1] + 0.14 * math.cos(b), 0.5 + 0.14 * math.sin(b)) for b in t]


def question_mark() -> Path:
    bow = [
        (0.5 + 0.28 * math.cos(a), 0.3 + 0.28 * math.sin(a)) for a in np.linspace(-math.pi, 0.5 * math.pi, 24)
    ]
    return [*bow, (0.5, 0.95)]


FOREIGN: dict[str, list[Path]] = {
    "v": [[(0.2, 0), (0.5, 1), (0.8, 0)]],
    "caret": [[(0.2, 1), (0.5, 0), (0.8, 1)]],
    "round caret": [
        [(0, 1), (0.28, 0.3), (0.36, 0.12), (0.43, 0.03), (0.5, 0), (0.56, 0.05), (0.62, 0.16), (0.95, 0.98)]
    ],
    "round v": [[(0, 0), (0.3, 0.75), (0.38, 0.93), (0.45, 0.99), (0.53, 0.94), (0.6, 0.8), (0.9, 0.02)]],
    "resistor": [[(0, 0.3), (0.3, 0.3), (0.38, 0.1), (0.5, 0.5), (0.62, 0.1), (0.7, 0.3), (1.2, 0.3)]],
    "zigzag": [[(0, 0.3), (0.2, 0.7), (0.4, 0.3), (0.6, 0.7), (0.8, 0.3), (1, 0.7)]],
    "z": [[(0, 0), (1, 0), (0, 1), (1, 1)]],
    "question mark": [question_mark()],
    "wave": [wave(2)],
    "spiral": [spiral(2.5)],
    "coil": [coil(4)],
    "bracket": [[(0.8, 0), (0.3, 0), (0.3, 1), (0.8, 1)]],
    "T": [[(0, 0), (1, 0)], [(0.5, 0), (0.5, 1)]],
    "H": [[(0, 0), (0, 1)], [(1, 0), (1, 1)], [(0, 0.5), (1, 0.5)]],
    "asterisk": [[(0.1, 0.1), (0.9, 0.9)], [(0.9, 0.1), (0.1, 0.9)], [(0, 0.5), (1, 0.5)]],
}


def drawn(name: str, x: float, y: float, size: float, rng: np.random.Generator) -> list[np.ndarray]:
    return [
        s for path in FOREIGN[name] for s in line([(x + size * u, y + size * v) for u, v in path], HAND, rng)
    ]


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("seed", range(3))
def test_foreign_ink_changes_nothing(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    alone = page(drawn(name, 500, 300, 130, rng))
    scene = recognize(alone).scene
    assert (scene.bodies, scene.gravity) == ([], (0.0, 0.0))
    sketch = cart(HAND, rng)
    ink = drawn(name, 1080, 90, 100, rng)
    first = len(sketch.strokes)
    beside = Sketch([*sketch.strokes, *map(Stroke, ink)], sketch.width, sketch.height)
    scene = recognize(beside).scene
    assert meaning(recognize(sketch)) == meaning(Recognition(sketch, scene, []))
    notes = " ".join(scene.notes)
    assert all(str(s) in notes for s in range(first, first + len(ink)))


def heart() -> np.ndarray:
    t = np.linspace(0, 2 * math.pi, 80)
    x, y = 16 * np.sin(t) ** 3, 13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t)
    return np.stack([500 + 6 * x, 300 - 6 * y], axis=1)


def arch() -> np.ndarray:
    t = np.linspace(0, math.pi, 40)
    outer = np.stack([500 - 90 * np.cos(t), 300 - 90 * np.sin(t)], axis=1)
    inner = np.stack([500 + 45 * np.cos(t), 300 - 45 * np.sin(t)], axis=1)
    foot = np.linspace(0, 70, 15)[:, None] * [0, 1]
    closed = [outer, outer[-1] + foot, inner[0] + foot[::-1], inner, inner[-1] + foot, outer[0] + foot[::-1]]
    return np.concatenate(closed)


@pytest.mark.parametrize("seed", range(4))
def test_a_closed_course_is_a_body_as_it_was_drawn(seed: int) -> None:
    """A heart is no triangle: its polygon follows the ink."""
    path = heart()
    scene = recognize(page(curve(path, HAND, np.random.default_rng(seed)))).scene
    (body,) = scene.bodies
    outline = np.ascontiguousarray((np.array(body.shape.vertices) + body.position) * [128, -128])
    assert len(outline) > 6
    assert max(abs(depth(x, y, outline)) for x, y in path.tolist()) < 192 / 10


@pytest.mark.parametrize("path", [heart(), arch()], ids=["heart", "arch"])
def test_what_goes_in_bows_has_no_corners_where_they_meet(path: np.ndarray) -> None:
    followed = 0
    for hand in HANDS.values():
        for seed in range(4):
            (reading,) = recognize(page(curve(path, hand, np.random.default_rng(seed)))).readings
            followed += len(reading.outline) > 12
    assert followed >= 16, followed  # of 20


def letter_p(foot: float) -> list[Path]:
    """A stem, and a shallow bow on it, which leaves a share of it below: straight sides would do for all else."""
    r = (1 - foot) / 2
    turn = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 16)
    bow = [(0.3 + 0.15 * math.cos(t), r + r * math.sin(t)) for t in turn]
    return [[(0, 0), (0, 1)], [(0.02, 0.02), (0.3, 0), *bow, (0.05, 2 * r)]]


def test_a_stem_that_runs_on_is_no_side() -> None:
    """A P is no box: what goes along a box's sides does not leave it by a third of its size."""
    beside = 0
    for foot in (0.3, 0.4, 0.5):
        for seed in range(4):
            rng = np.random.default_rng(seed)
            paths = [[(400 + 200 * u, 200 + 200 * v) for u, v in path] for path in letter_p(foot)]
            (reading,) = recognize(page([s for path in paths for s in line(path, HAND, rng)])).readings
            outline = np.ascontiguousarray(reading.outline)
            off = max(abs(depth(x, y, outline)) for path in paths for x, y in path)
            beside += off > 200 / 7
    assert beside <= 3, beside  # of 12


@pytest.mark.parametrize("width", [110, 120, 140])
def test_a_bow_that_is_half_open_is_nothing_round(width: float) -> None:
    """The bow of a P closes with its stem, if at all; an ellipse through it goes as far again beyond."""
    t = np.linspace(-2, 2, 40)
    bow = np.stack([500 + width * np.cos(t), 400 + 55 * np.sin(t)], axis=1)
    assert recognize(page([bow])).scene.bodies == []


@pytest.mark.parametrize(("beyond", "named"), [(8.0, False), (60.0, True)])
def test_ink_that_runs_far_beyond_an_outline_is_named(beyond: float, named: bool) -> None:
    ends = [(100, 100), (300, 100), (300, 260), (100, 260), (100, 100 - beyond)]
    sides = [np.linspace(a, b, 20) for a, b in itertools.pairwise(ends)]
    scene = recognize(Sketch([Stroke(s) for s in sides], 640, 480)).scene
    assert [len(b.outline()) for b in scene.bodies] == [4]
    said = [note for note in scene.notes if "off its outline" in note]
    assert bool(said) == named
    for note in said:
        name, off = note.split(" has ink that is ")
        assert name == "b1 (strokes 0, 1, 2, 3)"
        # ink is seen at 48 places a stroke, none of which is its end
        assert float(off.split()[0]) == pytest.approx(beyond, rel=0.05)
