"""Pivots' rings on the plane graph of a drawing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.skeleton.graph import Edge
from sketch.scan.strokes.subdivision import Subdivision

Points = NDArray[np.float64]


def test_a_ring_around_a_ring_leaves_no_line_without_a_face() -> None:
    """A wheel with a line through its middle, and two rings about its hub: every side of a line is of a face."""
    reach = 100.0, 40.0, 15.0  # of the wheel and the rings
    up = [np.array([[0.0, -r]]) for r in reach]
    edges, rings = [], []
    for k, r in enumerate(reach):
        node = 2 * k, 2 * k + 1  # above and below
        angle = np.linspace(-np.pi / 2, np.pi / 2, 33)
        half = r * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        edges += [Edge(half, node), Edge(half * [-1, 1], node)]
        rings.append(np.concatenate([half, half[::-1] * [-1, 1]]))
    for k in (0, 1):
        edges += [
            Edge(way(up[k], up[k + 1]), (2 * k, 2 * k + 2)),
            Edge(way(-up[k], -up[k + 1]), (2 * k + 1, 2 * k + 3)),
        ]
    edges.append(Edge(way(up[2], -up[2]), (4, 5)))
    plane = Subdivision(edges, [rings[2], rings[1]], pen=3.0)
    assert set(plane.face.values()) - {-1} == set(plane.faces)
    total = sum(face.area for face in plane.faces.values())
    assert np.isclose(total, np.pi * 100**2, rtol=0.01)


def way(a: Points, b: Points) -> Points:
    return np.linspace(a[0], b[0], 21)
