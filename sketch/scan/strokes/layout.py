"""Strokes: the pen's way along the edges of a skeleton and through its junctions."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from sketch.scan.binding import nearest
from sketch.scan.skeleton.graph import RING, End, Graph
from sketch.scan.skeleton.junctions import LONELY, Branch, Junction, Pairs, turn_cost
from sketch.scan.strokes.closing import SMOOTH, ends_cost
from sketch.scan.strokes.courses import Course, Links
from sketch.typing import Points

__all__ = ["CRUMB", "Layout"]

SHARED_SIDE = 0.45  # an outline may borrow this share of its length from ink that it rests on
CRUMB = 1.0  # pen widths for each end at other ink: a shorter piece is part of that
GAP = 3.0  # pen widths: hardly a gap between the ends of an outline, whatever is there
ACROSS = 8.0  # radii of a ring: what it is a pivot of is no wider there, or is not told by it
BETWEEN = 0.3  # of the way from one line to the other: a ring so near to its middle is between them
OWN_INK = 0.5  # and the lender has at least this much other ink, as a share of what it lends


class Layout:
    """A skeleton's graph with its junctions, to be asked for the strokes along its courses.

    pen: the width of the pen [pixels].  rings: the middles and radii of all there are,
    shape (n, 3).
    """

    def __init__(self, graph: Graph, junctions: list[Junction], pen: float, rings: Points) -> None:
        self.graph, self.pen, self.rings = graph, pen, rings
        self.branch_of = {branch.end: branch for junction in junctions for branch in junction.branches}
        self.junction_of = {branch.end: junction for junction in junctions for branch in junction.branches}
        self.meeting = graph.branches()
        self.lengths = [edge.length for edge in graph.edges]
        self._widest = ACROSS * max(rings[:, 2].tolist(), default=0.0)
        self._ways: dict[tuple[End, End], Points] = {}

    def links(self, junction: Junction, pairs: Pairs) -> Links:
        """Where the courses go on that a junction's pairs join."""
        out: Links = {}
        for i, j in pairs:
            a, b = junction.branches[i], junction.branches[j]
            if (a.end, b.end) not in self._ways:
                way = self._way(junction, a, b)
                self._ways[a.end, b.end], self._ways[b.end, a.end] = way, way[::-1]
            out[a.end] = b.end, self._ways[a.end, b.end]
            out[b.end] = a.end, self._ways[b.end, a.end]
        return out

    def _way(self, junction: Junction, a: Branch, b: Branch) -> Points:
        """The pen's way between two branches of a junction: as they lead into each other, or along a bridge.

        Where lines run into each other, thinning leads both along the middle of their ink; so a bridge is
        followed only where a smooth way across would leave it.
        """
        straight = _bend_over(a, b)
        if not junction.bridges or np.hypot(*(a.centre - b.centre)) < 1e-9:
            return straight
        ends = self.graph.node(a.end), self.graph.node(b.end)
        bridge, _ = self.shortest(*ends, np.inf, only=set(junction.bridges))
        if len(straight) and len(bridge):
            off = np.hypot(*(bridge[:, None] - straight[None]).transpose(2, 0, 1)).min(axis=1).max()
            return straight if off < self.pen else bridge
        return bridge

    def along(self, way: Sequence[End], *, closed: bool) -> tuple[Course, Links]:
        """The course along edges, given by the ends at which they are entered, and the links that it uses."""
        course, links = Course(list(way), closed=closed), Links()
        for (e, side), enter in pairwise([*way, way[0]] if closed else way):
            leave = (e, 1 - side)
            via = np.empty((0, 2))
            junction = self.junction_of.get(leave)
            if junction is not None and junction is self.junction_of.get(enter):
                i, j = (
                    next(k for k, b in enumerate(junction.branches) if b.end == end) for end in (leave, enter)
                )
                links.update(self.links(junction, [(i, j)]))
                via = links[leave][1]
            course.via.append(via)
        return course, links

    def shortest(
        self,
        start: int,
        goal: int,
        longest: float,
        *,
        only: set[int] | None = None,
        without: set[int] | None = None,
    ) -> tuple[Points, list[int]]:
        """The shortest way between two nodes along edges: its points and edges; empty where there is none."""
        queue: list[tuple[float, int, tuple[End, ...]]] = [(0.0, start, ())]
        seen = set()
        while queue:
            length, node, way = heapq.heappop(queue)
            if node == goal:
                pieces = [self.graph.outward(end) for end in way]
                return (np.concatenate(pieces) if pieces else np.empty((0, 2))), [e for e, _ in way]
            if node in seen:
                continue
            seen.add(node)
            for e, side in self.meeting[node]:
                far = self.graph.edges[e].ends[1 - side]
                total = length + self.lengths[e]
                if far < 0 or total > longest or (only is not None and e not in only):
                    continue
                if not (without and e in without):
                    heapq.heappush(queue, (total, far, (*way, (e, side))))
        return np.empty((0, 2)), []

    def length(self, course: Course) -> float:
        """The length of a course's own ink [pixels]."""
        return sum(self.lengths[e] for e, _ in course.steps)

    def ends(self, course: Course) -> tuple[int, int]:
        """The nodes at a course's ends, negative where there is none."""
        head, tail = _ends(course)
        return self.graph.node(head), self.graph.node(tail)

    def strain(self, course: Course) -> float:
        """What a course's turns and ends at junctions cost [rad²]."""
        total = 0.0
        count = len(course.steps)
        for k, (e, side) in enumerate(course.steps):
            here = self.branch_of.get((e, 1 - side))
            if k + 1 == count and not course.closed:
                total += LONELY * (here is not None)
            else:
                there = self.branch_of.get(course.steps[(k + 1) % count])
                if here and there:
                    turn = min(turn_cost(here, there), LONELY)
                    total += self._cut(here, there) if course.closed and turn > SMOOTH else turn
        return total + LONELY * (not course.closed and course.steps[0] in self.branch_of)

    def _cut(self, here: Branch, there: Branch) -> float:
        """What an outline's corner at a junction costs [rad²]: that it turns is said with its shape, but what goes
        straight on there has to end."""
        branches = self.junction_of[here.end].branches
        others = [b for b in branches if b is not here and b is not there]
        return ends_cost(sum(any(turn_cost(a, b) < SMOOTH for b in others) for a in (here, there)))

    def is_crumb(self, course: Course) -> bool:
        """Whether a course lies within the ink of the junctions at its ends."""
        met = sum(end >= 0 for end in self.ends(course))
        return not course.closed and self.length(course) < CRUMB * met * self.pen

    def loan(self, course: Course) -> tuple[Points, list[int]] | None:
        """Other ink that leads from an open course's end back to its beginning: its points and edges."""
        own = {e for e, _ in course.steps}
        return None if course.closed else self._along(course, course, SHARED_SIDE * self.length(course), own)

    def closing(self, course: Course) -> tuple[Points, list[int]] | None:
        """The same, or the way straight across where there is a ring or hardly a gap between its ends."""
        loan = self.loan(course)
        if loan is None and not course.closed:
            straight = self._straight(course, course, SHARED_SIDE * self.length(course))
            return None if straight is None else (straight, [])
        return loan

    def facing(self, sides: list[Course]) -> Iterator[tuple[Course, Course]]:
        """The pairs of open courses that may be two sides of one outline, those first whose ends are the nearest to
        each other, in proportion to their lengths; the second goes on from where the first ends."""
        if len(sides) < 2:
            return
        ends = np.array([[self._tip(end) for end in _ends(course)] for course in sides])
        lengths = np.array([self.length(course) for course in sides])
        first, second = np.triu_indices(len(sides), 1)
        apart = np.hypot(*(ends[first][:, :, None] - ends[second][:, None]).transpose(3, 1, 2, 0))
        onward, back = apart[1, 0] + apart[0, 1], apart[0, 0] + apart[1, 1]
        gap = np.minimum(onward, back) / (lengths[first] + lengths[second])
        order = np.argsort(gap, kind="stable")
        for k in order[: np.count_nonzero(gap < 2 * SHARED_SIDE)].tolist():
            a, b = sides[first[k]], sides[second[k]]
            b = b.reversed() if back[k] < onward[k] else b
            over_ink = [
                min(self.ends(first)[1], self.ends(second)[0]) >= 0 for first, second in ((a, b), (b, a))
            ]
            if any(over_ink) or len(self.across(a, b)) == 2:
                yield a, b

    def joined(self, first: Course, second: Course) -> list[Course]:
        """Two open courses as one, where the second begins where the first ends, or the first where the second ends, or
        where other ink leads there."""
        longest = SHARED_SIDE * (self.length(first) + self.length(second))
        own = {e for e, _ in first.steps + second.steps}
        out = []
        for a, b in ((first, second), (second, first)):
            loan = self._along(a, b, longest, own)
            if loan is not None:
                out.append(Course(a.steps + b.steps, [*a.via, loan[0], *b.via]))
        return out

    def across(self, first: Course, second: Course) -> list[Course]:
        """Two open courses as one, where a ring or hardly a gap is between the end of one and the other's beginning."""
        longest = SHARED_SIDE * (self.length(first) + self.length(second))
        out = []
        for a, b in ((first, second), (second, first)):
            straight = self._straight(a, b, longest)
            if straight is not None:
                out.append(Course(a.steps + b.steps, [*a.via, straight, *b.via]))
        return out

    def _along(self, a: Course, b: Course, longest: float, own: set[int]) -> tuple[Points, list[int]] | None:
        """The way along other ink from the end of one course to the beginning of another."""
        start, goal = self.graph.node(_ends(a)[1]), self.graph.node(_ends(b)[0])
        if start < 0 or goal < 0:
            return None
        way, edges = self.shortest(start, goal, longest, without=own)
        return (way, edges) if edges or start == goal else None

    def _straight(self, a: Course, b: Course, longest: float) -> Points | None:
        """The way straight from the end of one course to another's beginning, if it is short or a ring is between."""
        p, q = self._tip(_ends(a)[1]), self._tip(_ends(b)[0])
        gap = q - p
        wide = math.hypot(gap[0], gap[1])
        if wide > longest or (wide > GAP * self.pen and wide > self._widest):
            return None
        way = np.asarray(p + gap * np.linspace(0, 1, max(round(wide), 1) + 1)[1:-1, None])
        if wide < GAP * self.pen:
            return way
        middles, radii = self.rings[:, :2], self.rings[:, 2]
        along = (middles - p) @ gap / wide**2
        off = np.hypot(*(middles - p - along[:, None] * gap).T)
        between = (np.abs(along - 0.5) < BETWEEN) & (off < wide) & (wide < ACROSS * radii)
        return way if between.any() else None

    def _tip(self, end: End) -> Points:
        """Where an edge ends."""
        return np.asarray(self.graph.outward(end)[0])

    def borrow(self, course: Course, courses: list[Course]) -> None:
        """Close an outline that rests on other ink with both its ends: that ink is its missing side too.

        A lid that is drawn as a stroke of its own lends nothing: it has hardly any other ink, and closes the
        outline as it is.
        """
        loan = self.loan(course)
        if loan is None:
            return
        way, edges = loan
        lent = sum(self.lengths[e] for e in edges)
        for lender in courses:
            shared = [e for e, _ in lender.steps if e in edges]
            if shared and self.length(lender) - sum(self.lengths[e] for e in shared) < OWN_INK * lent:
                return
        course.borrowed = way

    def points(self, course: Course, links: Links) -> Points:
        """A course's stroke [pixels], (n, 2)."""
        pieces = []
        for k, step in enumerate(course.steps):
            pieces.append(self._trimmed(step, links))
            if k < len(course.via):
                pieces.append(course.via[k])
        if course.borrowed is not None:
            pieces.append(course.borrowed)
        if (course.closed or course.borrowed is not None) and self.graph.edges[
            course.steps[0][0]
        ].ends != RING:
            pieces.append(pieces[0][:1])
        return np.concatenate(pieces)

    def _trimmed(self, begin: End, links: Links) -> Points:
        """An edge's points from one end to the other, without what thinning bent at its junctions."""
        points = self.graph.outward(begin)
        finish = (begin[0], 1 - begin[1])
        head, tail = self.branch_of.get(begin), self.branch_of.get(finish)
        lo = nearest(points, head.start) if head else 0
        hi = nearest(points, tail.start) + 1 if tail else len(points)
        kept = [points[lo:hi] if lo < hi else points[len(points) // 2 : len(points) // 2 + 1]]
        if head and begin not in links:
            kept.insert(0, _reach_out(head)[None])
        if tail and finish not in links:
            kept.append(_reach_out(tail)[None])
        return np.concatenate(kept)


def _ends(course: Course) -> tuple[End, End]:
    """Where a course begins and where it ends."""
    last, side = course.steps[-1]
    return course.steps[0], (last, 1 - side)


def _bend_over(a: Branch, b: Branch) -> Points:
    """A smooth way from one branch into another, a point a pixel, without its ends; none around a corner.

    It is the cubic Hermite curve that has their directions at its ends.
    """
    gap = b.start - a.start
    size = float(np.hypot(*gap))
    if size < 2 or gap @ a.outward > -0.5 * size or gap @ b.outward < 0.5 * size:
        return np.empty((0, 2))
    t = np.linspace(0, 1, int(size) + 1)[1:-1, None]
    return np.asarray(
        (2 * t**3 - 3 * t**2 + 1) * a.start
        - (t**3 - 2 * t**2 + t) * size * a.outward
        + (3 * t**2 - 2 * t**3) * b.start
        + (t**3 - t**2) * size * b.outward
    )


def _reach_out(branch: Branch) -> Points:
    """Where a branch ends that ends at a junction: straight on, as far as the junction's centre is."""
    ahead = float((branch.start - branch.centre) @ branch.outward)
    return np.asarray(branch.start - max(ahead, 0.0) * branch.outward)
