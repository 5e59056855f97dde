"""Small rings: outlines of a few pen widths, such as a pivot's, that other lines run into or across.

Within so small an outline the lines and the ring melt together, and thinning leaves a tangle.  The ring
itself is plain to see, though: paper enclosed by a round belt of ink.  So it is taken first, and what runs
into it on one side and comes out on another is then a crossing, as wide as the ring.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import belt, distances
from sketch.scan.paper.fills import holes
from sketch.scan.quantiles import median
from sketch.scan.skeleton.graph import Edge, Graph, Ink
from sketch.scan.strokes.ways import Way
from sketch.typing import Box, Points

__all__ = ["find_rings", "is_part", "take_rings"]

Belt = tuple[float, Points, float, Points]  # as of `belt`

SMALLEST, LARGEST = 0.9, 4.5  # pen widths: the radius that the pen's middle went along, as in core/belt.c
CHINK = 1.0  # squares of the pen width: a smaller hole is one between lines that cross, for all one can tell
APART = 0.5  # pen widths: rings whose belts are nearer to each other have ink in common
WITHIN = 0.2  # of roundness: what is less round by more than a ring around it, and has some ink of that, is half of it
CHANCE = 10.0  # [rad²] for what a ring that is perfectly round is too good to be chance
ALL_ROUND = 0.7  # of its length: an edge that has so much of the ring is the ring
BLOT = 0.75  # pen widths from the paper: ink that is further from it is a hole that closed, and no line
PEAK = SMALLEST + 0.5  # pen widths from the paper: the middle of the smallest ring whose hole closed
PART = 0.7  # of the box around a ring: what fills less of it is a part of the ring
# Times a line's width, where lines lead to a ring: what is no wider from edge to edge are two lines beside each other,
# with a little paper between them, as where a slow pen closes an outline.
TWO_LINES = 2.4
NEARBY = (
    3.0  # pen widths, beyond a pen's width from a ring, along which the lines that lead there are looked at
)
BELT = 0.7  # pen widths to either side of the pen's middle are the belt's ink


def find_rings(
    mask: NDArray[Any], distance: NDArray[Any], pen: float, edges: Sequence[Edge] = ()
) -> list[Way]:
    """The closed ways of the pen around small round holes [pixels], each shape (n, 2), best first.

    mask: ink 1, paper 0, shape (h, w).  distance: each ink pixel's distance to the paper.  edges: the ink's lines.
    Their ink is not known yet.
    """
    import cv2

    every = holes(mask)
    lines = np.concatenate([np.zeros((0, 2)), *(edge.points for edge in edges)])
    x, y = np.round(lines).astype(int).T
    wide = 2 * distance[y, x]
    chinks = [way for way, area in every if area < CHINK * pen * pen]
    if chinks:
        mask = cv2.drawContours(mask.copy(), chinks, -1, 1, cv2.FILLED)
        distance = distances(mask)
    large = [(way, area) for way, area in every if area >= CHINK * pen * pen]
    found = [ring for seed in _seeds(large, distance, pen) if (ring := belt(mask, seed, pen)) is not None]
    found = [ring for ring in found if not _is_two_lines(ring, lines, wide, pen)]
    # of the smaller there is less to be seen, and what lies between a ring and a line beside it may be round by chance
    found.sort(key=lambda ring: -ring[0] * ring[2] ** 0.5)
    rings: list[Way] = []
    middles, radii = np.zeros((0, 2)), np.zeros(0)
    for ring in found:
        if any(_is_in(other, ring, pen) for other in found):
            continue
        roundness, middle, radius, points = ring
        if np.all(np.hypot(*(middles - middle).T) > radii + radius + APART * pen):
            rings.append(Way(points, {}, -CHANCE * roundness))
            middles, radii = np.concatenate([middles, middle[None]]), np.append(radii, radius)
    return rings


def _is_two_lines(ring: Belt, lines: Points, wide: NDArray[Any], pen: float) -> bool:
    """Whether a ring is no wider than two of the lines that lead there, side by side.

    lines: of all ink, shape (n, 2).  wide: how wide it is there [pixels], shape (n,).
    """
    _, middle, radius, _ = ring
    off = np.hypot(*(lines - middle).T) - radius - pen
    near = (off > 0) & (off < NEARBY * pen)
    return bool(near.any()) and 2 * radius + pen < TWO_LINES * median(wide[near])


def _is_in(ring: Belt, outer: Belt, pen: float) -> bool:
    """Whether a ring within another shows that this is none: it is not only half of it, cut off by a line across."""
    (roundness, middle, radius, _), (its, around, reach, _) = ring, outer
    off = float(np.hypot(*(middle - around)))
    has_own_ink = off + radius + APART * pen < reach
    return reach > radius + pen and off < reach and (has_own_ink or roundness > its - WITHIN)


def is_part(way: Way, rings: list[Points], pen: float) -> bool:
    """Whether a closed way is around a part of a ring only, which a line across it cuts off.

    rings: all there are, each shape (n, 2) [pixels].
    """
    points = way.points
    if not np.array_equal(points[0], points[-1]):
        return False
    low, high = points.min(axis=0), points.max(axis=0)
    boxes = [(ring.min(axis=0), ring.max(axis=0)) for ring in rings]
    return any(
        np.all(low > least - pen)
        and np.all(high < most + pen)
        and (high - low).prod() < PART * (most - least).prod()
        for least, most in boxes
    )


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
    for i, j in _beside(np.array([way[0, 0] for way, _ in small]).reshape(-1, 2), 2 * LARGEST * pen):
        (x, y), radius = cv2.minEnclosingCircle(np.concatenate([small[i][0], small[j][0]]))
        seeds.append((x, y, radius + pen / 2 - 1))
    inside = _grown((distance > BLOT * pen).view(np.uint8), pen / 4)
    cv2.drawContours(inside, [way for way, _ in small], -1, 1, cv2.FILLED)
    for way in cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]:
        box = cv2.boundingRect(way)
        seeds.append(_middle_and_radius(way, np.sqrt((cv2.contourArea(way) + len(way)) / np.pi)))
        seeds.append(_middle_and_radius(way, max(box[2:]) / 2))
        seeds += _peaks(distance, box, pen)
    return [seed for seed in seeds if SMALLEST * pen / 2 <= seed[2] <= LARGEST * pen]


def _peaks(distance: NDArray[Any], box: Sequence[int], pen: float) -> list[tuple[float, float, float]]:
    """Where ink is deepest in a box: a ring whose hole closed, however far the lines go on that run into it.

    box: its left, top, width and height [pixels].
    """
    import cv2

    left, top, width, height = box
    within = distance[top : top + height, left : left + width]
    seeds: list[tuple[float, float, float]] = []
    if within.max() <= PEAK * pen:
        return seeds
    deep = (within > PEAK * pen).view(np.uint8)
    for way in cv2.findContours(deep, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]:
        x, y, width, height = cv2.boundingRect(way)
        _, depth, _, at = cv2.minMaxLoc(within[y : y + height, x : x + width])
        seeds.append((float(left + x + at[0]), float(top + y + at[1]), depth - pen / 2))
    return seeds


def _beside(places: NDArray[Any], apart: float) -> list[tuple[int, int]]:
    """The pairs of some places, (n, 2), that are less than `apart` from each other either way, in order [pixels]."""
    order = np.argsort(places[:, 0], kind="stable")
    ahead = np.searchsorted(places[order, 0], places[order, 0] + apart)
    pairs = []
    for k, end in enumerate(ahead.tolist()):
        others = order[k + 1 : end]
        close = others[np.abs(places[others] - places[order[k]]).max(axis=1, initial=0) < apart]
        pairs += [(min(int(order[k]), j), max(int(order[k]), j)) for j in close.tolist()]
    return sorted(pairs)


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
    stretches = _Stretches(whole, names)
    nodes, radius = graph.nodes, graph.radius
    taken = []
    places = _Places(graph.edges)
    for ring in rings:
        middle = (ring.points.min(axis=0) + ring.points.max(axis=0)) / 2
        reach = float(np.hypot(*(ring.points - middle).T).max()) + BELT * pen
        within = {
            k: np.hypot(*(graph.edges[k].points - middle).T) < reach
            for k in places.near(middle, reach).tolist()
        }
        crossing = [k for k, points in within.items() if points.any()]
        around = float(np.hypot(*np.diff(ring.points, axis=0).T).sum())
        if not crossing:
            continue  # a better ring has it all
        only = within[crossing[0]]
        # other ink may lead to a ring's only line beyond its belt
        alone = len(crossing) == 1 and max(graph.edges[crossing[0]].ends) < 0
        if alone and only.mean() > 0.5 and np.count_nonzero(only) > ALL_ROUND * around:
            continue  # it stands by itself
        ink = _take(graph, middle, reach, pen, stretches, places)
        hidden = round(around) - sum(map(len, ink.values()))
        if hidden > 0:  # thinning leaves less of a blot than was drawn
            ink[next(names)] = ring.points[np.arange(hidden) % len(ring.points)]
        taken.append(replace(ring, ink=ink))
    if not taken:
        return None, []
    near = _reached(
        whole, [edge.ink.keys() != its.keys() for edge, its in zip(whole, stretches.of, strict=True)]
    )
    for edge, its in zip(whole, stretches.of, strict=True):
        edge.ink = its
    return Graph(nodes, radius, [edge for edge, there in zip(whole, near, strict=True) if there]), taken


class _Places:
    """Where a graph's edges are, in their order: on a page of writing few come near a place."""

    def __init__(self, edges: list[Edge]) -> None:
        self._boxes = np.array([_box(edge) for edge in edges]).reshape(-1, 4)
        self._ends = np.array([edge.ends for edge in edges], dtype=np.intp).reshape(-1, 2)

    def near(self, middle: Points, reach: float) -> NDArray[np.intp]:
        """The edges whose boxes come within `reach` of a place [pixels]."""
        return np.flatnonzero(self._comes_near(middle, reach))

    def touched(self, middle: Points, reach: float, inside: NDArray[np.bool_]) -> list[int]:
        """Likewise, and those that end at one of some nodes."""
        # what ends nowhere ends at -1, and what is closed at -2
        ending = np.append(inside, [False, False])[self._ends].any(axis=1)
        found: list[int] = np.flatnonzero(self._comes_near(middle, reach) | ending).tolist()
        return found

    def replace(self, gone: list[int], pieces: list[list[Edge]]) -> None:
        """Put the pieces of some edges in their places."""
        after = [k - 1 for k, cut in zip(gone, pieces, strict=True) for _ in cut]
        new = [edge for cut in pieces for edge in cut]
        left = np.delete(np.arange(len(self._boxes)), gone)
        order = np.argsort(np.concatenate([left, np.array(after) + 0.5]), kind="stable")
        boxes = np.array([_box(edge) for edge in new]).reshape(-1, 4)
        ends = np.array([edge.ends for edge in new], dtype=np.intp).reshape(-1, 2)
        self._boxes = np.concatenate([self._boxes[left], boxes])[order]
        self._ends = np.concatenate([self._ends[left], ends])[order]

    def _comes_near(self, middle: Points, reach: float) -> NDArray[np.bool_]:
        least, most = self._boxes[:, :2] - reach, self._boxes[:, 2:] + reach
        return np.asarray(((least < middle) & (middle < most)).all(axis=1))


