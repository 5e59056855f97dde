"""Which pieces of ink may belong together: chains that close, bars that cross, shafts with heads.

Only what lies close together is proposed; whether it means anything is for the fits and their costs to say.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Set
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sketch.outlines import Chain
from sketch.pieces import Page, Piece, Point

__all__ = ["arrow_groups", "closing_chains", "crosses"]

MOST_PARTS = 6  # of one outline: people draw a box in one to five strokes
LOOSE = 0.3  # gaps of a chain, as a share of its ink, overshoots counted as gaps
MOST_STEPS = 400  # from one piece, of chains that may close
MOST_CROSSED = 12  # bars that one bar may make an X with, the nearest in length: in shading each lies on all
MOST_CHAINS = 6  # a piece on the page that are fitted, the tightest first
CHOICES = 6  # ends that a chain may go on to
HEADS = 4  # strokes near a shaft's end that are tried as its head


def closing_chains(page: Page, complete: Set[int]) -> list[Chain]:
    """Orders of pieces whose ends meet around, each set of pieces in its tightest order.

    complete: pieces that close by themselves and need no others.
    """
    pieces = page.pieces
    loose = [p for p in pieces if p.index not in complete]
    near = _near_ends(page, loose)
    best: dict[tuple[int, ...], tuple[float, Chain]] = {(i,): (0.0, [(i, False)]) for i in sorted(complete)}

    steps = 0  # from one piece: in shading every end has many others near it

    def extend(chain: Chain, gaps: float, ink: float) -> None:
        nonlocal steps
        steps += 1
        if steps > MOST_STEPS:
            return
        first = chain[0][0]
        last, reverse = chain[-1]
        out = 0 if reverse else 1
        closing = math.dist(pieces[last].ends[out], pieces[first].ends[0])
        if gaps + closing <= LOOSE * ink:
            key = tuple(sorted(i for i, _ in chain))
            if key not in best or gaps + closing < best[key][0]:
                best[key] = (gaps + closing, list(chain))
        if len(chain) == MOST_PARTS:
            return
        for d, j, e in near.get((last, out), ()):
            if j > first and all(j != i for i, _ in chain) and page.apart(j, (i for i, _ in chain)):
                longer = ink + pieces[j].length
                if gaps + d <= LOOSE * 2 * longer:
                    extend([*chain, (j, e == 1)], gaps + d, longer)

    for p in loose:
        steps = 0
        extend([(p.index, False)], 0.0, p.length)
    tightest = sorted(best.items(), key=lambda t: t[1][0] / sum(pieces[i].length for i in t[0]))
    return [chain for _, (_, chain) in tightest[: MOST_CHAINS * len(pieces)]]


def _near_ends(page: Page, loose: list[Piece]) -> dict[tuple[int, int], list[tuple[float, int, int]]]:
    """For each end (piece, 0 or 1), the ends of other pieces close enough to go on to: distance, piece,
    end."""
    out: dict[tuple[int, int], list[tuple[float, int, int]]] = {}
    if len(loose) < 2:
        return out
    at = np.array([p.ends for p in loose]).reshape(-1, 2)
    length = np.repeat([p.length for p in loose], 2)
    # swept in the order of x: only ends that a chain's longest gap can bridge are compared
    order = np.argsort(at[:, 0], kind="stable")
    x = at[order, 0]
    reach = 1.5 * LOOSE * (length[order] + length.max())
    stop = np.searchsorted(x, x + reach, side="right")
    for a, (i, last) in enumerate(zip(order.tolist(), stop.tolist(), strict=True)):
        others = order[a + 1 : last]
        d = np.hypot(at[others, 0] - at[i, 0], at[others, 1] - at[i, 1])
        close = np.flatnonzero((d <= 1.5 * LOOSE * (length[others] + length[i])) & (others // 2 != i // 2))
        for j, gap in zip(others[close].tolist(), d[close].tolist(), strict=True):
            p, q = (loose[i // 2].index, i % 2), (loose[j // 2].index, j % 2)
            if not page.apart(p[0], q[:1]):
                continue
            out.setdefault(p, []).append((gap, *q))
            out.setdefault(q, []).append((gap, *p))
    return {end: sorted(found)[:CHOICES] for end, found in out.items()}


def crosses(page: Page, complete: Set[int] = frozenset()) -> Iterator[tuple[int, ...]]:
    """Strokes that may be an X by themselves, and pairs that overlap: of bars, or of a bar and one with hooks."""
    for p in page.pieces:
        if 1.6 * p.extent < p.length < 5 * p.extent and p.index not in complete:
            yield (p.index,)
    bars = [p for p in page.pieces if p.length < 3 * p.extent]
    bars.sort(key=lambda p: p.box[0])
    crossing: dict[int, list[tuple[float, tuple[int, int]]]] = {p.index: [] for p in bars}
    pairs = []
    for a, p in enumerate(bars):
        for q in bars[a + 1 :]:
            if q.box[0] > p.box[2]:
                break
            if not page.apart(p.index, (q.index,)):
                continue
            if not (_is_bar(p) or _is_bar(q)) or max(p.extent, q.extent) > 3 * min(p.extent, q.extent):
                continue
            if p.box[1] <= q.box[3] and q.box[1] <= p.box[3]:
                pair = (p.index, q.index) if p.index < q.index else (q.index, p.index)
                unlike = abs(math.log(max(p.extent, 1e-9) / max(q.extent, 1e-9)))
                crossing[p.index].append((unlike, pair))
                crossing[q.index].append((unlike, pair))
                pairs.append(pair)
    alike = {pair for found in crossing.values() for _, pair in sorted(found)[:MOST_CROSSED]}
    yield from (pair for pair in pairs if pair in alike)


def _is_bar(p: Piece) -> bool:
    return p.length < 1.6 * p.extent and p.straight < 0.12


def arrow_groups(
    page: Page, complete: Set[int] = frozenset()
) -> Iterator[tuple[tuple[int, ...], Point, Point]]:
    """Pieces that may make an arrow, with the shaft's tail and a point toward its tip."""
    boxes = np.array([p.box for p in page.pieces])
    for p in page.pieces:
        if p.index in complete:
            continue
        if p.length > 1.3 * p.extent:
            for k in (3, 4, 5):
                v = p.vertices[k]
                yield (p.index,), _point(v[0]), _point(v[1])
                yield (p.index,), _point(v[k]), _point(v[k - 1])
        if p.length > 2.5 * p.extent:
            continue
        if p.straight > 0.06:  # the shaft and one barb in one stroke
            v = p.vertices[2]
            for tail, tip in ((v[0], v[1]), (v[2], v[1])):
                for j in _heads(page, boxes, p, _point(tip)):
                    yield (p.index, j), _point(tail), _point(tip)
            continue
        for tail_end, tip_end in (p.ends, p.ends[::-1]):
            heads = _heads(page, boxes, p, tip_end)
            for size in (1, 2):
                for group in combinations(heads, size):
                    if not page.apart(group[0], group[1:]):
                        continue
                    yield (p.index, *group), tail_end, tip_end


def _point(v: list[float]) -> Point:
    return v[0], v[1]


def _heads(page: Page, boxes: NDArray[np.float64], shaft: Piece, tip: Point) -> list[int]:
    """The pieces nearest to a shaft's tip that are small enough to be its head."""
    reach = 0.5 * shaft.length
    x, y = tip
    near = (
        (boxes[:, 0] - reach <= x)
        & (boxes[:, 1] - reach <= y)
        & (boxes[:, 2] + reach >= x)
        & (boxes[:, 3] + reach >= y)
    )
    found = []
    for j in np.flatnonzero(near).tolist():
        q = page.pieces[j]
        if j == shaft.index or not page.apart(j, (shaft.index,)) or q.extent > 2 * shaft.length:
            continue
        d = np.hypot(q.points[:, 0] - x, q.points[:, 1] - y)
        closest = float(d.min())
        if closest < reach and float(d.max()) < 1.2 * shaft.length:
            found.append((closest, j))
    return [j for _, j in sorted(found)[:HEADS]]
