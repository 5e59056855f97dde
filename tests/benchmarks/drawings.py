"""A drawing in the making: ink by one writer, and what it means; and how a scene differs from that."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.scene import Body, Circle, Polygon, Scene
from sketch import Sketch, Stroke
from sketch.synthetic import HANDS, Hand, arrow, circle, cross, curve, ellipse, line, outline

__all__ = ["Drawing", "Joined", "Meant", "differences", "is_as_drawn", "matched", "overlap", "writer"]

Array = NDArray[np.float64]
Point = tuple[float, float]

WIDTH, HEIGHT = 1280.0, 720.0
SAME = 0.7  # overlap of two outlines from which on they are one body
ASTRAY = 0.1  # of its ink's extent: what is no further off it, either way, goes along it
THIN = 0.12  # of its extent: an open line counts as so thick when overlaps are measured
NEAR = 0.012  # of the page's width: how far from its place a pivot may be found
STEEP = math.radians(15)  # how far gravity may be off


@dataclass(frozen=True, eq=False)
class Meant:
    """A body that was drawn.

    Attributes:
        kind: "circle", "rectangle", "polygon", "round" (an ellipse, a hill) or "bar".
        outline: [pixels], (n, 2); open for a bar.
        sides: of what is round the least that a polygon needs to look like it.
    """

    kind: str
    outline: Array
    sides: int
    anchored: bool = False

    def is_read_as(self, body: Body) -> bool:
        """Whether a body's shape is what was drawn."""
        shape = body.shape
        sides = 0 if isinstance(shape, Circle) else len(shape.vertices) if isinstance(shape, Polygon) else 4
        if self.kind == "round":
            return sides >= self.sides
        return self.kind == "bar" or sides == self.sides


@dataclass(frozen=True)
class Joined:
    """A pivot that was drawn: the numbers of its bodies (None: the background), and its place [pixels]."""

    bodies: tuple[int, int | None]
    position: Point


