"""Readings → scene: anchors to bodies, pivots to pairs, gravity, scale; and notes of what was decided."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Set

import numpy as np

from sim.scene import Joint, Scene, View
from sketch.bodies import Bodies, Drawn, draw_body, touch
from sketch.ink import Sketch
from sketch.kernel import depth
from sketch.pins import is_on_line
from sketch.reading import Reading
from sketch.tidy import close_gaps, straighten
from sketch.typing import Array

__all__ = ["interpret"]

GRAVITY = 9.81
PAGE = 10.0  # metres: the longer side of a page without a scale
PEN = 1 / 320  # of the longer side of the page: the thickness of a bar
# radius of a pivot over the size of the smaller body that it joins: beyond, it is a ball or a wheel
JOINS = 0.3
NAILS = 0.12  # likewise of a pivot to the background: a ball in front of one body is common
PIN = 0.02  # likewise over the longer side of the page: what is larger is no nail, however large what it lies on is
MARGIN = (
    1.25  # times as long as its ink is a page, at least: one that is cut close to its ink is the same page
)
WHEEL = 20.0  # times that a circle with a much smaller one at its centre is likelier a wheel than a pin
NEAR = 2.5  # radii from a pivot's centre to a body that it misses by a slip of the hand
AROUND = 5.0  # radii, likewise to one whose ink runs on beyond its outline, into the circle
ON = 0.5  # radii from a small circle's centre to where two bodies meet: a ball that lies on both is a whole one off
CUT = 0.85  # of a wheel's radius, from its centre to a body that it overlaps too much for one that it only touches
ROUGH = 20.0  # nats that a polygon leaves to be said about its ink: nineteen in twenty clean ones leave less
UNSURE = 0.2  # a reading with a rival of this probability is named in the notes


def interpret(
    sketch: Sketch,
    readings: list[Reading],
    scale: float | None,
    gravity: tuple[float, float] | None,
    wide: float,
    tidy: bool = False,
) -> Scene:
    """The scene that readings make; a small circle that is a pivot becomes one in `readings`.

    wide: the longer side of the box around all that is drawn [pixels].
    scale: [pixels per metre], or None for the sketch's own.  gravity: [m/s²], y up, or None for the arrow's.
    tidy: whether to undo what the hand did to level sides, equal wheels and touching bodies.
    """
    notes = list(sketch.notes) + (straighten(readings) if tidy else [])
    view, longer = _view(sketch, scale)
    drawn = [
        draw_body(r, k, view.pixels_per_metre, PEN * longer)
        for k, r in enumerate((r for r in readings if r.solid), start=1)
    ]
    bodies = Bodies(drawn)
    fixed = {d for r in readings if r.kind == "anchor" if (d := _anchored(r, bodies)[0]) is not None}
    joints = _pivots(sketch, bodies, fixed, view.pixels_per_metre, PIN * max(longer, MARGIN * wide), notes)
    drawn = [d for d in drawn if d.reading.solid]
    _number(drawn, joints)
    for reading in readings:
        if reading.kind == "anchor":
            _anchor(reading, bodies, notes)
    pull = _gravity(readings, notes) if gravity is None else gravity
    if tidy:
        notes += close_gaps(drawn, joints, pull, view.pixels_per_metre)
    notes += [text for d in drawn for text in _doubts(d)]
    bars = [d for d in drawn if d.reading.kind == "bar"]
    if bars:
        what = "is an open line: a bar" if len(bars) == 1 else "are open lines: bars"
        strokes = _strokes(s for d in bars for s in d.reading.strokes)
        notes.append(f"{_ids(bars)} ({strokes}) {what} as thick as the pen")
    read = Counter(s for r in readings if r.kind != "unread" for s in r.strokes)
    left = sorted(s for r in readings if r.kind == "unread" and r.forced is None for s in r.strokes)
    if left:
        what = _strokes(s for s in left if s not in read)
        part = _strokes(s for s in left if s in read)
        what = " and ".join(w for w in (what, part and f"a part of {part}") if w)
        fits = "fits" if len(left) == 1 else "fit"
        notes.append(f"left out: {what}, which {fits} nothing that has a meaning")
    several = _strokes(s for s, count in read.items() if count > 1)
    if several:
        notes.append(
            f"{several}: several things drawn without lifting the pen; the ways between them are left out"
        )
    return Scene(bodies=[d.body for d in drawn], joints=joints, gravity=pull, view=view, notes=notes)


def _strokes(numbers: Iterable[int]) -> str:
    """Strokes as a note names them; nothing for none."""
    strokes = tuple(numbers)
    return Reading("unread", strokes, 0.0, np.empty((0, 2))).named if strokes else ""


def _view(sketch: Sketch, scale: float | None) -> tuple[View, float]:
    """The view, and the longer side of the page [pixels]: of the ink and a margin where no canvas is given."""
    longer = max(sketch.width or 0.0, sketch.height or 0.0)
    if longer == 0:
        longer = 1.1 * _extent(sketch) or 1.0
    ppm = scale or sketch.pixels_per_metre or longer / PAGE
    return View(pixels_per_metre=ppm, width=sketch.width, height=sketch.height), longer


def _extent(sketch: Sketch) -> float:
    """The longer side of the box around all ink [pixels], which may be larger than the page."""
    ink = np.concatenate([np.empty((0, 2)), *(s.points for s in sketch.strokes)])
    # by columns: numpy takes the least of short rows in four times as long
    return float(np.ptp(np.ascontiguousarray(ink.T), axis=1).max()) if len(ink) else 0.0


def _number(drawn: list[Drawn], joints: list[Joint]) -> None:
    """Name the bodies b1, b2, ... in the order of drawing, the pivots left out."""
    names: dict[str | None, str | None] = {None: None}
    for k, d in enumerate(drawn, start=1):
        names[d.body.id] = f"b{k}"
        d.body.id = f"b{k}"
    for joint in joints:
        joint.bodies = (names[joint.bodies[0]], names[joint.bodies[1]])


# ---------------------------------------------------------------- pivots


def _pivots(
    sketch: Sketch, bodies: Bodies, fixed: Set[Drawn], ppm: float, pin: float, notes: list[str]
) -> list[Joint]:
    """Small circles over bodies that overlap, or over one beside which they are small, become pivots.

    fixed: those that are anchored.  pin: radius that one to the background, or of an open line, hardly exceeds
    [pixels].
    """
    joints: list[Joint] = []
    places: list[tuple[Array, float, list[Drawn], list[Drawn], Joint]] = []
    circles = [
        d for d in bodies.drawn if d.reading.kind == "circle" and d.reading.forced not in ("ball", "circle")
    ]
    for circle in sorted(circles, key=lambda d: -d.size):  # so that a pivot is asked of bodies, not of pivots
        at = circle.outline.mean(axis=0)
        radius = circle.size / math.sqrt(math.pi)
        forced = circle.reading.forced == "pivot"
        under, further, odds = _under(sketch, circle, at, radius, bodies, fixed)
        if forced:
            under, odds = under or [d for _, d in _near(circle, at, NEAR * radius, bodies)][:1], 1.0
        if not under:
            continue
        if (len(under) == 1 or any(d.reading.kind == "bar" for d in under)) and not forced:
            odds *= 1 / (1 + (radius / pin) ** 6)
        if not forced and _pinned(circle, at, radius, bodies):
            odds /= odds + (1 - odds) * WHEEL
        rival = ("ball", 1 - odds) if odds >= 0.5 else ("pivot", odds)
        circle.reading.alternatives = sorted([*circle.reading.alternatives, rival], key=lambda t: -t[1])
        if odds < 0.5:
            if len(under) == 1 and odds > UNSURE:
                notes.append(_either(circle, f"a ball in front of {_ids(under)}", "a pivot to the page"))
            continue
        circle.reading.kind = "pivot"
        circle.reading.score *= odds
        place = (float(at[0]) / ppm, -float(at[1]) / ppm)
        # rings that overlap are one pivot, and a ring in another; the smaller, which comes later, says better where
        again = [
            j
            for other, r, same, _, j in places
            if math.dist(other, at) < (r + radius if same == under else r - ON * radius)
        ]
        for joint in again:
            joint.position = place
        if again:
            continue
        if len(under) == 1 and odds < 1 - UNSURE:
            notes.append(_either(circle, f"a pivot of {_ids(under)} to the page", "a ball"))
        pair = (under[0].body.id, under[1].body.id if len(under) == 2 else None)
        joints.append(Joint(bodies=pair, position=place))
        places.append((at, radius, under, further, joints[-1]))
    pairs = {frozenset(joint.bodies) for joint in joints}
    for _, _, under, further, joint in places:
        through = list(under)
        for d in further:
            # a rod on the rim of a wheel turns on the wheel, not on the frame behind that the wheel turns on
            if any({d.body.id, other.body.id} in pairs for other in through):
                continue
            # each pair is joined, as only those that are may overlap at the pin
            for other in through:
                a, b = sorted((other, d), key=bodies.drawn.index)
                joints.append(Joint(bodies=(a.body.id, b.body.id), position=joint.position))
            through.append(d)
    return joints


def _pinned(circle: Drawn, at: Array, radius: float, bodies: Bodies) -> bool:
    """Whether a circle has a pivot of its own: a much smaller circle at its centre. Nobody pins a pin."""
    return any(
        d is not circle
        and d.reading.kind == "circle"
        and d.size / math.sqrt(math.pi) < 2 * JOINS * radius
        and math.dist(at, d.outline.mean(axis=0)) < JOINS * radius
        for d in bodies.near(at, JOINS * radius)
    )


def _under(
    sketch: Sketch, circle: Drawn, at: Array, radius: float, bodies: Bodies, fixed: Set[Drawn]
) -> tuple[list[Drawn], list[Drawn], float]:
    """The two bodies that a circle would be a pivot of, or one, in order of drawing; further ones that it goes through;
    and how likely it is a pivot rather than a ball.

    The foremost two that its centre is over, or the one and one more that it misses by a slip of the hand; or else two
    that meet in it, if it is as small as a nail. What is behind those two is joined too, unless it holds the whole of
    one: that moves in front of it.
    """
    near = _near(circle, at, AROUND * radius, bodies)
    over = bool(near) and near[0][0] <= 0
    further: list[Drawn] = []
    if over:
        (_, first), *rest = near
        missed = [d for depth, d in rest if depth > 0 and _off_ink(sketch, d, at) < radius]
        first, *others = every = _foremost([first, *(d for depth, d in rest if depth <= 0)], missed)
        further = [
            d for d in others[1:] if d not in missed and not any(_holds(d, e) for e in every if e is not d)
        ]
        reach = NEAR * radius
    else:
        rest = [(depth, d) for depth, d in near if depth < NEAR * radius and radius < NAILS * d.size]
        off = {d: min(depth, _off_ink(sketch, d, at)) for depth, d in rest} if len(rest) > 1 else {}
        first = min(off, key=lambda d: off[d], default=circle)
        if off.get(first, math.inf) > ON * radius:
            return [], [], 0.0
        others, reach = [], (1 + ON) * radius
    if not others:
        others = [d for depth, d in rest if d is not first and depth < reach and touch(first, d, at, radius)]
    if over and not others:
        others = _axle(first, circle, at, radius, bodies) or _missed(first, rest, at, radius, fixed)
    under = [first, *others[:1]]
    if not over and len(under) == 1:
        return [], [], 0.0
    limit = JOINS if len(under) == 2 and over else NAILS
    odds = 1 / (1 + (radius / (limit * min(d.size for d in under))) ** 6)
    return sorted(under, key=bodies.drawn.index), further, odds


def _missed(
    first: Drawn, near: list[tuple[float, Drawn]], at: Array, radius: float, fixed: Set[Drawn]
) -> list[Drawn]:
    """What a ring over one body misses by more than a slip of the hand, where it says nothing else.

    A pin from an anchored body to the page means nothing, and one to an anchored body holds as one to the page does;
    and no rod ends beside a ring by chance.
    """
    found = [d for depth, d in near if depth < NEAR * radius and (d in fixed) != (first in fixed)]
    ends = [d for _, d in near if d.reading.kind == "bar" and _ends_near(d, at, NEAR * radius)]
    return found or ends


def _ends_near(d: Drawn, at: Array, reach: float) -> bool:
    return bool(np.hypot(*(d.reading.outline[[0, -1]] - at).T).min() < reach)


def _foremost(over: list[Drawn], missed: list[Drawn]) -> list[Drawn]:
    """Of bodies that a point is over, or misses by a slip of the hand, those in front first.

    One that holds the whole of another is what that moves in front of; of others, over which it is, the one drawn
    last is.
    """
    every = [*over, *missed]
    if len(every) < 3:
        return every
    holds = {d: sum(_holds(d, e) for e in every if e is not d) for d in every}
    return sorted(every, key=lambda d: (holds[d], d in missed, -d.reading.strokes[-1]))


def _holds(d: Drawn, other: Drawn) -> bool:
    """Whether the whole of another body is within one."""
    return all(d.depth(p) < 0 for p in other.outline)


def _near(circle: Drawn, at: Array, reach: float, bodies: Bodies) -> list[tuple[float, Drawn]]:
    """The bodies within `reach` of a circle that is small beside them, with the distances of its centre from them
    [pixels], negative inside; the deepest first."""
    radius = circle.size / math.sqrt(math.pi)
    large = [
        d
        for d in bodies.near(at, reach)
        if d is not circle and d.reading.solid and radius < 2 * JOINS * d.size
    ]
    near = [(off, d) for d in large if (off := _off(d, at, radius)) < reach]
    return sorted(near, key=lambda t: t[0])


def _off(d: Drawn, at: Array, radius: float) -> float:
    """How far a ring's middle is from a body [pixels], negative inside; 0 from an open line that it is over."""
    depth, line = d.depth(at), d.reading.outline
    if d.reading.kind == "bar" and depth > 0:
        long = float(np.hypot(*np.ptp(line, axis=0)))
        depth *= not is_on_line(at.tolist(), math.sqrt(8) * radius, line, long)
    return depth


