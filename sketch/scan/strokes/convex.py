"""Convex outlines: the closed ways over a graph that turn to one side only.

A rod that ends on others has its corners in their tangles, where several pairings at once may have to be other than the
likeliest ones for its outline to close.  Trying pairings in sets finds no more than two of them.  But most bodies are
convex, and few ways through a tangle are; so these are followed from edge to edge, the smoothest first.
"""

from __future__ import annotations

import heapq
import math
from cmath import phase
from collections.abc import Iterator
from itertools import count, pairwise, permutations

import numpy as np

from sketch.scan.skeleton.graph import RING, SIGHT, End
from sketch.scan.skeleton.junctions import LONELY, turn_cost
from sketch.scan.strokes.closing import SMOOTH, ends_cost
from sketch.scan.strokes.layout import Layout
from sketch.scan.strokes.subdivision import GAP

__all__ = ["convex_ways"]

Turning = tuple[float, float]  # to the left and to the right in all [rad]
Step = tuple[float, float, float, End]  # cost [rad²], turning to the left and right [rad], and where it leads
Found = tuple[float, tuple[End, ...]]  # cost [rad²], and the ends by which edges are entered

MOST_STRAIN = 6.0  # [rad²] of a way at junctions: all four corners of a rod may be at some
ASTRAY = 1.8  # [rad] in all that it may turn to the other side, as short edges are crooked
AROUND = 1.6  # [rad] that it may have turned more or less than once around
EVERY = 3.0  # pen widths: how finely an edge's turning is told
OPEN = 6.0  # pen widths: a gap that a hand leaves between an outline's ends
TURN = 0.5  # [rad²]: the most that a corner costs by itself
LEAP = 0.3  # [rad²] for going over a gap
LARGE = 4.0  # pen widths: what encloses no square of that is a gap between lines
SOLID = 0.85  # of its hull's area: less is not convex
MOST_STEPS = 3000  # that are looked at from one edge
LONG = 6.0  # pen widths: an edge that is no part of a tangle
BEST = 3  # ways through the same long edge that are given


def convex_ways(layout: Layout, inner: set[int]) -> list[tuple[End, ...]]:
    """The convex outlines through junctions, the smoothest first, as the ends by which edges are entered.

    inner: edges that belong to junctions.
    """
    import cv2

    onward = _onward(layout, inner)
    found = sorted(way for start in range(len(layout.graph.edges)) for way in _from(start, onward))
    seen: set[frozenset[End]] = set()
    through = [0] * len(layout.lengths)
    out = []
    for _, way in found:
        long = [e for e, _ in way if layout.lengths[e] > LONG * layout.pen]
        if frozenset(way) in seen or all(through[e] >= BEST for e in long):
            continue
        seen.add(frozenset(way))
        points = np.concatenate([layout.graph.outward(end) for end in way]).astype(np.float32)
        area = cv2.contourArea(points)
        if area > (LARGE * layout.pen) ** 2 and area > SOLID * cv2.contourArea(cv2.convexHull(points)):
            for e in long:
                through[e] += 1
            out.append(way)
    return out


def _from(start: int, onward: dict[End, list[Step]]) -> Iterator[Found]:
    """The ways around to the left from an edge back to it along later ones, the smoothest first."""
    for side in (0, 1):
        begin, order = (start, side), count()
        queue: list[tuple[float, int, float, float, tuple[End, ...]]] = [
            (0.0, next(order), 0.0, 0.0, (begin,))
        ]
        for _ in range(MOST_STEPS):
            if not queue:
                break
            cost, _, left, right, way = heapq.heappop(queue)
            for more, lefter, righter, end in onward.get((way[-1][0], 1 - way[-1][1]), ()):
                total, to_left, to_right = cost + more, left + lefter, right + righter
                if total > MOST_STRAIN:
                    break
                if to_right > ASTRAY or to_left - to_right > 2 * math.pi + AROUND:
                    continue
                if end == begin:
                    if to_left - to_right > 2 * math.pi - AROUND:
                        yield total, way
                elif end[0] > start and all(end[0] != e for e, _ in way):
                    heapq.heappush(queue, (total, next(order), to_left, to_right, (*way, end)))


