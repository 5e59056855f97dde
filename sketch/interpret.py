"""Readings → scene: bodies, anchors, pivots, gravity, scale; and notes of what was decided."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable

import numpy as np

from sim.scene import Joint, Scene, View
from sketch.ink import Sketch
from sketch.reading import Reading
from sketch.scene.bodies import Bodies, Drawn, draw_body, ids
from sketch.scene.pivots import UNSURE, pivots
from sketch.scene.tidy import close_gaps, straighten

__all__ = ["interpret"]

GRAVITY = 9.81
PAGE = 10.0  # metres: the longer side of a page without a scale
PEN = 1 / 320  # of the longer side of the page: the thickness of a bar
# of the longer side of the page: a larger ring is no nail, however large what it lies on is
PIN = 0.02
# times as long as its ink is a page, at least: one that is cut close to its ink is the same page
MARGIN = 1.25
ROUGH = 20.0  # nats that a polygon leaves to be said about its ink: nineteen in twenty clean ones leave less


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
    joints = pivots(sketch, bodies, fixed, view.pixels_per_metre, PIN * max(longer, MARGIN * wide), notes)
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
        notes.append(f"{ids(bars)} ({strokes}) {what} as thick as the pen")
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


# ---------------------------------------------------------------- anchors, gravity, doubts


def _anchored(cross: Reading, bodies: Bodies) -> tuple[Drawn | None, list[Drawn], list[Drawn]]:
    """The body that an X fixes, those that it lies over, and of these those that hold half of its bars' ends at least.

    Of several that hold them it is the one drawn last; of none the one that its bars reach.
    """
    ends, (xs, ys) = cross.outline.tolist(), cross.outline.T.tolist()
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    reach = math.hypot(max(xs) - min(xs), max(ys) - min(ys)) / 2
    near = [(d.depth((x, y)), d) for d in bodies.near((x, y), reach) if d.reading.solid]
    over = [d for depth, d in near if depth < 0]
    if not over:
        depth, nearest = min(near, key=lambda t: t[0], default=(reach, None))
        over = [nearest] if nearest is not None and depth < reach else []
    # a rod that runs under an X, and holds none of it, is not what the X was drawn on
    held = [d for d in over if 2 * sum(d.depth((x, y)) < 0 for x, y in ends) >= len(ends)]
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
        notes.append(f"the X of {reading.named} is over {ids(over)}: it anchors {body.body.id}, {why}")


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
