"""Bodies that overlap at pivots, nearly in one line: read from paper as the rods that they are."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from sheets import drawn, encoded

from sim.scene import Polygon, Rectangle, Scene
from sketch.recognize import recognize
from sketch.scan import read_picture
from sketch.scan.binding import thin, trace
from sketch.scan.skeleton.graph import Graph, build_graph
from sketch.scan.skeleton.stretches import Stretches
from sketch.scan.strokes.closing import ends_cost
from sketch.scan.strokes.faces import standing
from sketch.scan.strokes.overlaps import overlapping
from sketch.scan.strokes.rings import find_rings
from sketch.scan.strokes.subdivision import Subdivision, bridged
from sketch.scan.strokes.ways import Way

Points = NDArray[np.float64]

PEN = 4.0
OVER = 20.0  # [pixels] that a rod goes on beyond its pivot
WIDE = 40.0


def rod(a: Points, b: Points, wide: float = WIDE) -> Points:
    """The outline of a rod from joint to joint and a little beyond."""
    u = (b - a) / np.hypot(*(b - a))
    side = np.array([-u[1], u[0]]) * wide / 2
    a, b = a - OVER * u, b + OVER * u
    return np.array([a - side, b - side, b + side, a + side, a - side])


def ring(at: Points, radius: float = 8.0) -> Points:
    turn = np.linspace(0, 2 * np.pi, 40)
    return at + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def chain(joints: list[tuple[float, float]]) -> list[Points]:
    """Rods from joint to joint, of slightly different widths, with pivots where two of them meet."""
    at = [np.array(joint) for joint in joints]
    rods = [rod(a, b, WIDE + 3 * (k % 2)) for k, (a, b) in enumerate(pairwise(at))]
    return rods + [ring(joint) for joint in at[1:-1]]


def inked(lines: list[Points], size: tuple[int, int] = (460, 760)) -> NDArray[np.float64]:
    image = np.zeros((size[0] * 4, size[1] * 4), np.uint8)
    for line in lines:
        cv2.polylines(image, [np.round((line + 0.5) * 4 - 0.5).astype(np.int32)], False, 255, round(4 * PEN))
    return cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA) / 255.0


def read(lines: list[Points]) -> Scene:
    return recognize(read_picture(encoded(drawn(inked(lines), noise=1.5)))).scene


def looked_at(lines: list[Points]) -> tuple[Graph, list[Points]]:
    """The graph of some lines and the rings among them."""
    mask = (inked(lines) > 0.5).astype(np.uint8)
    skeleton, size = thin(mask)
    distance = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    graph = build_graph(trace(skeleton, size), distance, PEN)
    return graph, [found.points for found in find_rings(mask, distance, PEN)]


def offered(graph: Graph, rings: list[Points]) -> list[Way]:
    plane = Subdivision(bridged(graph, PEN), rings, PEN)
    return overlapping(plane, rings, ink_of(graph))


def ink_of(graph: Graph) -> Stretches:
    """Each edge as a stretch of ink."""
    return Stretches({name: edge.points for name, edge in enumerate(graph.edges)}, PEN)


ROW = [(80.0, 200.0), (270.0, 204.0), (460.0, 199.0), (650.0, 203.0)]
BENT = [(200.0, 80.0), (300.0, 230.0), (330.0, 390.0)]


@pytest.mark.parametrize("joints", [ROW, BENT], ids=["row", "bent"])
def test_rods_end_to_end_are_so_many_rods(joints: list[tuple[float, float]]) -> None:
    scene = read(chain(joints))
    assert len(scene.bodies) == len(joints) - 1
    for body in scene.bodies:
        assert isinstance(body.shape, Rectangle | Polygon)
        assert len(body.shape.vertices) == 4
    assert [None in joint.bodies for joint in scene.joints] == [False] * (len(joints) - 2)


@pytest.mark.parametrize("joints", [ROW, BENT], ids=["row", "bent"])
def test_overlapping_outlines_are_those_drawn_and_share_their_ink_out(
    joints: list[tuple[float, float]],
) -> None:
    lines = chain(joints)
    graph, rings = looked_at(lines)
    ways = offered(graph, rings)
    count = len(joints) - 1
    for outline in lines[:count]:
        box = np.concatenate([outline.min(axis=0), outline.max(axis=0)])
        found = [np.concatenate([w.points.min(axis=0), w.points.max(axis=0)]) for w in ways]
        assert min(np.abs(b - box).max() for b in found) < 1.5 * PEN
    outlines = {way.points.tobytes() for way in ways}
    assert len(outlines) == count
    least = [min((w.ink.keys() for w in ways if w.points.tobytes() == o), key=len) for o in outlines]
    assert sum(map(len, least)) == len(set().union(*least))


def test_of_more_unions_than_are_looked_at_the_likeliest_are(monkeypatch: pytest.MonkeyPatch) -> None:
    graph, rings = looked_at(chain(ROW))
    every = [way.points for way in offered(graph, rings)]
    monkeypatch.setattr("sketch.scan.strokes.overlaps.MOST_BODIES", 12)
    few = [way.points for way in offered(graph, rings)]
    assert few
    assert all(any(np.array_equal(points, other) for other in every) for points in few)


def test_without_a_ring_or_without_an_overlap_nothing_is_offered() -> None:
    lines = chain(ROW)
    graph, rings = looked_at(lines[:3])
    assert offered(graph, rings) == []
    alone = [rod(np.array([100.0, 200.0]), np.array([400.0, 200.0])), ring(np.array([200.0, 200.0]))]
    graph, rings = looked_at(alone)
    assert rings
    assert offered(graph, rings) == []


BASE = np.array([(60.0, 300), (500, 300), (500, 360), (60, 360), (60, 300)])


@pytest.mark.parametrize("gap", [0.0, 8.0], ids=["closed", "with a gap"])
def test_a_box_that_shares_its_base_is_offered_even_with_a_gap(gap: float) -> None:
    box = np.array([(200.0, 300), (200, 220), (290 - gap, 220), (290, 220 + gap), (380, 220), (380, 300)])
    lines = [BASE, box[:3], np.concatenate([[(290.0, 220)], box[4:]])]
    graph, _ = looked_at(lines)
    planes = [Subdivision(edges, [], PEN) for edges in (bridged(graph, PEN), graph.edges)]
    boxes = [
        np.concatenate([w.points.min(axis=0), w.points.max(axis=0)]) for w in standing(planes, ink_of(graph))
    ]
    for outline in (box, BASE):
        wanted = np.concatenate([outline.min(axis=0), outline.max(axis=0)])
        assert min(np.abs(found - wanted).max() for found in boxes) < PEN


@pytest.mark.parametrize(("low", "offered"), [(300.0, True), (330.0, False)], ids=["end there", "cross"])
def test_a_face_is_a_body_where_its_sides_end_at_a_base_but_not_where_they_cross_it(
    low: float, offered: bool
) -> None:
    sides = np.array([(200.0, low), (200, 220), (380, 220), (380, low)])
    graph, _ = looked_at([BASE, sides])
    found = standing([Subdivision(graph.edges, [], PEN)], ink_of(graph))
    assert any(abs(way.points[:, 1].min() - 220) < PEN for way in found) == offered


@pytest.mark.parametrize(("low", "crossings"), [(300.0, 0), (315.0, 1)], ids=["end there", "cross"])
def test_a_base_that_is_lent_is_not_cut_short_but_where_a_side_crosses_it(low: float, crossings: int) -> None:
    sides = np.array([(200.0, low), (200, 220), (380, 220), (380, 300)])
    graph, _ = looked_at([BASE, sides])
    (base,) = (k for k, edge in enumerate(graph.edges) if 170 < edge.length < 190)
    found = standing([Subdivision(graph.edges, [], PEN)], ink_of(graph))
    box = {base in way.ink: way.strain for way in found if way.points[:, 1].max() < 310}
    assert box[False] == crossings * ends_cost(2)
    assert box[True] == crossings * ends_cost(2) + (2 - crossings) * ends_cost(1)
