"""What stands around a reading: told last, in nats, so that it decides between readings that are nearly
equal."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import depth
from sketch.proposals import Box, Proposed
from sketch.scoring import Fitted

__all__ = ["Context"]

Array = NDArray[np.float64]

# nats that an X, or a small circle, is likelier over a body, or over two, than elsewhere; an arrow less
ANCHORS = 15.0
NO_BODY = 30.0  # nats that an X away from every body is unlikely: it would mean nothing
ON_LINE = 0.5  # of an X's extent: a line that goes by its middle as near as that is what it stands on,
LARGER = 2.0  # times as large as the X, at least: else it is a part of an asterisk
ONE_ARROW = (
    15.0  # nats that the likeliest arrow is likelier than by its ink, and any other rarer: few pages have two
)
SLIP = 25.0  # nats that a short mark on an outline is a slip of the pen and no rod
TOUCHING = 30.0  # nats that small bars which touch are no rods but a letter
NEAR_BY = 0.25  # of a bar's extent: as near as the strokes of a letter are
LETTER = 0.15  # of the page: larger bars are no letter
TWIG = 0.04  # of the page: an open line that is shorter is a slip too
DOT = 0.012  # of the page: nobody draws a smaller body
DOT_SPREAD = 0.1  # of the logarithm of a size, below that


class Context:
    """What the likely bodies say of the marks on and around them; kept for ink whose surroundings stay."""

    def __init__(self) -> None:
        self._known: dict[Proposed, tuple[list[Fitted], float, list[float]]] = {}

    def gains(
        self,
        proposed: list[Proposed],
        candidates: list[Fitted],
        chosen: list[int],
        size: float,
    ) -> list[float]:
        """The gains, given the bodies (`chosen` candidates) that the ink by itself makes likely.

        proposed: whose candidates are `candidates`, one after another.  size: of the page [pixels].
        """
        around = [k for k in chosen if candidates[k].closed or candidates[k].kind == "cross"]
        boxes = np.concatenate([np.empty((0, 4)), *(p.boxes for p in proposed)])
        bodies = _Bodies([candidates[k] for k in around], boxes[around])
        known, self._known = self._known, {}
        out: list[float] = []
        for p, near in zip(proposed, bodies.beside([p.box for p in proposed]), strict=True):
            there = known.get(p)
            its = [bodies.bodies[b] for b in near]
            if there is None or there[0] != its or there[1] != size:
                there = its, size, _told(p, _Bodies(its, bodies.boxes[near]), size)
            self._known[p] = there
            out += there[2]
        first = _first_arrow(candidates, out, chosen)
        for k, c in enumerate(candidates):
            if c.kind == "arrow" and first:
                out[k] += -ONE_ARROW if first.isdisjoint(c.pieces) else ONE_ARROW
        for k in _letters(candidates, out, chosen, LETTER * size):
            out[k] -= TOUCHING
        return out


def _told(proposed: Proposed, bodies: _Bodies, size: float) -> list[float]:
    """The gains of one piece's proposals, given the bodies around them."""
    gains = list(proposed.gains)
    for k, c in enumerate(proposed.candidates):
        if gains[k] < -NO_BODY:
            continue
        extent = _extent(c.outline)
        if c.closed and extent < DOT * size:  # where the pen rested
            gains[k] -= 0.5 * (math.log(DOT * size / max(extent, 1e-9)) / DOT_SPREAD) ** 2
        if c.kind == "cross":
            gains[k] += ANCHORS if bodies.around(c, 0.0) else -NO_BODY
        elif c.kind == "arrow":
            gains[k] -= ANCHORS * (bodies.around(c, 0.0) > 0)
        elif c.kind == "bar":
            gains[k] -= SLIP * (bodies.slip(c, extent) or extent < TWIG * size)
            gains[k] += NO_BODY * bodies.ground(c)
        elif c.kind == "circle" and bodies.around(c, extent / 2, 3 * extent) > 1:
            gains[k] += ANCHORS
    return gains


def _first_arrow(candidates: list[Fitted], gains: list[float], chosen: list[int]) -> set[int]:
    """The pieces of the likeliest arrow: of those chosen, or else on ink that is nothing likelier."""
    arrows = [k for k in chosen if candidates[k].kind == "arrow"]
    if not arrows:
        taken = {i for k in chosen if candidates[k].kind != "bar" for i in candidates[k].pieces}
        arrows = [k for k, c in enumerate(candidates) if c.kind == "arrow" and taken.isdisjoint(c.pieces)]
    return set(candidates[max(arrows, key=lambda k: gains[k])].pieces) if arrows else set()


