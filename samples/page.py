"""A pen that trembles, and the page that it draws on: shapes in, strokes and their meaning out."""

from __future__ import annotations

import itertools
import json
import math
import random
from dataclasses import dataclass, field

WIDTH, HEIGHT = 1280, 720

Point = tuple[float, float]
Stroke = list[tuple[float, float, int]]


class Hand:
    """A pen that trembles: ideal lines in, timed strokes out."""

    def __init__(self, seed: str) -> None:
        self.random = random.Random(seed)
        self.clock = 0

    def line(self, corners: list[Point], speed: float = 700.0) -> Stroke:
        """One stroke through the corners: bowed sides, tremor, slower at corners and ends. speed: [px/s]."""
        r = self.random
        path: list[Point] = []
        for (ax, ay), (bx, by) in itertools.pairwise(corners):
            length = math.hypot(bx - ax, by - ay) or 1.0
            bow = max(-3.0, min(3.0, r.gauss(0, 0.006 * length)))
            n = max(2, round(length / 3))
            for i in range(n):
                u = i / n
                side = bow * math.sin(math.pi * u) / length
                path.append((ax + (bx - ax) * u - (by - ay) * side, ay + (by - ay) * u + (bx - ax) * side))
        path.append(corners[-1])
        stops = [k * 1.0 for k in _lengths(corners)]
        return self._walk(path, stops, speed)

    def loop(self, centre: Point, radius: float) -> Stroke:
        """A circle in one stroke: a little oval, closing with a gap or an overlap."""
        r = self.random
        start, way = r.uniform(0, 2 * math.pi), r.choice((-1, 1))
        turn = 2 * math.pi + r.uniform(-3, 7) / radius
        oval, lean = r.uniform(-0.02, 0.02), r.uniform(0, math.pi)
        drift = r.uniform(-0.02, 0.02)
        path = []
        n = max(16, round(turn * radius / 3))
        for i in range(n + 1):
            a = start + way * turn * i / n
            rho = radius * (1 + oval * math.cos(2 * (a - lean)) + drift * (i / n - 0.5))
            path.append((centre[0] + rho * math.cos(a), centre[1] + rho * math.sin(a)))
        return self._walk(path, [0.0, turn * radius], 250 + 3 * min(radius, 100))

    def outline(self, vertices: list[Point]) -> list[Stroke]:
        """A closed polygon in one stroke, in two, or in a stroke a side, with gaps and overshoots."""
        r, n = self.random, len(vertices)
        size = max(math.dist(a, b) for a in vertices for b in vertices)
        first = r.randrange(n)
        v = vertices[first:] + vertices[:first]
        if r.random() < 0.5:
            v.reverse()
        v = [(x + r.gauss(0, 0.8), y + r.gauss(0, 0.8)) for x, y in v]
        way = r.random() if size > 90 else 0.0
        if way < 0.5:
            return [self.line([*v, self._past(v[-1], v[0])])]
        if way < 0.75:
            cut = r.randrange(1, n)
            parts = [v[: cut + 1], [*v[cut:], v[0]]]
        else:
            parts = [[a, b] for a, b in zip(v, [*v[1:], v[0]], strict=True)]
        return [self.line([self._past(p[1], p[0]), *p[1:-1], self._past(p[-2], p[-1])]) for p in parts]

    def cross(self, at: Point, size: float) -> list[Stroke]:
        r, out = self.random, []
        for slope in (1, -1):
            a = slope * math.pi / 4 + r.gauss(0, 0.08)
            h = size * r.uniform(0.45, 0.55) * math.sqrt(2)
            x, y = at[0] + r.gauss(0, 0.04 * size), at[1] + r.gauss(0, 0.04 * size)
            dx, dy = h * math.cos(a), h * math.sin(a)
            out.append(self.line([(x - dx, y - dy), (x + dx, y + dy)]))
        return out

    def arrow(self, tail: Point, head: Point) -> list[Stroke]:
        """The shaft, then the head as a V in one stroke or as two barbs."""
        r = self.random
        back = math.atan2(tail[1] - head[1], tail[0] - head[0])
        barbs = []
        for side in (-1, 1):
            a, h = back + side * r.uniform(0.45, 0.6), r.uniform(26, 34)
            barbs.append((head[0] + h * math.cos(a), head[1] + h * math.sin(a)))
        strokes = [self.line([tail, head])]
        if r.random() < 0.5:
            return [*strokes, self.line([barbs[0], head, barbs[1]])]
        return strokes + [self.line([(head[0] + r.gauss(0, 1), head[1] + r.gauss(0, 1)), b]) for b in barbs]

    def _past(self, a: Point, b: Point) -> Point:
        """b missed: the pen, coming from a, stops a little short of it or beyond."""
        length = math.dist(a, b) or 1.0
        k = 1 + self.random.uniform(-3, 6) / max(length, 60)
        return a[0] + k * (b[0] - a[0]), a[1] + k * (b[1] - a[1])

    def _walk(self, path: list[Point], stops: list[float], speed: float) -> Stroke:
        """Points every 12 ms along a path, with tremor across it."""
        r = self.random
        waves = [
            (r.uniform(0.2, 0.5), r.uniform(18, 40), r.uniform(0, 7)),
            (r.uniform(0.3, 0.8), r.uniform(60, 150), r.uniform(0, 7)),
        ]
        along = _lengths(path)
        out: Stroke = []
        s, t, i = 0.0, self.clock, 0
        while True:
            s = min(s, along[-1])
            while i < len(path) - 2 and along[i + 1] < s:
                i += 1
            (ax, ay), (bx, by) = path[i], path[i + 1]
            step = along[i + 1] - along[i] or 1.0
            u = (s - along[i]) / step
            w = sum(a * math.sin(2 * math.pi * s / wave + phase) for a, wave, phase in waves)
            x = ax + (bx - ax) * u - (by - ay) / step * w
            y = ay + (by - ay) * u + (bx - ax) / step * w
            out.append((round(x, 1), round(y, 1), t))
            if s >= along[-1]:
                break
            near = min(abs(s - k) for k in stops)
            s += 0.012 * speed * (0.3 + 0.7 * min(1.0, near / 50))
            t += 12
        self.clock = t + 350
        return out


