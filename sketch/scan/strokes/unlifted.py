"""What the pen may have drawn without being lifted: all of a small piece of ink in one movement.

An arrow whose barbs were gone over, or an X with the side that joins its bars, is a tangle in which no pairing of
branches is the pen's way: that goes along some of the lines twice.  So for small pieces of ink the least movement is
sought that goes along every line at least once (the postman's way: Edmonds and Johnson, "Matching, Euler tours and the
Chinese postman", Mathematical Programming 5, 1973), the smoothest such counting as the least.
"""

from __future__ import annotations

import heapq
from itertools import count

from sketch.scan.skeleton.graph import RING, End
from sketch.scan.skeleton.junctions import LONELY, turn_cost
from sketch.scan.strokes.courses import Course, Links
from sketch.scan.strokes.layout import Layout

__all__ = ["unlifted"]

FEWEST, MOST = 3, 7  # lines of a piece of ink
AGAIN = 0.06  # [rad²] for each pen width that is drawn twice
BACK = 2.0  # [rad²]: a sharper turn is as good as turning back
STEPS = 1500  # that are looked at for each piece

State = tuple[End, tuple[int, ...]]  # by which end the last edge was left, and how often each was drawn


def unlifted(layout: Layout, inner: set[int]) -> list[tuple[Course, Links, float]]:
    """The least movement along each small piece of ink: its course, its links and its strain [rad²].

    inner: edges that belong to junctions.
    """
    out = []
    for edges in _pieces(layout, inner):
        if FEWEST <= len(edges) <= MOST:
            found = _least(layout, edges)
            if found is not None:
                out.append(found)
    return out


def _pieces(layout: Layout, inner: set[int]) -> list[list[int]]:
    """The edges that hang together, piece by piece."""
    out, seen = [], set(inner)
    for first, edge in enumerate(layout.graph.edges):
        if first in seen or edge.ends == RING:
            continue
        seen.add(first)
        piece = [first]
        for e in piece:
            for end in ((e, 0), (e, 1)):
                for branch in layout.junction_of[end].branches if end in layout.junction_of else ():
                    if branch.end[0] not in seen:
                        seen.add(branch.end[0])
                        piece.append(branch.end[0])
        out.append(sorted(piece))
    return out


def _least(layout: Layout, edges: list[int]) -> tuple[Course, Links, float] | None:
    """The least movement along all of these edges from a free end of one; None where there is none."""
    number = {e: k for k, e in enumerate(edges)}
    order = count()
    queue: list[tuple[float, int, State, tuple[End, ...], float]] = []
    for e in edges:
        for side in (0, 1):
            if layout.graph.node((e, side)) == -1:
                drawn = tuple(int(f == e) for f in edges)
                heapq.heappush(queue, (0.0, next(order), ((e, 1 - side), drawn), ((e, side),), 0.0))
    seen: set[State] = set()
    while queue and len(seen) < STEPS:
        cost, _, state, way, strain = heapq.heappop(queue)
        if state in seen:
            continue
        seen.add(state)
        at, drawn = state
        if all(drawn):
            return *layout.along(way, closed=False), strain
        if at in layout.junction_of:
            here, branches = layout.branch_of[at], layout.junction_of[at].branches
            onward = [(b.end, min(turn_cost(here, b), BACK)) for b in branches if b.end != at]
        else:
            onward = [(at, LONELY)]
        for end, turn in onward:
            k = number[end[0]]
            if drawn[k] == 2:
                continue
            again = AGAIN * layout.lengths[end[0]] / layout.pen if drawn[k] else 0.0
            now = (*drawn[:k], drawn[k] + 1, *drawn[k + 1 :])
            after: State = (end[0], 1 - end[1]), now
            if after not in seen:
                bent = strain + min(turn, LONELY)
                heapq.heappush(queue, (cost + turn + again, next(order), after, (*way, end), bent))
    return None
