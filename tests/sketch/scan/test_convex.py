"""Outlines that are convex: found through the tangles where several bodies' corners lie in one another's ink."""

from __future__ import annotations

import numpy as np
import pytest
from test_overlaps import PEN, Points, chain, looked_at

from sketch.kernel import depth
from sketch.scan.skeleton.junctions import find_junctions
from sketch.scan.strokes.convex import convex_ways
from sketch.scan.strokes.layout import Layout


def convex_outlines(lines: list[Points]) -> list[Points]:
    """The convex outlines of some lines, each (n, 2)."""
    graph, _ = looked_at(lines)
    junctions = find_junctions(graph, PEN)
    inner = {e for junction in junctions for e in junction.bridges}
    ways = convex_ways(Layout(graph, junctions, PEN, np.empty((0, 3))), inner)
    return [np.concatenate([graph.outward(end) for end in way]) for way in ways]


def off(outline: Points, wanted: Points) -> float:
    """How far an outline is off a wanted one, at most, or that one's corners are off it [pixels]."""
    corners = max(float(np.hypot(*(outline - corner).T).min()) for corner in wanted)
    return max(corners, max(abs(depth(x, y, wanted)) for x, y in outline.tolist()))


@pytest.mark.parametrize(
    "joints",
    [
        [(100, 100), (330, 180), (560, 100), (700, 330)],
        [(100, 300), (300, 120), (480, 330), (650, 130)],
        [(90, 90), (330, 330), (560, 100), (640, 400)],
    ],
)
def test_rods_that_end_in_one_another_are_convex_outlines(joints: list[tuple[float, float]]) -> None:
    lines = chain(joints)
    found = convex_outlines(lines)
    for rod in lines[: len(joints) - 1]:
        assert min(off(outline, rod[:-1]) for outline in found) < 2 * PEN


def test_what_turns_inward_is_no_convex_outline() -> None:
    arrowhead = np.array([(100, 100), (500, 230), (100, 360), (260, 230), (100, 100)], dtype=float)
    box = np.array([(100, 100), (500, 130), (480, 360), (160, 330), (100, 100)], dtype=float)
    # a line across each, which makes junctions
    across = np.array([(60.0, 200.0), (560.0, 240.0)])
    assert not any(off(outline, arrowhead[:-1]) < PEN for outline in convex_outlines([arrowhead, across]))
    assert any(off(outline, box[:-1]) < PEN for outline in convex_outlines([box, across]))
