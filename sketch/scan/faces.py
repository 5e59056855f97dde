"""Faces: the pieces of paper that lines enclose.

Where bodies stand on one another, the ink of one's side is the other's side too, and no pairing of branches gives both
an outline.  But each encloses its own piece of paper: a face of the skeleton as a plane graph, found by turning the
same way at every junction (the doubly connected edge list of Muller and Preparata, 1978).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sketch.scan.graph import End
from sketch.scan.junctions import Branch, Junction, turn_cost
from sketch.scan.outlines import SMOOTH, ends_cost
from sketch.scan.strokes import Layout

__all__ = ["Face", "faces", "shared_sides"]

Points = NDArray[np.float64]
Rotation = dict[int, list[End]]

MOST_EDGES = 24  # of a face that is looked at
MOST_FACES = 80  # of a page, outsides and gaps among them: more are a net, or shading
SMALLEST = 4.0  # pen widths: a face whose area is no square of that is a gap between lines


@dataclass(frozen=True, eq=False)
class Face:
    """The way around a piece of paper.

    points: [pixels], closed, shape (n, 2).  edges: along it.  strain: of the lines that would have to end at its
    corners [rad²].
    """

    points: Points
    edges: frozenset[int]
    strain: float


def faces(junctions: list[Junction], layout: Layout) -> list[Face]:
    """The faces that share an edge with another one; none of a page that has very many."""
    rotation = _rotation(junctions, layout)
    after = {end: following for ends in rotation.values() for end, following in pairwise([*ends, ends[0]])}
    trails, seen = [], set[End]()
    for first in after:
        if first in seen:
            continue
        trail, at = [first], first
        while True:
            seen.add(at)
            at = after[at[0], 1 - at[1]]
            if at == first:
                break
            trail.append(at)
        if len(trail) <= MOST_EDGES:
            trails.append(trail)
    if len(trails) > MOST_FACES:
        return []
    out = [face for face in (_face(trail, layout) for trail in trails) if face is not None]
    owners: dict[int, int] = {}
    for face in out:
        for e in face.edges:
            owners[e] = owners.get(e, 0) + 1
    return [face for face in out if any(owners[e] > 1 for e in face.edges)]


def shared_sides(found: list[Face], k: int) -> list[frozenset[int]]:
    """Which of a face's edges may be others' ink: each neighbour's, all the earlier faces', all the later ones'."""
    own = found[k].edges
    sides = [(n, own & face.edges) for n, face in enumerate(found) if n != k and own & face.edges]
    out = [side for _, side in sides]
    out.append(frozenset().union(*(side for n, side in sides if n < k)))
    out.append(frozenset().union(*(side for n, side in sides if n > k)))
    return [side for side in dict.fromkeys(out) if side and side < own]


def _rotation(junctions: list[Junction], layout: Layout) -> Rotation:
    """For each junction the ends at it in the order of their directions, without those of edges that lead nowhere."""
    where = {branch.end: k for k, junction in enumerate(junctions) for branch in junction.branches}
    ends = {k: _turned(junction.branches) for k, junction in enumerate(junctions) if junction.branches}
    lonely = [k for k, meeting in ends.items() if len(meeting) == 1]
    loose = [end for end in where if (end[0], 1 - end[1]) not in where]
    while loose or lonely:
        if loose:
            end = loose.pop()
            k = where[end]
            if k not in ends or end not in ends[k]:
                continue
            ends[k].remove(end)
            if len(ends[k]) == 1:
                lonely.append(k)
            elif not ends[k]:
                del ends[k]
        else:
            k = lonely.pop()
            loose += [(e, 1 - side) for e, side in ends.pop(k, ())]
    return ends


def _turned(branches: list[Branch]) -> list[End]:
    starts = np.array([branch.start for branch in branches])
    x, y = (starts - starts.mean(axis=0)).T
    return [branches[n].end for n in np.argsort(np.arctan2(y, x), kind="stable").tolist()]


def _face(trail: list[End], layout: Layout) -> Face | None:
    """The face along a trail of edges; None for one that is no piece of paper within a single line."""
    names = [e for e, _ in trail]
    once = [end for end in trail if names.count(end[0]) == 1]
    if len(once) < 2:
        return None
    corners = [((e, 1 - side), end) for (e, side), end in pairwise([*once, once[0]])]
    if any(layout.junction_of[leave] is not layout.junction_of[enter] for leave, enter in corners):
        return None
    points = layout.points(*layout.along(once, closed=True))
    x, y = points.T
    area = float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2
    if -area < (SMALLEST * layout.pen) ** 2:  # the other way around is what lies outside
        return None
    return Face(points, frozenset(e for e, _ in once), sum(_cut(*corner, layout) for corner in corners))


def _cut(leave: End, enter: End, layout: Layout) -> float:
    """What it costs that lines end at a corner which continue there elsewhere [rad²]: two do where lines cross."""
    pair = [layout.branch_of[leave], layout.branch_of[enter]]
    others = [b for b in layout.junction_of[leave].branches if b.end not in (leave, enter)]
    most = min(turn_cost(*pair), SMOOTH)
    return ends_cost(sum(min((turn_cost(here, b) for b in others), default=math.inf) < most for here in pair))
