"""The loose ends of a page, which lie near which, and the chains of pieces that close through them."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence, Set
from itertools import accumulate

import numpy as np

from sketch.library import address, library
from sketch.typing import Array

__all__ = ["Chain", "End", "LooseEnds"]

Chain = list[tuple[int, bool]]  # pieces that go once around, each with whether it was drawn the other way
End = int  # 2 * piece for where a piece begins, one more for where it ends

CHOICES, MOST_PARTS, MOST_STEPS = 6, 6, 283  # as in core/chains.c, where it says what they are
REACH = 1.5 * 0.3  # likewise
UNKNOWN = -1  # neighbours that nobody has asked for yet

_pointer, _int = ctypes.c_void_p, ctypes.c_int32
_chains = ctypes.CFUNCTYPE(_int, _int, *[_pointer] * 8, _int, *[_pointer] * 7)(("ink_chains", library()))
_open_ways = ctypes.CFUNCTYPE(_int, _int, *[_pointer] * 8, _int, *[_pointer] * 4)(
    ("ink_open_ways", library())
)


class LooseEnds:
    """The ends of all pieces, which of them are loose, and the nearest others of those that were asked for.

    Attributes:
        rivals: where they are for the library, as of ink_apart.
        at: (2 * pieces, 2) [pixels].  length: of their pieces [pixels].  loose: whether chains go through them.
    """

    def __init__(self, rivals: Sequence[Set[int]] = ()) -> None:
        """rivals: of each piece, those that are the same ink; no two of them are in one chain."""
        self.at = np.empty((0, 2))
        self.length = np.empty(0)
        self.loose = np.empty(0, dtype=np.uint8)
        self._count = np.empty(0, dtype=np.int32)
        self._near = np.empty((0, CHOICES), dtype=np.int32)
        self._gap = np.empty((0, CHOICES))
        self._rivals = np.array([j for others in rivals for j in sorted(others)], dtype=np.int32)
        self._from = np.fromiter(accumulate(map(len, rivals), initial=0), dtype=np.int32)
        known = len(self._rivals) > 0
        self.rivals = (address(self._rivals), address(self._from)) if known else (None, None)
        self._links = np.empty((MOST_STEPS, MOST_PARTS), dtype=np.int32)
        self._parts = np.empty(MOST_STEPS, dtype=np.int32)
        self._asked = np.empty(MOST_STEPS + 1, dtype=np.int32)
        self._gaps, self._ink, self._back = np.empty((3, MOST_STEPS))
        out = (
            self._links,
            self._parts,
            self._gaps,
            self._ink,
            self._back,
            self._asked[1:],
            self._asked,
        )
        self._into = [address(array) for array in out]
        self._into_open = [self._into[k] for k in (0, 1, 5, 6)]
        self._of: list[int | None] = []

    def add(self, ends: Array, length: Array) -> None:
        """Add the ends of further pieces, (n, 2, 2), none of them loose yet; length: of the pieces."""
        new = 2 * len(ends)
        self.at = np.concatenate([self.at, ends.reshape(-1, 2)])
        self.length = np.concatenate([self.length, np.repeat(length, 2)])
        self.loose = np.concatenate([self.loose, np.zeros(new, dtype=np.uint8)])
        self._count = np.concatenate([self._count, np.full(new, UNKNOWN, dtype=np.int32)])
        self._near = np.concatenate([self._near, np.zeros((new, CHOICES), dtype=np.int32)])
        self._gap = np.concatenate([self._gap, np.zeros((new, CHOICES))])
        given = [address(array) for array in (self.at, self.length, self.loose)]
        self._of = [
            *given,
            *self.rivals,
            *(address(array) for array in (self._count, self._near, self._gap)),
        ]

    def loosen(self, piece: int) -> set[End]:
        """Let chains go through a piece. Returns the ends whose neighbours are others now."""
        ends = slice(2 * piece, 2 * piece + 2)
        self.loose[ends] = 1
        self._count[ends] = UNKNOWN
        known = np.flatnonzero(self._count >= 0)
        if len(known) == 0:
            return set()
        gaps = np.hypot(*(self.at[known, None] - self.at[ends]).transpose(2, 0, 1))
        last = self._gap[known, -1] / (self.length[known] + self.length[self._near[known, -1]])
        farthest = np.where(self._count[known] < CHOICES, REACH, np.minimum(last, REACH))
        share = gaps.min(axis=1) / (self.length[known] + self.length[2 * piece])
        changed = known[share <= 1.0001 * farthest]
        self._count[changed] = UNKNOWN
        return set(changed.tolist())

    def tighten(self, piece: int) -> set[End]:
        """Let no chain go through a piece any more. Returns the ends whose neighbours are others now."""
        ends = slice(2 * piece, 2 * piece + 2)
        self.loose[ends] = 0
        self._count[ends] = UNKNOWN
        its = (self._near // 2 == piece) & (np.arange(CHOICES) < self._count[:, None])
        changed = np.flatnonzero(its.any(axis=1))
        self._count[changed] = UNKNOWN
        return set(changed.tolist())

    def chains(self, start: int) -> tuple[list[tuple[float, float, float, Chain]], set[End]]:
        """Orders of pieces whose ends meet around, of which `start` is the first drawn: each set of pieces in its
        tightest order, with the lengths of its gaps and of its ink [pixels], and how far it turns
        back [rad]; and the ends whose neighbours matter to that."""
        count = _chains(len(self.loose), *self._of, start, *self._into)
        asked = set(self._asked[1 : 1 + self._asked[0]].tolist())
        if count == 0:
            return [], asked
        out = self._gaps, self._ink, self._back, self._links, self._parts
        found = [
            (gap, long, back, [(end // 2, end % 2 == 1) for end in row[:parts]])
            for gap, long, back, row, parts in zip(*(of[:count].tolist() for of in out), strict=True)
        ]
        return found, asked

    def open_ways(self, start: int) -> tuple[list[Chain], set[End]]:
        """Orders of two pieces or more, of which `start` is at an end, whose ends meet but for those of the
        whole, where no other goes on: perhaps another body has the side that lacks; and the ends whose neighbours
        matter to that."""
        count = _open_ways(len(self.loose), *self._of, start, *self._into_open)
        links, parts = self._links[:count].tolist(), self._parts[:count].tolist()
        found = [[(end // 2, end % 2 == 1) for end in row[:n]] for row, n in zip(links, parts, strict=True)]
        return found, set(self._asked[1 : 1 + self._asked[0]].tolist())
