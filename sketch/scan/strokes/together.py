"""The readings that say a drawing's ink for the least: a cover of its stretches.

Where bodies touch or overlap, a stretch of ink may be a side of two of them.  Each then says it, but it is said once
in vain: a reading gains nothing by ink that another has said.  So what is looked for is no packing, in which each
stretch has one owner, but the cheapest cover, in which a stretch that no reading has is said freely.  It is a set
cover with a price for what stays open, looked for by its linear dual, which ascends along its subgradients, and by
greedy covers at the dual's prices (Caprara, Fischetti and Toth, "A heuristic method for the set covering problem",
Operations Research 47, 1999).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sketch.kept import Kept
from sketch.scan.binding import cheapest_cover
from sketch.search import best, part

__all__ = ["Together"]

Ink = tuple[int, ...]  # names of stretches


class Together:
    """The sets of readings that may be chosen together."""

    def __init__(
        self,
        own: Sequence[Ink],
        left: Sequence[tuple[Ink, float]],
        free: Mapping[int, float],
        lengths: Mapping[int, float],
    ) -> None:
        """own: of each reading the stretches.  left: stretches that may be left over together, and what that saves.
        free: nats to say each stretch freely.  lengths: of each [pen widths]."""
        self._count, self._saved = len(own), [saved for _, saved in left]
        self._inks = [*own, *(ink for ink, _ in left)]
        number: dict[int, int] = {}
        every = [number.setdefault(name, len(number)) for ink in self._inks for name in ink]
        ends = np.cumsum([0, *map(len, self._inks)], dtype=np.int32)
        self._of = np.array(every, np.int32), ends
        self._free = np.array([max(free.get(name, 0.0), 0.0) for name in number])
        self._length = np.array([lengths[name] for name in number])
        self._left = np.arange(len(self._inks)) >= self._count
        whole = np.concatenate([[0.0], np.cumsum(self._free[self._of[0]])])[ends]
        self._whole = np.diff(whole)  # nats to say all ink of a reading freely
        first_of: dict[int, list[int]] = {}
        for k, ink in enumerate(self._inks):
            first_of.setdefault(ink[0], []).append(k)
        self._leading, self._kept = list(first_of.values()), Kept()

    def best(self, gains: list[float]) -> tuple[list[int], float]:
        """The set that gains the most, given the gains of the readings by themselves; and what is saved by what it
        leaves over, less what is lost where its readings say the same ink."""
        worth = gains + self._saved
        parts = [part([self._inks[k] for k in some], [worth[k] for k in some]) for some in self._leading]
        self._kept.forget()
        packed = [self._leading[p][k] for p, k in best(self._kept, *parts)]
        every = np.array(worth)
        some = np.flatnonzero(every > 0).astype(np.int32)
        cost = self._whole - every
        chosen, most = cheapest_cover(self._of, self._left, cost, self._free, self._length, some, packed)
        own = [k for k in chosen if k < self._count]
        return own, most - sum(gains[k] for k in own)
