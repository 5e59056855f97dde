"""The best joint explanation: disjoint groups of ink with the greatest total gain, found exactly but in shading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sketch.kept import Kept
from sketch.typing import Array

__all__ = ["Part", "best", "part"]

Group = tuple[int, ...]  # of pieces of ink
Packed = tuple[Group, float]  # and what it gains

# in one cluster: beyond, it is shading, and groups are taken one after another, as far as prices speak for them
MOST_PIECES, MOST_GROUPS = 400, 1000
MOST_TRIED = 24  # groups of a piece, the best by the piece, that may outdo another
ROUNDS = 2  # of lowering the pieces' shares in what a packing may gain
FEW_LOOKS = 25_000  # looks at groups, in one cluster, before those that are in no better packing are left out
MOST_LOOKS = 400_000  # and after: shading and grids, where no set is right, end with the best so far
DESCENTS = 100  # steps by which the prices of pieces are lowered,
PATIENCE = 5  # of which so many without gain halve the steps after,
OFTEN = 5  # and one in so many tries the packing that the prices speak for
CLOSE = 1e-6  # of gains: what is no more is no difference


@dataclass(eq=False, slots=True)  # frozen, it would take four times as long to make
class Part:
    """Groups that are all in one cluster, as one piece leads them: of each ink the best, with its gain (> 0). Never
    changed once it is made.

    Parts with the same groups and gains, of the same places, are equal.

    Attributes:
        groups, gains: one for each ink.  index: which of those that it was made of.
        pieces: of all groups.
        known_by: its hash: it is asked for at every stroke.
    """

    groups: tuple[Group, ...]
    gains: tuple[float, ...]
    index: tuple[int, ...]
    pieces: tuple[int, ...]
    known_by: int

    def __hash__(self) -> int:
        return self.known_by

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Part):
            return False
        return (self.groups, self.gains, self.index) == (other.groups, other.gains, other.index)


def part(groups: Sequence[Group], gains: Sequence[float]) -> Part:
    """The part of some groups; those that gain nothing are left out."""
    best: dict[Group, int] = {}
    for k, gain in enumerate(gains):
        if gain > 0:
            there = best.setdefault(groups[k], k)
            if gain > gains[there]:
                best[groups[k]] = k
    index, inks = tuple(best.values()), tuple(best)
    its = tuple(gains[k] for k in index)
    return Part(inks, its, index, tuple({i for group in inks for i in group}), hash((inks, its)))


def best(kept: Kept, *parts: Part) -> list[tuple[int, int]]:
    """Pairwise disjoint groups of some parts whose gains (> 0) add up to the most: the part, and the index in it, of
    each. Ink that no chosen group has stays unexplained, and gains nothing.

    Groups that share ink, however indirectly, form a cluster, which is solved by itself, and what did not change is
    not solved again. A group in whose ink others gain no less is in no best packing; without those most clusters fall
    apart.
    """
    chosen: list[tuple[int, int]] = []
    for cluster in _clusters([own.pieces for own in parts]):
        for q, k in kept.through(_solved, *map(parts.__getitem__, cluster)):
            chosen.append((cluster[q], k))
    return chosen


def _solved(kept: Kept, *parts: Part) -> list[tuple[int, int]]:
    """The best packing of a cluster: the part, and the index in it, of each."""
    if len(parts) == 1 and len(parts[0].groups) == 1:
        return [(0, parts[0].index[0])]
    groups = [g for own in parts for g in zip(own.groups, own.gains, strict=True)]
    at = [(q, k) for q, own in enumerate(parts) for k in own.index]
    left = _not_outdone(groups)
    chosen = []
    for cluster in _clusters([groups[g][0] for g in left]):
        its = [left[k] for k in cluster]
        chosen += [at[its[k]] for k in kept(_packed, tuple(groups[g] for g in its))]
    return chosen


def _clusters(inks: Sequence[Group]) -> list[list[int]]:
    """Those that share ink, however indirectly; without those that have none."""
    if len(inks) == 1:
        return [[0]] if inks[0] else []
    parent: dict[int, int] = {}

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = i = parent[parent[i]]
        return i

    live = [k for k, ink in enumerate(inks) if ink]
    for k in live:
        first, *others = inks[k]
        at = root(parent.setdefault(first, first))
        for i in others:
            parent[root(parent.setdefault(i, i))] = at
    clusters: dict[int, list[int]] = {}
    for k in live:
        clusters.setdefault(root(inks[k][0]), []).append(k)
    return list(clusters.values())


def _not_outdone(groups: list[Packed]) -> list[int]:
    """The groups in whose ink no others, that leave one another's ink alone, are found to gain as much."""
    best: dict[Group, int] = {}
    for g, (ink, gain) in enumerate(groups):
        if ink not in best or gain > groups[best[ink]][1]:
            best[ink] = g
    order = sorted(best.values(), key=lambda g: -groups[g][1] / len(groups[g][0]))
    bit = {i: 1 << k for k, i in enumerate({i for ink in best for i in ink})}
    mask = {g: sum(map(bit.__getitem__, groups[g][0])) for g in order}
    on: dict[int, list[tuple[int, float]]] = {i: [] for i in bit}
    for g in order:
        for i in groups[g][0]:
            if len(on[i]) < MOST_TRIED:
                on[i].append((mask[g], groups[g][1]))
    kept = []
    for g in best.values():
        ink, gain = groups[g]
        own = mask[g]
        within, taken = 0.0, ~own  # by others, or not of its ink
        for i in ink if len(ink) > 1 else ():
            if not taken & bit[i]:
                for other, its in on[i]:
                    if not other & taken and other != own:
                        taken, within = taken | other, within + its
                        break
                if within >= gain:
                    break
        else:
            kept.append(g)
    return kept