def _axle(wheel: Drawn, circle: Drawn, at: Array, radius: float, bodies: Bodies) -> list[Drawn]:
    """What a circle at the centre of a wheel joins it to: the body that the wheel overlaps the most, if by much.

    A wheel that is pinned to the background stands free, or touches; and a rod that is pinned to it elsewhere is none
    that it turns on.
    """
    r = wheel.size / math.sqrt(math.pi)
    if wheel.reading.kind != "circle" or math.dist(at, wheel.outline.mean(axis=0)) > JOINS * r:
        return []
    others = [
        (d.depth(at), d)
        for d in bodies.near(at, CUT * r)
        if d is not wheel
        and d is not circle
        and d.reading.solid
        and r < 2 * d.size
        and radius < 2 * JOINS * d.size
    ]
    by_depth = sorted(others, key=lambda t: t[0])
    return [d for depth, d in by_depth if depth < CUT * r and not _joined(wheel, d, circle, bodies)]


def _joined(wheel: Drawn, other: Drawn, circle: Drawn, bodies: Bodies) -> bool:
    """Whether another ring no larger than twice a circle's size lies over both a wheel and another body."""
    r = wheel.size / math.sqrt(math.pi)
    rings = (d for d in bodies.near(wheel.outline.mean(axis=0), r) if d.reading.kind in ("circle", "pivot"))
    return any(
        all(_off(d, ring.outline.mean(axis=0), ring.size / math.sqrt(math.pi)) <= 0 for d in (wheel, other))
        for ring in rings
        if ring not in (circle, wheel) and ring.size < 2 * circle.size
    )


