"""Which readings of ink are chosen together."""

import time
from itertools import combinations

import numpy as np

from sketch.scan.strokes.together import Together

FREE = dict.fromkeys(range(9), 60.0)


def test_what_two_bodies_have_in_common_is_part_of_both() -> None:
    """Each has a stretch that the other needs too; a third would take all but two of the stretches for itself."""
    own = [(0, 1, 2, 3), (3, 4, 5, 6), (1, 2, 3, 4, 5)]
    together = Together(own, [], FREE, dict.fromkeys(range(9), 3.0))
    chosen, saved = together.best([200.0, 200.0, 270.0])
    assert sorted(chosen) == [0, 1]
    assert saved == -60.0 - 3.0 * 4.0  # said twice, and a coincidence


def test_bodies_that_run_along_each_other_for_long_do_not_both_say_that_ink() -> None:
    own = [(0, 1, 2, 3), (3, 4, 5, 6), (4, 5, 6)]
    together = Together(own, [], FREE, dict.fromkeys(range(9), 30.0))
    chosen, saved = together.best([200.0, 200.0, 130.0])
    assert (sorted(chosen), saved) == ([0, 2], 0.0)


def test_what_is_left_over_together_is_no_other_readings_ink() -> None:
    together = Together([(0, 1), (2, 3)], [((1, 2), 50.0)], FREE, dict.fromkeys(range(9), 1.0))
    assert together.best([30.0, 10.0]) == ([], 50.0)


def test_no_set_of_a_few_readings_gains_more_than_the_one_that_is_chosen() -> None:
    rng, missed = np.random.default_rng(5), 0
    for _ in range(60):
        own = [tuple(rng.choice(9, rng.integers(1, 5), replace=False).tolist()) for _ in range(8)]
        gains = [float(g) for g in rng.uniform(0, 60, 8) * [len(ink) for ink in own]]
        together = Together(own, [], FREE, dict.fromkeys(range(9), 1.0))
        chosen, saved = together.best(gains)

        def gain(
            some: tuple[int, ...], own: list[tuple[int, ...]] = own, gains: list[float] = gains
        ) -> float:
            every = [name for k in some for name in own[k]]
            both = sum(len(set(own[i]) & set(own[j])) for i, j in combinations(some, 2))
            twice = len(every) - len(set(every))
            return sum(gains[k] for k in some) - 60.0 * twice - 4.0 * both

        most = max(gain(some) for size in range(9) for some in combinations(range(8), size))
        assert abs(sum(gains[k] for k in chosen) + saved - gain(tuple(chosen))) < 1e-6
        missed += gain(tuple(chosen)) < most - 1.0
    assert missed <= 3


def test_covers_are_looked_for_in_one_thread() -> None:
    """Others would wait for their share at full speed, which takes longer than the work."""
    rng = np.random.default_rng(6)
    own = [tuple(rng.choice(120, 3, replace=False).tolist()) for _ in range(400)]
    together = Together(own, [], dict.fromkeys(range(120), 60.0), dict.fromkeys(range(120), 3.0))
    gains = rng.uniform(0, 180, 400).tolist()
    together.best(gains)
    before = time.process_time() - time.thread_time()
    for _ in range(5):
        together.best(gains)
    assert time.process_time() - time.thread_time() - before < 0.02