def _onward(layout: Layout, inner: set[int]) -> dict[End, list[Step]]:
    """Where a way may go on from each end of an edge, the smoothest first; the turning includes the next edge's."""
    graph = layout.graph
    turning = [_turning(layout, e) for e in range(len(graph.edges))]
    out: dict[End, list[Step]] = {}

    def add(end: End, cost: float, turn: float, onto: End) -> None:
        left, right = turning[onto[0]][:: 1 - 2 * onto[1]]
        out.setdefault(end, []).append((cost, left + max(turn, 0.0), right + max(-turn, 0.0), onto))

    for junction in dict.fromkeys(layout.junction_of.values()):
        branches = junction.branches
        turns = {pair: turn_cost(*pair) for pair in permutations(branches, 2)}
        straight = {a: {b for b in branches if b is not a and turns[a, b] < SMOOTH} for a in branches}
        for (a, b), turn in turns.items():
            # what goes straight on there would have to end
            cut = 0 if b in straight[a] else bool(straight[a]) + bool(straight[b])
            cost = min(turn, TURN) + ends_cost(cut)
            add(a.end, cost, phase(-b.direction / a.direction), b.end)
    for end, other in _gaps(layout, inner):
        turn = phase(-_outward(layout, other) / _outward(layout, end))
        add(end, min(LEAP + turn * turn, LONELY), turn, other)
    return {end: sorted(steps) for end, steps in out.items()}


def _turning(layout: Layout, edge: int) -> Turning:
    """How far an edge turns on its way between its junctions."""
    points = layout.graph.edges[edge].points
    head, tail = layout.branch_of.get((edge, 0)), layout.branch_of.get((edge, 1))
    first = int(np.hypot(*(points - head.start).T).argmin()) if head else 0
    last = int(np.hypot(*(points - tail.start).T).argmin()) if tail else len(points) - 1
    kept = points[first : last + 1] if first < last else points
    steps = max(round(len(kept) / (EVERY * layout.pen)), 1)
    at = kept[np.linspace(0, len(kept) - 1, steps + 1).round().astype(np.intp)]
    ways = [complex(*way) for way in np.diff(at, axis=0).tolist() if any(way)]
    if head and tail and len(ways) < 2:
        ways = []  # these say it better
    ways = [*([head.direction] if head else []), *ways, *([-tail.direction] if tail else [])]
    turns = [phase(v / u) for u, v in pairwise(ways)]
    return sum(t for t in turns if t > 0), -sum(t for t in turns if t < 0)


def _gaps(layout: Layout, inner: set[int]) -> Iterator[tuple[End, End]]:
    """The ends of different edges, one of them free, that are so near to each other that a hand may have left a gap
    there."""
    graph = layout.graph
    free = [
        (e, side)
        for e, edge in enumerate(graph.edges)
        for side in (0, 1)
        if edge.ends[side] == -1 and edge.ends != RING and e not in inner
    ]
    every = free + list(layout.branch_of)
    tips = np.array([complex(*graph.outward(end)[0].tolist()) for end in every])
    reach = np.array([OPEN] * len(free) + [GAP] * len(layout.branch_of)) * layout.pen
    for k, end in enumerate(free):
        for n in np.flatnonzero(abs(tips - tips[k]) < reach).tolist():
            if every[n][0] != end[0]:
                yield end, every[n]
                if n >= len(free):
                    yield every[n], end


def _outward(layout: Layout, end: End) -> complex:
    """The direction of an edge from one of its ends."""
    points = layout.graph.outward(end)
    return complex(*(points[min(round(SIGHT * layout.pen), len(points) - 1)] - points[0]).tolist()) or 1.0