def _box(edge: Edge) -> Box:
    (left, top), (right, bottom) = edge.points.min(axis=0).tolist(), edge.points.max(axis=0).tolist()
    return left, top, right, bottom


def _reached(edges: list[Edge], touched: list[bool]) -> list[bool]:
    """Which edges hang together with those touched."""
    reached: set[int] = set()
    more = {end for edge, here in zip(edges, touched, strict=True) if here for end in edge.ends if end >= 0}
    while not more <= reached:
        reached |= more
        more = {end for edge in edges if not reached.isdisjoint(edge.ends) for end in edge.ends if end >= 0}
    return [here or not reached.isdisjoint(edge.ends) for edge, here in zip(edges, touched, strict=True)]


def _take(
    graph: Graph, middle: Points, reach: float, pen: float, stretches: _Stretches, places: _Places
) -> Ink:
    """Cut a ring out of the graph, in place; returns its ink. places: of the graph's edges."""
    inside = np.hypot(*(graph.nodes - middle).T) < reach
    touched = places.touched(middle, reach, inside)
    node = len(graph.nodes)
    graph.nodes = np.concatenate([graph.nodes, middle[None]])
    graph.radius = np.append(graph.radius, reach)
    ink: Ink = {}
    pieces: list[list[Edge]] = []
    for edge in map(graph.edges.__getitem__, touched):
        outside = np.hypot(*(edge.points - middle).T) >= reach
        head, tail = (node if end >= 0 and inside[end] else end for end in edge.ends)
        if outside.all() and (head, tail) == edge.ends:
            pieces.append([edge])
        else:
            left, its = _cut(edge, outside, (head, tail), node, pen, stretches)
            pieces.append(left)
            ink |= its
    places.replace(touched, pieces)
    edges, passed = list[Edge](), 0
    for k, cut in zip(touched, pieces, strict=True):
        edges += [*graph.edges[passed:k], *cut]
        passed = k + 1
    graph.edges = edges + graph.edges[passed:]
    return ink


