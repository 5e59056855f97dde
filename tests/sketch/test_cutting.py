"""Several things drawn in one stroke, and strokes that are one thing."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from pages import box, kinds, ngon, read

from sketch.shapes.cutting import things_in
from sketch.synthetic import HANDS, arrow, circle, cross, line, outline

NEAT = HANDS["neat"]


def dragged(*strokes: np.ndarray) -> np.ndarray:
    """Strokes as one, the pen dragged straight from the end of each to the beginning of the next."""
    out = [strokes[0]]
    for before, after in pairwise(strokes):
        way = after[0] - before[-1]
        t = np.linspace(0, 1, max(int(np.hypot(*way) / 5), 2))[1:-1, None]
        out += [before[-1] + t * way, after]
    return np.concatenate(out)


def square(x: float, rng: np.random.Generator) -> np.ndarray:
    return np.concatenate(outline(box(x, 300, 110, 100), HANDS["shaky"].__class__(parts=(1,)), rng))


def ball(x: float, rng: np.random.Generator) -> np.ndarray:
    return circle((x, 300), 55, NEAT, rng)[0]


@pytest.mark.parametrize("seed", range(6))
def test_two_shapes_in_one_stroke(seed: int) -> None:
    rng = np.random.default_rng(seed)
    recognition = read([dragged(square(300, rng), ball(460, rng))])
    assert kinds(recognition) == ["4-gon", "circle"]
    assert [b.strokes for b in recognition.scene.bodies] == [[0], [0]]
    assert any("without lifting the pen" in note for note in recognition.scene.notes)
    assert kinds(read([dragged(ball(300, rng), ball(450, rng))])) == ["circle", "circle"]
    assert kinds(read([dragged(ball(300, rng), ball(420, rng), ball(540, rng))])) == ["circle"] * 3


@pytest.mark.parametrize("seed", range(4))
def test_a_wheel_and_its_rod_in_one_stroke(seed: int) -> None:
    rng = np.random.default_rng(seed)
    wheel = ball(300, rng)
    (x, y), (u, v) = wheel[-1], (wheel[-1] - [300, 300]) / 55
    rod = line([(x, y), (x + 240 * u + 30 * v, y + 240 * v - 30 * u)], NEAT, rng)[0]
    assert kinds(read([dragged(wheel, rod)])) == ["bar", "circle"]


@pytest.mark.parametrize("name", ["neat", "quick", "shaky"])
def test_one_thing_stays_in_one_piece(name: str) -> None:
    from dataclasses import replace

    hand = replace(HANDS[name], parts=(1,))
    for seed in range(10):
        rng = np.random.default_rng(seed)
        drawn = [
            *outline(box(300, 300, 200, 120), hand, rng),
            *outline(ngon(5, 300, 300, 90), hand, rng),
            *circle((300, 300), 70, hand, rng),
            *cross((300, 300), 60, hand, rng),
            *arrow((300, 200), (310, 340), hand, rng),
            *line([(100, 100), (400, 140)], hand, rng),
        ]
        for stroke in drawn:
            assert len(things_in([stroke])[0]) == 1
        twice = np.concatenate([drawn[1], drawn[1] + 2])
        assert len(read([twice]).scene.bodies) == 1


def test_strokes_without_length_are_not_cut() -> None:
    for points in ([], [[1.0, 2.0]], [[1.0, 2.0]] * 5):
        assert len(things_in([np.array(points, dtype=float).reshape(-1, 2)])[0]) == 1
