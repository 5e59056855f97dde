"""Outlines from the paper that they enclose, where bodies overlap at a pivot.

Where bodies overlap, their lines cut the paper into faces, and each body is some of these together.  Planks end to
end, or rods that lie nearly in one line, leave no junction at which the pen's way could be seen: their lines run into
each other, and what is ink of one of them may be ink of both.  Their faces are plain, though, and most bodies are
convex, while most unions of faces are not.  So of the convex unions those few are sought that have all the lines
for their outlines and share as little as can be: that two outlines run along each other for long is a coincidence.
"""

from __future__ import annotations

from cmath import phase
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from sketch.scan.graph import RING, SIGHT, Edge, Graph, Ink
from sketch.scan.outlines import SMOOTH, ends_cost
from sketch.scan.ways import Way

__all__ = ["overlapping"]

Points = NDArray[np.float64]

SOLID = 0.9  # of its hull's area: what a convex outline drawn by hand has at least
SLIVER = 1.2  # pen widths: the mean width of a face between two lines that are drawn along each other
GAP = 3.0  # pen widths: of an outline's gap that is closed
AHEAD = 0.5  # cosine of the angle to where the line was going in which that is looked for
ROOM = 10.0  # of a ring's area: what bodies that it joins may have in common
SHORT = 2.5  # pen widths: a shorter edge is no line that must be explained
MOST_FACES = 24  # that hang together: more are a grid, or shading
MOST_UNIONS = 100  # that are looked at, from each face
MOST_BODIES = 80  # of those that are convex
BODY = 20.0  # nats to say one more body,
LEFT = 25.0  # to leave a line over,
SHARED = 60.0  # for two outlines that are the same in full, in part for a part,
DENTED = 100.0  # for an outline that takes nothing of its hull's area
PIVOT = 15.0  # that a ring is likelier over two bodies than elsewhere
STRAIN = 6.0  # nats for each square radian of strain, as in `sketch.scan.settle`
CLEAR = 1.0  # pen widths from a crossing where a line is clear of its ink
BESIDE = 0.9  # pen widths: ink as near to an outline is its ink
MOSTLY = 0.8  # of a stretch of ink must be
PLACES = 12  # or a few less, of a stretch that are looked at


@dataclass(eq=False)
class _Face:
    """sides: its half-edges.  loops: around its parts [pixels].  area: [pixels²]."""

    sides: list[int]
    loops: list[Points]
    area: float

    def holds(self, at: Points) -> bool:
        """Whether a place is within it."""
        import cv2

        place = float(at[0]), float(at[1])
        return any(cv2.pointPolygonTest(loop, place, measureDist=False) >= 0 for loop in self.loops)


@dataclass(frozen=True, eq=False)
class _Body:
    """A convex union: the way around it [pixels], the lines along that, and its cost by itself [nats].

    strain: of the lines that would have to end at its corners [rad²].
    """

    points: Points
    strain: float
    faces: frozenset[int]
    lines: frozenset[int]
    cost: float


def overlapping(graph: Graph, rings: list[Way], inked: list[Edge], pen: float) -> list[Way]:
    """The outlines that a graph's knots under a ring are best made of, each with its share of the ink and with all.

    graph: with the rings in it.  rings: where pivots may be [pixels].  inked: what has the stretches of ink.  pen: its
    width [pixels].
    """
    if not rings:
        return []
    round_ways = [ring.points for ring in rings]
    sheet = _Sheet(_bounding(_bridged(graph, pen)), round_ways, pen)
    out: list[Way] = []
    for knot in sheet.knots(round_ways):
        bodies = sheet.unions(knot)
        chosen = _fewest(bodies, sheet.length, knot.pivots) if 1 < len(bodies) <= MOST_BODIES else []
        if len(chosen) > 1:
            stretches: Ink = {name: points for edge in inked for name, points in edge.ink.items()}
            out += _ways([bodies[k] for k in chosen], stretches, pen)
    return out


@dataclass(eq=False)
class _Knot:
    """Faces that hang together: those that count, the small ones among them, and in which of them a ring lies."""

    faces: list[int]
    small: list[int]
    pivots: list[int]


