"""Ways: which strokes a graph may be made of.

At most junctions one pairing of the branches is much smoother than all others.  Where none is, only what the
strokes would make can tell; so the strokes of the next best pairings are given too, to be chosen among
(`sketch.scan.strokes.settle`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice

import numpy as np

from sketch.scan.skeleton.graph import Graph, Ink
from sketch.scan.skeleton.junctions import find_junctions
from sketch.scan.strokes.closing import Choice, close_outlines
from sketch.scan.strokes.convex import convex_ways
from sketch.scan.strokes.courses import Course, Links, follow, through
from sketch.scan.strokes.layout import Layout
from sketch.scan.strokes.unlifted import unlifted
from sketch.typing import Points

__all__ = ["SIDE", "Way", "Ways"]

DOUBT = 3.0  # [rad²] that pairings may be worse in all than the best ones, and still be looked at
SIDE = 3.0  # pen widths: the shortest side that is borrowed from other ink
TOGETHER = 2  # junctions that are paired otherwise at once
NET = 400  # edges: more than drawings of things have
MOST = 30  # combinations of pairings that are looked at


@dataclass(frozen=True, eq=False)
class Way:
    """A stroke that may have been drawn.

    points: [pixels], shape (n, 2).  ink: the stretches of the skeleton that it accounts for, and where each is; what
    it only borrows from other strokes is not among them.  strain: the cost of its turns and ends at junctions
    [rad²].  tail: of the ink, that of an end which goes on beside the beginning.
    """

    points: Points
    ink: Ink
    strain: float = 0.0
    tail: frozenset[int] = frozenset()


class Ways:
    """The strokes that a graph may be made of.

    pen: the width of the pen [pixels].  rings: all there are, each shape (n, 2).
    """

    def __init__(self, graph: Graph, pen: float, rings: Sequence[Points] = ()) -> None:
        junctions = find_junctions(graph, pen)
        self._graph = graph
        self.is_net = len(graph.edges) > NET  # shading, too: no way through it is better than another
        self._inner = {e for junction in junctions for e in junction.bridges}
        smoothest = [(junction, junction.pairs) for junction in junctions]
        self._choices = close_outlines(graph, junctions, pen)
        around = [(ring.min(axis=0), ring.max(axis=0)) for ring in rings]
        places = [(*(low + high) / 2, *(high - low)[:1] / 2) for low, high in around]
        self._layout = Layout(graph, junctions, pen, np.array(places).reshape(-1, 3))
        self._links: Links = {}
        self._smoothest: Links = {}
        for junction, pairs in smoothest:
            self._links.update(self._layout.links(junction, junction.pairs))
            self._smoothest.update(self._layout.links(junction, pairs))

    def likeliest(self, without: frozenset[int] = frozenset()) -> list[Way]:
        """The strokes of the best pairings, along the edges that have other ink than `without`."""
        gone = {e for e, edge in enumerate(self._graph.edges) if edge.ink and edge.ink.keys() <= without}
        links = {a: (b, way) for a, (b, way) in self._links.items() if a[0] not in gone and b[0] not in gone}
        courses = follow(self._graph, links, self._inner | gone)
        for course in courses if not without else ():  # what is left over closes nothing
            self._layout.borrow(course, courses)
        return [self._way(course, links) for course in courses if not self._layout.is_crumb(course)]

    def others(self) -> list[Way]:
        """Strokes of the next best pairings, the likelier first, each also closed over other ink where it can be."""
        out: list[Way] = []
        known = follow(self._graph, self._links, self._inner)
        seen = {_signature(course) for course in known}
        for course in known:
            if self._layout.is_crumb(course):
                continue
            self._layout.borrow(course, known)
            if course.borrowed is None:
                out += self._closed(course, self._links)
            else:
                out.append(self._way(replace(course, borrowed=None), self._links))
        long = SIDE * self._layout.pen
        sides = [c for c in known if not c.closed and self._layout.length(c) > long]
        for first, second in islice(self._layout.facing(sides), MOST):
            joined = self._layout.joined(first, second)
            out += [self._way(course, self._links) for course in joined]
            # closed it is the same from either
            joined += self._layout.across(first, second)
            out += self._closed(joined[0], self._links) if joined else []
        for course in follow(self._graph, self._smoothest, self._inner):
            signature = _signature(course)
            if signature not in seen and not self._layout.is_crumb(course):
                seen.add(signature)
                out += [self._way(course, self._smoothest), *self._closed(course, self._smoothest)]
        outlines = {e for course in known if course.closed for e, _ in course.steps}
        for course, links, strain in unlifted(self._layout, self._inner, outlines):
            out.append(replace(self._way(course, links), strain=strain))
        for choices in _combined(self._choices):
            links = dict(self._links)
            for choice in choices:
                for branch in choice.junction.branches:
                    links.pop(branch.end, None)
                links.update(self._layout.links(choice.junction, choice.pairs))
            for choice in choices:
                for branch in choice.junction.branches:
                    course = through(links, branch.end)
                    signature = _signature(course)
                    if signature in seen or self._layout.is_crumb(course):
                        continue
                    seen.add(signature)
                    out += [self._way(course, links), *self._closed(course, links)]
        for around in convex_ways(self._layout, self._inner):
            course, links = self._layout.along(around, closed=True)
            if (signature := _signature(course)) not in seen:
                seen.add(signature)
                out.append(self._way(course, links))
        return out

    def _closed(self, course: Course, links: Links) -> list[Way]:
        """A course closed over other ink, if that is long enough to be a side or the ink where both its ends are."""
        loan = self._layout.closing(course)
        if loan is None or (loan[1] and len(loan[0]) < SIDE * self._layout.pen):
            return []
        return [self._way(replace(course, borrowed=loan[0]), links)]

    def _way(self, course: Course, links: Links) -> Way:
        ink: Ink = {}
        for e, _ in course.steps:
            ink.update(self._graph.edges[e].ink)
        return Way(self._layout.points(course, links), ink, self._layout.strain(course))


def _signature(course: Course) -> tuple[frozenset[int], frozenset[frozenset[tuple[int, int]]]]:
    """What tells a course from others, whichever way and from wherever it is followed."""
    edges = [e for e, _ in course.steps]
    leaves = [(e, 1 - side) for e, side in course.steps]
    enters = course.steps[1:] + (course.steps[:1] if course.closed else [])
    return frozenset(edges), frozenset(frozenset(pair) for pair in zip(leaves, enters, strict=False))


def _combined(choices: list[Choice]) -> list[tuple[Choice, ...]]:
    """Sets of choices at different junctions, the likeliest first."""
    # what is not among the MOST likeliest by itself is in none of the MOST likeliest sets
    likely = sorted((c for c in choices if c.extra < DOUBT), key=lambda c: c.extra)[:MOST]
    sets = [
        some
        for size in range(1, TOGETHER + 1)
        for some in combinations(likely, size)
        if sum(c.extra for c in some) < DOUBT and len({id(c.junction) for c in some}) == size
    ]
    return sorted(sets, key=lambda some: sum(c.extra for c in some))[:MOST]
