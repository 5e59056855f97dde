"""The best joint explanation: disjoint groups of ink with the greatest total gain, found exactly."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["best_packing"]


def best_packing(groups: Sequence[frozenset[int]], gains: Sequence[float]) -> list[int]:
    """Indices of pairwise disjoint groups whose gains (> 0) add up to the most.

    Ink that no chosen group has stays unexplained and gains nothing. Groups that share ink, however
    indirectly, form a cluster; each cluster is solved by branch and bound: take the first piece of ink
    still open, try every group that has it and leaving it out, and give up where even the best share of
    each remaining piece cannot win.
    """
    chosen: list[int] = []
    for cluster in _clusters(groups):
        chosen += _solve(cluster, groups, gains)
    return chosen


def _clusters(groups: Sequence[frozenset[int]]) -> list[list[int]]:
    parent: dict[int, int] = {}

    def root(i: int) -> int:
        while parent.setdefault(i, i) != i:
            parent[i] = i = parent[parent[i]]
        return i

    for group in groups:
        first, *rest = sorted(group)
        for i in rest:
            parent[root(i)] = root(first)
        root(first)
    by_root: dict[int, list[int]] = {}
    for g, group in enumerate(groups):
        by_root.setdefault(root(min(group)), []).append(g)
    return list(by_root.values())


def _solve(cluster: list[int], groups: Sequence[frozenset[int]], gains: Sequence[float]) -> list[int]:
    pieces = sorted({i for g in cluster for i in groups[g]})
    of: dict[int, list[int]] = {i: [] for i in pieces}
    share = dict.fromkeys(pieces, 0.0)  # the most that a piece can bring: a group's gain split evenly
    for g in sorted(cluster, key=lambda g: -gains[g]):
        for i in groups[g]:
            of[i].append(g)
            share[i] = max(share[i], gains[g] / len(groups[g]))
    best, best_set = -1.0, list[int]()
    taken: set[int] = set()
    picked: list[int] = []

    def branch(at: int, gain: float, hope: float) -> None:
        nonlocal best, best_set
        while at < len(pieces) and pieces[at] in taken:
            at += 1
        if gain > best:
            best, best_set = gain, list(picked)
        if at == len(pieces) or gain + hope <= best:
            return
        first = pieces[at]
        for g in of[first]:
            group = groups[g]
            if taken.isdisjoint(group):
                taken.update(group)
                picked.append(g)
                branch(at + 1, gain + gains[g], hope - sum(share[i] for i in group))
                picked.pop()
                taken.difference_update(group)
        taken.add(first)
        branch(at + 1, gain, hope - share[first])
        taken.discard(first)

    branch(0, 0.0, sum(share.values()))
    return best_set
