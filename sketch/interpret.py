"""Readings → scene: anchors to bodies, pivots to pairs, gravity, scale; and notes of what was decided."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.scene import Body, Circle, Joint, Polygon, Rectangle, Scene, View
from sketch.ink import Sketch
from sketch.reading import Reading

__all__ = ["interpret"]

Array = NDArray[np.float64]

GRAVITY = 9.81
NEAR = 2.5  # radii from a pivot's centre to a body that it misses by a slip of the hand
SMALL = 0.3  # radius of a pivot over the size of what it joins
PAGE = 10.0  # metres: the longer side of a page without a scale
# Okabe and Ito's and Tol's muted colours: told apart by colour-blind readers, and by their lightness in print.
PALETTE = [
    "#4477aa",
    "#ee6677",
    "#228833",
    "#ccbb44",
    "#66ccee",
    "#aa3377",
    "#e69f00",
    "#44aa99",
    "#882255",
    "#997700",
]


@dataclass(eq=False)
class _Drawn:
    """A body on the page: its outline in pixels."""

    reading: Reading
    outline: Array
    area: float
    body: Body


def interpret(
    sketch: Sketch, readings: list[Reading], scale: float | None, gravity: tuple[float, float] | None
) -> tuple[Scene, list[Reading]]:
    """The scene, and the readings as the context turned them (a small circle becomes a pivot).

    scale: [pixels per metre], or None for the sketch's own.  gravity: [m/s²], y up, or None for the arrow's.
    """
    notes = list(sketch.notes)
    view = _view(sketch, scale)
    ppm = view.pixels_per_metre
    pivots, doubles = _small_circles(readings)
    solid = [
        r
        for r in readings
        if r.kind in ("circle", "rectangle", "polygon", "bar") and r not in pivots and r not in doubles
    ]
    drawn = [_drawn(r, k, ppm, _pen(sketch)) for k, r in enumerate(solid)]
    names = {id(d.reading): d.body.id for d in drawn}
    for reading in readings:
        if reading.kind == "anchor":
            _anchor(reading, drawn, notes)
    joints = []
    for reading in pivots:
        at, under = pivots[reading]
        ids = [names[id(r)] for r in under]
        pair = (ids[0], ids[1]) if len(ids) == 2 else (ids[0], None)
        joints.append(Joint(bodies=pair, position=(float(at[0]) / ppm, -float(at[1]) / ppm)))
        reading.kind = "pivot"
    for reading in doubles:
        reading.kind = "pivot"
    arrows = [r for r in readings if r.kind == "gravity"]
    pull = _gravity(arrows, notes) if gravity is None else gravity
    for reading in readings:
        if reading.kind == "unread":
            strokes = ", ".join(map(str, reading.strokes))
            notes.append(f"left out: stroke {strokes} fits nothing that has a meaning")
    scene = Scene(bodies=[d.body for d in drawn], joints=joints, gravity=pull, view=view, notes=notes)
    return scene, readings


def _pen(sketch: Sketch) -> float:
    return 4.0


def _view(sketch: Sketch, scale: float | None) -> View:
    width, height = sketch.width, sketch.height
    scale = scale or sketch.pixels_per_metre
    if scale is None:
        longer = max(width or 0.0, height or 0.0)
        if not longer:
            ink = np.concatenate([s.points for s in sketch.strokes])
            longer = float(np.ptp(ink, axis=0).max()) * 1.1
        scale = longer / PAGE
    return View(pixels_per_metre=scale, width=width, height=height)


# ---------------------------------------------------------------- bodies


def polygon_area(p: Array) -> float:
    x, y = p[:, 0], p[:, 1]
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _centroid(p: Array) -> Array:
    q = p - p[0]
    x, y = q[:, 0], q[:, 1]
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    total = float(cross.sum())
    if total == 0:
        return np.asarray(p.mean(axis=0))
    cx = float(((x + np.roll(x, -1)) * cross).sum()) / (3 * total)
    cy = float(((y + np.roll(y, -1)) * cross).sum()) / (3 * total)
    return np.asarray(p[0] + [cx, cy])


def _drawn(reading: Reading, k: int, ppm: float, pen: float) -> _Drawn:
    outline = reading.outline
    if reading.kind == "bar":
        outline = _thick(outline, pen)
    flip = np.array([1.0, -1.0]) / ppm
    world = outline * flip
    angle = 0.0
    shape: Circle | Rectangle | Polygon
    if reading.kind == "circle":
        centre = world.mean(axis=0)
        shape = Circle(float(np.hypot(*(world - centre).T).mean()))
    elif reading.kind == "rectangle" or (reading.kind == "bar" and len(outline) == 4):
        centre = world.mean(axis=0)
        a, b = world[1] - world[0], world[2] - world[1]
        angle = math.atan2(a[1], a[0])
        angle = math.remainder(angle, math.pi)
        w, h = float(np.hypot(*a)), float(np.hypot(*b))
        quarter = round(angle / (math.pi / 2))
        angle -= quarter * math.pi / 2
        shape = Rectangle((h, w) if quarter % 2 else (w, h))
    else:
        centre = _centroid(world)
        local = world - centre
        if polygon_area(local) < 0:
            local = local[::-1]
        shape = Polygon([(float(x), float(y)) for x, y in local])
    body = Body(
        id=f"b{k + 1}",
        shape=shape,
        position=(float(centre[0]), float(centre[1])),
        angle=angle,
        color=PALETTE[k % len(PALETTE)],
        strokes=list(reading.strokes),
        score=round(reading.score, 3),
    )
    return _Drawn(reading, outline, abs(polygon_area(outline)), body)


def _thick(line: Array, pen: float) -> Array:
    """A polyline as an outline of the pen's width."""
    steps = np.diff(line, axis=0)
    u = steps / np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 1e-9)[:, None]
    normals = np.stack([-u[:, 1], u[:, 0]], axis=1)
    miter = np.concatenate([normals[:1], normals[:-1] + normals[1:], normals[-1:]])
    miter[1:-1] /= np.maximum((miter[1:-1] ** 2).sum(axis=1), 0.2)[:, None] / 2
    side = miter * pen / 2
    return np.concatenate([line + side, (line - side)[::-1]])