def _off_ink(sketch: Sketch, d: Drawn, at: Array) -> float:
    """The distance of a point from the ink that a body was drawn with [pixels]."""
    x, y = at.tolist()
    inks = (sketch.strokes[s].points[:, :2] for s in d.reading.strokes)
    there_and_back = (np.concatenate([ink, ink[-2:0:-1]]) for ink in inks)  # closed, around nothing
    return min((abs(depth(x, y, ink)) for ink in there_and_back), default=math.inf)


def _ids(bodies: list[Drawn]) -> str:
    *most, last = [d.body.id for d in bodies]
    return f"{', '.join(most)} and {last}" if most else last


def _either(circle: Drawn, taken: str, other: str) -> str:
    return f"the small circle of {circle.reading.named} was taken for {taken}; it may be {other}"


# ---------------------------------------------------------------- anchors, gravity, doubts


def _anchored(cross: Reading, bodies: Bodies) -> tuple[Drawn | None, list[Drawn], list[Drawn]]:
    """The body that an X fixes, those that it lies over, and of these those that hold half of its bars' ends at least.

    Of several that hold them it is the one drawn last; of none the one that its bars reach.
    """
    at = cross.outline.mean(axis=0)
    reach = float(np.hypot(*np.ptp(cross.outline, axis=0))) / 2
    near = [(d.depth(at), d) for d in bodies.near(at, reach) if d.reading.solid]
    over = [d for depth, d in near if depth < 0]
    if not over:
        depth, nearest = min(near, key=lambda t: t[0], default=(reach, None))
        over = [nearest] if nearest is not None and depth < reach else []
    # a rod that runs under an X, and holds none of it, is not what the X was drawn on
    held = [d for d in over if 2 * sum(d.depth(end) < 0 for end in cross.outline) >= len(cross.outline)]
    return max(held or over, key=lambda d: d.reading.strokes[-1], default=None), over, held


