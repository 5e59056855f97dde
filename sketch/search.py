"""The best joint explanation: disjoint groups of ink with the greatest total gain, found exactly but in shading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Part", "Solved", "best_packing", "best_parts", "part"]

Group = tuple[int, ...]  # of pieces of ink

MOST_PIECES = 400  # in one cluster: beyond, it is shading, and the best groups are taken one after another
MOST_LOOKS = (
    100_000  # at groups, in one cluster: shading and grids, where no set is right, end with the best so far
)


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """Groups that are all in one cluster, as one piece leads them: of each ink the best, with its gain (> 0).

    Attributes:
        groups, gains: one for each ink.  index: which of those that it was made of.
        pieces: of all groups.
    """

    groups: list[Group]
    gains: list[float]
    index: list[int]
    pieces: tuple[int, ...]


Solved = dict[tuple[Part, ...], list[tuple[int, int]]]


def part(groups: Sequence[Group], gains: Sequence[float]) -> Part:
    """The part of some groups; those that gain nothing are left out."""
    best: dict[Group, int] = {}
    for k, (group, gain) in enumerate(zip(groups, gains, strict=True)):
        if gain > 0 and (group not in best or gain > gains[best[group]]):
            best[group] = k
    index = list(best.values())
    return Part(list(best), [gains[k] for k in index], index, tuple({i for group in best for i in group}))


def best_packing(groups: Sequence[Group], gains: Sequence[float]) -> list[int]:
    """Indices of pairwise disjoint groups whose gains (> 0) add up to the most.

    Ink that no chosen group has stays unexplained and gains nothing. Groups that share ink, however
    indirectly, form a cluster; each cluster is solved by branch and bound: take the first piece of ink
    still open, try every group that has it and leaving it out, and give up where even the best share of
    each remaining piece cannot win, or where the same pieces were settled before with no less gain.
    """
    by_first: dict[int, list[int]] = {}
    for g, group in enumerate(groups):
        by_first.setdefault(group[0], []).append(g)
    numbers = list(by_first.values())
    parts = [part([groups[g] for g in own], [gains[g] for g in own]) for own in numbers]
    return [numbers[p][k] for p, k in best_parts(parts, {})]


def best_parts(parts: Sequence[Part], solved: Solved) -> list[tuple[int, int]]:
    """As `best_packing`, of the groups of some parts: the part, and the index in it, of each chosen one.

    solved: the clusters of the last time, which are not solved again; replaced by those of this one.
    """
    chosen: list[tuple[int, int]] = []
    now: Solved = {}
    for cluster in _clusters(parts):
        key = tuple(parts[p] for p in cluster)
        best = solved.get(key)
        if best is None:
            at = [(q, k) for q, own in enumerate(key) for k in range(len(own.groups))]
            packed = _solve([g for own in key for g in own.groups], [v for own in key for v in own.gains])
            best = [at[g] for g in packed]
        now[key] = best
        chosen += [(cluster[q], key[q].index[k]) for q, k in best]
    solved.clear()
    solved.update(now)
    return chosen


def _clusters(parts: Sequence[Part]) -> list[list[int]]:
    """The parts that share ink, however indirectly."""
    parent: dict[int, int] = {}

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = i = parent[parent[i]]
        return i

    live = [p for p, own in enumerate(parts) if own.groups]
    for p in live:
        first, *others = parts[p].pieces
        at = root(parent.setdefault(first, first))
        for i in others:
            parent[root(parent.setdefault(i, i))] = at
    clusters: dict[int, list[int]] = {}
    for p in live:
        clusters.setdefault(root(parts[p].pieces[0]), []).append(p)
    return list(clusters.values())


def _greedy(cluster: list[int], groups: Sequence[Group], gains: Sequence[float]) -> list[int]:
    """The groups of a cluster, the best first, as far as each leaves the others' ink alone."""
    taken: set[int] = set()
    out = []
    for g in sorted(cluster, key=lambda g: -gains[g]):
        if taken.isdisjoint(groups[g]):
            taken.update(groups[g])
            out.append(g)
    return out


def _solve(groups: Sequence[Group], gains: Sequence[float]) -> list[int]:
    best_of: dict[Group, int] = {}  # of readings of the same ink only the best can be chosen
    for g in sorted(range(len(groups)), key=lambda g: -gains[g]):
        best_of.setdefault(groups[g], g)
    cluster = list(best_of.values())
    if len(cluster) == 1:
        return cluster
    bit = {i: 1 << k for k, i in enumerate(sorted({i for group in best_of for i in group}))}
    if len(bit) > MOST_PIECES:
        return _greedy(cluster, groups, gains)
    every = (1 << len(bit)) - 1
    share = dict.fromkeys(bit, 0.0)  # the most that a piece can bring: a group's gain split evenly
    for g in cluster:
        for i in groups[g]:
            share[i] = max(share[i], gains[g] / len(groups[g]))
    # For each piece the groups that have it, the best first: index, pieces as bits, gain, hope given up.
    choices: dict[int, list[tuple[int, int, float, float]]] = {b: [] for b in bit.values()}
    for g in cluster:
        choice = (g, sum(bit[i] for i in groups[g]), gains[g], sum(share[i] for i in groups[g]))
        for i in groups[g]:
            choices[bit[i]].append(choice)
    share_of = {bit[i]: hope for i, hope in share.items()}
    best, best_set = -1.0, list[int]()
    reached: dict[int, float] = {}  # by the pieces that are settled, the gain that they were settled with
    picked: list[int] = []
    looked = 0

    def branch(settled: int, gain: float, hope: float) -> None:
        nonlocal best, best_set, looked
        if gain > best:
            best, best_set = gain, list(picked)
        if gain + hope <= best or reached.get(settled, -1.0) >= gain or looked > MOST_LOOKS:
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

    branch(0, 0.0, sum(share.values()))
    if looked > MOST_LOOKS:
        greedy = _greedy(cluster, groups, gains)
        if sum(gains[g] for g in greedy) > best:
            return greedy
    return best_set
