"""Which readings of ink are chosen together."""

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
