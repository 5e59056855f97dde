"""What is written in a box is no side of it, though the box gapes there, and no X on it."""

from __future__ import annotations

import numpy as np
import pytest
from pages import Point, box, read

from sketch.synthetic import HANDS, Hand, cross, curve, line, outline

HAND = Hand(tremor=0.002, drift=0.008, rounding=0.02, overshoot=0.02, spacing=0.03, unsteady=0.5)


@pytest.mark.parametrize("seed", range(8))
def test_letters_beside_a_gap_are_no_part_of_the_outline(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sides = [
        line([(402, 300), (560, 306)], HAND, rng)[0],
        line([(560, 306), (562, 430), (410, 432)], HAND, rng)[0],
        line([(410, 432), (404, 336)], HAND, rng)[0],
    ]
    at = np.linspace(0, 1, 30)
    m = np.stack([442 + 22 * at, 334 - 14 * np.abs(np.sin(2 * np.pi * at)) ** 0.5], axis=1)
    stem = np.array([(468.0, 312.0), (474.0, 306.0), (475.0, 334.0)])
    foot = np.array([(466.0, 336.0), (482.0, 337.0)])
    words = [curve(points, HAND, rng)[0] for points in (m, stem, foot)]
    (body,) = read(sides, words).scene.bodies
    assert set(body.strokes) == {0, 1, 2}


LETTERS: dict[str, list[list[Point]]] = {  # in a box of height 1
    "7": [[(0, 0.02), (0.5, 0), (0.15, 1)], [(0.08, 0.5), (0.5, 0.48)]],
    "4": [[(0.3, 0), (0, 0.65), (0.55, 0.65)], [(0.4, 0.32), (0.4, 1)]],
    "f": [[(0.45, 0.1), (0.28, 0), (0.2, 0.25), (0.2, 1)], [(0, 0.45), (0.4, 0.43)]],
}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("letter", LETTERS)
def test_a_letter_with_a_bar_across_it_is_no_anchor(letter: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    floor = outline(box(640, 650, 1000, 60), HAND, rng) + cross((640, 650), 34, HAND, rng)
    strokes = [
        line([(625 + 30 * x, 565 + 30 * y) for x, y in points], HANDS["neat"], rng)[0]
        for points in LETTERS[letter]
    ]
    scene = read(floor, outline(box(640, 580, 120, 90), HAND, rng), strokes).scene
    assert [body.anchored for body in scene.bodies] == [True, False]