@dataclass(eq=False)
class Drawing:
    """Ink on a page, and what it means.

    Attributes:
        strokes: (n, 2) [pixels], y down, in the order of drawing.
        gravity: angle of the arrow [rad], y down; None where there is no arrow.
    """

    hand: Hand
    rng: np.random.Generator
    name: str = ""
    strokes: list[Array] = field(default_factory=list)
    bodies: list[Meant] = field(default_factory=list)
    joints: list[Joined] = field(default_factory=list)
    gravity: float | None = None
    width: float = WIDTH
    height: float = HEIGHT

    # ------------------------------------------------------------ what is drawn

    def polygon(self, vertices: Sequence[Point], kind: str = "polygon") -> int:
        self.strokes += outline(vertices, self.hand, self.rng)
        return self._body(kind, vertices, len(vertices))

    def box(self, x: float, y: float, width: float, height: float, angle: float = 0.0) -> int:
        w, h = width / 2, height / 2
        return self.polygon(turned([(-w, -h), (w, -h), (w, h), (-w, h)], angle, (x, y)), "rectangle")

    def beam(self, a: Point, b: Point, thickness: float, beyond: float = 0.0) -> int:
        """A rectangle about the line from a to b, longer by `beyond` at both ends [pixels]."""
        x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
        angle = math.atan2(b[1] - a[1], b[0] - a[0])
        return self.box(x, y, math.dist(a, b) + 2 * beyond, thickness, angle)

    def ball(self, x: float, y: float, radius: float) -> int:
        self.strokes += circle((x, y), radius, self.hand, self.rng)
        return self._body("circle", _ring((x, y), (radius, radius), 0.0), 0)

    def oval(self, x: float, y: float, radii: Point, angle: float) -> int:
        self.strokes += ellipse((x, y), radii, angle, self.hand, self.rng)
        return self._body("round", _ring((x, y), radii, angle), 8)

    def free(self, path: Array) -> int:
        """A closed outline along a dense path, in one stroke."""
        self.strokes += curve(np.concatenate([path, path[:1]]), self.hand, self.rng)
        return self._body("round", path, 5)

    def bar(self, points: Sequence[Point]) -> int:
        self.strokes += line(points, self.hand, self.rng)
        return self._body("bar", points, 4)

    def on_top(self, body: int, left: float, right: float, height: float) -> int:
        """A box on the first side of a body, that side being its base: only the other three are drawn.

        left, right: where it stands, as shares of the side.
        """
        a, b = self.bodies[body].outline[:2]
        up = np.array([b[1] - a[1], a[0] - b[0]]) / math.dist(a, b) * height
        p, q = a + left * (b - a), a + right * (b - a)
        v = [tuple(map(float, c)) for c in (p, p + up, q + up, q)]
        self.strokes += line(v, self.hand, self.rng)
        return self._body("rectangle", v, 4)

    def _body(self, kind: str, vertices: Any, sides: int) -> int:
        self.bodies.append(Meant(kind, np.array(vertices, dtype=np.float64), sides))
        return len(self.bodies) - 1

    def anchor(self, body: int, at: Point | None = None, size: float | None = None) -> None:
        v = self.bodies[body].outline
        x, y = v.mean(axis=0) if at is None else at
        if size is None:
            room = math.sqrt(abs(_area(v))) if self.bodies[body].kind != "bar" else 60.0
            size = float(np.clip(0.5 * min(room, *np.ptp(v, axis=0) + 30), 16, 56)) * self.rng.uniform(
                0.8, 1.1
            )
        self.strokes += cross((float(x), float(y)), size, self.hand, self.rng)
        self.bodies[body] = replace(self.bodies[body], anchored=True)

    def pivot(self, a: int, b: int | None, at: Point, radius: float | None = None) -> None:
        r = radius or float(self.rng.uniform(8, 12))
        self.strokes += circle(at, r, self.hand, self.rng)
        self.joints.append(Joined((a, b), at))

    def arrow(self, at: Point = (90.0, 150.0), angle: float = math.pi / 2) -> None:
        length = self.rng.uniform(90, 150)
        head = (at[0] + length * math.cos(angle), at[1] + length * math.sin(angle))
        self.strokes += arrow(at, head, self.hand, self.rng)
        self.gravity = angle

    # ------------------------------------------------------------ what becomes of it

    @property
    def sketch(self) -> Sketch:
        return Sketch([Stroke(np.ascontiguousarray(s)) for s in self.strokes], self.width, self.height)

    def moved(self, way: Callable[[Array], Array], turn: float = 0.0) -> Drawing:
        """The same under a similarity of the plane that turns it by `turn` [rad]; the page becomes as large as
        its ink needs."""
        strokes = [way(s) for s in self.strokes]
        low = np.concatenate(strokes).min(axis=0) - 10
        strokes = [s - low for s in strokes]
        width, height = (np.concatenate(strokes).max(axis=0) + 10).tolist()
        bodies = [replace(b, outline=way(b.outline) - low) for b in self.bodies]
        places = [tuple((way(np.array([j.position]))[0] - low).tolist()) for j in self.joints]
        joints = [replace(j, position=p) for j, p in zip(self.joints, places, strict=True)]
        gravity = None if self.gravity is None else self.gravity + turn
        return replace(
            self, strokes=strokes, bodies=bodies, joints=joints, gravity=gravity, width=width, height=height
        )

    @classmethod
    def composed(cls, text: str) -> Drawing:
        """A sketch of the corpus' composer: JSON with strokes and their truth."""
        data = json.loads(text)
        truth = data["truth"]
        return cls(
            HANDS["neat"],
            np.random.default_rng(0),
            data["template"],
            [np.array([p[:2] for p in s["points"]], dtype=np.float64) for s in data["strokes"]],
            [Meant(b["kind"], np.array(b["hull"]), b["sides"], b["anchored"]) for b in truth["bodies"]],
            [Joined(tuple(j["bodies"]), tuple(j["position"])) for j in truth["joints"]],
            truth["gravity"],
            data["width"],
            data["height"],
        )


def writer(number: int) -> Hand:
    """One of any number of writers: a style, and how strongly this person shows it."""
    rng = np.random.default_rng([31, number])
    hand = HANDS[list(HANDS)[number % len(HANDS)]]
    more = np.exp(rng.normal(0, 0.2, 5))
    return replace(
        hand,
        tremor=hand.tremor * more[0],
        drift=hand.drift * more[1],
        rounding=min(hand.rounding * more[2], 0.4),
        overshoot=hand.overshoot * more[3],
        hook=hand.hook * more[4],
    )


def turned(points: Sequence[Point], angle: float, to: Point = (0.0, 0.0)) -> list[Point]:
    """Points turned about the origin, then moved."""
    c, s = math.cos(angle), math.sin(angle)
    return [(to[0] + c * x - s * y, to[1] + s * x + c * y) for x, y in points]


def _ring(centre: Point, radii: Point, angle: float) -> Array:
    t = np.linspace(0, 2 * math.pi, 48, endpoint=False)
    points = np.stack([radii[0] * np.cos(t), radii[1] * np.sin(t)], axis=1)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(np.array(centre) + points @ np.array([[c, s], [-s, c]]))


def _area(p: Array) -> float:
    x, y = p[:, 0] - p[0, 0], p[:, 1] - p[0, 1]
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


# ---------------------------------------------------------------- how a scene differs


