"""What is left of the ink of strokes once these are told: stubs, and bits of sides, and no letters."""

from __future__ import annotations

import numpy as np

from sketch.around.writing import LARGEST
from sketch.scan.skeleton.graph import Graph
from sketch.scan.strokes.ways import Way
from sketch.typing import Points

__all__ = ["remaining"]


def remaining(left: list[Way], chosen: list[Way], graph: Graph, scale: float) -> list[Way]:
    """Those of the ways left over that hang together with a chosen one which is larger than what is written.

    graph: of all the ink.  scale: the ways' pixels to one of the graph's.
    """
    if not left or not chosen:
        return []
    drawn = float(np.ptp(np.concatenate([way.points for way in chosen]), axis=0).max())
    pieces = graph.pieces()
    points = np.concatenate([graph.edges[e].points for piece in pieces for e in piece])
    ink = ((points + 0.5) * scale - 0.5).view(complex)[:, 0]
    sizes = [sum(len(graph.edges[e].points) for e in piece) for piece in pieces]
    whose = np.repeat(np.arange(len(pieces)), sizes)

    def piece(points: Points) -> int:
        return int(whose[np.abs(ink - complex(*points[len(points) // 2].tolist())).argmin()])

    large = {piece(way.points) for way in chosen if np.ptp(way.points, axis=0).max() > LARGEST * drawn}
    return [way for way in left if piece(way.points) in large]
