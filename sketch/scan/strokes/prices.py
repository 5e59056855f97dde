"""What ink costs to say: each stretch of it freely, and as part of a reading.

A stretch that is left over between two that are not is a stroke of its own, so that is what leaving it costs; stretches
left over together are said for less, as the strokes that they are (`Prices.together`).  What lies within the ink of
other lines where they meet, a crumb, is part of all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sketch.around.context import LARGE
from sketch.page.pieces import Page, Piece
from sketch.scan.binding import coarseness, course_length
from sketch.scan.skeleton.graph import Ink
from sketch.scan.strokes.layout import CRUMB
from sketch.scan.strokes.ways import SIDE, Way
from sketch.scoring import STRANGE, Fitted
from sketch.typing import Points

__all__ = ["Prices", "Taken", "lines"]

# pen widths that ink may be off what was fitted to it, for all that tracing leaves of it in a tangle
OFF = 0.5
SAMPLES = 8  # or a few more points of a stretch that are compared with what was fitted
MOSTLY = 0.1  # of a reading's ink: of two that have such a stretch in common neither stands around the other
STRAIN = 6.0  # nats for each square radian at junctions: an end that lies on a line by chance, ln(page / pen)


@dataclass(frozen=True, eq=False)
class Taken:
    """The ink that a reading of some ways takes.

    Attributes:
        ink: its stretches.  tails: of these, those of tails.
        own: those that no other reading may have.  main: those that are most of it.
        freely: nats to say it freely, less what the ways' turns and ends cost.
        finer: how much finer that is said than as these ways.
    """

    ink: tuple[int, ...]
    tails: frozenset[int]
    own: tuple[int, ...]
    main: tuple[int, ...]
    freely: float
    finer: float


class Prices:
    """What it costs to say each stretch of ink, freely and as part of something."""

    def __init__(self, page: Page, ways: list[Way], likeliest: int, ends: dict[int, int], pen: float) -> None:
        """page: with the ways for pieces, the likeliest first.  likeliest: how many those are, which take all the ink.
        ends: of each stretch but crumbs, as of `lines`.  pen: its width [pixels]."""
        self._ways, self._page, self._ends, self._pen = ways, page, ends, pen
        self._taken: dict[tuple[int, ...], Taken | None] = {}
        self._known: dict[Taken, tuple[Points, NDArray[np.int32], Points]] = {}
        self.free: dict[int, float] = {}  # nats to say each stretch of ink freely, as a stroke of its own,
        self._strange: dict[int, float] = {}  # and of these, those for being one
        self._fine: dict[int, float] = {}  # observations that it is worth in the likeliest ways
        self._scale: dict[int, float] = {}  # [pixels] of the smallest thing that it may be part of
        ink = _all_ink(ways)
        self._some = {name: points[:: len(points) // SAMPLES + 1] for name, points in ink.items()}
        alone = Page()
        alone.add([ink[name] for name in ends])
        alone.settle()
        for k, (name, count) in enumerate(ends.items()):
            if k in alone.pieces:
                p = alone.pieces[k]
                self._strange[name] = self._strangeness(p)
                self.free[name] = p.unread - STRANGE + self._strange[name] + STRAIN * count
        for p in page.pieces.values():
            stretches = ways[p.index].ink
            self._scale.update((name, min(p.scale, self._scale.get(name, np.inf))) for name in stretches)
            if p.index < likeliest:
                whole = max(sum(map(len, stretches.values())), 1)
                for name, points in stretches.items():
                    self._fine[name] = p.observations * len(points) / whole

    def together(self, way: int) -> float:
        """Nats that it saves to leave the stretches of a way over as one stroke."""
        p = self._page.pieces.get(way)
        if p is None:
            return 0.0
        apart = sum(self.free.get(name, 0.0) for name in self._ways[way].ink)
        return apart - (p.unread - STRANGE + self._strangeness(p)) - STRAIN * self._ways[way].strain

    def _strangeness(self, p: Piece) -> float:
        return STRANGE if p.length > SIDE * self._pen else 0.0  # what is no side means nothing

    def of(self, pieces: tuple[int, ...]) -> Taken | None:
        """The ink of some ways; None where two of them are the same ink, or all of it is crumbs."""
        if pieces not in self._taken:
            self._taken[pieces] = self._take(pieces)
        return self._taken[pieces]

    def _take(self, pieces: tuple[int, ...]) -> Taken | None:
        if not all(self._page.apart(i, pieces) for i in pieces):
            return None
        ways = [self._ways[i] for i in pieces]
        tails = frozenset[int]().union(*(way.tail for way in ways))
        ink = {name: points for way in ways for name, points in way.ink.items()}
        kept = tuple(name for name in ink if name in self._ends)
        if not kept:
            return None
        least = MOSTLY * sum(map(len, ink.values()))
        freely = sum(self.free.get(name, 0.0) for name in ink)
        freely -= sum(self._strange.get(name, 0.0) for name in tails)
        said = sum(self._fine.get(name, 0.0) for name in ink)
        return Taken(
            tuple(ink),
            tails,
            kept,
            tuple(name for name, points in ink.items() if len(points) > least),
            freely - STRAIN * sum(way.strain for way in ways),
            max(said / sum(self._page.pieces[i].observations for i in pieces), 1.0),
        )

    def gain(self, c: Fitted, taken: Taken, least: float) -> float:
        """Nats that a reading saves against saying the ink that it takes freely; no more than `least` if less."""
        said = min(c.model, c.cost)  # what is commoner than its kind costs less
        # what is off its ink is said as finely as that ink is said freely, in more strokes maybe, never less finely
        gain = taken.freely - said - (c.cost - said) * taken.finer
        # the strokes of a mark, and of an arrow in one stroke, are judged as a whole
        if gain <= least or self._is_mark(c) or (c.kind == "arrow" and len(c.pieces) == 1):
            return gain
        return gain - self._coarse(c, taken)

    def _is_mark(self, c: Fitted) -> bool:
        """Whether it is an X as large as people draw them on bodies: a larger one has to be drawn as one."""
        return c.kind == "cross" and float(np.ptp(c.outline, axis=0).max()) < LARGE * self._page.size

    def _coarse(self, c: Fitted, taken: Taken) -> float:
        """Nats that a reading owes where it says ink less precisely than the smallest thing that it may be part of
        would: a pivot's ring is no bump on a long side."""
        line = c.outline if c.figure is None else c.figure
        some, ends, worth = self._stretches(taken)
        closed = c.closed or c.figure is not None
        return coarseness(some, ends, worth, line, OFF * self._pen, c.scale, closed=closed)

    def _stretches(self, taken: Taken) -> tuple[Points, NDArray[np.int32], Points]:
        """Some points of each stretch that a reading takes, but tails, up to where each goes, and of each the size of
        the smallest thing that it may be part of, observations and nats, (3, n): many readings take the same."""
        if taken not in self._known:
            names = [name for name in taken.ink if name not in taken.tails]
            some = [self._some[name] for name in names]
            ends = np.cumsum([len(points) for points in some], dtype=np.int32)
            worth = [
                # nothing drawn is smaller than the pen
                (max(self._scale[name], self._pen / 2), self._fine.get(name, 0.0), self.free.get(name, 0.0))
                for name in names
            ]
            self._known[taken] = np.concatenate(some), ends, np.array(worth)
        return self._known[taken]


def lines(ways: list[Way], pen: float) -> dict[int, int]:
    """The stretches of some ways' ink that are more than crumbs: of each, how many of its ends are at others.

    pen: its width, in the pixels of the ways.
    """
    ink = _all_ink(ways)
    ends = np.array([points[[0, -1]] for points in ink.values()]).reshape(-1, 4).view(complex)
    near = np.abs(ends[:, :, None, None] - ends) < pen
    near[np.arange(len(ends)), :, np.arange(len(ends))] = False
    met = near.any(axis=(2, 3)).sum(axis=1).tolist()
    return {
        name: count
        for (name, points), count in zip(ink.items(), met, strict=True)
        if course_length(points) > CRUMB * count * pen
    }


def _all_ink(ways: list[Way]) -> Ink:
    return {name: points for way in ways for name, points in way.ink.items()}
