"""The graph of a skeleton: edges between nodes, without the twigs that thinning grows."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains, course_length, heading
from sketch.scan.quantiles import median
from sketch.typing import Points

__all__ = ["RING", "SIGHT", "Edge", "End", "Graph", "Ink", "build_graph"]

RING = (-2, -2)  # the ends of an edge that closes on itself
SIGHT = 4.0  # pen widths along a branch that show where it is going
OVERSHOOT = 2.5  # pen widths that a line may go on past its corner
DOUBLE = 1.3  # pen widths: wider ink is that of two lines
MERGED = 10.0  # pen widths that two lines from one tip may be one
STRAIGHT_ON = 0.8  # cosine of the angle between a tip and the lines that go on from it
ONWARD = 0.5  # cosine of the angle between a line and what goes on from it past a corner
TWIG = 0.5  # pen widths: an end whose ink reaches less far beyond its node's is thinning's
PINHOLE = 4.0  # radii of a node's ink: a shorter ring at it is around a hole of a pixel or two
LEAST_SINE = 0.2  # of the angle at which two lines meet in a corner

# Times that the lines of a corner are at least as long as what sticks out of it. One tip at a fork is a corner's; two
# short arms may be a small cross's, whose others are not much longer, nor is the line that joins these, if any.
LONGER_THAN_TIP, LONGER_THAN_ARMS, LONGER_THAN_LOOP = 1.2, 3.0, 6.0

Ink = dict[int, Points]  # stretches of the skeleton by name, each shape (n, 2) [pixels]
End = tuple[int, int]  # an edge and which of its ends


@dataclass(eq=False)
class Edge:
    """points: [pixels] from the first node to the last, shape (n, 2).  ends: nodes, -1 free, -2 a ring.

    ink: the stretches of the skeleton that it is made of, for telling which edges of two graphs of one skeleton are
    the same ink.
    """

    points: Points
    ends: tuple[int, int]
    ink: Ink = field(default_factory=dict)

    @property
    def length(self) -> float:
        return course_length(self.points)


@dataclass(eq=False)
class Graph:
    """nodes: [pixels], shape (k, 2).  radius: the ink's half width at each node [pixels], shape (k,)."""

    nodes: Points
    radius: NDArray[np.float64]
    edges: list[Edge] = field(default_factory=list)

    def branches(self) -> list[list[End]]:
        """For each node the edges that end there, as (edge, which of its ends)."""
        out: list[list[End]] = [[] for _ in self.nodes]
        for e, edge in enumerate(self.edges):
            for side in (0, 1):
                if edge.ends[side] >= 0:
                    out[edge.ends[side]].append((e, side))
        return out

    def pieces(self) -> list[list[int]]:
        """The edges that hang together, piece by piece; a ring is one by itself."""
        meeting = self.branches()
        out, seen = [], set[int]()
        for first in range(len(self.edges)):
            if first in seen:
                continue
            seen.add(first)
            piece = [first]
            for e in piece:
                for node in self.edges[e].ends:
                    for other, _ in meeting[node] if node >= 0 else ():
                        if other not in seen:
                            seen.add(other)
                            piece.append(other)
            out.append(piece)
        return out

    def node(self, end: End) -> int:
        """The node at an end of an edge, -1 where it is free, -2 on a ring."""
        return self.edges[end[0]].ends[end[1]]

    def outward(self, end: End) -> Points:
        """An edge's points, from this end on."""
        points = self.edges[end[0]].points
        return points if end[1] == 0 else points[::-1]


def build_graph(chains: Chains, distance: NDArray[Any], pen: float) -> Graph:
    """The graph of traced chains.

    distance: each pixel's distance to the paper, shape (h, w).  pen: the width of the pen [pixels].
    """
    at = np.round(chains.nodes).astype(int)
    graph = Graph(chains.nodes, distance[at[:, 1], at[:, 0]].astype(np.float64))
    for points, ends in zip(chains.chains, chains.ends, strict=True):
        head, tail = (chains.nodes[end : end + 1] if end >= 0 else points[:0] for end in ends)
        closed = points[:1] if ends == RING else points[:0]
        graph.edges.append(Edge(np.concatenate([head, points, tail, closed]), ends))
    _drop_twigs(graph, distance, pen)
    _drop_overshoots(graph, pen)
    _turn_hairpins(graph, distance, pen)
    return graph


def _drop_twigs(graph: Graph, distance: NDArray[Any], pen: float) -> None:
    """Drop the edges that end freely within the ink of their own node: thinning's, not the pen's.

    Tiny rings at one node go too: they are holes of a pixel or two.
    """
    kept = []
    for edge in graph.edges:
        a, b = edge.ends
        if (a >= 0) != (b >= 0):
            node, tip = max(a, b), edge.points[-1 if a >= 0 else 0]
            x, y = np.round(tip).astype(int).tolist()
            beyond = math.dist(tip, graph.nodes[node]) + float(distance[y, x]) - graph.radius[node]
            if beyond < TWIG * pen + 1:  # and a pixel's bump
                continue
        elif a == b and a >= 0 and edge.length < PINHOLE * graph.radius[a]:
            continue
        kept.append(edge)
    graph.edges = kept
    _join_passed_nodes(graph, {})


