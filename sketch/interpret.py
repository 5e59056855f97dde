"""Readings → scene: bodies, anchors, pivots, gravity, scale; and notes of what was decided."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import NamedTuple

import numpy as np

from sim.scene import Joint, Scene, View
from sketch.ink import Sketch
from sketch.kept import Kept
from sketch.reading import Reading
from sketch.scene.bodies import Bodies, Drawn, body, drawn_body, ids
from sketch.scene.pivots import UNSURE, Pivot, either, pivots
from sketch.scene.tidy import close_gaps, straighten
from sketch.typing import Point

__all__ = ["interpret"]

GRAVITY = 9.81
PAGE = 10.0  # metres: the longer side of a page without a scale
PEN = 1 / 320  # of the longer side of the page: the thickness of a bar
# of the longer side of the page: a larger ring is no nail, however large what it lies on is
PIN = 0.02
# times as long as its ink is a page, at least: one that is cut close to its ink is the same page
MARGIN = 1.25
THROUGH = 0.5  # of an X's half extent: a line so near to its middle goes through it
STRAY = 0.1  # of an outline's extent: ink that is further off it is no hook or overshoot, and is named
ROUGH = 20.0  # nats that a polygon leaves to be said about its ink: nineteen in twenty clean ones leave less


def interpret(
    sketch: Sketch,
    keys: Sequence[int],
    readings: list[Reading],
    scale: float | None,
    gravity: tuple[float, float] | None,
    wide: float,
    kept: Kept,
    tidy: bool = False,
) -> Scene:
    """The scene that readings make; a small circle that is a pivot becomes one in `readings`.

    keys: of the sketch's strokes, of what is drawn later it is greater.
    wide: the longer side of the box around all that is drawn [pixels].
    scale: [pixels per metre], or None for the sketch's own.  gravity: [m/s²], y up, or None for the arrow's.
    tidy: whether to undo what the hand did to level sides, equal wheels and touching bodies.
    """
    notes = list(sketch.notes) + (straighten(readings) if tidy else [])
    view, longer = _view(sketch, scale)
    ppm, pen = view.pixels_per_metre, PEN * longer
    of: dict[Drawn, Reading] = {}
    for r in readings:
        if r.solid:
            ink = tuple(sketch.strokes[s] for s in r.strokes)
            d = kept(drawn_body, r.kind, r.forced, ink, keys[r.strokes[-1]], r.outline.tobytes(), ppm, pen)
            of[d] = r
    bodies = Bodies(list(of))
    crosses = [(r, _cross(r, bodies)) for r in readings if r.kind == "anchor"]
    bodies.fixed = {on for _, cross in crosses if (on := cross.on(bodies.pins, kept).fixed) is not None}
    numbers = {d: k for k, d in enumerate(bodies.drawn, start=1)}
    joints, unsure = pivots(bodies, of, PIN * max(longer, MARGIN * wide), kept)
    names = {d: f"b{k}" for k, d in enumerate((d for d in of if d not in bodies.pins), start=1)}
    notes += [either(of[ring], names[d]) for ring, d in unsure]
    held_by = [_anchored(r, cross.on(bodies.pins, kept), names, notes) for r, cross in crosses]
    anchored = {d for d in held_by if d is not None}
    pull = _gravity(readings, notes) if gravity is None else gravity
    lies: Mapping[Drawn, Drawn] = {}
    if tidy:
        held = anchored.union(d for joint in joints for d in joint[:2] if d is not None)
        lies, said = close_gaps(names, held, pull, ppm)
        notes += said
    notes += [text for d, name in names.items() for text in _doubts(of[d], name)]
    bars = [d for d in names if d.kind == "bar"]
    if bars:
        what = "is an open line: a bar" if len(bars) == 1 else "are open lines: bars"
        strokes = _strokes(s for d in bars for s in of[d].strokes)
        notes.append(f"{ids([names[d] for d in bars])} ({strokes}) {what} as thick as the pen")
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
    return Scene(
        bodies=[body(lies.get(d, d), names[d], numbers[d], of[d], d in anchored) for d in names],
        joints=[_joint(joint, names, ppm) for joint in joints],
        gravity=pull,
        view=view,
        notes=notes,
    )


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


def _joint(pivot: Pivot, names: Mapping[Drawn, str], ppm: float) -> Joint:
    first, second, (x, y) = pivot
    return Joint(bodies=(names[first], names[second] if second else None), position=(x / ppm, -(y / ppm)))


# ---------------------------------------------------------------- anchors, gravity, doubts


class _On(NamedTuple):
    """The body that an X fixes, those that it lies over, and of these those that hold most of its bars' ends."""

    fixed: Drawn | None
    over: list[Drawn]
    held: list[Drawn]


