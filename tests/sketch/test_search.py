"""The exact search against trying everything."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sketch.search import best_packing


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