def _drop_overshoots(graph: Graph, pen: float) -> None:
    """Drop the short ends that stick out where two long lines meet in a corner, and set the corner right.

    They are where a line went on past its corner, or what thinning makes of the tip of a sharp one.  The
    arms of a small cross stay: they are as long as each other.
    """
    gone: set[int] = set()
    corners: dict[int, Points] = {}
    for node, meeting in enumerate(graph.branches()):
        short = [
            e
            for e, side in meeting
            if graph.edges[e].ends[1 - side] == -1 and graph.edges[e].length < OVERSHOOT * pen
        ]
        rest = [end for end in meeting if end[0] not in short]
        if not short or len(rest) != 2:
            continue
        if not all(_goes_on(graph, node, e, rest, pen) for e in short):
            continue
        longest = max(graph.edges[e].length for e in short)
        apart = rest[0][0] != rest[1][0]
        far = LONGER_THAN_TIP if len(short) == 1 else LONGER_THAN_ARMS if apart else LONGER_THAN_LOOP
        if min(graph.edges[e].length for e, _ in rest) > far * longest:
            corner = _corner(graph, node, rest, pen)
            if corner is not None:
                gone.update(short)
                corners[node] = corner
    graph.edges = [edge for e, edge in enumerate(graph.edges) if e not in gone]
    _join_passed_nodes(graph, corners)


def _goes_on(graph: Graph, node: int, short: int, lines: list[End], pen: float) -> bool:
    """Whether a short end at a node goes on from one of the lines there: a barb of an arrow does not."""
    centre, reach = graph.nodes[node], graph.radius[node] + 1
    points = graph.edges[short].points
    ahead = _unit(points[0 if graph.edges[short].ends[0] == -1 else -1] - centre)
    return any(heading(graph.outward(end), centre, reach, SIGHT * pen)[1] @ ahead < -ONWARD for end in lines)


def _turn_hairpins(graph: Graph, distance: NDArray[Any], pen: float) -> None:
    """Lead lines that come back beside themselves around their tips, where their ink is one.

    A skeleton shows such a tip as a short line with two that go on from it.
    """
    gone: set[int] = set()
    tips: dict[int, Points] = {}
    for node, meeting in enumerate(graph.branches()):
        free = [end for end in meeting if graph.node((end[0], 1 - end[1])) == -1]
        if len(meeting) != 3 or not free:
            continue
        tip = min(free, key=lambda end: graph.edges[end[0]].length)
        sides = [end for end in meeting if end != tip]
        line = graph.outward(tip)
        long = graph.edges[tip[0]].length
        x, y = np.round(line).astype(int).T
        double = 2 * median(distance[y, x]) > DOUBLE * pen
        shortest = min(graph.edges[e].length for e, _ in sides)
        if sides[0][0] == sides[1][0] or long > (MERGED * pen if double else min(OVERSHOOT * pen, shortest)):
            continue
        centre, reach = graph.nodes[node], graph.radius[node] + 1
        ahead = _unit(line[-1] - line[0])
        if all(
            heading(graph.outward(end), centre, reach, SIGHT * pen)[1] @ ahead < -STRAIGHT_ON for end in sides
        ):
            gone.add(tip[0])
            tips[node] = line[-1]
    graph.edges = [edge for e, edge in enumerate(graph.edges) if e not in gone]
    _join_passed_nodes(graph, tips)


def _unit(v: Points) -> Points:
    return np.asarray(v / max(float(np.hypot(*v)), 1e-9))


def _corner(graph: Graph, node: int, sides: list[End], pen: float) -> Points | None:
    """Where the lines of two branches cross, or None where they continue each other or cross elsewhere."""
    centre, reach = graph.nodes[node], graph.radius[node] + 1
    (p, u), (q, v) = (heading(graph.outward(end), centre, reach, SIGHT * pen) for end in sides)
    sine = u[0] * v[1] - u[1] * v[0]
    if abs(sine) < LEAST_SINE:
        return None
    along = ((q[0] - p[0]) * v[1] - (q[1] - p[1]) * v[0]) / sine
    corner = p + along * u
    return corner if np.hypot(*(corner - centre)) < OVERSHOOT * pen else None


def _join_passed_nodes(graph: Graph, corners: dict[int, Points]) -> None:
    """Make one edge of the two that meet at a node where nothing else does any more."""
    branches = graph.branches()
    gone: set[int] = set()
    for node, meeting in enumerate(branches):
        if len(meeting) != 2:
            continue
        (e, side), (f, other) = meeting
        first, second = graph.edges[e], graph.edges[f]
        before = first.points if side == 1 else first.points[::-1]
        after = second.points if other == 0 else second.points[::-1]
        if node in corners:
            far = np.hypot(*(graph.nodes[node] - corners[node])) + graph.radius[node]
            before = _cut_back(before, corners[node], far)
            after = _cut_back(after[::-1], corners[node], far)[::-1]
        if e == f:
            first.points, first.ends = before, RING
            if node in corners:
                inner = _cut_back(before[::-1], corners[node], far)
                first.points = np.concatenate([inner, inner[:1]])
            continue
        beyond = second.ends[1 - other]
        graph.edges[e] = Edge(np.concatenate([before, after[1:]]), (first.ends[1 - side], beyond))
        gone.add(f)
        near = first.ends[1 - side]
        if near >= 0 and side == 0:
            i = branches[near].index((e, 1))
            branches[near][i] = (e, 0)
        if beyond >= 0:
            i = branches[beyond].index((f, 1 - other))
            branches[beyond][i] = (e, 1)
        branches[node] = []
    graph.edges = [edge for k, edge in enumerate(graph.edges) if k not in gone]


def _cut_back(points: Points, corner: Points, far: float) -> Points:
    """Points up to `far` from the corner that they lead to, then straight to the corner, a point a pixel."""
    near = np.hypot(*(points - corner).T) < far
    keep = len(points)
    while keep > 1 and near[keep - 1]:
        keep -= 1
    gap = corner - points[keep - 1]
    steps = max(int(np.hypot(*gap)), 1)
    return np.concatenate(
        [points[:keep], points[keep - 1] + gap * (np.arange(1, steps + 1) / steps)[:, None]]
    )