class _Cross(NamedTuple):
    """An X: its ends, their middle, its half extent [pixels], and the bodies near it."""

    ends: tuple[Point, ...]
    middle: Point
    reach: float
    near: list[Drawn]

    def on(self, pins: Set[Drawn], kept: Kept) -> _On:
        """What it is drawn on, given which circles are pivots."""
        near = tuple(d for d in self.near if d not in pins)
        return kept(_held, self.ends, self.middle, self.reach, near)


def _cross(reading: Reading, bodies: Bodies) -> _Cross:
    ends = tuple((x, y) for x, y in reading.outline.tolist())
    xs, ys = zip(*ends, strict=True)
    middle = sum(xs) / len(xs), sum(ys) / len(ys)
    reach = math.hypot(max(xs) - min(xs), max(ys) - min(ys)) / 2
    return _Cross(ends, middle, reach, bodies.near(middle, reach))


def _held(ends: tuple[Point, ...], middle: Point, reach: float, near: tuple[Drawn, ...]) -> _On:
    """What an X is drawn on, as of `_Cross`.

    Of several that hold it, it fixes the one drawn last; over none the one that its bars reach. Where a line goes
    through its middle it is the line, if nothing holds more of it than what stands on that does.
    """
    deep = [(d.depth(middle), d) for d in near if d.kind != "bar"]
    over = [d for depth, d in deep if depth < 0]
    within = {d: sum(d.depth(end) < 0 for end in ends) for d in over}
    # a line bends as it was drawn, and the X is on its ink
    lines = [(d.off_ink(middle), d) for d in near if d.kind == "bar"]
    off, line = min(lines, key=lambda t: t[0], default=(reach, None))
    if line is not None and off < THROUGH * reach and max(within.values(), default=0) <= len(ends) / 2:
        over = [line]
    elif not over:
        depth, nearest = min(deep + lines, key=lambda t: t[0], default=(reach, None))
        over = [nearest] if nearest is not None and depth < reach else []
    # a rod that runs under an X, and holds none of it, is not what the X was drawn on
    held = [d for d in over if 2 * within.get(d, 0) >= len(ends)]
    return _On(max(held or over, key=lambda d: d.last, default=None), over, held)


def _anchored(reading: Reading, on: _On, names: Mapping[Drawn, str], notes: list[str]) -> Drawn | None:
    """The body that an X is drawn on; what was decided is noted."""
    fixed, over, held = on
    if fixed is None:
        notes.append(f"the X of {reading.named} is over no body: it anchors nothing")
    elif len(over) > 1:
        why, every = (
            "in which it was drawn" if len(held) == 1 else "drawn last",
            ids([names[d] for d in over]),
        )
        notes.append(f"the X of {reading.named} is over {every}: it anchors {names[fixed]}, {why}")
    return fixed


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


def _doubts(reading: Reading, name: str) -> list[str]:
    """What a person should look at: rivals that are nearly as likely, irregular outlines, ink far off its outline."""
    out = []
    rivals = [(k, p) for k, p in reading.alternatives if p > UNSURE and k != "pivot"]
    if rivals and reading.forced is None:
        kind, score = rivals[0]
        out.append(f"{name} ({reading.named}) may also be {_a(kind)} ({score:.0%})")
    if reading.kind == "polygon" and len(reading.outline) <= 12 and reading.rough > ROUGH:
        sides = len(reading.outline)
        out.append(f"{name} ({reading.named}) is no clean polygon: {sides} sides come nearest to its ink")
    elif reading.kind == "polygon" and len(reading.outline) > 8:
        out.append(f"{name} ({reading.named}) is an irregular outline: a polygon of many sides")
    if reading.stray > STRAY * math.hypot(*np.ptp(reading.outline, axis=0).tolist()):
        out.append(f"{name} ({reading.named}) has ink that is {reading.stray:.0f} pixels off its outline")
    return out


def _a(kind: str) -> str:
    names = {"gravity": "the gravity arrow", "anchor": "an anchor", "unread": "without a meaning"}
    return names.get(kind, f"a {kind}")
