"""Junctions: which branches one movement of the pen drew.

Two branches that continue each other smoothly are paired; what is left over ends at the junction.  Where two
lines run into each other for a while and part again, the ink between serves both: that bridge belongs to one
junction with the branches at both its ends.
"""

from __future__ import annotations

import math
from cmath import phase
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sketch.lazy import lazy
from sketch.scan.binding import bend, heading
from sketch.scan.skeleton.graph import SIGHT, End, Graph
from sketch.typing import Points

__all__ = ["LONELY", "Branch", "Junction", "Pairs", "find_junctions", "turn_cost"]

Pairs = list[tuple[int, int]]  # indices of a junction's branches

CROSSING = 1.6  # pen widths: nodes nearer than this are one crossing, which thinning pulled apart
MERGED = 12.0  # pen widths: the longest bridge that is tried as the ink of two lines
DETOUR = 1.5  # times as long as the way straight across: half a circle, the way around a hole, and no bridge
BRIDGE_COST = 0.06  # for each pen width of a bridge that two lines share
UNEVEN = 0.5  # weight of the difference in bend between two branches
ROUND_BEND = 1.0  # [rad] beyond which bends are not compared
SMOOTH = 0.04  # of the sight: how far an arc may be off a parabola
LONELY = 1.0  # the cost of an end at a junction, as the square of a turn in radians
LOOP = 0.3  # of the length of a line that comes back: what shows where it is going
KNOT = 8  # more branches than this are paired greedily


@dataclass(frozen=True, eq=False)
class Branch:
    """A branch as its junction sees it.

    Attributes:
        end: the edge and which of its ends.
        start: [pixels] where it gets clear of the other ink.
        outward: unit vector of its direction there.
        bend: the angle by which it turns within SIGHT, leftwards positive [rad].
        centre: [pixels] of the crossing that it comes from.
    """

    end: End
    start: Points
    outward: Points
    bend: float
    centre: Points

    @lazy
    def place(self) -> complex:
        """`start` as a number."""
        return complex(*self.start.tolist())

    @lazy
    def direction(self) -> complex:
        """`outward` as a number."""
        return complex(*self.outward.tolist())


@dataclass(eq=False)
class Junction:
    """branches, the pairs of them that continue each other, and the edges that are ink of several."""

    branches: list[Branch]
    pairs: list[tuple[int, int]]
    bridges: list[int]


def find_junctions(graph: Graph, pen: float) -> list[Junction]:
    """The junctions of a skeleton's graph. pen: the width of the pen [pixels]."""
    crossing = _group(
        len(graph.nodes),
        [edge.ends for edge in graph.edges if _is_bridge(edge.ends) and edge.length < CROSSING * pen],
    )
    short = [
        e
        for e, edge in enumerate(graph.edges)
        if _is_bridge(edge.ends)
        and edge.length < CROSSING * pen
        and crossing[edge.ends[0]] == crossing[edge.ends[1]]
    ]
    branches: dict[int, list[Branch]] = {k: [] for k in set(crossing)}
    members: dict[int, list[int]] = {k: [] for k in branches}
    for node, k in enumerate(crossing):
        members[k].append(node)
    ends: dict[int, list[End]] = {k: [] for k in branches}
    inner = set(short)
    for node, meeting in enumerate(graph.branches()):
        ends[crossing[node]].extend(end for end in meeting if end[0] not in inner)
    for k, nodes in members.items():
        # a ring's node stands for all its area
        places, radii = graph.nodes[nodes], graph.radius[nodes]
        weights = radii**2 + 1e-9
        centre = (places * weights[:, None]).sum(axis=0) / weights.sum()
        spread = float(np.hypot(*(places - centre).T).max())
        reach = max(float(radii.max()), spread + pen / 2)
        for end in ends[k]:
            points, sight = graph.outward(end), SIGHT * pen
            if _is_loop(graph.edges[end[0]].ends, crossing):  # its other end shows where it comes from
                sight = min(sight, max(LOOP * graph.edges[end[0]].length - reach, pen))
            start, outward = heading(points, centre, reach, sight)
            curvature = bend(points, start, SIGHT * pen, SMOOTH)
            branches[k].append(Branch(end, start, outward, curvature * SIGHT * pen, centre))
    junctions = _share_bridges(graph, branches, crossing, pen)
    home = {k: junction for junction in junctions for k in junction[0]}
    for e in short:
        home[crossing[graph.edges[e].ends[0]]][2].append(e)
    return [Junction(b, _pair(b)[1], bridges) for _, b, bridges in junctions]


