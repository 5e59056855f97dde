"""What the pen may have drawn without being lifted: all of a small piece of ink in one movement.

An arrow whose barbs were gone over, or an X with the side that joins its bars, is a tangle in which no pairing of
branches is the pen's way: that goes along some of the lines twice.  So for small pieces of ink the least movement is
sought that goes along every line at least once (the postman's way: Edmonds and Johnson, "Matching, Euler tours and the
Chinese postman", Mathematical Programming 5, 1973), the smoothest such counting as the least.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator, Sequence
from itertools import count, islice

from sketch.scan.skeleton.graph import RING, End
from sketch.scan.skeleton.junctions import LONELY, Branch, turn_cost
from sketch.scan.strokes.courses import Course, Links
from sketch.scan.strokes.layout import Layout

__all__ = ["unlifted"]

FEWEST, MOST = 3, 7  # lines of a piece of ink
AGAIN = 0.06  # [rad²] for each pen width that is drawn twice
BACK = 2.0  # [rad²]: a sharper turn is as good as turning back
BEST = 2  # movements along the same lines that are given: a loop may be drawn either way,
WORSE = 1.0  # [rad²] if that is hardly worse
STEPS = 1500  # that are looked at for each piece

State = tuple[End, tuple[int, ...]]  # by which end the last edge was left, and how often each was drawn


def unlifted(layout: Layout, inner: set[int], outlines: set[int]) -> list[tuple[Course, Links, float]]:
    """The least movements along each small piece of ink, each as its course, its links and its strain [rad²].

    inner: edges that belong to junctions.  outlines: those of outlines, which a piece may only touch.
    """
    pieces = {tuple(piece): None for gone in (inner, inner | outlines) for piece in _pieces(layout, gone)}
    small = [piece for piece in pieces if FEWEST <= len(piece) <= MOST]
    return [found for edges in small for found in islice(_movements(layout, edges), BEST)]


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


def _movements(layout: Layout, edges: Sequence[int]) -> Iterator[tuple[Course, Links, float]]:
    """The movements along all of these edges from a free end of one, the least first."""
    number = {e: k for k, e in enumerate(edges)}
    order = count()

    def onward(end: End) -> list[Branch]:
        """The piece's other branches where an end of an edge is."""
        junction = layout.junction_of.get(end)
        every = [] if junction is None else junction.branches
        return [b for b in every if b.end != end and b.end[0] in number]

    queue: list[tuple[float, int, State, tuple[End, ...], float]] = []
    for e in edges:
        for side in (0, 1):
            if not onward((e, side)):
                drawn = tuple(int(f == e) for f in edges)
                lonely = LONELY * ((e, side) in layout.junction_of)  # it ends at other ink
                heapq.heappush(queue, (lonely, next(order), ((e, 1 - side), drawn), ((e, side),), lonely))
    seen, done = set[State](), set[tuple[End, ...]]()
    most = math.inf
    while queue and len(seen) < STEPS:
        cost, _, state, way, strain = heapq.heappop(queue)
        if cost > most:
            break
        at, drawn = state
        if all(drawn):
            back = tuple((e, 1 - side) for e, side in way[::-1])
            if way not in done and back not in done:
                done.add(way)
                most = min(most, cost + WORSE)
                lonely = LONELY * (at in layout.junction_of and not onward(at))
                yield *layout.along(way, closed=False), strain + lonely
            continue
        if state in seen:
            continue
        seen.add(state)
        turns = [(b.end, min(turn_cost(layout.branch_of[at], b), BACK)) for b in onward(at)]
        for end, turn in turns or [(at, LONELY)]:
            k = number[end[0]]
            if drawn[k] == 2:
                continue
            again = AGAIN * layout.lengths[end[0]] / layout.pen if drawn[k] else 0.0
            now = (*drawn[:k], drawn[k] + 1, *drawn[k + 1 :])
            after: State = (end[0], 1 - end[1]), now
            if after not in seen:
                bent = strain + min(turn, LONELY)
                heapq.heappush(queue, (cost + turn + again, next(order), after, (*way, end), bent))
