"""What is written in a box is no side of it, though the box gapes there."""

from __future__ import annotations

import numpy as np
import pytest
from pages import read

from sketch.synthetic import Hand, curve, line

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
