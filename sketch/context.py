"""What stands around a reading: told last, in nats, so that it decides between readings that are nearly
equal."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import beside, depth
from sketch.proposals import Box, Proposed
from sketch.scoring import Fitted

__all__ = ["Context"]

Array = NDArray[np.float64]
Row = list[float]  # of a reading: its least x, least y, greatest x, greatest y and extent [pixels]
Gaps = dict[tuple[Fitted, Fitted], tuple[float, Array]]  # of open lines: how wide [pixels], and where

# nats that an X, or a small circle, is likelier over a body, or over two, than elsewhere; an arrow less
ANCHORS = 15.0
NO_BODY = 33.0  # nats that an X away from every body is unlikely: it would mean nothing
ON_LINE = 0.5  # of an X's extent: a line that goes by its middle as near as that is what it stands on,
LARGER = 2.0  # times as large as the X, at least: else it is a part of an asterisk
ONE_ARROW = (
    15.0  # nats that the likeliest arrow is likelier than by its ink, and any other rarer: few pages have two
)
SLIP = 25.0  # nats that a short mark on an outline is a slip of the pen and no rod
TOUCHING = 30.0  # nats that small bars which touch are no rods but a letter
NEAR_BY = 0.25  # of a bar's extent: as near as the strokes of a letter are
LETTER = 0.15  # of the page: larger bars are no letter
DENSE = 64  # points of an open line that are compared with others, or so
TWIG = 0.04  # of the page: an open line, or an arrow, that is shorter is a slip too
DOT = 0.012  # of the page: nobody draws a smaller body
DOT_SPREAD = 0.1  # of the logarithm of a size, below that


class Context:
    """What the likely bodies say of the marks on and around them; kept for ink whose surroundings stay."""

    def __init__(self) -> None:
        self._gaps: Gaps = {}
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
        extents = np.hypot(*(boxes[:, 2:] - boxes[:, :2]).T)
        rows = np.column_stack([boxes, extents]).tolist()
        bodies = _Bodies([candidates[k] for k in around], [rows[k] for k in around])
        known, self._known = self._known, {}
        out: list[float] = []
        for p, near in zip(proposed, bodies.beside([p.box for p in proposed]), strict=True):
            there = known.get(p)
            its = [bodies.bodies[b] for b in near]
            if there is None or there[0] != its or there[1] != size:
                own = rows[len(out) : len(out) + len(p.candidates)]
                there = its, size, _told(p, own, _Bodies(its, [bodies.rows[b] for b in near]), size)
            self._known[p] = there
            out += there[2]
        first = _first_arrow(candidates, out, chosen)
        for k, c in enumerate(candidates):
            if c.kind == "arrow" and first:
                out[k] += -ONE_ARROW if first.isdisjoint(c.pieces) else ONE_ARROW
        for k in _letters(candidates, out, chosen, LETTER * size, self._gaps):
            out[k] -= TOUCHING
        return out


def _told(proposed: Proposed, rows: list[Row], bodies: _Bodies, size: float) -> list[float]:
    """The gains of one piece's proposals, given where each is and the bodies around them."""
    gains = list(proposed.gains)
    for k, (c, row) in enumerate(zip(proposed.candidates, rows, strict=True)):
        if gains[k] < -NO_BODY:
            continue
        extent = row[4]
        if c.closed and extent < DOT * size:  # where the pen rested
            gains[k] -= 0.5 * (math.log(DOT * size / max(extent, 1e-9)) / DOT_SPREAD) ** 2
        if c.kind == "cross":
            large = extent > LETTER * size  # nobody writes an X so large: two rods
            gains[k] += ANCHORS if bodies.around(c, 0.0) else -NO_BODY * (1 + large)
        elif c.kind == "arrow":
            gains[k] -= ANCHORS * (bodies.around(c, 0.0) > 0)
            gains[k] -= SLIP * ((extent < TWIG * size) + bodies.slip(c, extent))
        elif c.kind == "bar":
            gains[k] -= SLIP * (extent < TWIG * size or bodies.slip(c, extent))
            gains[k] += NO_BODY * bodies.ground(c, row)
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


