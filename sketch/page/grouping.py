"""Which pieces of ink may belong together: chains that close, bars that cross, shafts with heads.

Only what lies close together is proposed; whether it means anything is for the fits and their costs to say.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sketch.kernel import Shaft, lent
from sketch.page.loose import Chain
from sketch.page.pieces import Page, Piece
from sketch.scoring import Fitted
from sketch.typing import Array, Point

__all__ = ["WIDE", "closing_chains", "closing_ink", "crosses", "crossing", "in_line", "shafts"]

MOST_CROSSED = 12  # bars that one bar may make an X with, the nearest in length: in shading each lies on all
MOST_IN_LINE = 6  # parts of one straight line with it, those nearest to that
MOST_OVER = 6  # bars that may make an X with one in two strokes, likewise
MOST_CHAINS = 16  # chains from one piece that are fitted, the tightest first
MOST_OPEN = 5  # likewise, of chains with wide gaps, which are many in a tangle
WIDE = 0.1  # of a chain's ink: gaps that are wide
PART = 0.015  # of a chain's ink: gaps that a further part is worth, as it is one of several that lie near
REFLEX = 0.06  # likewise for each rad that it turns back; as in core/chains.c
ENDS_ON = 0.08  # of a piece's length: as near as its ends are to the ink that they are drawn up to; as in core/lend.c
LACKS = 0.2  # of what a way of several pieces lacks: likewise
BENT = 1.4  # of the distance of its ends: an open piece that is shorter encloses nothing
FINE = 8  # steps from end to end: ways over other ink that are no further apart are one; as in core/lend.c
AS_WIDE = 1.3  # times the extent of a piece is as far apart as what ends on it with both ends
# length over extent: of a bar, of a bar with hooks, and of a stroke that is an X by itself
BAR, HOOKED, X = 1.6, 3.0, 5.0
BOWED = 0.12  # of its length, what a bar of an X bends
UNLIKE = 3.0  # times that one bar of an X is as large as the other
WHOLE, BARBED = 1.3, 2.5  # length over extent: of an arrow in one stroke, of a shaft with one barb
CORNERED = 0.06  # of its length, what a shaft bends that has a barb
STRAIGHT = 0.03  # of its length, what a stroke bends that may be one part of a straight line
ALIKE = 0.2  # tangent of the angle between two parts of such a line, at most
BESIDE = 0.1  # of its length: as near as another part of such a line is
HEAD_REACH = 0.5  # of a shaft: as near to its tip as a stroke of the head comes
HEAD_SPAN = 1.2  # of a shaft: as far from its tip as a stroke of the head goes
HEAD_SIZE = 2.0  # shafts: a stroke of the head is no longer


def closing_chains(page: Page, start: int) -> list[tuple[float, Chain]]:
    """Orders of pieces whose ends meet around, of which `start` is the first drawn, each set of pieces in its
    tightest order, the tightest first: its gaps, as a share of its ink, and the order."""
    tightest = sorted(page.chains(start), key=lambda t: t[0] / t[1] + REFLEX * t[2] + PART * len(t[3]))
    close = sum(gaps / ink + REFLEX * back <= WIDE for gaps, ink, back, _ in tightest)
    wide = MOST_CHAINS if page.rivals else MOST_OPEN
    return [(gaps / ink, chain) for gaps, ink, _, chain in tightest[: min(max(close, wide), MOST_CHAINS)]]


def closing_ink(page: Page, p: Piece) -> Iterator[tuple[Chain, int, Array]]:
    """Ways with a piece at one end that end on another piece with both ends: the way, that piece, and its ink between
    these: a side that is shared."""
    for way in ([(p.index, False)], *page.open_ways(p.index)):
        for j, ink in _side_between(page, way):
            yield way, j, ink


def _side_between(page: Page, way: Chain) -> Iterator[tuple[int, Array]]:
    (first, back), (last, again) = way[0], way[-1]
    a, b = page.pieces[first].ends[back], page.pieces[last].ends[not again]
    gap, length, names = math.dist(a, b), sum(page.pieces[i].length for i, _ in way), [i for i, _ in way]
    if length < BENT * gap or not gap:
        return
    # of several strokes each may go on elsewhere
    reach = ENDS_ON * length if len(way) == 1 else min(ENDS_ON * length, LACKS * gap)
    ends, known = np.array([a, b]), list[Array]()
    for q in page.reaching(a, b, reach):
        if q.index in names or AS_WIDE * q.extent < gap or not page.apart(q.index, names):
            continue
        found = lent(page.strokes, q.stroke, q.points, ends, reach, several=len(way) > 1)
        if found is None:
            continue
        side, step = found
        count = len(side) - 1
        places = side[[count // 4, count // 2, 3 * count // 4]]
        if all(np.hypot(*(places - others).T).max() > gap / FINE + step for others in known):
            known.append(places)
            yield q.index, side


def crosses(page: Page, p: Piece) -> Iterator[tuple[int, ...]]:
    """A stroke that may be an X by itself, and its pairs with later ones that overlap: of bars, or of a bar
    and one with hooks."""
    if BAR * p.extent < p.length < X * p.extent:
        yield (p.index,)
    if p.length >= HOOKED * p.extent:
        return
    bar, found = _is_bar(p), []
    for q in page.touching(*p.box):
        if (
            q is p
            or q.length >= HOOKED * q.extent
            or not (bar or _is_bar(q))
            or not page.apart(p.index, (q.index,))
        ):
            continue
        if max(p.extent, q.extent) <= UNLIKE * min(p.extent, q.extent):
            found.append((abs(math.log(max(p.extent, 1e-9) / max(q.extent, 1e-9))), q.index))
    for _, j in sorted(found)[:MOST_CROSSED]:
        if j > p.index:
            yield (p.index, j)


def crossing(page: Page, bar: Fitted) -> list[Piece]:
    """Strokes of other ink that may make an X with a straight bar, given as its reading."""
    (ax, ay), (bx, by) = bar.outline.tolist()
    long, found = math.hypot(bx - ax, by - ay), []
    for q in page.touching(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)):
        unlike = max(q.length, long) / min(q.length, long)
        if unlike <= UNLIKE and q.index not in bar.pieces and _is_bar(q) and page.apart(q.index, bar.pieces):
            found.append((unlike, q))
    return _first(found, MOST_OVER)


def in_line(page: Page, p: Piece) -> list[Piece]:
    """Later strokes that go on with a straight one, or over it again: as straight, and nearly the same way."""
    if not _is_line(p):
        return []
    (ax, ay), (bx, by) = p.reach
    x0, y0, x1, y1 = p.box
    reach, found = BESIDE * p.length, []
    for q in page.touching(x0 - reach, y0 - reach, x1 + reach, y1 + reach):
        if q.index > p.index and _is_line(q) and page.apart(p.index, (q.index,)):
            (cx, cy), (dx, dy) = q.reach
            across, along = (
                (bx - ax) * (dy - cy) - (by - ay) * (dx - cx),
                (bx - ax) * (dx - cx) + (by - ay) * (dy - cy),
            )
            if abs(across) < ALIKE * abs(along):
                middle = (ax - (cx + dx) / 2) * (by - ay) - (ay - (cy + dy) / 2) * (bx - ax)
                found.append((abs(middle), q))
    return _first(found, MOST_IN_LINE)


def _first(found: list[tuple[float, Piece]], most: int) -> list[Piece]:
    """Of pieces with a number those with the least, in the order of drawing."""
    if len(found) > most:
        found = sorted(sorted(found, key=lambda t: t[0])[:most], key=lambda t: t[1].index)
    return [q for _, q in found]


def _is_line(p: Piece) -> bool:
    """Whether a stroke goes straight, and perhaps over itself again."""
    return p.retraces or (_is_bar(p) and p.straight < STRAIGHT)


def _is_bar(p: Piece) -> bool:
    return p.length < BAR * p.extent and p.straight < BOWED


def shafts(page: Page, p: Piece) -> Iterator[Shaft]:
    """A piece as an arrow's shaft, with others that may be its head."""
    if p.length > WHOLE * p.extent:  # the whole arrow in one stroke
        yield Shaft((p.index,), (0, 0), p.ends[0], p.ends[1])
    if p.length > BARBED * p.extent:
        return
    if p.straight > CORNERED:  # the shaft and one barb in one stroke
        v = p.corners(2)
        ends, heads = ((_point(v[0]), _point(v[1])), (_point(v[2]), _point(v[1]))), (1, 1)
    else:
        ends, heads = (p.ends, (p.ends[1], p.ends[0])), (1, 2)
    reach, span, size = HEAD_REACH * p.length, HEAD_SPAN * p.length, HEAD_SIZE * p.length
    near = page.heads(p, (ends[0][1], ends[1][1]), reach, span, size)
    for (tail, tip), those in zip(ends, near, strict=True):
        if those:
            yield Shaft((p.index, *those), heads, tail, tip)


def _point(v: list[float]) -> Point:
    return v[0], v[1]
