"""What was drawn in parts and read apart, merged: bodies and marks gone over, and arrows whose shaft was drawn in two.

That two readings are one thing is known of the pair. The search scores each reading by itself, so it cannot tell;
what it chose is looked at afterwards.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sketch.kept import Kept
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


def merged(chosen: list[Chosen], kept: Kept) -> list[Chosen]:
    """The same explanation with each body and each mark in one reading, though it was drawn in parts."""
    chosen = _bodies_gone_over(chosen, kept)
    others = [c for c in chosen if c.fit.kind not in ("arrow", "cross")]
    crosses = _marks_gone_over([c for c in chosen if c.fit.kind == "cross"], kept)
    arrows = _marks_gone_over([c for c in chosen if c.fit.kind == "arrow"], kept)
    return _with_tails(arrows, others + crosses, kept)


def _bodies_gone_over(chosen: list[Chosen], kept: Kept) -> list[Chosen]:
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
    for a, b in np.argwhere(close).tolist():
        k, j = closed[a], closed[b]
        if k < j and k not in gone and j not in gone and _in_one_place(chosen[j].fit, chosen[k].fit):
            gone.add(j)
            chosen[k] = kept(Chosen.along_with, chosen[k], chosen[j])
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


def _marks_gone_over(marks: list[Chosen], kept: Kept) -> list[Chosen]:
    """Some arrows, or some crosses, with those between the same places joined to the best of them."""
    if len(marks) < 2:
        return marks
    marks = sorted(marks, key=lambda c: -c.gain)
    boxes = boxes_around([c.fit.outline for c in marks])
    reach = np.array([SAME_PLACE * math.dist(*c.fit.outline[:2].tolist()) for c in marks])
    apart = [np.abs(side[:, None] - side) for side in boxes.T]
    close = np.maximum.reduce(apart) < reach  # for else their ends are further apart
    before: dict[int, list[int]] = {}
    for n, k in np.argwhere(close).tolist():
        if k < n:
            before.setdefault(n, []).append(k)
    whole: dict[int, Chosen] = {}
    for n, mark in enumerate(marks):
        for k in before.get(n, ()):
            if k in whole and _ends_apart(mark.fit, whole[k].fit) < reach[k]:
                whole[k] = kept(Chosen.along_with, whole[k], mark)
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


def _with_tails(arrows: list[Chosen], others: list[Chosen], kept: Kept) -> list[Chosen]:
    """All that was chosen, with bars that are the far parts of arrows' shafts joined to these: the pen was lifted."""
    bars = [c for c in others if c.fit.kind == "bar" and len(c.fit.outline) == 2]
    if not bars or not arrows:
        return others + arrows
    tails, tips = np.array([arrow.fit.outline for arrow in arrows]).transpose(1, 0, 2)[:, :, None, None]
    at = np.array([bar.fit.outline for bar in bars])
    lift = np.hypot(*(at - tails).transpose(3, 0, 1, 2)).min(axis=2)
    near = lift < 1.001 * LIFT * np.hypot(*(at - tips).transpose(3, 0, 1, 2)).max(axis=2)
    whole, others = list(arrows), list(others)
    for k, n in np.argwhere(near).tolist():
        if whole[k] is arrows[k] and bars[n] in others:
            joined = kept(_along, arrows[k], bars[n])
            if joined is not None:
                others.remove(bars[n])
                whole[k] = joined
    return others + whole


def _along(arrow: Chosen, bar: Chosen) -> Chosen | None:
    """An arrow whose shaft begins with a bar, if that goes on where it begins."""
    beyond = _tail_beyond(arrow.fit, bar.fit)
    if beyond is None:
        return None
    fit, gain = arrow.along_with(bar)
    return Chosen(replace(fit, outline=np.array([beyond, arrow.fit.outline[1]])), gain)


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
