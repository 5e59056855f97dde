"""What was drawn in parts and read apart, merged: bodies and marks gone over, and arrows whose shaft was drawn in two.

That two readings are one thing is known of the pair. The search scores each reading by itself, so it cannot tell;
what it chose is looked at afterwards.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sketch.kernel import depth
from sketch.page.near import boxes_around
from sketch.scoring import Fitted
from sketch.shapes.bars import ASIDE, LIFT
from sketch.typing import Array

__all__ = ["Chosen", "merged"]

# of a body's size, or of a mark's length: two nowhere further apart are one, gone over
SAME_PLACE = 0.2


class Chosen(NamedTuple):
    """A reading that is part of the best explanation.

    Attributes:
        fit: what some ink was taken for.
        gain: what that saves against saying the ink freely, with all that is around [nats].
    """

    fit: Fitted
    gain: float

    def along_with(self, other: Chosen) -> Chosen:
        """The same reading, of the other's pieces too, with what both gain."""
        pieces = tuple(sorted((*self.fit.pieces, *other.fit.pieces)))
        return Chosen(replace(self.fit, pieces=pieces), self.gain + other.gain)


def merged(chosen: list[Chosen]) -> list[Chosen]:
    """The same explanation with each body and each mark in one reading, though it was drawn in parts."""
    chosen = _bodies_gone_over(chosen)
    others = [c for c in chosen if c.fit.kind not in ("arrow", "cross")]
    crosses = _marks_gone_over([c for c in chosen if c.fit.kind == "cross"])
    arrows = _marks_gone_over([c for c in chosen if c.fit.kind == "arrow"])
    return _with_tails(arrows, others + crosses)


def _bodies_gone_over(chosen: list[Chosen]) -> list[Chosen]:
    """The chosen, with bodies that were drawn over one another in full joined to the best of them: no two bodies have
    one place."""
    chosen = sorted(chosen, key=lambda c: -c.gain)
    closed = [k for k, c in enumerate(chosen) if c.fit.closed]
    scale = np.array([chosen[k].fit.scale for k in closed])
    at = np.array([chosen[k].fit.middle for k in closed]).reshape(-1, 2)
    far = SAME_PLACE * np.maximum(scale, scale[:, None])
    close = np.abs(scale - scale[:, None]) <= far
    for side in at.T:
        close &= np.abs(side[:, None] - side) <= far
    gone: set[int] = set()  # into another
    for a, b in np.argwhere(np.triu(close, 1)).tolist():
        k, j = closed[a], closed[b]
        if k not in gone and j not in gone and _in_one_place(chosen[j].fit, chosen[k].fit):
            gone.add(j)
            chosen[k] = chosen[k].along_with(chosen[j])
    return [chosen[k] for k in range(len(chosen)) if k not in gone]


def _in_one_place(a: Fitted, b: Fitted) -> bool:
    if abs(a.scale - b.scale) > SAME_PLACE * max(a.scale, b.scale):
        return False
    if math.dist(a.middle, b.middle) > SAME_PLACE * a.scale:
        return False
    return all(
        abs(depth(x, y, other.outline)) < SAME_PLACE * a.scale
        for one, other in ((a, b), (b, a))
        for x, y in one.outline.tolist()
    )


def _marks_gone_over(marks: list[Chosen]) -> list[Chosen]:
    """Some arrows, or some crosses, with those between the same places joined to the best of them."""
    marks = sorted(marks, key=lambda c: -c.gain)
    boxes = boxes_around([c.fit.outline for c in marks])
    reach = np.array([SAME_PLACE * math.dist(*c.fit.outline[:2].tolist()) for c in marks])
    apart = [np.abs(side[:, None] - side) for side in boxes.T]
    close = np.maximum.reduce(apart) < reach  # for else their ends are further apart
    whole: dict[int, Chosen] = {}
    for n, mark in enumerate(marks):
        for k in np.flatnonzero(close[n, :n]).tolist():
            if k in whole and _ends_apart(mark.fit, whole[k].fit) < reach[k]:
                whole[k] = whole[k].along_with(mark)
                break
        else:
            whole[n] = mark
    return list(whole.values())


def _ends_apart(mark: Fitted, other: Fitted) -> float:
    """How far apart the tails or the tips of two arrows are, or the ends of two crosses' bars, at most [pixels]."""
    ends, its = mark.outline.tolist(), other.outline.tolist()
    if mark.kind == "arrow":
        return max(map(math.dist, ends, its))
    return max(min(math.dist(p, q) for q in places) for of, places in ((ends, its), (its, ends)) for p in of)


def _with_tails(arrows: list[Chosen], others: list[Chosen]) -> list[Chosen]:
    """All that was chosen, with bars that are the far parts of arrows' shafts joined to these: the pen was lifted."""
    others = list(others)
    bars = [c for c in others if c.fit.kind == "bar" and len(c.fit.outline) == 2]
    at = np.array([bar.fit.outline for bar in bars]).reshape(-1, 2, 2)
    whole = []
    for arrow in arrows:
        tail, tip = arrow.fit.outline
        lift = np.hypot(*(at - tail).transpose(2, 0, 1)).min(axis=1)
        near = np.flatnonzero(lift < 1.001 * LIFT * np.hypot(*(at - tip).transpose(2, 0, 1)).max(axis=1))
        for bar in (bars[n] for n in near.tolist()):
            beyond = _tail_beyond(arrow.fit, bar.fit)
            if beyond is not None and bar in others:
                others.remove(bar)
                fit, gain = arrow.along_with(bar)
                arrow = Chosen(replace(fit, outline=np.array([beyond, tip])), gain)
                break
        whole.append(arrow)
    return others + whole


def _tail_beyond(arrow: Fitted, bar: Fitted) -> Array | None:
    """The far end of a bar that goes on where an arrow's shaft begins, in line with it."""
    tail, tip = arrow.outline
    near, far = sorted(bar.outline, key=lambda end: math.dist(end, tail))
    shaft, whole = tip - tail, tip - far
    long = float(np.hypot(*whole))
    off = abs(whole[0] * shaft[1] - whole[1] * shaft[0]) / max(float(np.hypot(*shaft)), 1e-9)
    along = float((near - far) @ whole) / long
    goes_on = math.dist(near, tail) < LIFT * long and along > 0 and np.hypot(*shaft) < long
    return far if goes_on and off < ASIDE * long else None
