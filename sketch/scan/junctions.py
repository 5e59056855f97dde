"""Strokes through junctions: which branches one movement of the pen drew, and where it went between them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.graph import Graph

__all__ = ["trace_strokes"]

Points = NDArray[np.float64]
End = tuple[int, int]  # an edge and which of its ends

BRIDGE = 1.6  # pen widths: two junctions nearer than this are one crossing, pulled apart by thinning
LONELY = 1.0  # the cost of an end at a junction, in squares of a radian
SIGHT = 4.0  # pen widths along a branch that show where it is going


@dataclass(frozen=True, eq=False)
class Branch:
    """A branch as its junction sees it: where it gets clear of other ink, and its direction there."""

    end: End
    start: Points
    outward: Points


def trace_strokes(graph: Graph, pen: float) -> list[Points]:
    """The strokes of a graph [pixels], each shape (n, 2). pen: the width of the pen [pixels]."""
    zones = _zones(graph, pen)
    inner = {e for e, edge in enumerate(graph.edges) if _is_inner(graph, zones, e, pen)}
    meeting: dict[int, list[End]] = {}
    for node, ends in enumerate(graph.branches()):
        meeting.setdefault(zones[node], []).extend(end for end in ends if end[0] not in inner)
    links: dict[End, End] = {}
    cut: dict[End, Points] = {}
    for zone, ends in meeting.items():
        members = [k for k in range(len(graph.nodes)) if zones[k] == zone]
        centre = graph.nodes[members].mean(axis=0)
        reach = max(
            float(np.max(graph.radius[members])),
            float(np.max(np.hypot(*(graph.nodes[members] - centre).T))) + pen / 2,
        )
        branches = [_look(graph, end, reach, pen) for end in ends]
        pairs = _pair([_turn_cost(a, b) for a, b in combinations(branches, 2)], len(branches))
        for i, j in pairs:
            links[ends[i]], links[ends[j]] = ends[j], ends[i]
        for branch in branches:
            cut[branch.end] = branch.start
            if branch.end not in links:
                cut[branch.end] = np.array([_reach_out(branch, centre), branch.start])
    return _assemble(graph, links, cut, inner)


def _zones(graph: Graph, pen: float) -> list[int]:
    """For each node its zone: nodes joined by bridges of the length of a crossing are one."""
    zone = list(range(len(graph.nodes)))

    def root(k: int) -> int:
        while zone[k] != k:
            k = zone[k]
        return k

    for edge in graph.edges:
        a, b = edge.ends
        if a >= 0 and b >= 0 and a != b and edge.length < BRIDGE * pen:
            zone[root(a)] = root(b)
    return [root(k) for k in range(len(zone))]


def _is_inner(graph: Graph, zones: list[int], e: int, pen: float) -> bool:
    a, b = graph.edges[e].ends
    return a >= 0 and b >= 0 and a != b and zones[a] == zones[b] and graph.edges[e].length < BRIDGE * pen


def _outward(graph: Graph, end: End) -> Points:
    points = graph.edges[end[0]].points
    return points if end[1] == 0 else points[::-1]


def _look(graph: Graph, end: End, reach: float, pen: float) -> Branch:
    """Look beyond the `reach` in which thinning bends a branch; at half of what there is if it is short."""
    points = _outward(graph, end)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    first = min(reach, 0.5 * along[-1])
    window = points[(along >= first) & (along <= first + SIGHT * pen)]
    if len(window) < 2:
        window = points[[-2, -1]] if len(points) > 1 else np.repeat(points, 2, axis=0)
    centred = window - window.mean(axis=0)
    direction = np.linalg.svd(centred, full_matrices=False)[2][0] if np.any(centred) else np.array([1.0, 0.0])
    if direction @ (window[-1] - window[0]) < 0:
        direction = -direction
    return Branch(end, window[0], direction)


def _turn_cost(a: Branch, b: Branch) -> float:
    """The square of the angle by which the pen turns on its way from a to b: at once, and on the way."""
    turn = _angle(-a.outward, b.outward)
    gap = b.start - a.start
    if np.hypot(*gap) < 1e-9:
        return turn * turn
    detour = _angle(-a.outward, gap) + _angle(gap, b.outward)
    return 0.5 * (turn * turn + detour * detour)


def _angle(u: Points, v: Points) -> float:
    return float(abs(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)))


def _pair(costs: list[float], count: int) -> list[tuple[int, int]]:
    """The cheapest set of pairs, an unpaired branch costing LONELY. costs: in combinations' order."""
    cost = dict(zip(combinations(range(count), 2), costs, strict=True))
    if count > 8:  # a knot: greedily
        free, chosen = set(range(count)), []
        for (i, j), c in sorted(cost.items(), key=lambda item: item[1]):
            if i in free and j in free and c < 2 * LONELY:
                chosen.append((i, j))
                free -= {i, j}
        return chosen

    def best(left: tuple[int, ...]) -> tuple[float, list[tuple[int, int]]]:
        if not left:
            return 0.0, []
        i, rest = left[0], left[1:]
        total, chosen = best(rest)
        total += LONELY
        for k, j in enumerate(rest):
            value, others = best(rest[:k] + rest[k + 1 :])
            if value + cost[i, j] < total:
                total, chosen = value + cost[i, j], [(i, j), *others]
        return total, chosen

    return best(tuple(range(count)))[1]


def _reach_out(branch: Branch, centre: Points) -> Points:
    """Where a branch that ends at a junction ends: straight on, as far as the junction's centre is."""
    ahead = float((branch.start - centre) @ branch.outward)
    return np.asarray(branch.start - max(ahead, 0.0) * branch.outward)


def _assemble(graph: Graph, links: dict[End, End], cut: dict[End, Points], inner: set[int]) -> list[Points]:
    """Follow the links from edge to edge: first from ends, then around what closes on itself."""
    done = set(inner)
    strokes = []
    ends = [(e, side) for e in range(len(graph.edges)) for side in (0, 1)]
    for begin in [end for end in ends if end not in links] + ends:
        if begin[0] in done:
            continue
        pieces, at = [], begin
        while at[0] not in done:
            done.add(at[0])
            pieces.append(_trimmed(graph, at, cut))
            leave = (at[0], 1 - at[1])
            if leave not in links:
                break
            at = links[leave]
        else:
            pieces.append(pieces[0][:1])  # came back to where it began
        strokes.append(np.concatenate(pieces))
    return strokes


def _trimmed(graph: Graph, begin: End, cut: dict[End, Points]) -> Points:
    """An edge's points from one end to the other, without what thinning bent at its junctions."""
    points = _outward(graph, begin)
    head, tail = cut.get(begin), cut.get((begin[0], 1 - begin[1]))
    lo, hi = 0, len(points)
    if head is not None:
        lo = int(np.argmin(np.hypot(*(points - np.atleast_2d(head)[-1]).T)))
    if tail is not None:
        hi = int(np.argmin(np.hypot(*(points - np.atleast_2d(tail)[-1]).T))) + 1
    kept = [points[lo:hi] if lo < hi else points[len(points) // 2 : len(points) // 2 + 1]]
    if head is not None and np.ndim(head) == 2:
        kept.insert(0, head[:1])
    if tail is not None and np.ndim(tail) == 2:
        kept.append(tail[:1])
    return np.concatenate(kept)