def _anchor(reading: Reading, bodies: Bodies, notes: list[str]) -> None:
    """Fix the body that an X is drawn on."""
    body, over, held = _anchored(reading, bodies)
    if body is None:
        notes.append(f"the X of {reading.named} is over no body: it anchors nothing")
        return
    body.body.anchored = True
    if len(over) > 1:
        why = "in which it was drawn" if len(held) == 1 else "drawn last"
        notes.append(f"the X of {reading.named} is over {_ids(over)}: it anchors {body.body.id}, {why}")


def _gravity(readings: list[Reading], notes: list[str]) -> tuple[float, float]:
    arrows = [r for r in readings if r.kind == "gravity"]
    if not arrows:
        notes.append("no gravity arrow: nothing will fall")
        return 0.0, 0.0
    best = max(arrows, key=lambda r: (r.forced is not None, r.gain))
    if len(arrows) > 1:
        others = "; ".join(r.named for r in arrows if r is not best)
        notes.append(f"{len(arrows)} arrows: gravity follows that of {best.named}, not that of {others}")
    dx, dy = (best.outline[-1] - best.outline[0]).tolist()
    long = math.hypot(dx, dy)
    return GRAVITY * dx / long, -GRAVITY * dy / long


def _doubts(d: Drawn) -> list[str]:
    """What a person should look at: rivals that are nearly as likely, irregular outlines."""
    reading, out = d.reading, []
    rivals = [(k, p) for k, p in reading.alternatives if p > UNSURE and k != "pivot"]
    if rivals and reading.forced is None:
        kind, score = rivals[0]
        out.append(f"{d.body.id} ({reading.named}) may also be {_a(kind)} ({score:.0%})")
    if reading.kind == "polygon" and len(reading.outline) <= 12 and reading.rough > ROUGH:
        sides = len(reading.outline)
        out.append(
            f"{d.body.id} ({reading.named}) is no clean polygon: {sides} sides come nearest to its ink"
        )
    elif reading.kind == "polygon" and len(reading.outline) > 8:
        out.append(f"{d.body.id} ({reading.named}) is an irregular outline: a polygon of many sides")
    return out


def _a(kind: str) -> str:
    names = {"gravity": "the gravity arrow", "anchor": "an anchor", "unread": "without a meaning"}
    return names.get(kind, f"a {kind}")
