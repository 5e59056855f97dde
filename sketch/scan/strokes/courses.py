"""Courses: the pen's ways over the graph of a skeleton."""

from __future__ import annotations

from dataclasses import dataclass, field

from sketch.scan.skeleton.graph import RING, End, Graph
from sketch.typing import Points

__all__ = ["Course", "Links", "follow", "length", "through"]

Links = dict[End, tuple[End, Points]]  # where a course goes on from an end, and the ink in between


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

    def reversed(self) -> Course:
        """An open course from its other end."""
        return Course([(e, 1 - side) for e, side in self.steps[::-1]], [way[::-1] for way in self.via[::-1]])


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
        if graph.edges[begin[0]].ends == RING:
            course.closed = True
        courses.append(course)
    return courses


def through(links: Links, end: End) -> Course:
    """The course through an edge, given one of its ends."""
    begin = end
    while begin in links:
        left = links[begin][0]
        begin = (left[0], 1 - left[1])
        if begin == end:
            break
    course, at = Course([]), begin
    while True:
        course.steps.append(at)
        leave = (at[0], 1 - at[1])
        if leave not in links:
            return course
        at, via = links[leave]
        course.via.append(via)
        if at == begin:
            course.closed = True
            return course


def length(graph: Graph, course: Course) -> float:
    """The length of a course's own ink [pixels]."""
    return sum(graph.edges[e].length for e, _ in course.steps)
