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
from numpy.typing import NDArray

from sketch.kept import Kept
from sketch.search import best, part

__all__ = ["Together"]

ALONG = 4.0  # nats that two readings are rarer for each pen width of ink that both say: lines cross, or sides touch
ASCENTS = 30  # steps by which the prices of stretches are raised or lowered,
PATIENCE = 5  # of which so many without gain halve the steps after,
OFTEN = 5  # and one in so many tries the cover that the prices speak for
CLOSE = 1.0  # nats: covers that gain no more than that beyond another are no better

Ink = tuple[int, ...]  # names of stretches
Singles = NDArray[np.float32]


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
        names = list(dict.fromkeys(name for ink in self._inks for name in ink))
        number = {name: k for k, name in enumerate(names)}
        self._has = np.zeros((len(self._inks), len(names)), np.float32)
        for k, ink in enumerate(self._inks):
            self._has[k, [number[name] for name in ink]] = 1.0
        self._free = np.array([max(free.get(name, 0.0), 0.0) for name in names], np.float32)
        length = np.array([lengths[name] for name in names], np.float32)
        self._along = self._has * length
        self._whole = self._has @ self._free  # nats to say all ink of a reading freely
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
        every = np.array(worth, np.float32)
        some = np.flatnonzero(every > 0)
        at = {k: n for n, k in enumerate(some.tolist())}
        cover = _Cover(self, some, self._whole[some] - every[some])
        chosen = [int(some[n]) for n in cover.cheapest([at[k] for k in packed])]
        own = [k for k in chosen if k < self._count]
        return own, cover.gain([at[k] for k in chosen]) - sum(gains[k] for k in own)


class _Cover:
    """Covers with some of the readings, by number. cost: nats to say each."""

    def __init__(self, all_: Together, some: NDArray[np.intp], cost: Singles) -> None:
        self._has, self._free, self._cost = all_._has[some], all_._free, cost
        left, both = some >= all_._count, all_._along[some] @ self._has.T
        # nats that one is rarer beside another; what is left over together is no other's ink
        self._beside = np.where((both > 0) & (left | left[:, None]), np.inf, ALONG * both).astype(np.float32)
        np.fill_diagonal(self._beside, 0.0)

    def gain(self, chosen: list[int]) -> float:
        """Nats that some readings save together against saying all ink freely."""
        covered = self._has[chosen].any(axis=0)
        beside = float(self._beside[np.ix_(chosen, chosen)].sum()) / 2
        return float(self._free[covered].sum() - self._cost[chosen].sum()) - beside

    def cheapest(self, first: list[int]) -> list[int]:
        """The cover that gains the most of those that were found, beginning with one."""
        best, most = first, self.gain(first)
        price, step, waited, least = self._prices(first), 1.0, 0, -np.inf
        everything = float(self._free.sum())
        for ascent in range(ASCENTS):
            profit = self._has @ price - self._cost
            wanted = profit > CLOSE / 10
            bound = float(price.sum() - profit[wanted].sum())
            gap = everything - most - bound
            if gap < CLOSE:
                break
            waited = 0 if bound > least else waited + 1
            least = max(bound, least)
            if waited == PATIENCE:
                step, waited = step / 2, 0
            if ascent % OFTEN == 0:
                found = self._greedy(price)
                if (gain := self.gain(found)) > most + CLOSE:
                    best, most = found, gain
            slope = 1.0 - self._has[wanted].sum(axis=0)
            slope[(price >= self._free) & (slope > 0) | (price <= 0) & (slope < 0)] = 0.0
            steep = float(slope @ slope)
            if not steep:
                break
            price = np.clip(price + step * gap / steep * slope, 0.0, self._free)
        return best

    def _prices(self, chosen: list[int]) -> Singles:
        """What each stretch costs in a cover: what is open its price, and what a reading says its part of that one's.
        If no reading costs less than its stretches do then, no cover is cheaper."""
        price = self._free.copy()
        for k in chosen:
            its = self._has[k] > 0
            whole = float(self._free[its].sum())
            share = max(float(self._cost[k]), 0.0) / whole if whole > 0 else 0.0
            price[its] = np.minimum(price[its], share * self._free[its])
        return price

    def _greedy(self, price: Singles) -> list[int]:
        """A cover by the readings that are the cheapest for what they cover, at some prices and then at those of ink
        that is said freely, without those that others make needless."""
        chosen: list[int] = []
        open_ = np.ones(len(self._free), bool)
        rarer = np.zeros(len(self._cost), np.float32)
        for worth in (price, self._free):
            profit = self._has @ (worth * open_) - self._cost - rarer
            profit[chosen] = -np.inf
            while profit[k := int(profit.argmax())] > 0:
                chosen.append(k)
                new = open_ & (self._has[k] > 0)
                open_ &= ~new
                rarer += self._beside[k]
                profit -= self._has @ (worth * new) + self._beside[k]
                profit[k] = -np.inf
        return self._needed(chosen)

    def _needed(self, chosen: list[int]) -> list[int]:
        """Some readings without those that gain nothing beside the others, the worst first."""
        while chosen:
            holders = self._has[chosen].sum(axis=0)
            alone = self._has[chosen] @ (self._free * (holders == 1)) - self._cost[chosen]
            alone -= self._beside[np.ix_(chosen, chosen)].sum(axis=1)
            worst = int(alone.argmin())
            if alone[worst] >= 0:
                break
            chosen = chosen[:worst] + chosen[worst + 1 :]
        return chosen
