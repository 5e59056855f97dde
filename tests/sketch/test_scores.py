"""A score is a probability: of readings that are said to be so sure, so many are right."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pages import read

from sketch import recognize
from sketch.reading import Rival, scored
from sketch.synthetic import HANDS, outline
from tests.benchmarks.drawings import matched
from tests.benchmarks.mechanisms import draw

NATS = st.floats(-20.0, 400.0)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(st.tuples(NATS, st.booleans()), min_size=1, max_size=5), st.floats(0.0, 50.0))
def test_scores_are_probabilities(behind: list[tuple[float, bool]], more: float) -> None:
    rivals = [Rival(f"kind {k}", nats, alike) for k, (nats, alike) in enumerate(behind)]
    score, others = scored(rivals)
    assert score + sum(p for _, p in others) == pytest.approx(1.0)
    assert [p for _, p in others] == sorted((p for _, p in others), reverse=True)
    assert len(others) == len(rivals)
    assert scored([r._replace(behind=r.behind + more) for r in rivals])[0] >= score - 1e-12


def test_a_corner_that_is_hardly_cut_leaves_a_rival() -> None:
    """The other number of sides is named, and the likelier the less of the corner is cut."""
    rng = np.random.default_rng(2)
    said = []
    for cut in (0.0, 0.14, 0.3, 0.5):
        (ax, ay), *rest = [(300.0, 200.0), (700.0, 200.0), (700.0, 500.0), (300.0, 500.0)]
        corners = [(ax + 300 * cut, ay), *rest, (ax, ay + 300 * cut)] if cut else [(ax, ay), *rest]
        reading = read(outline(corners, HANDS["neat"], rng)).readings[0]
        sides = len(reading.outline)
        alike = dict(reading.alternatives)
        said.append(alike.get("polygon of 5 sides", 0.0) if sides == 4 else reading.score)
        assert sides == (5 if cut >= 0.3 else 4)
    assert said[0] < said[1] < 0.5 < said[2] < said[3]


def test_as_many_are_right_as_the_scores_say() -> None:
    """Of bodies of 100 made-up machines: the sum of their scores, within three standard deviations."""
    scores, right = [], 0
    for k in range(100):
        drawing = draw(k, 11, 20)
        scene = recognize(drawing.sketch).scene
        hits = {found: i for i, (found, _) in matched(drawing, scene).items()}
        for n, body in enumerate(scene.bodies):
            scores.append(body.score or 0.0)
            right += n in hits and drawing.bodies[hits[n]].is_read_as(body)
    spread = math.sqrt(sum(p * (1 - p) for p in scores))
    assert len(scores) > 300
    assert abs(right - sum(scores)) < 3 * spread