def _is_loop(ends: tuple[int, int], crossing: list[int]) -> bool:
    return ends[0] >= 0 and ends[1] >= 0 and crossing[ends[0]] == crossing[ends[1]]


def _is_bridge(ends: tuple[int, int]) -> bool:
    return ends[0] >= 0 and ends[1] >= 0 and ends[0] != ends[1]


def _group(count: int, joined: Sequence[tuple[int, int]]) -> list[int]:
    """For each of `count` things the name of its group."""
    group = list(range(count))

    def root(k: int) -> int:
        while group[k] != k:
            k = group[k]
        return k

    for a, b in joined:
        group[root(a)] = root(b)
    return [root(k) for k in range(count)]


_Merged = list[tuple[set[int], list[Branch], list[int]]]  # crossings, branches, bridges


def _share_bridges(
    graph: Graph, branches: dict[int, list[Branch]], crossing: list[int], pen: float
) -> _Merged:
    """Merge the junctions at both ends of a bridge where the branches then continue each other better."""
    junctions = {k: ({k}, found, list[int]()) for k, found in branches.items()}
    home = {k: k for k in branches}  # of each crossing, its junction
    lengths = [
        (length, e)
        for e, edge in enumerate(graph.edges)
        if _is_bridge(edge.ends)
        and (length := edge.length) < DETOUR * math.dist(*graph.nodes[list(edge.ends)].tolist())
    ]
    for length, e in sorted(lengths):
        if not CROSSING * pen <= length < MERGED * pen:
            continue
        first, second = (home[crossing[node]] for node in graph.edges[e].ends)
        if first == second:
            continue
        a, b = junctions[first], junctions[second]
        together = [branch for branch in a[1] + b[1] if branch.end[0] != e]
        if len(together) > KNOT:
            continue
        apart = _pair(a[1])[0] + _pair(b[1])[0]
        cost, pairs = _pair(together)
        left = sum(branch.end[0] != e for branch in a[1])
        crossing_over = sum(i < left <= j for i, j in pairs)
        if crossing_over >= 2 and cost + BRIDGE_COST * length / pen < apart:
            junctions[first] = (a[0] | b[0], together, [*a[2], *b[2], e])
            home.update((k, first) for k in junctions.pop(second)[0])
    return list(junctions.values())


def turn_cost(a: Branch, b: Branch) -> float:
    """What it costs to take b for the continuation of a, as the square of an angle [rad²].

    It is the angle by which the pen turns, at once and on its way across the gap, and that by which one of
    them bends otherwise than the other: a wheel that touches a plank goes on as round as it was.
    """
    u, v = a.direction, b.direction
    turn = phase(-v / u)
    gap = b.place - a.place
    # seen from a junction, both halves of an arc bend opposite ways; what bends a lot bends as it likes
    uneven = UNEVEN * min(abs(a.bend + b.bend), ROUND_BEND) ** 2
    if abs(gap) < 1e-9:
        return turn * turn + uneven
    detour = abs(phase(-gap / u)) + abs(phase(v / gap))
    return 0.5 * (turn * turn + detour * detour) + uneven


def _pair(branches: list[Branch]) -> tuple[float, list[tuple[int, int]]]:
    """The cheapest set of pairs, an unpaired branch costing LONELY, and what it costs."""
    count = len(branches)
    cost = {(i, j): turn_cost(branches[i], branches[j]) for i, j in combinations(range(count), 2)}
    if count > KNOT:
        return _pair_greedily(cost, count)

    def best(left: tuple[int, ...]) -> tuple[float, list[tuple[int, int]]]:
        if not left:
            return 0.0, []
        i, rest = left[0], left[1:]
        total, chosen = best(rest)
        total += LONELY
        for k, j in enumerate(rest):
            if cost[i, j] >= 2 * LONELY:
                continue
            value, others = best(rest[:k] + rest[k + 1 :])
            if value + cost[i, j] < total:
                total, chosen = value + cost[i, j], [(i, j), *others]
        return total, chosen

    return best(tuple(range(count)))


def _pair_greedily(cost: dict[tuple[int, int], float], count: int) -> tuple[float, list[tuple[int, int]]]:
    free, chosen, total = set(range(count)), [], 0.0
    for (i, j), c in sorted(cost.items(), key=lambda item: item[1]):
        if i in free and j in free and c < 2 * LONELY:
            chosen.append((i, j))
            free -= {i, j}
            total += c
    return total + LONELY * len(free), chosen
