"""Rows: small strokes near one another, as letters stand in words and in lines."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection, Iterable, Mapping, Sequence, Set

from sketch.kernel import words
from sketch.page.pieces import Page

__all__ = ["TALL", "Rows", "near_one_another"]

TALL = 2.5  # times that a thing in a word is as large as another: a capital as a small letter
BETWEEN = 1.0  # of the larger stroke: what is between the strokes of a word, at most


def near_one_another(page: Page, largest: float, idle: Set[int]) -> dict[int, list[int]]:
    """Of each stroke smaller than `largest` [pixels] the others that may be in one word with it, or in one line.

    What is between two words is as wide as the largest of their strokes.
    """
    near: dict[int, list[int]] = {i: [] for i, p in page.pieces.items() if p.extent < largest}
    for i, j in (
        words(page.strokes, {i: page.pieces[i].extent for i in near}, BETWEEN) if len(near) > 1 else ()
    ):
        near[i].append(j)
        near[j].append(i)
    tall = dict[int, float]()
    for start in idle & near.keys():
        if start not in tall:
            word = _joined(near, start)
            tall.update(dict.fromkeys(word, max(page.pieces[i].extent for i in word)))
    for i, j in words(page.strokes, tall, BETWEEN) if len(tall) > 1 else ():
        if j not in near[i]:
            near[i].append(j)
            near[j].append(i)
    return near


def _joined(near: Mapping[int, Sequence[int]], start: int) -> list[int]:
    """A stroke and all that are near it, near these, and so on."""
    found, known = [start], {start}
    for i in found:  # it grows meanwhile
        new = [j for j in near[i] if j not in known]
        known.update(new)
        found += new
    return found


class Rows:
    """The rows in which small strokes stand, near one another, with some that mean nothing: these are idle.

    Attributes:
        of: by stroke, the idle ones in its row: TALL times their extents, in order, and which they are.
    """

    def __init__(
        self, page: Page, near: Mapping[int, Sequence[int]], idle: Set[int], others: Iterable[Rows] = ()
    ) -> None:
        """near: of each small stroke the others that may be in one word with it.  others: rows of other strokes."""
        self.of: dict[int, tuple[list[float], list[int]]] = {}
        self._near = dict(near)
        self._idle = {i: TALL * page.pieces[i].extent for i in near.keys() & idle}
        for start in self._idle:
            if start in self.of:
                continue
            its: tuple[list[float], list[int]] = [], []
            row = _joined(near, start)
            self.of.update((i, its) for i in row)
            for tall, i in sorted((self._idle[i], i) for i in row if i in self._idle):
                its[0].append(tall)
                its[1].append(i)
        for rows in others:
            self.of |= rows.of
            self._near |= rows._near
            self._idle |= rows._idle

    def beside(self, pieces: Sequence[int], extent: float) -> int:
        """How many idle strokes, large enough for one of some extent [pixels], some strokes stand in a row with."""
        large = sum(len(tall) - bisect_right(tall, extent) for tall, _ in self._rows(pieces))
        return large and large - sum(extent < self._idle.get(i, 0.0) for i in pieces)

    def idle(self, pieces: Sequence[int], extent: float) -> list[int]:
        """Those strokes."""
        large = (i for tall, its in self._rows(pieces) for i in its[bisect_right(tall, extent) :])
        return [i for i in large if i not in pieces]

    def _rows(self, pieces: Sequence[int]) -> Collection[tuple[list[float], list[int]]]:
        """The rows that some strokes stand in."""
        return {id(row): row for i in pieces if (row := self.of.get(i))}.values()

    def near_idle(self, pieces: Sequence[int]) -> list[int]:
        """The idle strokes next to some strokes."""
        return [j for i in pieces for j in self._near.get(i, ()) if j in self._idle and j not in pieces]