def _cut(
    edge: Edge,
    outside: NDArray[np.bool_],
    ends: tuple[int, int],
    node: int,
    pen: float,
    stretches: _Stretches,
) -> tuple[list[Edge], Ink]:
    """What is left of an edge outside a ring, and the ring's ink that was the edge's.

    outside: which of its points are.  ends: of the whole edge, now.  node: the ring's.
    """
    (name,) = edge.ink
    whole = stretches.drop(name)
    left, ink = list[Edge](), Ink()
    if not outside.all():
        within = edge.points[~outside]
        ink[stretches.add(whole, within)] = within
    steps = np.flatnonzero(np.diff(np.concatenate([[0], outside.astype(int), [0]])))
    for a, b in steps.reshape(-1, 2):
        piece = Edge(edge.points[a:b], (ends[0] if a == 0 else node, ends[1] if b == len(outside) else node))
        name = stretches.add(whole, piece.points)
        # a stub that ends freely beside the belt is the belt's own
        if b - a > 1 and (node not in piece.ends or min(piece.ends) >= 0 or piece.length > pen):
            piece.ink = {name: piece.points}
            left.append(piece)
        else:
            ink[name] = piece.points
    return left, ink


class _Stretches:
    """The stretches of ink that whole edges are cut into, ring by ring.

    Attributes:
        of: each whole edge's, by name.
    """

    def __init__(self, edges: list[Edge], names: Iterator[int]) -> None:
        """edges: they get names for their ink, where they have none.  names: those that are left."""
        for edge in edges:
            if not edge.ink:
                edge.ink = {next(names): edge.points}
        self.of = [edge.ink for edge in edges]
        self._names = names
        self._edge = {name: k for k, ink in enumerate(self.of) for name in ink}

    def drop(self, name: int) -> int:
        """Forget a stretch that is cut; returns the whole edge that it is of."""
        edge = self._edge[name]
        self.of[edge] = {n: points for n, points in self.of[edge].items() if n != name}
        return edge

    def add(self, edge: int, points: Points) -> int:
        """A new stretch of a whole edge; returns its name."""
        name = next(self._names)
        self._edge[name] = edge
        self.of[edge][name] = points
        return name
