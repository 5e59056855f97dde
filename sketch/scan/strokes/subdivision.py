"""A drawing as a plane graph: the faces that its lines cut the paper into.

Where bodies stand on one another or overlap, no pairing of branches gives each its outline.  But each encloses pieces
of paper: faces, found by turning the same way at every node (the doubly connected edge list of Muller and Preparata,
1978).  A gap that a hand left in an outline is closed first, and what a pivot's ring cuts up is one face with what is
around the ring.
"""

from __future__ import annotations

from cmath import phase
from collections import Counter
from collections.abc import Set
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sketch.scan.skeleton.graph import RING, SIGHT, Edge, Graph
from sketch.scan.strokes.closing import SMOOTH, ends_cost
from sketch.typing import Points

__all__ = ["Face", "Outline", "Subdivision", "bridged"]

SLIVER = 1.2  # pen widths: the mean width of a face between two lines that are drawn along each other
GAP = 3.0  # pen widths: how far before other ink a line may end that was drawn up to it
AHEAD = 0.5  # cosine of the angle to where the line was going in which that is looked for
ROOM = 10.0  # of a ring's area: what bodies that it joins may have in common
SHORT = 2.5  # pen widths: a shorter edge is no line that must be explained
STUB = 1.6  # and what is shorter than this does not stand out from a crossing
CLEAR = 1.0  # pen widths from a crossing where a line is clear of its ink


@dataclass(eq=False)
class Face:
    """A piece of paper.

    sides: its half-edges.  loops: around its parts [pixels].  area: [pixels²].
    """

    sides: list[int]
    loops: list[Points]
    area: float

    def holds(self, at: Points) -> bool:
        """Whether a place is within it."""
        import cv2

        place = float(at[0]), float(at[1])
        return any(cv2.pointPolygonTest(loop, place, measureDist=False) >= 0 for loop in self.loops)


@dataclass(frozen=True, eq=False)
class Outline:
    """The longest way around some faces.

    points: [pixels], closed, shape (n, 2).  lines: the edges along it that are more than crumbs.  cut: at each corner
    those of its edges that go straight on there, and would have to end.
    """

    points: Points
    lines: frozenset[int]
    cut: tuple[frozenset[int], ...]

    @property
    def strain(self) -> float:
        """Of the lines that would have to end at its corners [rad²]."""
        return self.strain_without(frozenset())

    def strain_without(self, lent: Set[int]) -> float:
        """The same where some of its edges are lent to it: another's line goes on, if its own do not cross it there."""
        return sum(ends_cost(len(edges)) for edges in self.cut if not edges <= lent)


