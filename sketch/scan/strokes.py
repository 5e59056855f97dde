"""Strokes: the pen's way along the edges of a skeleton and through its junctions."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from sketch.scan.courses import Course, Links, follow, length
from sketch.scan.graph import RING, End, Graph
from sketch.scan.junctions import Branch, Junction, find_junctions
from sketch.scan.outlines import close_outlines

__all__ = ["trace_strokes"]

Points = NDArray[np.float64]

SHARED_SIDE = 0.45  # an outline may borrow this share of its length from ink that it rests on
CRUMB = 2.0  # pen widths: a piece shorter than this that starts at other ink is part of that
OWN_INK = 0.5  # and the lender has at least this much other ink, as a share of what it lends


def trace_strokes(graph: Graph, pen: float) -> list[Points]:
    """The strokes of a graph [pixels], each shape (n, 2). pen: the width of the pen [pixels]."""
    junctions = find_junctions(graph, pen)
    branch_of = {branch.end: branch for junction in junctions for branch in junction.branches}
    inner = {e for junction in junctions for e in junction.bridges}
    close_outlines(graph, junctions, pen)
    links: Links = {}
    for junction in junctions:
        for i, j in junction.pairs:
            a, b = junction.branches[i], junction.branches[j]
            via = _way(graph, junction, a, b, pen)
            links[a.end], links[b.end] = (b.end, via), (a.end, via[::-1])
    courses = follow(graph, links, inner)
    for course in courses:
        _borrow(graph, course, courses, inner)
    kept = [course for course in courses if not _is_crumb(graph, course, pen)]
    return [_points(graph, course, branch_of, links) for course in kept]


def _way(graph: Graph, junction: Junction, a: Branch, b: Branch, pen: float) -> Points:
    """The pen's way between two branches of a junction: as they lead into each other, or along a bridge.

    Where lines run into each other, thinning leads both along the middle of their ink; so a bridge is followed
    only where a smooth way across would leave it.
    """
    straight = _bend_over(a, b)
    if not junction.bridges or np.hypot(*(a.centre - b.centre)) < 1e-9:
        return straight
    bridge, _ = _shortest(graph, graph.node(a.end), graph.node(b.end), np.inf, only=set(junction.bridges))
    if len(straight) and len(bridge):
        off = np.hypot(*(bridge[:, None] - straight[None]).transpose(2, 0, 1)).min(axis=1).max()
        return straight if off < pen else bridge
    return bridge


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


def _shortest(
    graph: Graph,
    start: int,
    goal: int,
    longest: float,
    *,
    only: set[int] | None = None,
    without: set[int] | None = None,
) -> tuple[Points, list[int]]:
    """The shortest way between two nodes along edges: its points and edges; empty where there is none."""
    queue: list[tuple[float, int, tuple[End, ...]]] = [(0.0, start, ())]
    branches, seen = graph.branches(), set()
    while queue:
        length, node, way = heapq.heappop(queue)
        if node == goal:
            pieces = [graph.outward(end) for end in way]
            return (np.concatenate(pieces) if pieces else np.empty((0, 2))), [e for e, _ in way]
        if node in seen:
            continue
        seen.add(node)
        for e, side in branches[node]:
            far = graph.edges[e].ends[1 - side]
            total = length + graph.edges[e].length
            if (
                far < 0
                or total > longest
                or (only is not None and e not in only)
                or (without and e in without)
            ):
                continue
            heapq.heappush(queue, (total, far, (*way, (e, side))))
    return np.empty((0, 2)), []


def _is_crumb(graph: Graph, course: Course, pen: float) -> bool:
    """Whether a course lies within the ink of the junctions at its ends."""
    ends = (graph.node(course.steps[0]), graph.node((course.steps[-1][0], 1 - course.steps[-1][1])))
    return not course.closed and max(ends) >= 0 and length(graph, course) < CRUMB * pen


def _borrow(graph: Graph, course: Course, courses: list[Course], inner: set[int]) -> None:
    """Close an outline that rests on other ink with both its ends: that ink is its missing side too.

    A lid that is drawn as a stroke of its own lends nothing: it has hardly any other ink, and closes the
    outline as it is.
    """
    if course.closed or not course.steps:
        return
    head, tail = course.steps[0], (course.steps[-1][0], 1 - course.steps[-1][1])
    a, b = graph.node(head), graph.node(tail)
    if a < 0 or b < 0:
        return
    own = {e for e, _ in course.steps}
    way, edges = _shortest(graph, b, a, SHARED_SIDE * length(graph, course), without=own)
    if a != b and not edges:
        return
    lent = sum(graph.edges[e].length for e in edges)
    for lender in courses:
        shared = [e for e, _ in lender.steps if e in edges]
        if shared and length(graph, lender) - sum(graph.edges[e].length for e in shared) < OWN_INK * lent:
            return
    course.borrowed = way


def _points(graph: Graph, course: Course, branch_of: dict[End, Branch], links: Links) -> Points:
    pieces = []
    for k, step in enumerate(course.steps):
        pieces.append(_trimmed(graph, step, branch_of, links))
        if k < len(course.via):
            pieces.append(course.via[k])
    if course.borrowed is not None:
        pieces.append(course.borrowed)
    if (course.closed or course.borrowed is not None) and graph.edges[course.steps[0][0]].ends != RING:
        pieces.append(pieces[0][:1])
    return np.concatenate(pieces)


def _trimmed(graph: Graph, begin: End, branch_of: dict[End, Branch], links: Links) -> Points:
    """An edge's points from one end to the other, without what thinning bent at its junctions."""
    points = graph.outward(begin)
    finish = (begin[0], 1 - begin[1])
    head, tail = branch_of.get(begin), branch_of.get(finish)
    lo = int(np.argmin(np.hypot(*(points - head.start).T))) if head else 0
    hi = int(np.argmin(np.hypot(*(points - tail.start).T))) + 1 if tail else len(points)
    kept = [points[lo:hi] if lo < hi else points[len(points) // 2 : len(points) // 2 + 1]]
    if head and begin not in links:
        kept.insert(0, _reach_out(head)[None])
    if tail and finish not in links:
        kept.append(_reach_out(tail)[None])
    return np.concatenate(kept)


def _reach_out(branch: Branch) -> Points:
    """Where a branch ends that ends at a junction: straight on, as far as the junction's centre is."""
    ahead = float((branch.start - branch.centre) @ branch.outward)
    return np.asarray(branch.start - max(ahead, 0.0) * branch.outward)
