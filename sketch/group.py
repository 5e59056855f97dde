"""Which pieces of ink may belong together: chains that close, bars that cross, shafts with heads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sketch.pieces import Piece

__all__ = ["arrow_groups", "closing_chains", "crossing_pairs"]

MOST_PARTS = 6  # of one outline
LOOSE = 0.3  # gaps of a chain, as a share of its ink


def closing_chains(pieces: list[Piece], complete: set[int]) -> list[list[tuple[int, bool]]]:
    """Orders of pieces (index, reversed) whose ends meet around, each set of pieces in its tightest order.

    complete: pieces that close by themselves and need no others.
    """
    best: dict[tuple[int, ...], tuple[float, list[tuple[int, bool]]]] = {}
    loose = [i for i in range(len(pieces)) if i not in complete]
    ends = {(i, e): pieces[i].ends[e] for i in loose for e in (0, 1)}
    near: dict[tuple[int, int], list[tuple[float, int, int]]] = {key: [] for key in ends}
    for i, j in combinations(loose, 2):
        limit = LOOSE * (pieces[i].length + pieces[j].length) * 1.5
        for e in (0, 1):
            for f in (0, 1):
                d = math.dist(ends[i, e], ends[j, f])
                if d <= limit:
                    near[i, e].append((d, j, f))
                    near[j, f].append((d, i, e))

    def extend(chain: list[tuple[int, bool]], gaps: float, ink: float) -> None:
        first, back = chain[0]
        last, reverse = chain[-1]
        out = (last, 0 if reverse else 1)
        closing = math.dist(ends[out], ends[first, 1 if back else 0])
        if gaps + closing <= LOOSE * ink:
            key = tuple(sorted(i for i, _ in chain))
            if key not in best or gaps + closing < best[key][0]:
                best[key] = (gaps + closing, list(chain))
        if len(chain) == MOST_PARTS:
            return
        used = {i for i, _ in chain}
        for d, j, f in near[out]:
            if j > first and j not in used and gaps + d <= LOOSE * 2 * (ink + pieces[j].length):
                extend([*chain, (j, f == 1)], gaps + d, ink + pieces[j].length)

    for i in loose:
        extend([(i, False)], 0.0, pieces[i].length)
    for i in complete:
        best[(i,)] = (0.0, [(i, False)])
    return [chain for _, chain in best.values()]


def crossing_pairs(pieces: list[Piece]) -> Iterator[tuple[int, ...]]:
    for i, p in enumerate(pieces):
        if p.length > 1.5 * p.extent:
            yield (i,)
    bars = [i for i, p in enumerate(pieces) if p.straight < 0.12 and p.length < 1.5 * p.extent]
    for i, j in combinations(bars, 2):
        a, b = pieces[i].box, pieces[j].box
        if a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]:
            yield i, j


def arrow_groups(pieces: list[Piece]) -> Iterator[tuple[tuple[int, ...], np.ndarray, np.ndarray]]:
    """Pieces that may make an arrow, with the shaft's tail and a point toward its tip."""
    for i, p in enumerate(pieces):
        for k in (3, 4, 5, 6):
            v = p.fit.vertices(k)
            yield (i,), v[0], v[1]
            yield (i,), v[-1], v[-2]
        if p.straight > 0.06:
            # a shaft and one barb, or a shaft and a hook, in one stroke
            v = p.fit.vertices(2)
            for tail, tip in ((v[0], v[1]), (v[2], v[1])):
                for j in _heads(pieces, i, tip, p.length):
                    yield (i, j), tail, tip
            continue
        for tail, tip in (p.ends, p.ends[::-1]):
            heads = _heads(pieces, i, tip, p.length)
            for size in (1, 2):
                for group in combinations(heads, size):
                    yield (i, *group), np.array(tail), np.array(tip)


def _heads(pieces: list[Piece], shaft: int, tip, length: float) -> list[int]:
    out = []
    for j, q in enumerate(pieces):
        if j == shaft or q.extent > 2 * length:
            continue
        x0, y0, x1, y1 = q.box
        reach = 0.5 * length
        if x0 - reach <= tip[0] <= x1 + reach and y0 - reach <= tip[1] <= y1 + reach:
            d = np.hypot(*(q.points - np.asarray(tip)).T)
            if d.min() < reach and d.max() < 1.2 * length:
                out.append(j)
    return out