class Subdivision:
    """The faces that a graph cuts the paper into.  A half-edge 2e goes along edge e, and 2e + 1 back.

    Attributes:
        faces: by name.  neighbours: of each face those across an edge.
        length: of each edge [pixels].
        pen: its width [pixels].
    """

    def __init__(self, edges: list[Edge], rings: list[Points], pen: float) -> None:
        """edges: of a graph with the rings in it.  rings: where pivots may be [pixels].  pen: its width [pixels]."""
        bounding = _bounding(edges)
        self.pen = pen
        self._way: dict[int, Points] = {}
        self._cut: dict[tuple[int, ...], frozenset[int]] = {}
        self.length: dict[int, float] = {}
        leaving: dict[int, list[tuple[float, int]]] = {}
        for e, edge in enumerate(edges):
            self.length[e] = edge.length
            for side in (0, 1):
                h = 2 * e + side
                self._way[h] = way = edge.points[::-1] if side else edge.points
                if edge.ends[side] >= 0 and len(way) > 1:
                    dx, dy = way[min(max(round(pen), 2), len(way) - 1)] - way[0]
                    leaving.setdefault(edge.ends[side], []).append((float(np.arctan2(dy, dx)), h))
        self._around = {h: [other for _, other in around] for around in leaving.values() for _, h in around}
        self._next: dict[int, int] = {}
        for meeting in leaving.values():
            around = sorted(there for there in meeting if there[1] >> 1 in bounding)
            for k, (_, h) in enumerate(around):
                self._next[h ^ 1] = around[k - 1][1]
        self.faces: dict[int, Face] = {}
        self.face: dict[int, int] = {}  # of each half-edge the face beside it, -1 for the paper outside
        for h in self._next:
            if h in self.face:
                continue
            sides = [h]
            while (after := self._next[sides[-1]]) != h:
                sides.append(after)
            points = np.concatenate([self._way[s][:-1] for s in sides])
            inside = (area := _area(points)) > 0
            self.face.update((s, h if inside else -1) for s in sides)
            if inside:
                self.faces[h] = Face(sides, [points.astype(np.float32)], area)
        for ring in rings:
            self._fill(ring[:-1])
        self.neighbours: dict[int, set[int]] = {f: set() for f in self.faces}
        for h, f in self.face.items():
            g = self.face[h ^ 1]
            if f >= 0 and g >= 0 and f != g:
                self.neighbours[f].add(g)

    def _fill(self, ring: Points) -> None:
        """Make what a ring cuts up one face with what is around the ring."""
        import cv2

        area, middle = abs(_area(ring)), ring.mean(axis=0)
        within = {
            f
            for f, face in self.faces.items()
            if face.area < 2 * area and np.hypot(*(face.loops[0].mean(axis=0) - middle)) ** 2 < area / 4
        }
        beside = {self.face[h ^ 1] for f in within for h in self.faces[f].sides} - within - {-1}
        at = float(middle[0]), float(middle[1])
        about = [
            f
            for f in sorted(beside, key=lambda f: self.faces[f].area)
            if cv2.pointPolygonTest(
                cv2.convexHull(np.concatenate(self.faces[f].loops)), at, measureDist=False
            )
            >= 0
        ]
        scraps = [f for f in beside if self.faces[f].area < 2 * area]
        some = {*within, *scraps, *(f for f in about[:1] if not scraps or self.faces[f].area < ROOM * area)}
        one, *others = sorted(some, key=lambda f: -self.faces[f].area) if within else [-1]
        for f in others:
            into, face = self.faces[one], self.faces.pop(f)
            # also of its lines that lie within it and are no sides any more
            self.face.update([(h, one) for h, beside_it in self.face.items() if beside_it == f])
            into.sides += face.sides
            into.loops += face.loops
            into.area += face.area
        if others:
            into.sides = [h for h in into.sides if self.face[h ^ 1] != one]

    def middle(self, edge: int) -> Points:
        """The place half along an edge, shape (2,)."""
        way = self._way[2 * edge]
        return np.asarray(way[len(way) // 2])

    def is_thin(self, face: Face) -> bool:
        around = sum(self.length[h >> 1] for h in face.sides)
        return 2 * face.area < SLIVER * self.pen * around

    def outline(self, union: Set[int]) -> Outline:
        """The longest way around a union of faces."""
        border = {h for f in union for h in self.faces[f].sides if self.face[h ^ 1] not in union}
        outer, around, most = list[int](), np.empty((0, 2)), 0.0
        passed: set[int] = set()
        for first in sorted(border):
            if first in passed:
                continue
            loop, after = [], first
            while after not in passed:
                passed.add(after)
                loop.append(after)
                after = self._next[after]
                while after not in border:
                    after = self._next[after ^ 1]
            points = np.concatenate([self._way[h][:-1] for h in loop])
            if (area := abs(_area(points))) > most:
                outer, around, most = loop, points, area
        lines = frozenset(h >> 1 for h in outer if self.length[h >> 1] > SHORT * self.pen)
        return Outline(np.concatenate([around, around[:1]]), lines, self._ends(outer))

    def _ends(self, outer: list[int]) -> tuple[frozenset[int], ...]:
        """Where an outline turns and lines go straight on that then have to end there: which of its edges these are."""
        long = [k for k, h in enumerate(outer) if self.length[h >> 1] > SHORT * self.pen]
        out = []
        for k, after in pairwise([*long, long[0] + len(outer)] if long else []):
            corner = tuple(outer[n % len(outer)] for n in range(k, after + 1))
            if corner not in self._cut:
                self._cut[corner] = self._cut_at(corner)
            if self._cut[corner]:
                out.append(self._cut[corner])
        return tuple(out)

    def _cut_at(self, corner: tuple[int, ...]) -> frozenset[int]:
        """The same for one corner. corner: the half-edges that lead around it, the first and the last being long."""
        back, ahead = self._leaving(corner[0] ^ 1), self._leaving(corner[-1])
        turn = _turn(back, ahead)
        if turn <= SMOOTH:
            return frozenset()
        own = {h >> 1 for h in corner}
        # of two lines that part hardly further than the pen is wide, either goes straight on
        along = self._thin_beside(corner[0]) | self._thin_beside(corner[-1])
        others = [
            self._leaving(other)
            for h in corner[1:]
            for other in self._around[h]
            if other >> 1 not in own and self.length[other >> 1] > STUB * self.pen
            if along.isdisjoint(self._thin_beside(other))
        ]
        ends = (corner[0], back), (corner[-1], ahead)
        return frozenset(
            h >> 1 for h, here in ends if min((_turn(here, other) for other in others), default=turn) < SMOOTH
        )

    def _thin_beside(self, h: int) -> set[int]:
        """The thin faces beside an edge."""
        return {
            f
            for f in (self.face.get(h, -1), self.face.get(h ^ 1, -1))
            if f >= 0 and self.is_thin(self.faces[f])
        }

    def _leaving(self, h: int) -> complex:
        """The direction in which a half-edge leaves its node, clear of the ink there."""
        way = self._way[h]
        near, far = (min(round(reach * self.pen), len(way) - 1) for reach in (CLEAR, SIGHT))
        return complex(*(way[far] - way[min(near, far // 2)]).tolist())


def _turn(a: complex, b: complex) -> float:
    """The turn from one line into another, given how both leave a crossing [rad²]."""
    return phase(-b / a) ** 2 if a and b else 0.0


def bridged(graph: Graph, pen: float) -> list[Edge]:
    """The edges of a graph, with the gaps in outlines closed: a line goes on to other ink that it was heading for."""
    edges = [Edge(edge.points, edge.ends) for edge in graph.edges if edge.ends != RING]
    boxes = [(*edge.points.min(axis=0), *edge.points.max(axis=0)) for edge in edges]
    node = len(graph.nodes)
    for k, side in [(k, side) for k, edge in enumerate(edges) for side in (0, 1) if edge.ends[side] < 0]:
        if edges[k].length < SHORT * pen:
            continue
        back = edges[k].points[::-1] if side else edges[k].points
        tip = back[0]
        ahead = tip - back[min(round(2 * pen), len(back) - 1)]
        ahead /= max(np.hypot(*ahead), 1e-9)
        least, top, most, bottom = np.array(boxes).T
        (x, y), gap = tip, GAP * pen
        close = (least - gap <= x) & (x <= most + gap) & (top - gap <= y) & (y <= bottom + gap)
        best = gap, -1, -1
        for e in np.flatnonzero(close).tolist():
            way = edges[e].points - tip
            off = np.hypot(*way.T)
            off[(way @ ahead < AHEAD * off) | (e == k)] = np.inf
            at = int(off.argmin())
            best = min(best, (float(off[at]), e, at))
        _, e, at = best
        if e < 0:
            continue
        other, last = edges[e], len(edges[e].points) - 1
        if other.ends[0] >= 0 and at <= 1:
            end, at = other.ends[0], 0
        elif other.ends[1] >= 0 and at >= last - 1:
            end, at = other.ends[1], last
        else:
            end, node = node, node + 1
            edges[e] = Edge(other.points[: at + 1], (other.ends[0], end))
            edges.append(Edge(other.points[at:], (end, other.ends[1])))
            boxes.append(boxes[e])
        way = np.concatenate([other.points[at][None], back])
        ends = end, edges[k].ends[1 - side]
        edges[k] = Edge(way[::-1], ends[::-1]) if side else Edge(way, ends)
    return edges


def _bounding(edges: list[Edge]) -> set[int]:
    """The edges that may bound a face: without those that end freely."""
    kept = {e for e, edge in enumerate(edges) if min(edge.ends) >= 0 and len(edge.points) > 1}
    while True:
        count = Counter(node for e in kept for node in edges[e].ends)
        fewer = {e for e in kept if min(count[node] for node in edges[e].ends) > 1}
        if len(fewer) == len(kept):
            return kept
        kept = fewer


def _area(points: Points) -> float:
    """The area within a closed way, negative anticlockwise on a page whose y points down [pixels²]."""
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