def _swept(inks: list[Group]) -> list[int]:
    """Pieces of ink in an order in which those that share groups are near one another (Cuthill and McKee 1969): few
    are half decided at any time."""
    near: dict[int, set[int]] = {}
    for ink in inks:
        for i in ink:
            near.setdefault(i, set()).update(ink)
    out: list[int] = []
    for _ in range(2):  # begun anew from the far end
        out = [out[-1]] if out else [min(near, key=lambda i: (len(near[i]), i))]
        seen = set(out)
        for i in out:
            new = sorted(near[i] - seen, key=lambda j: (len(near[j]), j))
            out += new
            seen.update(new)
    return out


def _as_bits(groups: Sequence[Packed]) -> list[int]:
    """The pieces of each group as the bits of a number."""
    bit: dict[int, int] = {}
    for ink, _ in groups:
        for i in ink:
            bit.setdefault(i, 1 << len(bit))
    return [sum(map(bit.__getitem__, ink)) for ink, _ in groups]


def _greedy(inks: Sequence[int], gains: Array) -> list[int]:
    """The groups of a cluster, the best first, as far as each leaves the others' ink alone.

    inks: as of `_as_bits`.
    """
    taken = 0
    out = []
    for g in np.argsort(-gains, kind="stable").tolist():
        if not taken & inks[g]:
            taken |= inks[g]
            out.append(g)
    return out


def _shares(groups: Sequence[Packed], share: dict[int, float] | None = None) -> dict[int, float]:
    """What each piece can bring, so that no group gains more than its pieces' shares: no packing gains more than all.

    Groups' gains split evenly, or the shares given raised until no group gains more, and then each piece's share
    lowered as far as the others' allow (the packing's linear dual, descended along its coordinates).
    """
    on: dict[int, list[int]] = {}
    even = {} if share is None else dict(share)
    for g, (ink, gain) in enumerate(groups):
        lacks = (gain if share is None else gain - sum(map(even.__getitem__, ink))) / len(ink)
        for i in ink:
            on.setdefault(i, []).append(g)
            even[i] = max(even.get(i, 0.0), lacks if share is None else even[i] + lacks)
    spare = [sum(map(even.__getitem__, ink)) - gain for ink, gain in groups]
    for _ in range(ROUNDS):
        for i, its in on.items():
            less = min(even[i], min(map(spare.__getitem__, its)))
            even[i] -= less
            for g in its:
                spare[g] -= less
    return even


def _packed(groups: Sequence[Packed]) -> list[int]:
    """The best packing of a cluster, as indices."""
    if len(groups) == 1:
        return [0]
    if len(groups) == 2 and groups[0][1] != groups[1][1]:  # as they share ink, the better one
        return [0] if groups[0][1] > groups[1][1] else [1]
    if len(groups) > MOST_GROUPS or len({i for ink, _ in groups for i in ink}) > MOST_PIECES:
        return _narrowed(groups, [])[0]
    best, is_best = _branched(groups, _shares(groups), FEW_LOOKS)
    if is_best:
        return best
    best, kept, share = _narrowed(groups, best)
    better = []
    for cluster in _clusters([groups[g][0] for g in kept]):  # without the others it may have fallen apart
        its = [kept[k] for k in cluster]
        some = [groups[g] for g in its]
        better += [its[k] for k in _branched(some, _shares(some, share), MOST_LOOKS)[0]]
    return max(best, better, key=lambda found: _total(groups, found))


