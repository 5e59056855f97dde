"""Courses: the pen's ways over the graph of a skeleton, and the pairing at junctions that closes outlines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.graph import End, Graph
from sketch.scan.junctions import Junction, turn_cost

__all__ = ["Course", "Links", "close_outlines", "follow", "length"]

Points = NDArray[np.float64]
Links = dict[End, tuple[End, Points]]  # where a course goes on from an end, and the ink in between
Pairs = list[tuple[int, int]]

GAP = 0.15  # of an outline's length: what its ends may be apart
SHORTEST_OUTLINE = 8.0  # pen widths
STEEPEST = 6.5  # the cost (see turn_cost) of a turn by 145 degrees: nothing closes by turning back


@dataclass(eq=False)
class Course:
    """A stroke as a course over the graph: edges by the end at which they are entered.

    Attributes:
        steps: the edges.
        via: [pixels] the ink that lies between an edge and the next one, where they share it with others.
        closed: whether the last step leads to the first.
        borrowed: the way from the last end back to the first over other strokes' ink, or None.
    """

    steps: list[End]
    via: list[Points] = field(default_factory=list)
    closed: bool = False
    borrowed: Points | None = None


def follow(graph: Graph, links: Links, inner: set[int]) -> list[Course]:
    """Follow the links from edge to edge: first from ends, then around what closes on itself.

    inner: edges that belong to junctions and are no course of their own.
    """
    done, courses = set(inner), []
    ends = [(e, side) for e in range(len(graph.edges)) for side in (0, 1)]
    for begin in [end for end in ends if end not in links] + ends:
        if begin[0] in done:
            continue
        course, at = Course([]), begin
        while at[0] not in done:
            done.add(at[0])
            course.steps.append(at)
            leave = (at[0], 1 - at[1])
            if leave not in links:
                break
            at, via = links[leave]
            course.via.append(via)
        else:
            course.closed = True
        if graph.edges[begin[0]].ends == (-2, -2):
            course.closed = True
        courses.append(course)
    return courses


def length(graph: Graph, course: Course) -> float:
    """The length of a course's own ink [pixels]."""
    return sum(graph.edges[e].length for e, _ in course.steps)


def close_outlines(graph: Graph, junctions: list[Junction], inner: set[int], pen: float) -> None:
    """Pair branches otherwise, in place, where that closes outlines and opens none.

    Where two outlines touch, the smoothest way may well lead from one into the other; but bodies are closed
    outlines, and of two ways to read the same ink the one that closes them is the better.
    """
    for junction in junctions:
        for pairs in _other_pairings(junction):
            before, after = (_affected(graph, junctions, inner, junction, p) for p in (junction.pairs, pairs))
            gained = _outlines(graph, after, pen) - _outlines(graph, before, pen)
            if gained > 0 and _outlines(graph, after, pen) == len(after):
                junction.pairs = pairs
                break


def _other_pairings(junction: Junction) -> Iterator[Pairs]:
    """Pairings in which two of the pairs have exchanged partners."""
    for first, second in combinations(junction.pairs, 2):
        rest = [pair for pair in junction.pairs if pair not in (first, second)]
        (a, b), (c, d) = first, second
        for exchanged in ([(a, c), (b, d)], [(a, d), (b, c)]):
            cost = max(turn_cost(junction.branches[i], junction.branches[j]) for i, j in exchanged)
            if cost < STEEPEST:
                yield rest + exchanged


def _affected(
    graph: Graph, junctions: list[Junction], inner: set[int], junction: Junction, pairs: Pairs
) -> list[Course]:
    """The courses through the pairs in which two pairings differ, were the junction paired like `pairs`."""
    links: Links = {}
    nothing = np.empty((0, 2))
    for other in junctions:
        for i, j in pairs if other is junction else other.pairs:
            a, b = other.branches[i].end, other.branches[j].end
            links[a], links[b] = (b, nothing), (a, nothing)
    touched = {junction.branches[k].end[0] for pair in pairs for k in pair}
    return [c for c in follow(graph, links, inner) if any(e in touched for e, _ in c.steps)]


def _outlines(graph: Graph, courses: list[Course], pen: float) -> int:
    """How many of the courses are closed, or as good as closed."""
    count = 0
    for course in courses:
        drawn = length(graph, course)
        if drawn < SHORTEST_OUTLINE * pen:
            continue
        first, last = course.steps[0], course.steps[-1]
        gap = graph.outward(first)[0] - graph.outward((last[0], 1 - last[1]))[0]
        count += course.closed or bool(np.hypot(*gap) < GAP * drawn)
    return count