def _letters(
    candidates: list[Fitted], gains: list[float], chosen: list[int], largest: float, known: Gaps
) -> list[int]:
    """Bars no larger than `largest` [pixels] that touch or cross one another, with no small circle there to join them.

    A letter, an asterisk, a battery's sign are that; rods that are meant to do something are joined, or large.
    known: gaps of the last time, replaced by those of this one.
    """
    taken = {i for k in chosen if candidates[k].kind not in ("bar", "cross") for i in candidates[k].pieces}
    pins = [candidates[k].middle for k in chosen if candidates[k].kind == "circle"]
    readings: dict[tuple[int, ...], list[int]] = {}  # a stroke too short or bent for a rod is in a letter too
    for k, c in enumerate(candidates):
        if c.kind == "bar" and taken.isdisjoint(c.pieces):
            readings.setdefault(c.pieces, []).append(k)
    bars: list[tuple[float, float, float, float, Fitted]] = []
    for k, *_ in readings.values():
        c = candidates[k]
        (x0, y0), (x1, y1) = c.outline.min(axis=0).tolist(), c.outline.max(axis=0).tolist()
        if math.hypot(x1 - x0, y1 - y0) < largest:
            bars.append((x0, y0, x1, y1, c))
    bars.sort(key=lambda t: t[:4])
    found: set[int] = set()
    now: Gaps = {}
    longest = max((math.hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1, _ in bars), default=0.0)
    for a, (x0, y0, x1, y1, c) in enumerate(bars):
        for left, top, right, bottom, other in bars[a + 1 :]:
            if left > x1 + NEAR_BY * longest:
                break
            if not set(c.pieces).isdisjoint(other.pieces):
                continue
            reach = NEAR_BY * max(math.hypot(x1 - x0, y1 - y0), math.hypot(right - left, bottom - top))
            if left > x1 + reach or top > y1 + reach or bottom < y0 - reach:
                continue
            pair = c, other
            gap, at = now[pair] = known.get(pair) or _closest(c.outline, other.outline)
            if gap <= reach and not any(math.dist(pin, at) < 2 * reach for pin in pins):
                found.update(readings[c.pieces], readings[other.pieces])
    known.clear()
    known.update(now)
    return sorted(found)


def _closest(a: Array, b: Array) -> tuple[float, Array]:
    """How near two open lines come to each other [pixels], and where on the first."""
    dense, other = _dense(a), _dense(b)
    gap = np.hypot(dense[:, None, 0] - other[:, 0], dense[:, None, 1] - other[:, 1])
    nearest = gap.min(axis=1)
    return float(nearest.min()), dense[int(nearest.argmin())]


def _dense(line: Array) -> Array:
    t = np.linspace(0, 1, max(2, min(16, DENSE // (len(line) - 1))))[:, None, None]
    return np.asarray((line[:-1] + t * (line[1:] - line[:-1])).reshape(-1, 2))


class _Bodies:
    """The likely bodies, and the marks on them, to be asked which of them are at a place."""

    def __init__(self, bodies: list[Fitted], rows: list[Row]) -> None:
        self.bodies = bodies
        self.rows = rows
        self.closed = [(body, row) for body, row in zip(bodies, rows, strict=True) if body.closed]
        self.crosses = [(c, row[4]) for c, row in zip(bodies, rows, strict=True) if c.kind == "cross"]

    def beside(self, boxes: list[Box]) -> list[list[int]]:
        """Which bodies can matter to marks in each of these boxes."""
        out: list[list[int]] = [[] for _ in boxes]
        for i, b in beside(np.array(boxes), np.array(self.rows)) if self.bodies and boxes else ():
            out[i].append(b)
        return out

    def around(self, c: Fitted, reach: float, least: float = 0.0) -> int:
        """How many bodies of other ink, at least so large, have c's centre within them or within `reach`."""
        if not self.closed:
            return 0
        (x, y), count = c.middle, 0
        for body, (x0, y0, x1, y1, extent) in self.closed:
            if (
                x0 - reach <= x <= x1 + reach
                and y0 - reach <= y <= y1 + reach
                and extent > least
                and not set(c.pieces).intersection(body.pieces)
            ):
                count += depth(x, y, body.outline) < reach
        return count

    def slip(self, c: Fitted, extent: float) -> bool:
        """Whether an end of c touches the outline of a body of other ink that is twice as large."""
        large = [(body, row) for body, row in self.closed if extent < 0.5 * row[4]]
        for x, y in (c.outline[0].tolist(), c.outline[-1].tolist()) if large else ():
            for body, (x0, y0, x1, y1, other) in large:
                r = 0.1 * other
                if (
                    x0 - r <= x <= x1 + r
                    and y0 - r <= y <= y1 + r
                    and abs(depth(x, y, body.outline)) < r
                    and not set(c.pieces).intersection(body.pieces)
                ):
                    return True
        return False

    def ground(self, line: Fitted, row: Row) -> bool:
        """Whether an X of other ink stands on an open line, and on no closed outline."""
        x0, y0, x1, y1, long = row
        for mark, extent in self.crosses:
            if extent >= long / LARGER or set(line.pieces).intersection(mark.pieces):
                continue
            (x, y), reach = mark.middle, ON_LINE * extent
            if x0 - reach <= x <= x1 + reach and y0 - reach <= y <= y1 + reach:
                off = np.hypot(*(_dense(line.outline) - (x, y)).T).min()
                if off < reach and not self.around(mark, 0.0):
                    return True
        return False
