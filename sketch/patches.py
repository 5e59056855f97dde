"""Patches: ink that may be parts of one thing. What is decided of one is decided of no other ink."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from sketch.kept import Kept
from sketch.kernel import together
from sketch.lazy import lazy
from sketch.scoring import Fitted
from sketch.shapes.proposals import Proposed, Row, proposing
from sketch.typing import Array, Point

__all__ = ["Likely", "Patch", "patches"]


@dataclass(eq=False)
class Patch:
    """What pieces propose that share ink with one another, however indirectly, and with no others. Never changed once
    it is made.

    Attributes:
        proposed: by each of the pieces, in the order of drawing.
    """

    proposed: tuple[Proposed, ...]

    @lazy
    def whole(self) -> Proposed:
        """All of it."""
        if len(self.proposed) == 1:
            return self.proposed[0]
        whole = proposing(
            [c for p in self.proposed for c in p.candidates],
            [gain for p in self.proposed for gain in p.gains],
        )
        whole.rows = [row for p in self.proposed for row in p.rows]
        return whole

    @lazy
    def first(self) -> list[int]:
        """Of each that proposed it, which of all of it is the first; and how many there are."""
        return list(accumulate((len(p.candidates) for p in self.proposed), initial=0))

    def along_with(self, k: int) -> range:
        """Which of all of it were proposed by the piece that proposed one of it."""
        n = bisect_right(self.first, k) - 1
        return range(self.first[n], self.first[n + 1])


@dataclass(eq=False)
class Likely:
    """What is likely of one patch. Never changed once it is made.

    Attributes:
        patch: all that is proposed of it.  which: of that.
    """

    patch: Patch
    which: tuple[int, ...]

    @lazy
    def chosen(self) -> list[tuple[Fitted, Row]]:
        """The same, each with where it lies."""
        whole = self.patch.whole
        return [(whole.candidates[k], whole.rows[k]) for k in self.which]

    @lazy
    def closed(self) -> list[tuple[Fitted, Row]]:
        """The closed outlines of these."""
        return [(c, row) for c, row in self.chosen if c.closed]

    @lazy
    def bodies(self) -> list[tuple[Fitted, Row]]:
        """Those, and the crosses."""
        return [(c, row) for c, row in self.chosen if c.closed or c.kind == "cross"]

    @lazy
    def lines(self) -> list[tuple[Fitted, Array, Row]]:
        """The open lines of these, with their courses, as of `Proposed`."""
        return [(c, *self.patch.whole.course(c)) for c, _ in self.chosen if c.kind == "bar"]

    @lazy
    def rings(self) -> list[tuple[float, float, float]]:
        """Middle and extent of each circle [pixels]."""
        return [(*c.middle, row[4]) for c, row in self.closed if c.kind == "circle"]

    @lazy
    def pins(self) -> list[Point]:
        """The middles of the circles [pixels]."""
        return [(x, y) for x, y, _ in self.rings]

    @lazy
    def bars(self) -> list[tuple[Fitted, Row, tuple[int, ...]]]:
        """The bars that are proposed of ink that is nothing but a bar or a cross, each ink once: with where it lies,
        and which of what is proposed are of that ink."""
        whole = self.patch.whole
        taken = {i for c, _ in self.chosen if c.kind not in ("bar", "cross") for i in c.pieces}
        of: dict[tuple[int, ...], list[int]] = {}
        for k in whole.bars:
            if taken.isdisjoint(whole.candidates[k].pieces):
                of.setdefault(whole.candidates[k].pieces, []).append(k)
        return [(whole.candidates[ks[0]], whole.rows[ks[0]], tuple(ks)) for ks in of.values()]


def patches(
    leading: Sequence[int], proposed: Sequence[Proposed], more: Iterable[Sequence[int]], kept: Kept
) -> tuple[list[Patch], list[int]]:
    """The patches of what is proposed, in the order of drawing, and the number of each one's patch.

    leading: the pieces that propose it, in that order.  more: pieces that may be parts of one thing besides.
    """
    inks = [p.ink or [i] for i, p in zip(leading, proposed, strict=True)]
    numbers = together([*inks, *more])[: len(inks)]
    members: list[list[Proposed]] = []
    for n, p in zip(numbers, proposed, strict=True):
        if n == len(members):
            members.append([p])
        else:
            members[n].append(p)
    return [kept(_patch, *own) for own in members], numbers


def _patch(*proposed: Proposed) -> Patch:
    return Patch(proposed)
