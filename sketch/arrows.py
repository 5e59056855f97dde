"""Which arrow is gravity: of several the likeliest on free paper. What begins at a body says how that moves, two from
one place are a pair of axes, and a line with a head at either end says how long something is."""

from __future__ import annotations

import math

import numpy as np

from sketch.kernel import depth
from sketch.pieces import Page
from sketch.proposals import Proposed
from sketch.scoring import Fitted

__all__ = ["Pick", "pointing"]

Pick = tuple[int, int]  # what was proposed by which piece, and which of it

# nats that the likeliest arrow is likelier than by its ink, and any other rarer: few pages have two
ONE_ARROW = 15.0
SECOND = 1.0  # nats that it gains more than others: what it is drawn in says nothing of which of them it is,
SURE = 40.0  # and no more than this does how well it is drawn
LONGEST = 10.0  # nats for each time that one is e times as long as another: what is beside a body is smaller
BESIDE = 40.0  # nats that an arrow is rarer that runs along a body or points at one,
NEAR = 0.4  # less, up to this share of its length from it
# One means something else that begins at a body and points away,
AT_BODY, AWAY = 0.25, 0.7  # so near to it, and further from it with its tip, in shares of its length;
SAME_TAIL = 0.2  # that has its tail, as near as that, where another's is,
ALIKE = 2.0  # times as long at most, at a right angle
UPRIGHT = 0.4  # cosine, at most;
MARK = 0.3  # or that has a head at its tail too: ink so large, in shares of its length,
AT_TAIL = 0.05  # so near, on both sides
SIDES = 0.015  # as far
PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)  # shares of its length at which it is asked how far off a body it is


def pointing(
    page: Page, proposed: list[Proposed], told: list[list[float]], likely: list[Pick]
) -> tuple[list[list[float]], set[int]]:
    """Gains, with one arrow likelier and the others rarer; and the pieces of likely arrows that mean something else.

    told: the gains of all that is proposed.  likely: which of it the ink makes likely.
    """
    every = [(n, k) for n, p in enumerate(proposed) for k in p.arrows if told[n][k] > -ONE_ARROW]
    if not every:
        return told, set()
    arrows = _Arrows(page, proposed, likely)
    losses = {(n, k): arrows.loss(proposed[n].candidates[k]) for n, k in every}
    first = _first(proposed, told, likely, losses)
    its: set[int] = set() if first is None else set(proposed[first[0]].candidates[first[1]].pieces)
    most = math.inf if first is None else told[first[0]][first[1]] - losses[first] + ONE_ARROW
    out = list(told)
    for (n, k), loss in losses.items():
        out[n] = own = list(told[n]) if out[n] is told[n] else out[n]
        c = proposed[n].candidates[k]
        if its.isdisjoint(c.pieces):
            own[k] = min(own[k] - loss - ONE_ARROW, most - SECOND)
        else:
            own[k] += ONE_ARROW - loss
    other = {
        i
        for pick in likely
        if losses.get(pick) == math.inf
        for i in proposed[pick[0]].candidates[pick[1]].pieces
    }
    return out, other


def _first(
    proposed: list[Proposed],
    told: list[list[float]],
    likely: list[Pick],
    losses: dict[Pick, float],
) -> Pick | None:
    """The likeliest arrow: of those that are likely, or else on ink that is nothing likelier."""
    free = [pick for pick, loss in losses.items() if loss < math.inf]
    arrows = [pick for pick in free if pick in likely]
    if not arrows:
        others = (proposed[n].candidates[k] for n, k in likely)
        taken = {i for c in others if c.kind != "bar" for i in c.pieces}
        arrows = [(n, k) for n, k in free if taken.isdisjoint(proposed[n].candidates[k].pieces)]

    def gain(pick: Pick) -> float:
        n, k = pick
        long = math.dist(*proposed[n].candidates[k].outline.tolist())
        return min(told[n][k], SURE) - losses[pick] + LONGEST * math.log(max(long, 1e-9))

    return max(arrows, key=gain, default=None)


class _Arrows:
    """What stands around arrows, to be asked of each whether it means something else than gravity."""

    def __init__(self, page: Page, proposed: list[Proposed], likely: list[Pick]) -> None:
        self._page = page
        chosen = [(proposed[n].candidates[k], proposed[n].rows[k]) for n, k in likely]
        self._bodies = [c for c, _ in chosen if c.closed]
        self._boxes = np.array([row[:4] for c, row in chosen if c.closed]).reshape(-1, 4)
        self._arrows = [c for c, _ in chosen if c.kind == "arrow"]
        taken = {i for c in self._bodies for i in c.pieces}
        self._idle = [p for i, p in page.pieces.items() if i not in taken]

    def loss(self, arrow: Fitted) -> float:
        """Nats that an arrow is rarer as gravity than by its ink; infinite if it means something else."""
        tail, tip = arrow.outline
        long = max(math.dist(tail, tip), 1e-9)
        bodies = self._near(arrow, NEAR * long)
        if self._is_axis(arrow, long) or self._has_two_heads(arrow, long):
            return math.inf
        along = NEAR * long
        for body in bodies:
            first, *others = (depth(x, y, body.outline) for x, y in (tail + t * (tip - tail) for t in PLACES))
            if first < AT_BODY * long and others[-1] - first > AWAY * long:
                return math.inf
            along = min(along, first, *others)
        return BESIDE * (1 - max(along, 0.0) / (NEAR * long))

    def _near(self, arrow: Fitted, reach: float) -> list[Fitted]:
        """The bodies of other ink that may be within `reach` of an arrow [pixels]."""
        low, high = arrow.outline.min(axis=0) - reach, arrow.outline.max(axis=0) + reach
        near = ((self._boxes[:, :2] < high) & (self._boxes[:, 2:] > low)).all(axis=1)
        bodies = (self._bodies[b] for b in np.flatnonzero(near).tolist())
        return [body for body in bodies if set(arrow.pieces).isdisjoint(body.pieces)]

    def _is_axis(self, arrow: Fitted, long: float) -> bool:
        """Whether another arrow begins where it does, at a right angle."""
        tail, way = arrow.outline[0], arrow.outline[1] - arrow.outline[0]
        for other in self._arrows:
            its, wide = other.outline[1] - other.outline[0], math.dist(*other.outline)
            if (
                set(arrow.pieces).isdisjoint(other.pieces)
                and max(long, wide) < ALIKE * min(long, wide)
                and math.dist(tail, other.outline[0]) < SAME_TAIL * min(long, wide)
                and abs(way @ its) < UPRIGHT * long * wide
            ):
                return True
        return False

    def _has_two_heads(self, arrow: Fitted, long: float) -> bool:
        """Whether there is ink at its tail, on both sides, that means nothing else."""
        (x, y), (ux, uy) = arrow.outline[0], (arrow.outline[1] - arrow.outline[0]) / long
        sides = []
        for p in self._idle:
            x0, y0, x1, y1 = p.box
            r = AT_TAIL * long
            if (
                p.extent > MARK * long
                or p.index in arrow.pieces
                or not (x0 - r < x < x1 + r and y0 - r < y < y1 + r)
            ):
                continue
            off = self._page.strokes.samples[p.stroke] - (x, y)
            if np.hypot(*off.T).min() < r:
                sides.append(off @ (-uy, ux))
        if not sides:
            return False
        across = np.concatenate(sides)
        return bool(across.min() < -SIDES * long and across.max() > SIDES * long)