def overlap(a: Array, b: Array, is_open: bool = False) -> float:
    """Area that two outlines share over the area that either has; of open lines as if they were thick."""
    import cv2

    both = np.concatenate([a, b])
    low, span = both.min(axis=0), float(np.ptp(both, axis=0).max())
    if np.any(a.max(axis=0) < b.min(axis=0) - 0.1 * span) or np.any(
        b.max(axis=0) < a.min(axis=0) - 0.1 * span
    ):
        return 0.0
    up = 400 / max(span, 1e-9)
    masks = []
    for p in (a, b):
        mask = np.zeros((480, 480), np.uint8)
        points = np.rint((p - low) * up + 40).astype(np.int32)
        if is_open:
            cv2.polylines(mask, [points], False, 1, round(400 * THIN))
        else:
            cv2.fillPoly(mask, [points], 1)
        masks.append(mask)
    return np.count_nonzero(masks[0] & masks[1]) / max(np.count_nonzero(masks[0] | masks[1]), 1)


def is_as_drawn(drawing: Drawing, scene: Scene, body: Body) -> bool:
    """Whether a body's outline goes along the ink that it was read from, and along all of that.

    By the conventions whatever is closed is a body, be it a heart; but as a triangle it is a wrong one.
    """
    scale = scene.view.pixels_per_metre if scene.view else 1.0
    rim = np.array(body.outline()) * [scale, -scale]
    ink = np.concatenate([_dense(drawing.strokes[k]) for k in body.strokes or []])
    apart = np.hypot(*(_dense(np.concatenate([rim, rim[:1]]))[:, None] - ink).transpose(2, 0, 1))
    far = max(apart.min(axis=0).max(), apart.min(axis=1).max())
    return bool(far < ASTRAY * np.hypot(*np.ptp(ink, axis=0)))


def _dense(line: Array) -> Array:
    """So many points along a line that the ways between them do not matter."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    t = np.linspace(0, along[-1], 200)
    return np.stack([np.interp(t, along, line[:, k]) for k in (0, 1)], axis=1)


def matched(drawing: Drawing, scene: Scene) -> dict[int, tuple[int, float]]:
    """For each body that was drawn and found, which of the scene's it is, and how well they overlap."""
    scale = scene.view.pixels_per_metre if scene.view else 1.0
    found = [np.array(b.outline()) * [scale, -scale] for b in scene.bodies]
    pairs = []
    for i, meant in enumerate(drawing.bodies):
        for j, points in enumerate(found):
            share = overlap(meant.outline, points, meant.kind == "bar")
            if share >= SAME:
                pairs.append((share, i, j))
    out: dict[int, tuple[int, float]] = {}
    taken: set[int] = set()
    for share, i, j in sorted(pairs, reverse=True):
        if i not in out and j not in taken:
            out[i] = (j, share)
            taken.add(j)
    return out


def differences(
    drawing: Drawing, scene: Scene, hits: dict[int, tuple[int, float]] | None = None
) -> list[str]:
    """How a scene is not what was drawn: a line each; none where it is wholly right."""
    hits = matched(drawing, scene) if hits is None else hits
    wrong = []
    for i, meant in enumerate(drawing.bodies):
        if i not in hits:
            wrong.append(f"{meant.kind} {i} is missing")
            continue
        body = scene.bodies[hits[i][0]]
        if not meant.is_read_as(body):
            wrong.append(f"{meant.kind} {i} of {meant.sides} sides was read as {_shape(body)}")
        if body.anchored != meant.anchored:
            wrong.append(f"{meant.kind} {i} is {'' if body.anchored else 'not '}anchored")
    taken = {j for j, _ in hits.values()}
    wrong += [f"{b.id} ({_shape(b)}) was invented" for j, b in enumerate(scene.bodies) if j not in taken]
    return wrong + _other_joints(drawing, scene, hits) + _other_gravity(drawing, scene)


def _shape(body: Body) -> str:
    shape = body.shape
    return f"{len(shape.vertices)} sides" if isinstance(shape, Polygon) else type(shape).__name__.lower()


def _other_joints(drawing: Drawing, scene: Scene, hits: dict[int, tuple[int, float]]) -> list[str]:
    scale = scene.view.pixels_per_metre if scene.view else 1.0
    left, wrong = list(scene.joints), []
    for joint in drawing.joints:
        pair = {
            None if k is None else scene.bodies[hits[k][0]].id if k in hits else "?" for k in joint.bodies
        }
        near = NEAR * max(drawing.width, drawing.height)
        found = [
            j
            for j in left
            if set(j.bodies) == pair
            and math.dist((j.position[0] * scale, -j.position[1] * scale), joint.position) < near
        ]
        if found:
            left.remove(found[0])
        else:
            wrong.append(f"the pivot of {joint.bodies} is missing")
    return wrong + [f"a pivot of {j.bodies} was invented" for j in left]


def _other_gravity(drawing: Drawing, scene: Scene) -> list[str]:
    gx, gy = scene.gravity
    if (math.hypot(gx, gy) > 0) != (drawing.gravity is not None):
        return ["gravity is missing" if drawing.gravity is not None else "gravity was invented"]
    if drawing.gravity is not None:
        off = math.remainder(math.atan2(-gy, gx) - drawing.gravity, 2 * math.pi)
        if abs(off) > STEEP:
            return [f"gravity is {math.degrees(off):.0f} degrees off"]
    return []
