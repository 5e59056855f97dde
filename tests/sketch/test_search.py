"""The exact search against trying everything."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp

from sketch.kept import Kept
from sketch.search import best, part


def best_packing(groups: Sequence[tuple[int, ...]], gains: Sequence[float]) -> list[int]:
    """Indices of the best packing of some groups, a part for each piece that they begin with."""
    by_first: dict[int, list[int]] = {}
    for g, group in enumerate(groups):
        by_first.setdefault(group[0], []).append(g)
    numbers = list(by_first.values())
    parts = [part([groups[g] for g in own], [gains[g] for g in own]) for own in numbers]
    return [numbers[p][k] for p, k in best(Kept(), *parts)]


def brute(groups: list[tuple[int, ...]], gains: list[float]) -> float:
    best = 0.0
    for size in range(1, len(groups) + 1):
        for chosen in combinations(range(len(groups)), size):
            ink = [i for g in chosen for i in groups[g]]
            if len(ink) == len(set(ink)):
                best = max(best, sum(gains[g] for g in chosen))
    return best


@pytest.mark.parametrize("seed", range(60))
def test_no_other_set_gains_more(seed: int) -> None:
    rng = np.random.default_rng(seed)
    groups = [
        tuple(rng.choice(7, size=rng.integers(1, 4), replace=False).tolist())
        for _ in range(rng.integers(1, 11))
    ]
    gains = rng.uniform(1, 50, len(groups)).tolist()
    chosen = best_packing(groups, gains)
    ink = [i for g in chosen for i in groups[g]]
    assert len(ink) == len(set(ink)), "each piece of ink in at most one group"
    assert sum(gains[g] for g in chosen) == pytest.approx(brute(groups, gains))


def test_nothing_is_the_best_of_nothing() -> None:
    assert best_packing([], []) == []


@pytest.mark.parametrize("seed", range(5))
def test_a_long_row_in_any_order_is_packed_exactly(seed: int) -> None:
    """Of groups of neighbours in a row the best packing is known from left to right, however they are numbered."""
    rng = np.random.default_rng(seed)
    count = 120
    number = rng.permutation(count).tolist()
    spans = [(a, a + int(w)) for a in range(count) for w in rng.integers(1, 6, 4) if a + w <= count]
    gains = rng.uniform(1, 50, len(spans)).tolist()
    best = [0.0] * (count + 1)
    for end in range(1, count + 1):
        through = [best[a] + gain for (a, b), gain in zip(spans, gains, strict=True) if b == end]
        best[end] = max([best[end - 1], *through])
    groups = [tuple(sorted(number[a:b])) for a, b in spans]
    chosen = best_packing(groups, gains)
    ink = [i for g in chosen for i in groups[g]]
    assert len(ink) == len(set(ink))
    assert sum(gains[g] for g in chosen) == pytest.approx(best[count])


@pytest.mark.parametrize("seed", range(5))
def test_a_tangle_of_groups_that_all_gain_alike_is_packed_exactly(seed: int) -> None:
    """As dense drawings on paper are: nearly all groups of pieces beside one another are about as good."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(0, 1, (40, 2))
    groups, gains = [], []
    for _ in range(160):
        near = np.argsort(np.hypot(*(at - at[rng.integers(40)]).T))[: rng.integers(4, 16)]
        some = rng.choice(near, size=min(len(near), int(rng.integers(3, 10))), replace=False)
        groups.append(tuple(some.tolist()))
        gains.append(len(some) * float(rng.uniform(32, 40)))
    has = np.zeros((40, len(groups)))
    for g, group in enumerate(groups):
        has[list(group), g] = 1
    solved = milp(
        -np.array(gains),
        constraints=LinearConstraint(has, ub=1),
        integrality=np.ones(160),
        bounds=Bounds(0, 1),
    )
    chosen = best_packing(groups, gains)
    ink = [i for g in chosen for i in groups[g]]
    assert len(ink) == len(set(ink))
    assert sum(gains[g] for g in chosen) == pytest.approx(-solved.fun)


def test_parts_that_gain_the_same_in_other_places_are_not_one() -> None:
    """What was found of one is given by its places: of another, they would be the wrong ones, or none."""
    kept = Kept()
    early, late = part([(0,), (0, 1)], [5.0, -1.0]), part([(0, 1), (0,)], [-1.0, 5.0])
    assert best(kept, early) == [(0, 0)]
    assert best(kept, late) == [(0, 1)]


def test_what_changed_is_packed_anew_and_the_rest_kept() -> None:
    rng = np.random.default_rng(3)
    kept = Kept()
    groups = [tuple(sorted({int(a), int(a + b)})) for a, b in rng.integers(0, 12, (60, 2))]
    for _ in range(20):
        gains = rng.uniform(-10, 50, len(groups)).tolist()
        by_lead = [[k for k, g in enumerate(groups) if g[0] == lead] for lead in range(24)]
        parts = [part([groups[k] for k in own], [gains[k] for k in own]) for own in by_lead]
        chosen = [by_lead[p][k] for p, k in best(kept, *parts)]
        live = [k for k, gain in enumerate(gains) if gain > 0]
        afresh = best_packing([groups[k] for k in live], [gains[k] for k in live])
        assert sorted(chosen) == sorted(live[k] for k in afresh)
        made = kept.made
        assert best(kept, *parts) == best(kept, *parts)
        assert kept.made == made