def _letters(candidates: list[Fitted], gains: list[float], chosen: list[int], largest: float) -> list[int]:
    """Bars no larger than `largest` [pixels] that touch or cross one another, with no small circle there to join them.

    A letter, an asterisk, a battery's sign are that; rods that are meant to do something are joined, or large.
    """
    taken = {i for k in chosen if candidates[k].kind not in ("bar", "cross") for i in candidates[k].pieces}
    pins = [candidates[k].outline.mean(axis=0) for k in chosen if candidates[k].kind == "circle"]
    bars = [
        (k, c, _dense(c.outline))
        for k, c in enumerate(candidates)
        if c.kind == "bar" and gains[k] > 0 and taken.isdisjoint(c.pieces) and _extent(c.outline) < largest
    ]
    bars.sort(key=lambda t: t[2][:, 0].min())
    found: set[int] = set()
    for a, (k, c, dense) in enumerate(bars):
        reach = NEAR_BY * _extent(c.outline)
        for j, other, points in bars[a + 1 :]:
            if points[:, 0].min() > dense[:, 0].max() + reach:
                break
            gap = np.hypot(*(dense[:, None] - points[None]).transpose(2, 0, 1))
            if gap.min() > reach or c.pieces == other.pieces:
                continue
            at = dense[int(gap.min(axis=1).argmin())]
            if not any(math.dist(pin, at) < 2 * reach for pin in pins):
                found |= {k, j}
    return sorted(found)


def _dense(line: Array) -> Array:
    t = np.linspace(0, 1, 16)[:, None, None]
    return np.asarray((line[:-1] + t * (line[1:] - line[:-1])).reshape(-1, 2))


def _extent(outline: Array) -> float:
    width, height = (outline.max(axis=0) - outline.min(axis=0)).tolist()
    return math.hypot(width, height)


class _Bodies:
    """The likely bodies, and the marks on them, to be asked which of them are at a place."""

    def __init__(self, bodies: list[Fitted], boxes: Array) -> None:
        self.bodies = bodies
        self.boxes = boxes
        self.low, self.high = boxes[:, :2], boxes[:, 2:]
        self.extent = np.hypot(*(self.high - self.low).T)

    def beside(self, boxes: list[Box]) -> list[list[int]]:
        """Which bodies can matter to marks in each of these boxes."""
        out: list[list[int]] = [[] for _ in boxes]
        if not self.bodies or not boxes:
            return out
        x0, y0, x1, y1 = np.array(boxes).T[:, :, None]
        r = np.maximum(0.1 * self.extent, np.hypot(np.maximum(x1 - x0, 0), np.maximum(y1 - y0, 0)))
        close = (self.low[:, 0] - r <= x1) & (self.low[:, 1] - r <= y1)
        close &= (self.high[:, 0] + r >= x0) & (self.high[:, 1] + r >= y0)
        for i, b in np.argwhere(close).tolist():
            out[i].append(b)
        return out

    def near(self, x: float, y: float, reach: float | Array) -> list[int]:
        if not self.bodies:
            return []
        r = np.asarray(reach)
        close = (
            (self.low[:, 0] - r <= x)
            & (self.low[:, 1] - r <= y)
            & (self.high[:, 0] + r >= x)
            & (self.high[:, 1] + r >= y)
        )
        return [int(b) for b in np.flatnonzero(close)]

    def around(self, c: Fitted, reach: float, least: float = 0.0) -> int:
        """How many bodies of other ink, at least so large, have c's centre within them or within `reach`."""
        x, y = c.outline.mean(axis=0).tolist()
        mine = set(c.pieces)
        return sum(
            self.bodies[b].closed
            and self.extent[b] > least
            and mine.isdisjoint(self.bodies[b].pieces)
            and depth(x, y, self.bodies[b].outline) < reach
            for b in self.near(x, y, reach)
        )

    def slip(self, c: Fitted, extent: float) -> bool:
        """Whether an end of c touches the outline of a body of other ink that is twice as large."""
        mine = set(c.pieces)
        for x, y in (c.outline[0].tolist(), c.outline[-1].tolist()):
            for b in self.near(x, y, 0.1 * self.extent):
                large, other = self.extent[b], self.bodies[b]
                touches = other.closed and abs(depth(x, y, other.outline)) < 0.1 * large
                if touches and extent < 0.5 * large and mine.isdisjoint(other.pieces):
                    return True
        return False

    def ground(self, line: Fitted) -> bool:
        """Whether an X of other ink stands on an open line, and on no closed outline."""
        mine, dense = set(line.pieces), _dense(line.outline)
        most = _extent(line.outline) / LARGER
        for extent, mark in zip(self.extent, self.bodies, strict=True):
            if mark.kind == "cross" and extent < most and mine.isdisjoint(mark.pieces):
                off = np.hypot(*(dense - mark.outline.mean(axis=0)).T).min()
                if off < ON_LINE * extent and not self.around(mark, 0.0):
                    return True
        return False
