"""Small rings: outlines of a few pen widths, such as a pivot's, that other lines run into or across.

Within so small an outline the lines and the ring melt together, and thinning leaves a tangle.  The ring
itself is plain to see, though: paper enclosed by a round belt of ink.  So it is taken first, and what runs
into it on one side and comes out on another is then a crossing, as wide as the ring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import belt, distances
from sketch.scan.graph import Edge, Graph, Ink
from sketch.scan.page import holes
from sketch.scan.ways import Way

__all__ = ["find_rings", "take_rings"]

Points = NDArray[np.float64]
Box = tuple[float, float, float, float]  # left, top, right, bottom [pixels]

SMALLEST, LARGEST = 0.9, 4.5  # pen widths: the radius that the pen's middle went along, as in core/belt.c
CHINK = 1.0  # squares of the pen width: a smaller hole is one between lines that cross, for all one can tell
CHANCE = 10.0  # [rad²] for what a ring that is perfectly round is too good to be chance
ALL_ROUND = 0.7  # of its length: an edge that has so much of the ring is the ring
BELT = 0.7  # pen widths to either side of the pen's middle are the belt's ink


def find_rings(mask: NDArray[Any], distance: NDArray[Any], pen: float) -> list[Way]:
    """The closed ways of the pen around small round holes [pixels], each shape (n, 2), best first.

    mask: ink 1, paper 0, shape (h, w).  distance: each ink pixel's distance to the paper.  Their ink is not known yet.
    """
    import cv2

    every = holes(mask)
    chinks = [way for way, area in every if area < CHINK * pen * pen]
    if chinks:
        mask = cv2.drawContours(mask.copy(), chinks, -1, 1, cv2.FILLED)
        distance = distances(mask)
    large = [(way, area) for way, area in every if area >= CHINK * pen * pen]
    found = sorted(
        (ring for seed in _seeds(large, distance, pen) if (ring := belt(mask, seed, pen)) is not None),
        key=lambda r: -r[0],
    )
    rings: list[Way] = []
    middles = np.zeros((0, 2))
    for roundness, middle, radius, points in found:
        if np.all(np.hypot(*(middles - middle).T) > radius):
            rings.append(Way(points, {}, -CHANCE * roundness))
            middles = np.concatenate([middles, points[:-1].mean(axis=0)[None]])
    return rings


def _seeds(
    every: list[tuple[NDArray[Any], int]], distance: NDArray[Any], pen: float
) -> list[tuple[float, float, float]]:
    """Where rings may be: middle and radius of small holes, alone and with the holes beside them.

    every: all holes in the ink, with their areas.
    """
    import cv2

    largest = np.pi * (LARGEST * pen) ** 2
    small = [(way, area) for way, area in every if area < largest]
    seeds = [_middle_and_radius(way, np.sqrt(max(area, 1) / np.pi) + pen / 2) for way, area in small]
    # a line across a ring makes two holes of one
    for (one, _), (other, _) in combinations(small, 2):
        if np.abs(one[0, 0] - other[0, 0]).max() < 2 * LARGEST * pen:
            (x, y), radius = cv2.minEnclosingCircle(np.concatenate([one, other]))
            seeds.append((x, y, radius + pen / 2 - 1))
    # ink much wider than a line is a hole that closed, wholly or in part
    inside = _grown((distance > 0.75 * pen).view(np.uint8), pen / 4)
    cv2.drawContours(inside, [way for way, _ in small], -1, 1, cv2.FILLED)
    for way in cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]:
        box = cv2.boundingRect(way)
        seeds.append(_middle_and_radius(way, np.sqrt((cv2.contourArea(way) + len(way)) / np.pi)))
        seeds.append(_middle_and_radius(way, max(box[2:]) / 2))
    return [seed for seed in seeds if SMALLEST * pen / 2 <= seed[2] <= LARGEST * pen]


def _middle_and_radius(way: NDArray[Any], radius: float) -> tuple[float, float, float]:
    x, y = way[:, 0].mean(axis=0)
    return float(x), float(y), float(radius)


def _grown(region: NDArray[Any], by: float) -> NDArray[Any]:
    import cv2

    side = 2 * max(round(by), 0) + 1
    return np.asarray(cv2.dilate(region, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))))


def take_rings(
    graph: Graph, rings: list[Way], pen: float, names: Iterator[int]
) -> tuple[Graph | None, list[Way]]:
    """Take the rings that other ink touches out of the graph, in place. names: for stretches of ink.

    Each leaves one node at its centre, at which the edges that ran into its belt end.  Returns the graph of the
    tangles as it was with the rings in it, or None without any, and the rings taken.
    """
    whole = list(graph.edges)
    for edge in whole:
        if not edge.ink:
            edge.ink = {next(names): edge.points}
    parts = {k: edge.ink for k, edge in enumerate(whole)}
    nodes, radius = graph.nodes, graph.radius
    taken = []
    boxes: dict[Edge, Box] = {}
    for ring in rings:
        middle = (ring.points.min(axis=0) + ring.points.max(axis=0)) / 2
        place = (float(middle[0]), float(middle[1]))
        reach = float(np.hypot(*(ring.points - middle).T).max()) + BELT * pen
        inside = set(np.flatnonzero(np.hypot(*(graph.nodes - middle).T) < reach).tolist())
        within = {
            k: np.hypot(*(edge.points - middle).T) < reach
            for k, edge in enumerate(graph.edges)
            if _comes_near(edge, place, reach, boxes)
        }
        crossing = [k for k, points in within.items() if points.any()]
        around = float(np.hypot(*np.diff(ring.points, axis=0).T).sum())
        if not crossing:
            continue  # a better ring has it all
        only = within[crossing[0]]
        if len(crossing) == 1 and only.mean() > 0.5 and np.count_nonzero(only) > ALL_ROUND * around:
            continue  # it stands by itself
        ink = _take(graph, middle, reach, inside, pen, names, parts, boxes)
        hidden = round(around) - sum(map(len, ink.values()))
        if hidden > 0:  # thinning leaves less of a blot than was drawn
            ink[next(names)] = ring.points[np.arange(hidden) % len(ring.points)]
        taken.append(replace(ring, ink=ink))
    if not taken:
        return None, []
    near = _reached(whole, [edge.ink.keys() != parts[k].keys() for k, edge in enumerate(whole)])
    for k, edge in enumerate(whole):
        edge.ink = parts[k]
    return Graph(nodes, radius, [edge for edge, there in zip(whole, near, strict=True) if there]), taken


def _comes_near(edge: Edge, middle: tuple[float, float], reach: float, boxes: dict[Edge, Box]) -> bool:
    """Whether the box around an edge comes within reach: on a page of writing few do."""
    if edge not in boxes:
        (left, top), (right, bottom) = edge.points.min(axis=0).tolist(), edge.points.max(axis=0).tolist()
        boxes[edge] = left, top, right, bottom
    left, top, right, bottom = boxes[edge]
    x, y = middle
    return left - reach < x < right + reach and top - reach < y < bottom + reach


def _reached(edges: list[Edge], touched: list[bool]) -> list[bool]:
    """Which edges hang together with those touched."""
    reached: set[int] = set()
    more = {end for edge, here in zip(edges, touched, strict=True) if here for end in edge.ends if end >= 0}
    while not more <= reached:
        reached |= more
        more = {end for edge in edges if not reached.isdisjoint(edge.ends) for end in edge.ends if end >= 0}
    return [here or not reached.isdisjoint(edge.ends) for edge, here in zip(edges, touched, strict=True)]


def _take(
    graph: Graph,
    middle: Points,
    reach: float,
    inside: set[int],
    pen: float,
    names: Iterator[int],
    parts: dict[int, Ink],
    boxes: dict[Edge, Box],
) -> Ink:
    """Cut a ring out of the graph, in place; returns its ink.

    names: for stretches of ink that are new by being cut.  parts: of each whole edge, the stretches.  boxes: around
    edges, as far as they are known.
    """
    node = len(graph.nodes)
    graph.nodes = np.concatenate([graph.nodes, middle[None]])
    graph.radius = np.append(graph.radius, reach)
    edges = []
    ink: Ink = {}
    place = (float(middle[0]), float(middle[1]))
    for edge in graph.edges:
        head, tail = (node if end in inside else end for end in edge.ends)
        if (head, tail) == edge.ends and not _comes_near(edge, place, reach, boxes):
            edges.append(edge)
            continue
        outside = np.hypot(*(edge.points - middle).T) >= reach
        if outside.all() and (head, tail) == edge.ends:
            edges.append(edge)
            continue
        (name,) = edge.ink
        whole = next(k for k, found in parts.items() if name in found)
        parts[whole] = stretches = {n: size for n, size in parts[whole].items() if n != name}
        steps = np.flatnonzero(np.diff(np.concatenate([[0], outside.astype(int), [0]])))
        if not outside.all():
            name = next(names)
            stretches[name] = ink[name] = edge.points[~outside]
        for a, b in steps.reshape(-1, 2):
            ends = (head if a == 0 else node, tail if b == len(outside) else node)
            piece = Edge(edge.points[a:b], ends)
            name = next(names)
            stretches[name] = piece.points
            # a stub that ends freely beside the belt is the belt's own
            if b - a > 1 and (node not in ends or min(ends) >= 0 or piece.length > pen):
                piece.ink = {name: piece.points}
                edges.append(piece)
            else:
                ink[name] = piece.points
    graph.edges = edges
    return ink
