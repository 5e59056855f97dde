"""Outlines from the paper that they enclose, where bodies overlap at a pivot.

Where bodies overlap, their lines cut the paper into faces, and each body is some of these together.  Planks end to
end, or rods that lie nearly in one line, leave no junction at which the pen's way could be seen: their lines run into
each other, and what is ink of one of them may be ink of both.  Their faces are plain, though, and most bodies are
convex, while most unions of faces are not.  So of the convex unions those few are sought that have all the lines
for their outlines and share as little as can be: that two outlines run along each other for long is a coincidence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sketch.scan.skeleton.stretches import Stretches
from sketch.scan.strokes.subdivision import Outline, Subdivision
from sketch.scan.strokes.ways import Way
from sketch.typing import Points

__all__ = ["overlapping"]

SOLID = 0.9  # of its hull's area: what a convex outline drawn by hand has at least
WITHOUT_SMALL = 0.8  # of that: what it has at least without the small faces in it
MOST_FACES = 24  # that hang together: more are a grid, or shading
MOST_UNIONS = 100  # that are looked at, from each face
MOST_BODIES = 60  # of those that are convex, the likeliest
ROWS = 32  # of a product of matrices at a time
BODY = 20.0  # nats to say one more body
LEFT = 25.0  # nats to leave a line over
SHARED = 60.0  # nats that two outlines are rarer which are the same in full; in part, a part of that
DENTED = 100.0  # nats that an outline is rarer which takes nothing of its hull's area; some, a part of that
PIVOT = 15.0  # nats that a ring is likelier over two bodies than elsewhere
STRAIN = 6.0  # nats for each square radian of strain, as in `sketch.scan.strokes.settle`


@dataclass(frozen=True, eq=False)
class _Body:
    """A convex union of faces that count: the way around it, and its cost by itself [nats]."""

    outline: Outline
    faces: frozenset[int]
    cost: float


def overlapping(plane: Subdivision, rings: list[Points], stretches: Stretches) -> list[Way]:
    """The outlines that a plane's knots under a ring are best made of, each with its share of the ink and with all.

    rings: where pivots may be [pixels].  stretches: of all the ink.
    """
    out: list[Way] = []
    for knot in _knots(plane, rings) if rings else ():
        bodies = sorted(_unions(plane, knot), key=lambda body: body.cost)[:MOST_BODIES]
        chosen = _fewest(bodies, plane.length, knot.pivots) if len(bodies) > 1 else []
        if len(chosen) > 1:
            some = [bodies[k] for k in chosen]
            out += _ways([body.outline for body in some], _grounds(plane, some, stretches), stretches)
    return out


def _grounds(plane: Subdivision, bodies: list[_Body], stretches: Stretches) -> list[frozenset[int]]:
    """For each of some bodies the ink along what it stands on: faces beside it and beside those that overlap it."""
    out = []
    for body in bodies:
        over = (other.faces for other in bodies if not other.faces.isdisjoint(body.faces))
        beside = set[int]().union(*(plane.neighbours[f] for f in body.faces)).difference(*over)
        grounds = (plane.outline({f}) for f in beside if not plane.is_thin(plane.faces[f]))
        out.append(frozenset[int]().union(*(stretches.beside(ground.points) for ground in grounds)))
    return out


@dataclass(eq=False)
class _Knot:
    """Faces that hang together: those that count, the small ones among them, and in which of them a ring lies."""

    faces: list[int]
    small: list[int]
    pivots: list[int]


def _knots(plane: Subdivision, rings: list[Points]) -> Iterator[_Knot]:
    """The faces that hang together where a ring lies in one of several."""
    middles = [ring[:-1].mean(axis=0) for ring in rings]
    done: set[int] = set()
    for start in plane.faces:
        if start in done:
            continue
        group = [start]
        done.add(start)
        for f in group:
            group += plane.neighbours[f] - done
            done |= plane.neighbours[f]
        small = [f for f in group if plane.is_thin(plane.faces[f])]
        faces = [f for f in group if f not in small]
        if not 3 <= len(faces) <= MOST_FACES:
            continue
        pivots = set()
        for middle in middles:
            holding = [f for f in faces if plane.faces[f].holds(middle)]
            pivots.update([min(holding, key=lambda f: plane.faces[f].area)] if holding else [])
        if pivots:
            yield _Knot(faces, small, sorted(pivots))


def _unions(plane: Subdivision, knot: _Knot) -> list[_Body]:
    """The connected sets of faces that are convex together, with the small ones in them."""
    import cv2

    beside = {f: _about(plane, f, knot) for f in knot.faces}
    hulls = {f: cv2.convexHull(np.concatenate(plane.faces[f].loops)) for f in knot.faces}
    small = [(f, plane.faces[f].loops[0].mean(axis=0).tolist()) for f in knot.small]
    best: dict[frozenset[int], _Body] = {}
    for some in _connected(beside):
        if len(some) == 1 and not some.isdisjoint(knot.pivots):
            continue  # what is under a pivot alone is no body
        hull = cv2.convexHull(np.concatenate([hulls[f] for f in some]))
        whole = cv2.contourArea(hull)
        if sum(plane.faces[f].area for f in some) < WITHOUT_SMALL * SOLID * whole:
            continue
        within = [f for f, at in small if cv2.pointPolygonTest(hull, (at[0], at[1]), measureDist=False) >= 0]
        solid = sum(plane.faces[f].area for f in [*some, *within]) / whole
        if solid > SOLID:
            outline = plane.outline(some.union(within))
            body = _Body(outline, some, BODY + DENTED * (1 - solid) + STRAIN * outline.strain)
            if body.cost <= best.get(outline.lines, body).cost:
                best[outline.lines] = body
    return list(best.values())


def _about(plane: Subdivision, face: int, knot: _Knot) -> set[int]:
    """The faces that count beside a face, or with small ones between."""
    small, reached = set(knot.small), {face}
    queue = [face]
    for f in queue:
        for n in plane.neighbours[f] - reached:
            reached.add(n)
            if n in small:
                queue.append(n)
    return reached - small - {face}


def _connected(beside: dict[int, set[int]]) -> Iterator[frozenset[int]]:
    """The connected sets of faces, each once. beside: of each face those next to it."""
    for first in sorted(beside):
        queue = [frozenset([first])]
        seen = set(queue)
        for some in queue:
            yield some
            for f in sorted({n for m in some for n in beside[m] if n > first} - some):
                larger = some | {f}
                if larger not in seen and len(queue) < MOST_UNIONS:
                    seen.add(larger)
                    queue.append(larger)


def _fewest(bodies: list[_Body], length: dict[int, float], pivots: list[int]) -> list[int]:
    """The cheapest set of bodies for all the lines that any of them has.

    It is come to from none by taking up to two bodies out and up to two others in, until none is cheaper.  length: of
    each line [pixels].  pivots: the faces over which two bodies are likely.
    """
    lines = sorted({e for body in bodies for e in body.outline.lines})
    has = np.array([[e in body.outline.lines for e in lines] for body in bodies], dtype=float)
    over = np.array([[f in body.faces for f in pivots] for body in bodies], dtype=float)
    both = _product(has * [length[e] for e in lines], has.T)
    least = np.minimum.outer(np.diag(both), np.diag(both))
    cost = SHARED * both / np.maximum(least, 1e-9)
    np.fill_diagonal(cost, 0.0)
    each = np.array([body.cost for body in bodies])

    def saved(mask: NDArray[np.float64], of: NDArray[np.float64]) -> NDArray[np.float64]:
        """For each pair of bodies how many of the columns of `mask` either has."""
        one = of @ mask
        return np.asarray(one[:, None] + one - _product(of * mask, of.T))

    chosen: list[int] = []
    best = np.inf
    while True:
        found = None
        for out in [(), *combinations(chosen, 1), *combinations(chosen, 2)]:
            kept = [k for k in chosen if k not in out]
            open_lines = (has[kept].sum(axis=0) == 0).astype(float)
            held = over[kept].sum(axis=0)
            more = each + cost[:, kept].sum(axis=1)
            total = more[:, None] + more + cost - LEFT * saved(open_lines, has)
            total -= PIVOT * (saved((held == 1).astype(float), over) + (over * (held == 0)) @ over.T)
            # one body with itself is that body alone
            one = more - LEFT * (has @ open_lines) - PIVOT * (over @ (held == 1))
            np.fill_diagonal(total, one)
            base = each[kept].sum() + cost[np.ix_(kept, kept)].sum() / 2
            base += LEFT * open_lines.sum() - PIVOT * np.count_nonzero(held > 1)
            total[kept], total[:, kept] = np.inf, np.inf
            a, b = divmod(int(total.argmin()), len(bodies))
            for value, new in ((base, kept), (base + total[a, b], [*kept, *{a, b}])):
                if value < best - 1e-6:
                    best, found = value, new
        if found is None:
            return chosen
        chosen = found


def _product(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """a @ b, a few rows at a time: larger products are shared among threads, which takes longer than they do."""
    return np.concatenate([a[k : k + ROWS] @ b for k in range(0, len(a), ROWS)])


def _ways(outlines: list[Outline], grounds: list[frozenset[int]], stretches: Stretches) -> list[Way]:
    """Ways along the outlines of bodies that overlap: each with its share of the ink, and with all of it, and both
    without the ink of what it stands on."""
    near = [stretches.beside(outline.points) for outline in outlines]
    mine: list[list[int]] = [[] for _ in outlines]
    had = [0.0 for _ in outlines]
    around = [float(np.hypot(*np.diff(o.points, axis=0).T).sum()) for o in outlines]
    ink = stretches.ink
    wanted = {name: [k for k, its in enumerate(near) if name in its] for name in ink}
    for name, holders in sorted(wanted.items(), key=lambda item: (len(item[1]), -len(ink[item[0]]))):
        if holders:
            k = min(holders, key=lambda k: had[k] / around[k])
            mine[k].append(name)
            had[k] += len(ink[name])
    return [
        Way(outline.points, {name: ink[name] for name in sorted(names)}, outline.strain)
        for outline, along, own, ground in zip(outlines, near, map(frozenset, mine), grounds, strict=True)
        for names in dict.fromkeys((along, own, along - ground, own - ground))
        if names
    ]
