"""Pivots: small circles that join the bodies under them, or fix one to the page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sketch.around.pins import is_on_line
from sketch.kept import Kept
from sketch.reading import Reading
from sketch.scene.bodies import Bodies, Drawn, touch
from sketch.typing import Point

__all__ = ["UNSURE", "Pivot", "either", "pivots"]

# radius of a pivot over the size of the smaller body that it joins: beyond, it is a ball or a wheel
JOINS = 0.3
NAILS = 0.12  # likewise of a pivot to the background: a ball in front of one body is common
WHEEL = 20.0  # times that a circle with a much smaller one at its centre is likelier a wheel than a pin
NEAR = 2.5  # radii from a pivot's centre to a body that it misses by a slip of the hand
AROUND = 5.0  # radii, likewise to one whose ink runs on beyond its outline, into the circle
ON = 0.5  # radii from a small circle's centre to where two bodies meet: a ball that lies on both is a whole one off
CUT = 0.85  # of a wheel's radius, from its centre to a body that it overlaps too much for one that it only touches
UNSURE = 0.2  # a reading with a rival of this probability is named in the notes


@dataclass(eq=False)
class _Pin:
    """A ring that is a pivot: of the one or two bodies `under` it, and of `further` ones that it goes through.

    at: where [pixels].
    """

    ring: Drawn
    under: tuple[Drawn, ...]
    further: tuple[Drawn, ...]
    at: Point


class Pivot(NamedTuple):
    """A joint of two bodies, or of one and the page.  at: where [pixels]."""

    first: Drawn
    second: Drawn | None
    at: Point


def pivots(
    bodies: Bodies, readings: Mapping[Drawn, Reading], pin: float, kept: Kept
) -> tuple[list[Pivot], list[tuple[Drawn, Drawn]]]:
    """Small circles over bodies that overlap, or over one beside which they are small, become pivots.

    pin: radius that one to the background, of an open line, or in two rings hardly exceeds [pixels].  Returns the
    joints in the order in which their circles were drawn; and the circles that are nearly as likely a ball in front of
    a body as its pivot to the page, each with the body.
    """
    circles = [d for d in bodies.drawn if d.kind == "circle"]
    pins: dict[Drawn, _Pin] = {}
    unsure: list[tuple[Drawn, Drawn]] = []
    for ring in sorted(circles, key=lambda d: -d.size):  # so that a pivot is asked of bodies, not of pivots
        if ring.forced in ("ball", "circle"):
            continue
        near = _around(ring, bodies)
        its = tuple(d for d in near if d in bodies.pins), tuple(d for d in near if d in bodies.fixed)
        under, further, odds = kept(_odds, ring, near, *its, pin)
        if not under:
            continue
        if not _is_pivot(readings[ring], odds):
            if len(under) == 1 and odds > UNSURE:
                unsure.append((ring, under[0]))
            continue
        bodies.pins.add(ring)
        again = [p for d in its[0] if (p := pins.get(d)) and _is_again(p, ring, under)]
        for p in again:  # the smaller, which comes later, says better where
            p.at = ring.middle
        if again:
            continue
        if len(under) == 1 and odds < 1 - UNSURE:
            unsure.append((ring, under[0]))
        pins[ring] = _Pin(ring, under, further, ring.middle)
    order = {d: k for k, d in enumerate(bodies.drawn)}
    by_drawing = sorted(pins.values(), key=lambda p: order[p.ring])
    joints = [Pivot(p.under[0], p.under[1] if len(p.under) == 2 else None, p.at) for p in by_drawing]
    return joints + _through(by_drawing, order), unsure


def either(ring: Reading, body: str) -> str:
    """What a person should know of a circle over a body that may be its pivot, or not."""
    ways = f"a pivot of {body} to the page", "a ball"
    if ring.kind != "pivot":
        ways = f"a ball in front of {body}", "a pivot to the page"
    return "the small circle of {} was taken for {}; it may be {}".format(ring.named, *ways)


def _around(ring: Drawn, bodies: Bodies) -> tuple[Drawn, ...]:
    """The bodies that say whether a ring is a pivot, and of what, in the order of drawing: those near it, and near a
    wheel that it is at the centre of."""
    found = bodies.numbers(ring.middle, AROUND * ring.radius)
    for wheel in (bodies.drawn[k] for k in found):
        if _is_at_centre(ring, wheel) and wheel.radius > ring.radius:
            found = sorted({*found, *bodies.numbers(wheel.middle, (JOINS + CUT) * wheel.radius)})
    return tuple(bodies.drawn[k] for k in found)


def _odds(
    ring: Drawn, around: tuple[Drawn, ...], pins: tuple[Drawn, ...], fixed: tuple[Drawn, ...], pin: float
) -> tuple[tuple[Drawn, ...], tuple[Drawn, ...], float]:
    """The bodies under a ring, as of `_under`, and how likely it is a pivot.

    around: as of `_around`.  pins, fixed: which of these are pivots already, and which are anchored.
    """
    bodies = Bodies(around, pins, fixed)
    under, further, odds = _under(ring, bodies)
    if ring.forced == "pivot":
        under, odds = under or [d for _, d in _near(ring, NEAR * ring.radius, bodies)][:1], 1.0
        return tuple(under), tuple(further), odds
    is_pinned = _pinned(ring, bodies)
    if len(under) == 1 or is_pinned or any(d.kind == "bar" for d in under):
        odds *= 1 / (1 + (ring.radius / pin) ** 6)
    if is_pinned:
        odds /= odds + (1 - odds) * WHEEL
    return tuple(under), tuple(further), odds


def _is_pivot(reading: Reading, odds: float) -> bool:
    """Whether a ring is taken for a pivot; its reading says so, and what else it may be."""
    is_pivot = odds >= 0.5
    rival = ("ball", 1 - odds) if is_pivot else ("pivot", odds)
    reading.alternatives = sorted([*reading.alternatives, rival], key=lambda t: -t[1])
    if is_pivot:
        reading.kind = "pivot"
        reading.score *= odds
    return is_pivot


def _is_again(pin: _Pin, ring: Drawn, under: tuple[Drawn, ...]) -> bool:
    """Whether a ring is a pivot drawn again: one that overlaps a ring over the same bodies, or is within one."""
    r = pin.ring.radius
    return math.dist(pin.ring.middle, ring.middle) < (
        r + ring.radius if pin.under == under else r - ON * ring.radius
    )


def _through(pins: list[_Pin], order: Mapping[Drawn, int]) -> list[Pivot]:
    """The joints with what pivots go through besides the two bodies in front."""
    joints: list[Pivot] = []
    pairs = {frozenset(pin.under) for pin in pins}
    for pin in pins:
        through = list(pin.under)
        for d in pin.further:
            # a rod on the rim of a wheel turns on the wheel, not on the frame behind that the wheel turns on
            if any({d, other} in pairs for other in through):
                continue
            # each pair is joined, as only those that are may overlap at the pin
            for other in through:
                a, b = sorted((other, d), key=order.__getitem__)
                joints.append(Pivot(a, b, pin.at))
            through.append(d)
    return joints


def _pinned(ring: Drawn, bodies: Bodies) -> bool:
    """Whether a ring has a pivot of its own: a much smaller circle at its centre. Nobody pins a pin."""
    reach = JOINS * ring.radius
    return any(
        d is not ring
        and d.kind == "circle"
        and d not in bodies.pins
        and d.radius < 2 * reach
        and math.dist(ring.middle, d.middle) < reach
        for d in bodies.near(ring.middle, reach)
    )


def _under(ring: Drawn, bodies: Bodies) -> tuple[list[Drawn], list[Drawn], float]:
    """The two bodies that a ring would be a pivot of, or one, in order of drawing; further ones that it goes through;
    and how likely it is a pivot rather than a ball.

    The foremost two that its centre is over, or the one and one more that it misses by a slip of the hand; or else two
    that meet in it, if it is as small as a nail. What is behind those two is joined too, unless it holds the whole of
    one: that moves in front of it.
    """
    radius, near = ring.radius, _near(ring, AROUND * ring.radius, bodies)
    over = bool(near) and near[0][0] <= 0
    further: list[Drawn] = []
    if over:
        (_, first), *rest = near
        missed = [d for depth, d in rest if depth > 0 and d.off_ink(ring.middle) < radius]
        first, *others = every = _foremost([first, *(d for depth, d in rest if depth <= 0)], missed)
        further = [
            d for d in others[1:] if d not in missed and not any(_holds(d, e) for e in every if e is not d)
        ]
        reach = NEAR * radius
    else:
        rest = [(depth, d) for depth, d in near if depth < NEAR * radius and radius < NAILS * d.size]
        off = {d: min(depth, d.off_ink(ring.middle)) for depth, d in rest} if len(rest) > 1 else {}
        first = min(off, key=lambda d: off[d], default=ring)
        if off.get(first, math.inf) > ON * radius:
            return [], [], 0.0
        others, reach = [], (1 + ON) * radius
    if not others:
        others = [d for depth, d in rest if d is not first and depth < reach and touch(first, d, ring)]
    if over and not others:
        others = _axle(first, ring, bodies) or _missed(first, rest, ring, bodies.fixed)
    under = [first, *others[:1]]
    if not over and len(under) == 1:
        return [], [], 0.0
    limit = JOINS if len(under) == 2 and over else NAILS
    odds = 1 / (1 + (radius / (limit * min(d.size for d in under))) ** 6)
    return sorted(under, key=bodies.drawn.index), further, odds


def _missed(first: Drawn, near: list[tuple[float, Drawn]], ring: Drawn, fixed: Set[Drawn]) -> list[Drawn]:
    """What a ring over one body misses by more than a slip of the hand, where it says nothing else.

    A pin from an anchored body to the page means nothing, and one to an anchored body holds as one to the page does;
    what turns about the page does so about its middle, if it is a wheel; and no rod ends beside a ring by chance.
    """
    aside = first.kind == "circle" and math.dist(ring.middle, first.middle) > JOINS * first.radius
    found = [
        d for depth, d in near if depth < NEAR * ring.radius and (aside or (d in fixed) != (first in fixed))
    ]
    return found or [d for _, d in near if d.kind == "bar" and _ends_near(d, ring)]


def _ends_near(bar: Drawn, ring: Drawn) -> bool:
    return bool(np.hypot(*(bar.line[[0, -1]] - ring.middle).T).min() < NEAR * ring.radius)


def _foremost(over: list[Drawn], missed: list[Drawn]) -> list[Drawn]:
    """Of bodies that a point is over, or misses by a slip of the hand, those in front first.

    One that holds the whole of another is what that moves in front of; of others, over which it is, the one drawn
    last is.
    """
    every = [*over, *missed]
    if len(every) < 3:
        return every
    holds = {d: sum(_holds(d, e) for e in every if e is not d) for d in every}
    return sorted(every, key=lambda d: (holds[d], d in missed, -d.last))


def _holds(d: Drawn, other: Drawn) -> bool:
    """Whether the whole of another body is within one."""
    return all(d.depth((x, y)) < 0 for x, y in other.outline.tolist())


def _near(ring: Drawn, reach: float, bodies: Bodies) -> list[tuple[float, Drawn]]:
    """The bodies within `reach` of a ring that is small beside them, with the distances of its middle from them
    [pixels], negative inside; the deepest first."""
    large = [
        d
        for d in bodies.near(ring.middle, reach)
        if d is not ring and d not in bodies.pins and ring.radius < 2 * JOINS * d.size
    ]
    near = [(off, d) for d in large if (off := _off(d, ring)) < reach]
    return sorted(near, key=lambda t: t[0])


def _off(d: Drawn, ring: Drawn) -> float:
    """How far a ring's middle is from a body [pixels], negative inside; 0 from an open line that it is over."""
    depth = d.depth(ring.middle)
    if d.kind == "bar" and depth > 0:
        long, extent = float(np.hypot(*np.ptp(d.line, axis=0))), math.sqrt(8) * ring.radius
        # its ink bends, and may end aside of where a straight line does
        ends = (stroke.points[k : k + 1, :2] for stroke in d.ink for k in (0, len(stroke.points) - 1))
        depth *= not any(is_on_line(ring.middle, extent, line, long) for line in (d.line, *ends))
    return depth