def _lengths(path: list[Point]) -> list[float]:
    """How far along the path each of its points is [px]."""
    out = [0.0]
    for a, b in itertools.pairwise(path):
        out.append(out[-1] + math.dist(a, b))
    return out


@dataclass
class Page:
    """A drawing in the making, with what it means.

    Attributes:
        strokes: of (x, y, t) [px, px, ms], y down.
        bodies: {"kind", "anchored", "outline" [px]} in the order of drawing.
        joints: {"bodies": (i, j or None), "position" [px]}.
        gravity: the arrow's direction as a unit vector, y down, or None.
    """

    name: str
    strokes: list[Stroke] = field(default_factory=list)
    bodies: list[dict[str, object]] = field(default_factory=list)
    joints: list[dict[str, object]] = field(default_factory=list)
    gravity: Point | None = None

    def __post_init__(self) -> None:
        self.hand = Hand(self.name)

    def circle(self, centre: Point, radius: float) -> int:
        self.strokes.append(self.hand.loop(centre, radius))
        steps = [2 * math.pi * k / 32 for k in range(32)]
        outline = [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in steps]
        return self._body("circle", outline)

    def polygon(self, vertices: list[Point], kind: str = "polygon", anchor: Point | None = None) -> int:
        self.strokes += self.hand.outline(vertices)
        body = self._body(kind, vertices)
        if anchor is not None:
            self.anchor(body, anchor, 40)
        return body

    def rectangle(
        self, centre: Point, size: tuple[float, float], turn: float = 0.0, anchored: bool = False
    ) -> int:
        """turn: [degrees], clockwise on the page."""
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        w, h = size[0] / 2, size[1] / 2
        vertices = [
            (centre[0] + c * x - s * y, centre[1] + s * x + c * y)
            for x, y in [(-w, -h), (w, -h), (w, h), (-w, h)]
        ]
        body = self.polygon(vertices, "rectangle")
        if anchored:
            self.anchor(body, centre, max(22.0, min(0.6 * min(size), 44.0)))
        return body

    def beam(self, a: Point, b: Point, thickness: float, anchored: bool = False) -> int:
        """A rectangle about the line from a to b."""
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        turn = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        return self.rectangle(middle, (math.dist(a, b), thickness), turn, anchored)

    def bar(self, corners: list[Point]) -> int:
        """An open line, as thin as the pen."""
        self.strokes.append(self.hand.line(corners))
        return self._body("bar", corners)

    def anchor(self, body: int, at: Point, size: float = 28) -> None:
        self.strokes += self.hand.cross(at, size)
        self.bodies[body]["anchored"] = True

    def pivot(self, a: int, b: int | None, at: Point, radius: float = 9) -> None:
        """b: None is the background."""
        self.strokes.append(self.hand.loop(at, radius))
        self.joints.append({"bodies": (a, b), "position": at})

    def arrow(self, tail: Point = (90, 90), head: Point = (90, 210)) -> None:
        self.strokes += self.hand.arrow(tail, head)
        length = math.dist(tail, head)
        self.gravity = ((head[0] - tail[0]) / length, (head[1] - tail[1]) / length)

    def to_json(self) -> str:
        """Stroke JSON, a stroke a line."""
        strokes = ",\n".join(
            json.dumps({"points": s}, separators=(",", ":")).replace(".0,", ",") for s in self.strokes
        )
        header = {"format": "sketchsim-strokes", "version": 1, "width": WIDTH, "height": HEIGHT}
        return f'{json.dumps(header)[:-1]}, "strokes": [\n{strokes}\n]}}\n'

    def _body(self, kind: str, outline: list[Point]) -> int:
        self.bodies.append({"kind": kind, "anchored": False, "outline": outline})
        return len(self.bodies) - 1
