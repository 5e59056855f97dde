"""Readings that the caller says: some strokes are an anchor, a ball, nothing; the rest is read around them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from operator import index

import numpy as np

from sim.scene import InputError
from sketch.page.grouping import closing_chains, shafts
from sketch.page.loose import Chain
from sketch.page.pieces import Page, Piece
from sketch.scoring import Fitted
from sketch.shapes.bars import line_of_any_course, read_bar
from sketch.shapes.marks import read_arrows, read_cross
from sketch.shapes.outlines import read_outline

__all__ = ["KINDS", "Overrides", "forced_reading", "normal_overrides"]

KINDS = ("circle", "ball", "pivot", "rectangle", "polygon", "bar", "anchor", "gravity", "ignore")
_OUTLINES = {
    "circle": "circle",
    "ball": "circle",
    "pivot": "circle",
    "rectangle": "rectangle",
    "polygon": "polygon",
}

Overrides = dict[tuple[int, ...], str]


def normal_overrides(given: Mapping[int | tuple[int, ...], str] | None, stroke_count: int) -> Overrides:
    """The overrides by tuples of strokes in order. Raises InputError for strokes or kinds that there are
    not."""
    out: Overrides = {}
    seen: set[int] = set()
    for key, kind in (given or {}).items():
        try:
            strokes = tuple(sorted({index(s) for s in (key if isinstance(key, tuple) else (key,))}))
        except TypeError:
            raise InputError(
                f"overrides[{key!r}]", "not the number of a stroke", "or several: (3, 4)"
            ) from None
        name = ",".join(map(str, strokes))
        path = f"overrides[{name}]"
        if kind not in KINDS:
            raise InputError(path, f"{kind!r} is not a reading", "one of " + ", ".join(KINDS))
        for s in strokes:
            if not 0 <= s < stroke_count:
                raise InputError(path, f"there is no stroke {s}", f"strokes are 0 to {stroke_count - 1}")
            if s in seen:
                raise InputError(path, f"stroke {s} has another reading already")
            seen.add(s)
        out[strokes] = kind
    return out


def forced_reading(page: Page, strokes: tuple[int, ...], kind: str) -> Fitted | None:
    """The strokes read as they are said to be, however badly they fit; None where they have no length."""
    pieces = [page.pieces[s] for s in strokes if s in page.pieces]
    if not pieces or kind == "ignore":
        return None
    names = tuple(p.index for p in pieces)
    if kind in _OUTLINES:
        found = read_outline(page, _around(page, pieces))
        best = [f for f in found if f.kind == _OUTLINES[kind]] or [f for f in found if f.kind == "polygon"]
        return best[0]
    longest = max(pieces, key=lambda p: p.length)
    if kind == "bar":
        return Fitted("bar", names, 0.0, _line(page, longest))
    if kind == "anchor":
        return read_cross(page, names[:2]) or Fitted("cross", names, 0.0, _bars(pieces))
    return _arrow(page, names) or Fitted("arrow", names, 0.0, np.array(longest.ends))


def _arrow(page: Page, names: tuple[int, ...]) -> Fitted | None:
    found = read_arrows(page, [shaft for i in names for shaft in shafts(page, page.pieces[i])])
    return min((f for f in found if f.pieces == names), key=lambda f: f.cost, default=None)


def _line(page: Page, piece: Piece) -> np.ndarray:
    """An open line as it was drawn: as a polyline, or of any course, or straight between its ends."""
    bar = read_bar(page, piece)
    if bar is not None and bar.cost < piece.unread:
        return bar.outline
    course = line_of_any_course(piece)
    return piece.line(1) if course is None else course


def _bars(pieces: list[Piece]) -> np.ndarray:
    if len(pieces) > 1:
        return np.concatenate([p.line(1) for p in pieces[:2]])
    return pieces[0].line(3)


def _around(page: Page, pieces: list[Piece]) -> Chain:
    """The pieces in an order that goes around: the tightest that closes, else each to the nearest end."""
    wanted = {p.index for p in pieces}
    for _, chain in closing_chains(page, min(wanted)) if len(pieces) > 1 else ():
        if {i for i, _ in chain} == wanted:
            return chain
    chain, left = [(pieces[0].index, False)], pieces[1:]
    at = pieces[0].ends[1]
    while left:
        _, p, e = min(_gaps(at, left), key=lambda t: t[0])
        chain.append((p.index, e == 1))
        at = p.ends[1 - e]
        left = [q for q in left if q is not p]
    return chain


def _gaps(at: tuple[float, float], pieces: list[Piece]) -> Iterable[tuple[float, Piece, int]]:
    return ((math.dist(at, p.ends[e]), p, e) for p in pieces for e in (0, 1))
