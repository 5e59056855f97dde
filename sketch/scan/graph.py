"""The graph of a skeleton: edges between nodes, without the twigs that thinning grows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains

__all__ = ["Edge", "Graph", "build_graph"]

Points = NDArray[np.float64]


@dataclass(eq=False)
class Edge:
    """points: [pixels] from the first node to the last, shape (n, 2).  ends: nodes, -1 free, -2 a ring."""

    points: Points
    ends: tuple[int, int]

    @property
    def length(self) -> float:
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


@dataclass(eq=False)
class Graph:
    """nodes: [pixels], shape (k, 2).  radius: the ink's half width at each node [pixels], shape (k,)."""

    nodes: Points
    radius: NDArray[np.float64]
    edges: list[Edge] = field(default_factory=list)

    def branches(self) -> list[list[tuple[int, int]]]:
        """For each node the edges that end there, as (edge, which of its ends)."""
        out: list[list[tuple[int, int]]] = [[] for _ in self.nodes]
        for e, edge in enumerate(self.edges):
            for side in (0, 1):
                if edge.ends[side] >= 0:
                    out[edge.ends[side]].append((e, side))
        return out


def build_graph(chains: Chains, distance: NDArray[np.float32]) -> Graph:
    """The graph of traced chains. distance: each pixel's distance to the paper, shape (h, w)."""
    at = np.round(chains.nodes).astype(int)
    graph = Graph(chains.nodes, distance[at[:, 1], at[:, 0]].astype(np.float64))
    for points, ends in zip(chains.chains, chains.ends, strict=True):
        head = [chains.nodes[ends[0]]] if ends[0] >= 0 else []
        tail = [chains.nodes[ends[1]]] if ends[1] >= 0 else []
        closed = [points[0]] if ends[0] == -2 else []
        graph.edges.append(Edge(np.array([*head, *points, *tail, *closed]), ends))
    _drop_twigs(graph)
    return graph


def _drop_twigs(graph: Graph) -> None:
    """Drop the edges that end freely within the ink of their own node: thinning's, not the pen's.

    Tiny rings at one node go too: they are holes of a pixel or two.
    """
    kept = []
    for edge in graph.edges:
        a, b = edge.ends
        if (a >= 0) != (b >= 0):
            reach = 1.5 * graph.radius[max(a, b)] + 1
            if edge.length < reach:
                continue
        elif a == b and a >= 0 and edge.length < 4 * graph.radius[a]:
            continue
        kept.append(edge)
    graph.edges = kept
    _join_passed_nodes(graph)


def _join_passed_nodes(graph: Graph) -> None:
    """Make one edge of the two that meet at a node where nothing else does any more."""
    branches = graph.branches()
    gone: set[int] = set()
    for node, meeting in enumerate(branches):
        if len(meeting) != 2:
            continue
        (e, side), (f, other) = meeting
        if e == f:
            graph.edges[e].ends = (-2, -2)
            continue
        first, second = graph.edges[e], graph.edges[f]
        before = first.points if side == 1 else first.points[::-1]
        after = second.points if other == 0 else second.points[::-1]
        far = second.ends[1 - other]
        graph.edges[e] = Edge(np.concatenate([before, after[1:]]), (first.ends[1 - side], far))
        gone.add(f)
        near = first.ends[1 - side]
        if near >= 0 and side == 0:
            i = branches[near].index((e, 1))
            branches[near][i] = (e, 0)
        if far >= 0:
            i = branches[far].index((f, 1 - other))
            branches[far][i] = (e, 1)
        branches[node] = []
    graph.edges = [edge for k, edge in enumerate(graph.edges) if k not in gone]
