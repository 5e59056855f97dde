"""What tracing leaves of ink that runs into strokes: no letters, and no bodies."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from test_tangles import BOX, circle, inked, kinds

from sketch.ink import Sketch, Stroke
from sketch.recognize import recognize
from sketch.scan.binding import thin, trace
from sketch.scan.skeleton.graph import Graph, build_graph
from sketch.scan.strokes.remains import remaining
from sketch.scan.strokes.ways import Way

Array = NDArray[np.float64]
PLANK = np.array([(100, 200), (1300, 206), (1298, 256), (103, 250), (100, 200)], float)
STUB = np.array([(1252, 206), (1266, 218), (1254, 228)], float)  # from the plank's side to a ring on it
SLIVER = np.array([(300, 205), (318, 201), (341, 207), (320, 211), (301, 206)], float)  # along its side


def pinned_plank(rest: Array, *, remains: bool) -> Sketch:
    """A plank with a ring on it, and one stroke more."""
    rings = [Stroke(np.array(circle(1280, 229, 10)))]
    return Sketch([Stroke(PLANK), *rings, Stroke(rest, remains=remains)], 1400, 420)


@pytest.mark.parametrize("remains", [True, False])
def test_a_stub_makes_no_letter_of_a_ring_that_it_runs_into(remains: bool) -> None:
    scene = recognize(pinned_plank(STUB, remains=remains)).scene
    assert kinds(scene) == ["rectangle"]
    assert len(scene.joints) == remains  # as strokes, the two may as well be a letter


@pytest.mark.parametrize("remains", [True, False])
def test_a_sliver_along_a_side_is_neither_a_body_nor_a_letter(remains: bool) -> None:
    scene = recognize(pinned_plank(SLIVER, remains=remains)).scene
    assert (kinds(scene) == ["rectangle"] and len(scene.joints) == 1) == remains


def test_a_large_outline_that_is_left_may_be_a_body_yet() -> None:
    left = Stroke(np.array(circle(700, 330, 60)), remains=True)
    assert kinds(recognize(Sketch([Stroke(PLANK), left], 1400, 420)).scene) == ["circle", "rectangle"]


def graph_of(ink: NDArray[np.float64]) -> Graph:
    mask = (ink > 0.5).astype(np.uint8)
    return build_graph(trace(*thin(mask)), mask.astype(np.float32) * 2, 4.0)


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_only_what_hangs_together_with_large_strokes_is_left_of_their_ink(scale: float) -> None:
    box, small = np.array(BOX, float), np.array(circle(450, 60, 6))
    spur, bit, free = (
        np.array(line, float)
        for line in ([(200, 204), (204, 180)], [(456, 60), (466, 50)], [(60, 60), (80, 70)])
    )
    graph = graph_of(inked([line.tolist() for line in (box, small, spur, bit, free)], 4.0))
    ways = [Way((line + 0.5) * scale - 0.5, {}) for line in (box, small, spur, bit, free)]
    assert remaining(ways[2:], ways[:2], graph, scale) == [ways[2]]
    assert remaining(ways[2:], [], graph, scale) == []
    assert remaining([], ways, graph, scale) == []