def _axle(wheel: Drawn, ring: Drawn, bodies: Bodies) -> list[Drawn]:
    """What a ring at the centre of a wheel joins it to: the body that the wheel overlaps the most, if by much.

    A wheel that is pinned to the background stands free, or touches; and a rod that is pinned to it elsewhere is none
    that it turns on.
    """
    deep = CUT * wheel.radius
    if not _is_at_centre(ring, wheel):
        return []
    others = [
        (d.depth(ring.middle), d)
        for d in bodies.near(ring.middle, deep)
        if d is not wheel
        and d is not ring
        and d not in bodies.pins
        and wheel.radius < 2 * d.size
        and ring.radius < 2 * JOINS * d.size
    ]
    by_depth = sorted(others, key=lambda t: t[0])
    return [d for depth, d in by_depth if depth < deep and not _joined(wheel, d, ring, bodies)]


def _is_at_centre(ring: Drawn, wheel: Drawn) -> bool:
    return wheel.kind == "circle" and math.dist(ring.middle, wheel.middle) <= JOINS * wheel.radius


def _joined(wheel: Drawn, other: Drawn, ring: Drawn, bodies: Bodies) -> bool:
    """Whether a further ring, no larger than twice the size of one, reaches a wheel, and another body but for a
    slip of the hand."""
    near = bodies.near(wheel.middle, wheel.radius)
    rings = (d for d in near if d.kind == "circle" and d is not ring and d is not wheel)
    return any(
        _off(wheel, further) < further.radius and _off(other, further) < NEAR * further.radius
        for further in rings
        if further.size < 2 * ring.size
    )