def _total(groups: Sequence[Packed], some: list[int]) -> float:
    return sum(groups[g][1] for g in some)


def _narrowed(groups: Sequence[Packed], best: list[int]) -> tuple[list[int], list[int], dict[int, float]]:
    """A packing no worse than `best`, the groups that may be in a better one, and what each piece can bring.

    Pieces have a price, and a group's surplus is what it gains beyond those of its pieces: no packing gains more than
    all prices and surpluses together, and none with a group that lacks something more than that without what it lacks
    (the linear dual, descended along its subgradients as by Held, Wolfe and Crowder 1974, with steps of Polyak 1969).
    """
    names = list(dict.fromkeys(i for ink, _ in groups for i in ink))
    number = {i: k for k, i in enumerate(names)}
    sizes = np.array([len(ink) for ink, _ in groups])
    piece = np.array([number[i] for ink, _ in groups for i in ink])
    first, gains = np.cumsum(sizes) - sizes, np.array([gain for _, gain in groups])
    shares = _shares(groups)
    price = np.array([shares[i] for i in names])
    least, prices, step, waited = np.inf, price, 1.0, 0
    inks = _as_bits(groups)
    by_gain = _greedy(inks, gains)
    best = max(best, by_gain, key=lambda some: _total(groups, some))
    reached = _total(groups, best)
    for descent in range(DESCENTS):
        surplus = gains - np.add.reduceat(price[piece], first)
        most = float(price.sum() + surplus[surplus > 0].sum())
        waited = 0 if most < least else waited + 1
        if most < least:
            least, prices = most, price
        if waited == PATIENCE:
            step, waited = step / 2, 0
        if descent % OFTEN == 0:
            found = _greedy(inks, surplus)
            if (gain := _total(groups, found)) > reached:
                best, reached = found, gain
        slope = 1.0 - np.bincount(piece[np.repeat(surplus > 0, sizes)], minlength=len(names))
        slope[(price <= 0) & (slope > 0)] = 0.0
        steep = float(slope @ slope)
        if least - reached < CLOSE or not steep:
            break
        price = np.maximum(price - step * (most - reached) / steep * slope, 0.0)
    surplus = gains - np.add.reduceat(prices[piece], first)
    kept: list[int] = np.flatnonzero(least + np.minimum(surplus, 0.0) > reached + CLOSE).tolist()
    return best, kept, dict(zip(names, prices.tolist(), strict=True))


def _branched(groups: Sequence[Packed], share: dict[int, float], looks: int) -> tuple[list[int], bool]:
    """The best packing of a cluster by branch and bound, as indices, and whether it is that: with no more than so many
    looks at groups it may not be.

    share: what each piece can bring, as of `_shares`.

    Take the first piece of ink still open, try every group that has it and leaving it out, and give up where even
    the best share of each remaining piece cannot win, or where the same pieces were settled before with no less gain.
    """
    order = _swept([ink for ink, _ in groups])
    bit = {i: 1 << k for k, i in enumerate(order)}
    every = (1 << len(bit)) - 1
    # For each piece the groups that have it, the best first: index, pieces as bits, gain, hope given up.
    choices: dict[int, list[tuple[int, int, float, float]]] = {b: [] for b in bit.values()}
    for g in sorted(range(len(groups)), key=lambda g: -groups[g][1]):
        ink, gain = groups[g]
        choice = (g, sum(bit[i] for i in ink), gain, sum(share[i] for i in ink))
        for i in ink:
            choices[bit[i]].append(choice)
    share_of = {b: share[i] for i, b in bit.items()}
    best, best_set = -1.0, list[int]()
    reached: dict[int, float] = {}  # by the pieces that are settled, the gain that they were settled with
    picked: list[int] = []
    looked = 0

    def branch(settled: int, gain: float, hope: float) -> None:
        nonlocal best, best_set, looked
        if gain > best:
            best, best_set = gain, list(picked)
        if gain + hope <= best or reached.get(settled, -1.0) >= gain or looked > looks:
            return
        reached[settled] = gain
        free = every & ~settled
        if not free:
            return
        first = free & -free
        looked += len(choices[first])
        for g, pieces, its_gain, its_hope in choices[first]:
            if not settled & pieces:
                picked.append(g)
                branch(settled | pieces, gain + its_gain, hope - its_hope)
                picked.pop()
        branch(settled | first, gain, hope - share_of[first])

    branch(0, 0.0, sum(share_of.values()))
    return best_set, looked <= looks