def inside(p: Array, outline: Array) -> bool:
    """Whether a point lies in a polygon (even-odd rule)."""
    x, y = outline[:, 0], outline[:, 1]
    x2, y2 = np.roll(x, -1), np.roll(y, -1)
    spans = (y > p[1]) != (y2 > p[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = x + (p[1] - y) * (x2 - x) / (y2 - y)
    return bool(np.count_nonzero(spans & (p[0] < at)) % 2)


def distance(p: Array, outline: Array) -> float:
    """From a point to a closed outline [pixels]."""
    d = np.roll(outline, -1, axis=0) - outline
    t = np.clip(((p - outline) * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-12), 0, 1)
    return float(np.hypot(*(outline + t[:, None] * d - p).T).min())


# ---------------------------------------------------------------- context


def _small_circles(
    readings: list[Reading],
) -> tuple[dict[Reading, tuple[Array, list[Reading]]], list[Reading]]:
    """Circles that are pivots, with their centres and the bodies under them; and those that are balls on something."""
    bodies = [r for r in readings if r.kind in ("circle", "rectangle", "polygon", "bar")]
    areas = {id(r): abs(polygon_area(r.outline)) for r in bodies}
    pivots: dict[Reading, tuple[Array, list[Reading]]] = {}
    doubles: list[Reading] = []
    for reading in sorted((r for r in bodies if r.kind == "circle"), key=lambda r: -areas[id(r)]):
        centre = reading.outline.mean(axis=0)
        radius = float(np.hypot(*(reading.outline - centre).T).mean())
        under = []
        for other in bodies:
            if other is reading or other in pivots:
                continue
            line = (
                np.concatenate([other.outline, other.outline[::-1]]) if other.kind == "bar" else other.outline
            )
            depth = distance(centre, line) * (-1 if other.kind != "bar" and inside(centre, line) else 1)
            small = SMALL * (
                math.sqrt(areas[id(other)]) if other.kind != "bar" else float(np.ptp(line, axis=0).max())
            )
            if depth < NEAR * radius and radius < small:
                under.append((depth, other))
        under.sort(key=lambda t: t[0])
        if not under or under[0][0] > 0:
            continue  # over no body: a ball
        if len(under) >= 2:
            pair = sorted((r for _, r in under[:2]), key=bodies.index)
            if under[1][0] > 0 and not _meet(pair[0].outline, pair[1].outline, centre, radius):
                continue
            twin = next(
                (p for p, (at, same) in pivots.items() if same == pair and math.dist(at, centre) < radius),
                None,
            )
            if twin is None:
                pivots[reading] = (centre, pair)
            else:  # drawn twice
                doubles.append(reading)
        elif radius < 0.4 * SMALL * math.sqrt(areas[id(under[0][1])]):
            pivots[reading] = (centre, [under[0][1]])
    return pivots, doubles


def _meet(a: Array, b: Array, at: Array, radius: float) -> bool:
    """Whether two outlines overlap, or all but touch, near a point."""
    steps = np.linspace(0, 1, 64, endpoint=False)[:, None, None]
    dense = (a + steps * (np.roll(a, -1, axis=0) - a)).reshape(-1, 2)
    close = dense[np.hypot(*(dense - at).T) < 5 * radius]
    return any(inside(p, b) or distance(p, b) < radius for p in close)


def _anchor(reading: Reading, drawn: list[_Drawn], notes: list[str]) -> None:
    centre = reading.outline.mean(axis=0)
    over = [d for d in drawn if d.reading.kind != "bar" and inside(centre, d.outline)]
    if not over:
        reach = float(np.hypot(*np.ptp(reading.outline, axis=0))) / 2
        near = [(distance(centre, d.outline), k) for k, d in enumerate(drawn)]
        if near and min(near)[0] < reach:
            over = [drawn[min(near)[1]]]
    if not over:
        notes.append(
            f"the X of stroke {', '.join(map(str, reading.strokes))} is over no body: it anchors nothing"
        )
        return
    top = max(over, key=lambda d: max(d.reading.strokes))
    top.body.anchored = True
    if len(over) > 1:
        names = " and ".join(d.body.id for d in over)
        notes.append(f"an X lies over {names}: it anchors {top.body.id}, drawn last")


def _gravity(arrows: list[Reading], notes: list[str]) -> tuple[float, float]:
    if not arrows:
        notes.append("no gravity arrow: nothing will fall")
        return 0.0, 0.0
    if len(arrows) > 1:
        notes.append(
            f"{len(arrows)} arrows: gravity follows the first, stroke {', '.join(map(str, arrows[0].strokes))}"
        )
    tail, head = arrows[0].outline[0], arrows[0].outline[-1]
    d = head - tail
    long = float(np.hypot(*d))
    return GRAVITY * float(d[0]) / long, -GRAVITY * float(d[1]) / long
