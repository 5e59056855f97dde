"""A stroke in which the pen went on from one thing to the next without being lifted, as those things."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sketch.kernel import cuts
from sketch.page.grouping import shafts
from sketch.page.pieces import Page, Piece
from sketch.shapes.bars import read_bar
from sketch.shapes.marks import read_arrows, read_cross
from sketch.shapes.outlines import read_outline
from sketch.shapes.proposals import APART
from sketch.typing import Array

__all__ = ["things_in"]

BETWEEN = 2  # the kind of part that leads from one thing to the next, as in core/cut.c
CUT = 10.0  # nats for each part beyond the first: going on to the next thing is rarer than lifting the pen
LEAST = (20.0, 40.0)  # nats of the cheapest loop, and of the cheapest line, as core/cut.c numbers them


def things_in(strokes: Sequence[Array]) -> list[list[Array]]:
    """The parts of each stroke, (n, 2) [pixels], that were drawn as things of their own; mostly itself alone."""
    found = cuts(strokes)
    return [
        [points] if len(kinds) < 2 else _parts(np.ascontiguousarray(points), shares, kinds)
        for points, (shares, kinds) in zip(strokes, found, strict=True)
    ]


def _parts(points: Array, shares: list[float], kinds: list[int]) -> list[Array]:
    """The things in a stroke, given where it may go on from one to the next, as of `cuts`.

    It is cut where that says its ink in fewer nats than any reading of the whole. The ways between the parts
    are in none of them.
    """
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    at = np.searchsorted(along, np.array(shares) * along[-1])
    parts = [points[a : b + 1] for a, b, kind in zip(at, at[1:], kinds, strict=False) if kind != BETWEEN]
    if len(parts) < 2:
        return [points]
    least = [LEAST[kind] for kind in kinds if kind != BETWEEN]
    page = Page()
    page.add([points, *parts])
    page.settle()
    if len(page.pieces) <= len(parts):
        return [points]
    whole, *things = page.pieces.values()
    # the whole is to be said as finely as its parts: with their number of observations, and to their precision
    count = sum(p.observations for p in things)
    scale = sum(p.scale * p.observations for p in things) / count
    coarse = whole.observations * max(math.log(whole.scale / scale), 0.0)
    most = replace(whole, scale=min(scale, whole.scale), observations=count).unread
    said = CUT * (len(kinds) - 1) + sum(least)  # at least
    if said < most:  # seldom: so it isn't read before that is known
        for meant in _meant(page, whole):
            most = min(most, max(count / whole.observations, 1.0) * meant + coarse)
            if said >= most:
                return [points]
    for p, bound in zip(things, least, strict=True):
        if said >= most:
            return [points]
        said += min((p.unread, *_meant(page, p))) - bound
    return parts if said < most else [points]


def _meant(page: Page, p: Piece) -> Iterator[float]:
    """The nats to say a piece by itself as each thing that has a meaning."""
    found = [read_bar(page, p)]
    if p.gap < APART * p.length:
        found += read_outline(page, [(p.index, False)])
    yield from (f.cost for f in found if f is not None)
    found = [read_cross(page, (p.index,))]
    found += read_arrows(page, [shaft for shaft in shafts(page, p) if shaft.names == (p.index,)])
    yield from (f.cost for f in found if f is not None)
