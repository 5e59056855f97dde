"""Bodies that stand on one another: the outlines of single pieces of paper.

Where bodies touch, the ink of one's side is the other's side too, and no pairing of branches gives both an outline.
But each encloses its own piece of paper.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sketch.scan.skeleton.stretches import Stretches
from sketch.scan.strokes.subdivision import Subdivision
from sketch.scan.strokes.ways import Way

__all__ = ["standing"]

MOST_SIDES = 24  # edges of a face that is looked at
MOST_FACES = 80  # of a page: more are a net, or shading
CUT = 5.0  # [rad²] of strain: where lines cross at two corners or more, what they enclose is no body
SMALLEST = 4.0  # pen widths: a face whose area is no square of that is a gap between lines


def standing(planes: list[Subdivision], stretches: Stretches) -> list[Way]:
    """The outlines of pieces of paper that have lines in common, each with all its ink, and without sides of others.

    planes: of one drawing, with its gaps, then without.  stretches: of all its ink.
    """
    found: dict[frozenset[int], Way] = {}
    for plane in planes:
        for way in _standing(plane, stretches):
            found.setdefault(frozenset(way.ink), way)
    return list(found.values())


def with_all_ink(ways: list[Way], stretches: Stretches) -> list[Way]:
    """Some ways, and each closed one that runs along other ink also with all of that."""
    out = list(ways)
    for way in ways:
        if len(way.points) > 3 and np.array_equal(way.points[0], way.points[-1]):
            more = sorted(stretches.beside(way.points) - way.ink.keys())
            if more:
                out.append(replace(way, ink={**way.ink, **{name: stretches.ink[name] for name in more}}))
    return out


def _standing(plane: Subdivision, stretches: Stretches) -> list[Way]:
    least = (SMALLEST * plane.pen) ** 2
    found = [
        f
        for f, face in plane.faces.items()
        if face.area > least and len(face.sides) <= MOST_SIDES and plane.neighbours[f]
    ]
    if len(found) > MOST_FACES:
        return []
    outlines = [outline for f in found if (outline := plane.outline({f})).strain < CUT]
    near = [stretches.beside(outline.points) for outline in outlines]
    cut = frozenset[int]().union(*(edges for outline in outlines for edges in outline.cut))
    names = {e: stretches.at(plane.middle(e)) for e in cut}
    out = []
    for k, outline in enumerate(outlines):
        for lent in _lent(near, k):
            strain = outline.strain_without({e for e, name in names.items() if name in lent})
            ink = {name: stretches.ink[name] for name in sorted(near[k] - lent)}
            out.append(Way(outline.points, ink, strain))
    return out


def _lent(near: list[frozenset[int]], k: int) -> list[frozenset[int]]:
    """Which ink beside an outline may be others': none, each neighbour's, all the earlier ones', all the later ones',
    all neighbours'.

    None where it has nothing in common with another.
    """
    sides = [(n, near[k] & other) for n, other in enumerate(near) if n != k and near[k] & other]
    lent = [frozenset[int](), *(side for _, side in sides)]
    lent.append(frozenset().union(*(side for n, side in sides if n < k)))
    lent.append(frozenset().union(*(side for n, side in sides if n > k)))
    lent.append(frozenset().union(*(side for _, side in sides)))
    return [side for side in dict.fromkeys(lent) if side < near[k]] if sides else []