class _Sheet:
    """The faces that a graph cuts the paper into.  A half-edge 2e goes along edge e, and 2e + 1 back."""

    def __init__(self, edges: list[Edge], rings: list[Points], pen: float) -> None:
        self._pen = pen
        self._way: dict[int, Points] = {}
        self._cut: dict[tuple[int, ...], float] = {}
        self.length: dict[int, float] = {}
        leaving: dict[int, list[tuple[float, int]]] = {}
        for e, edge in enumerate(edges):
            self.length[e] = edge.length
            for side in (0, 1):
                h = 2 * e + side
                self._way[h] = way = edge.points[::-1] if side else edge.points
                dx, dy = way[min(max(round(pen), 2), len(way) - 1)] - way[0]
                leaving.setdefault(edge.ends[side], []).append((float(np.arctan2(dy, dx)), h))
        self._around = {h: [other for _, other in around] for around in leaving.values() for _, h in around}
        self._next: dict[int, int] = {}
        for around in leaving.values():
            around.sort()
            for k, (_, h) in enumerate(around):
                self._next[h ^ 1] = around[k - 1][1]
        self.faces: dict[int, _Face] = {}
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
                self.faces[h] = _Face(sides, [points.astype(np.float32)], area)
        for ring in rings:
            self._fill(ring[:-1])
        self._neighbours: dict[int, set[int]] = {f: set() for f in self.faces}
        for h, f in self.face.items():
            g = self.face[h ^ 1]
            if f >= 0 and g >= 0 and f != g:
                self._neighbours[f].add(g)

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
            self.face.update((h, one) for h in face.sides)
            into.sides += face.sides
            into.loops += face.loops
            into.area += face.area
        if others:
            into.sides = [h for h in into.sides if self.face[h ^ 1] != one]

    def knots(self, rings: list[Points]) -> Iterator[_Knot]:
        """The faces that hang together where a ring lies in one of several."""
        middles = [ring[:-1].mean(axis=0) for ring in rings]
        done: set[int] = set()
        for start in self.faces:
            if start in done:
                continue
            group = [start]
            done.add(start)
            for f in group:
                group += self._neighbours[f] - done
                done |= self._neighbours[f]
            small = [f for f in group if self._is_thin(self.faces[f])]
            faces = [f for f in group if f not in small]
            if not 3 <= len(faces) <= MOST_FACES:
                continue
            pivots = set()
            for middle in middles:
                holding = [f for f in faces if self.faces[f].holds(middle)]
                pivots.update([min(holding, key=lambda f: self.faces[f].area)] if holding else [])
            if pivots:
                yield _Knot(faces, small, sorted(pivots))

    def _is_thin(self, face: _Face) -> bool:
        around = sum(self.length[h >> 1] for h in face.sides)
        return 2 * face.area < SLIVER * self._pen * around

    def unions(self, knot: _Knot) -> list[_Body]:
        """The connected sets of faces that are convex together, with the small ones in them."""
        import cv2

        beside = {f: self._about(f, knot) for f in knot.faces}
        hulls = {f: cv2.convexHull(np.concatenate(self.faces[f].loops)) for f in knot.faces}
        small = [(f, self.faces[f].loops[0].mean(axis=0).tolist()) for f in knot.small]
        best: dict[frozenset[int], _Body] = {}
        for some in _connected(beside):
            if len(some) == 1 and not some.isdisjoint(knot.pivots):
                continue  # what is under a pivot alone is no body
            hull = cv2.convexHull(np.concatenate([hulls[f] for f in some]))
            whole = cv2.contourArea(hull)
            if sum(self.faces[f].area for f in some) < 0.8 * SOLID * whole:
                continue
            within = [
                f for f, at in small if cv2.pointPolygonTest(hull, (at[0], at[1]), measureDist=False) >= 0
            ]
            solid = sum(self.faces[f].area for f in [*some, *within]) / whole
            if solid > SOLID:
                body = self._body(some.union(within), some, BODY + DENTED * (1 - solid))
                if body.cost <= best.get(body.lines, body).cost:
                    best[body.lines] = body
        return list(best.values())

    def _about(self, face: int, knot: _Knot) -> set[int]:
        """The faces that count beside a face, or with small ones between."""
        small, reached = set(knot.small), {face}
        queue = [face]
        for f in queue:
            for n in self._neighbours[f] - reached:
                reached.add(n)
                if n in small:
                    queue.append(n)
        return reached - small - {face}

    def _body(self, union: frozenset[int], counting: frozenset[int], cost: float) -> _Body:
        """What is within the longest way around a union of faces."""
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
        lines = frozenset(h >> 1 for h in outer if self.length[h >> 1] > SHORT * self._pen)
        strain = self._strain(outer)
        return _Body(np.concatenate([around, around[:1]]), strain, counting, lines, cost + STRAIN * strain)

    def _strain(self, outer: list[int]) -> float:
        """What it costs that an outline turns where lines go straight on that then have to end there [rad²]."""
        long = [k for k, h in enumerate(outer) if self.length[h >> 1] > SHORT * self._pen]
        total = 0.0
        for k, after in pairwise([*long, long[0] + len(outer)] if long else []):
            corner = tuple(outer[n % len(outer)] for n in range(k, after + 1))
            if corner not in self._cut:
                self._cut[corner] = self._cut_at(corner)
            total += self._cut[corner]
        return total

    def _cut_at(self, corner: tuple[int, ...]) -> float:
        """The same for one corner. corner: the half-edges that lead around it, the first and the last being long."""
        back, ahead = self._leaving(corner[0] ^ 1), self._leaving(corner[-1])
        turn = _turn(back, ahead)
        if turn <= SMOOTH:
            return 0.0
        own = {h >> 1 for h in corner}
        # of two lines that part hardly further than the pen is wide, either goes straight on
        along = self._thin_beside(corner[0]) | self._thin_beside(corner[-1])
        others = [
            self._leaving(other)
            for h in corner[1:]
            for other in self._around[h]
            if other >> 1 not in own and self.length[other >> 1] > SHORT * self._pen
            if along.isdisjoint(self._thin_beside(other))
        ]
        ends = [min((_turn(here, other) for other in others), default=turn) for here in (back, ahead)]
        return ends_cost(sum(end < SMOOTH for end in ends))

    def _thin_beside(self, h: int) -> set[int]:
        """The thin faces beside an edge."""
        return {f for f in (self.face[h], self.face[h ^ 1]) if f >= 0 and self._is_thin(self.faces[f])}

    def _leaving(self, h: int) -> complex:
        """The direction in which a half-edge leaves its node, clear of the ink there."""
        way = self._way[h]
        near, far = (min(round(reach * self._pen), len(way) - 1) for reach in (CLEAR, SIGHT))
        return complex(*(way[far] - way[min(near, far // 2)]).tolist())


def _turn(a: complex, b: complex) -> float:
    """The turn from one line into another, given how both leave a crossing [rad²]."""
    return phase(-b / a) ** 2 if a and b else 0.0


def _connected(beside: dict[int, set[int]]) -> Iterator[frozenset[int]]:
    """The connected sets of faces, each once. beside: of each face those next to it."""
    for first in sorted(beside):
        queue = [frozenset([first])]
        seen = set(queue)
        for some in queue:
            yield some
            for f in sorted({n for m in some for n in beside[m] if n > first} - some):
                larger = some | {f}
                if larger not in seen and len(queue) < MOST_UNIONS:
                    seen.add(larger)
                    queue.append(larger)


def _fewest(bodies: list[_Body], length: dict[int, float], pivots: list[int]) -> list[int]:
    """The cheapest set of bodies for all the lines that any of them has.

    It is come to from none by taking up to two bodies out and up to two others in, until none is cheaper.  length: of
    each line [pixels].  pivots: the faces over which two bodies are likely.
    """
    lines = sorted({e for body in bodies for e in body.lines})
    has = np.array([[e in body.lines for e in lines] for body in bodies], dtype=float)
    over = np.array([[f in body.faces for f in pivots] for body in bodies], dtype=float)
    both = has * [length[e] for e in lines] @ has.T
    least = np.minimum.outer(np.diag(both), np.diag(both))
    cost = SHARED * both / np.maximum(least, 1e-9)
    np.fill_diagonal(cost, 0.0)
    each = np.array([body.cost for body in bodies])

    def saved(mask: NDArray[np.float64], of: NDArray[np.float64]) -> NDArray[np.float64]:
        """For each pair of bodies how many of the columns of `mask` either has."""
        one = of @ mask
        return np.asarray(one[:, None] + one - (of * mask) @ of.T)

    chosen: list[int] = []
    best = np.inf
    while True:
        found = None
        for out in [(), *combinations(chosen, 1), *combinations(chosen, 2)]:
            kept = [k for k in chosen if k not in out]
            open_lines = (has[kept].sum(axis=0) == 0).astype(float)
            held = over[kept].sum(axis=0)
            more = each + cost[:, kept].sum(axis=1)
            total = more[:, None] + more + cost - LEFT * saved(open_lines, has)
            total -= PIVOT * (saved((held == 1).astype(float), over) + (over * (held == 0)) @ over.T)
            # one body with itself is that body alone
            one = more - LEFT * (has @ open_lines) - PIVOT * (over @ (held == 1))
            np.fill_diagonal(total, one)
            base = each[kept].sum() + cost[np.ix_(kept, kept)].sum() / 2
            base += LEFT * open_lines.sum() - PIVOT * np.count_nonzero(held > 1)
            total[kept], total[:, kept] = np.inf, np.inf
            a, b = divmod(int(total.argmin()), len(bodies))
            for value, new in ((base, kept), (base + total[a, b], [*kept, *{a, b}])):
                if value < best - 1e-6:
                    best, found = value, new
        if found is None:
            return chosen
        chosen = found


def _ways(bodies: list[_Body], stretches: Ink, pen: float) -> list[Way]:
    """Ways along the outlines of bodies that overlap: each with its share of the ink, and with all of it.

    stretches: of the skeleton [pixels], by name.
    """
    outlines = [body.points for body in bodies]
    near = [_beside(outline, stretches, pen) for outline in outlines]
    mine: list[list[int]] = [[] for _ in outlines]
    had = [0.0 for _ in outlines]
    around = [float(np.hypot(*np.diff(o, axis=0).T).sum()) for o in outlines]
    wanted = {name: [k for k, its in enumerate(near) if name in its] for name in stretches}
    for name, holders in sorted(wanted.items(), key=lambda item: (len(item[1]), -len(stretches[item[0]]))):
        if holders:
            k = min(holders, key=lambda k: had[k] / around[k])
            mine[k].append(name)
            had[k] += len(stretches[name])
    return [
        Way(body.points, {name: stretches[name] for name in sorted(names)}, body.strain)
        for body, along, own in zip(bodies, near, mine, strict=True)
        for names in dict.fromkeys((along, frozenset(own)))
        if names
    ]


def _beside(outline: Points, stretches: Ink, pen: float) -> frozenset[int]:
    """The stretches of ink that run along an outline."""
    import cv2

    contour = outline.astype(np.float32)
    least, most = contour.min(axis=0) - pen, contour.max(axis=0) + pen
    out = set()
    for name, points in stretches.items():
        some = points[:: len(points) // PLACES + 1]
        if ((some > least) & (some < most)).all(axis=1).mean() >= MOSTLY:
            off = [cv2.pointPolygonTest(contour, (x, y), measureDist=True) for x, y in some.tolist()]
            if (np.abs(off) < BESIDE * pen).mean() >= MOSTLY:
                out.add(name)
    return frozenset(out)


def _bridged(graph: Graph, pen: float) -> list[Edge]:
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


def _bounding(edges: list[Edge]) -> list[Edge]:
    """The edges that may bound a face: without those that end freely."""
    kept = [edge for edge in edges if min(edge.ends) >= 0 and len(edge.points) > 1]
    while True:
        count = Counter(node for edge in kept for node in edge.ends)
        fewer = [edge for edge in kept if min(count[node] for node in edge.ends) > 1]
        if len(fewer) == len(kept):
            return kept
        kept = fewer


def _area(points: Points) -> float:
    """The area within a closed way, negative anticlockwise on a page whose y points down [pixels²]."""
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
