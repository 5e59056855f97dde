"""Mechanisms at random, as people draw them: each function draws one kind, anew every time."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from tests.benchmarks.drawings import Drawing, Point, turned, writer

__all__ = ["KINDS", "draw", "nonsense"]

KINDS: list[Callable[[Drawing], None]] = []


def kind(way: Callable[[Drawing], None]) -> Callable[[Drawing], None]:
    KINDS.append(way)
    return way


def draw(number: int, seed: int, writers: int) -> Drawing:
    """The drawing of this number: the kinds and the writers take turns."""
    rng = np.random.default_rng([seed, number])
    way = KINDS[number % len(KINDS)]
    drawing = Drawing(writer(int(rng.integers(writers))), rng, way.__name__)
    way(drawing)
    return drawing


def _floor(d: Drawing, y: float = 640.0) -> int:
    floor = d.box(640, y, d.rng.uniform(900, 1120), d.rng.uniform(50, 76))
    d.anchor(floor, (640 + d.rng.uniform(-300, 300), y))
    return floor


def _top(d: Drawing, body: int) -> float:
    return float(d.bodies[body].outline[:, 1].min())


@kind
def pendulum(d: Drawing) -> None:
    r = d.rng
    beam = d.box(640, 110, r.uniform(240, 420), r.uniform(56, 90))
    d.anchor(beam, (540, 110))
    a = (660.0, 116.0)
    angle, long = r.uniform(0.6, 2.5), r.uniform(220, 330)
    b = (a[0] + long * math.cos(angle), a[1] + long * math.sin(angle))
    rod = d.beam(a, b, r.uniform(30, 44), 16)
    d.pivot(beam, rod, a)
    if r.random() < 0.6:
        bob = d.ball(*b, r.uniform(44, 64))
        d.pivot(rod, bob, b)
    d.arrow()


@kind
def cart(d: Drawing) -> None:
    """Wheels that cross the lower side of their frame."""
    r = d.rng
    floor = _floor(d)
    radius = r.uniform(38, 56)
    y = _top(d, floor) - radius - 2
    x, long = r.uniform(420, 840), r.uniform(280, 400)
    frame = d.box(x, y - r.uniform(28, 36), long, r.uniform(80, 110))
    for side in (-1, 1):
        hub = (x + side * 0.32 * long, y)
        wheel = d.ball(*hub, radius)
        d.pivot(frame, wheel, hub)
    d.arrow()


@kind
def seesaw(d: Drawing) -> None:
    r = d.rng
    x, y = r.uniform(560, 720), r.uniform(400, 440)
    wide, high = r.uniform(180, 260), r.uniform(170, 210)
    foot = d.polygon([(x, y), (x + wide / 2, y + high), (x - wide / 2, y + high)])
    d.anchor(foot, (x, y + 0.68 * high))
    tilt = r.uniform(-0.12, 0.12)
    long = r.uniform(520, 680)
    end = (long / 2 * math.cos(tilt), long / 2 * math.sin(tilt))
    plank = d.beam((x - end[0], y - end[1]), (x + end[0], y + end[1]), r.uniform(44, 56))
    d.pivot(foot, plank, (x, y + 8), 9)
    d.ball(x - 0.8 * end[0], y - 0.8 * end[1] - 80, r.uniform(32, 48))
    if r.random() < 0.6:
        d.box(x + 0.75 * end[0], y + 0.75 * end[1] - 75, r.uniform(60, 90), r.uniform(60, 90))
    d.arrow()


@kind
def stack(d: Drawing) -> None:
    r = d.rng
    y = _top(d, _floor(d))
    for _ in range(r.integers(2, 5)):
        high = r.uniform(62, 96)
        d.box(640 + r.uniform(-12, 12), y - high / 2 - r.uniform(-2, 3), r.uniform(120, 190), high)
        y -= high
    if r.random() < 0.5:
        d.polygon([(600, y - 2), (680, y - 2), (640, y - 70)])
    d.arrow()


@kind
def shared_sides(d: Drawing) -> None:
    """Boxes of three sides that stand on a drawn line: the fourth is the floor's."""
    r = d.rng
    floor = d.box(640, 640, 1040, 70)
    left = r.uniform(0.1, 0.25)
    for _ in range(r.integers(1, 4)):
        right = left + r.uniform(0.1, 0.16)
        d.on_top(floor, left, right, r.uniform(80, 150))
        left = right + r.uniform(0.08, 0.12)
    d.anchor(floor, (200, 640))
    d.arrow()


@kind
def dominoes(d: Drawing) -> None:
    r = d.rng
    y = _top(d, _floor(d))
    high, x = r.uniform(110, 160), r.uniform(330, 400)
    d.ball(x - 100, y - 0.8 * high, r.uniform(30, 40))
    for _ in range(r.integers(4, 9)):
        d.box(x, y - high / 2, r.uniform(26, 36), high, r.uniform(-0.02, 0.02))
        x += r.uniform(68, 84)
    d.arrow()


@kind
def funnel(d: Drawing) -> None:
    r = d.rng
    tilt = r.uniform(0.45, 0.75)
    for x, turn in ((380, tilt), (900, -tilt)):
        wall = d.box(x, 480, 420, 46, turn)
        d.anchor(wall)
    cells = [(x, y) for y in (70, 190) for x in (430, 570, 710, 850)]
    for i in r.permutation(len(cells))[: r.integers(3, 8)]:
        _something(d, *cells[i], r.uniform(34, 46))
    d.arrow()


def _something(d: Drawing, x: float, y: float, size: float) -> None:
    """A shape of the vocabulary, about as large as a circle of this radius."""
    r = d.rng
    angle = r.uniform(0, 6.28)
    n = int(r.integers(0, 7))
    if n == 0:
        d.ball(x, y, size)
    elif n == 1:
        d.box(x, y, 2 * size, size * r.uniform(1.1, 2), angle)
    elif n == 2:  # a trapezoid
        a, b = size, size * r.uniform(0.4, 0.6)
        d.polygon(
            turned([(-a, 0.6 * size), (a, 0.6 * size), (b, -0.6 * size), (-b, -0.6 * size)], angle, (x, y))
        )
    elif n == 3:  # a parallelogram
        a, s, h = 0.8 * size, r.uniform(0.3, 0.5) * size, 0.6 * size
        d.polygon(turned([(-a - s, h), (a - s, h), (a + s, -h), (-a + s, -h)], angle, (x, y)))
    else:
        k = {4: 3, 5: 5, 6: 6}[n]
        step = 2 * math.pi / k
        d.polygon(
            [(x + size * math.cos(angle + step * i), y + size * math.sin(angle + step * i)) for i in range(k)]
        )


@kind
def chain(d: Drawing) -> None:
    """Links from a beam down, each on a pivot of the one before; a weight at the end."""
    r = d.rng
    beam = d.box(420, 100, 300, 66)
    d.anchor(beam, (340, 100))
    at, angle, before = (480.0, 104.0), r.uniform(0.5, 1.2), beam
    for _ in range(r.integers(2, 5)):
        long = r.uniform(110, 140)
        end = (at[0] + long * math.cos(angle), at[1] + long * math.sin(angle))
        link = d.beam(at, end, r.uniform(30, 38), 15)
        d.pivot(before, link, at, 7.5)
        at, before = end, link
        angle += r.uniform(-0.5, 0.4)
    weight = d.ball(*at, r.uniform(40, 52))
    d.pivot(before, weight, at, 7.5)
    d.arrow()


@kind
def hill(d: Drawing) -> None:
    """A smooth hill on which a ball lies."""
    r = d.rng
    t = np.linspace(0, math.pi, 60)
    high, steep = r.uniform(160, 260), r.uniform(0.6, 1.6)
    top = np.stack([640 - 420 * np.cos(t), 620 - high * np.sin(t) ** steep], axis=1)
    body = d.free(
        np.concatenate(
            [top, np.linspace(top[-1], [640 + 420, 670], 8), np.linspace([1060, 670], [220, 670], 60)]
        )
    )
    d.anchor(body, (640, 580))
    d.ball(640 + r.uniform(-80, 80), 620 - high - 60, r.uniform(32, 46))
    d.arrow()


@kind
def bridge(d: Drawing) -> None:
    """Two posts, planks between them on pivots, and a load."""
    r = d.rng
    posts = [d.box(x, 530, 90, 240) for x in (200, 1080)]
    for post in posts:
        d.anchor(post, tuple(d.bodies[post].outline.mean(axis=0).tolist()))
    n = int(r.integers(2, 5))
    ends = [(220 + 840 * k / n, 440 + 40 * math.sin(math.pi * k / n)) for k in range(n + 1)]
    before = posts[0]
    for a, b in pairwise(ends):
        plank = d.beam(a, b, r.uniform(34, 42), 14)
        d.pivot(before, plank, a, 8)
        before = plank
    d.pivot(before, posts[1], ends[-1], 8)
    d.box(640, 250, r.uniform(80, 120), r.uniform(80, 120))
    d.arrow()


@kind
def framed(d: Drawing) -> None:
    """A wheel within a frame, on a pivot of both."""
    r = d.rng
    y = _top(d, _floor(d))
    high = r.uniform(170, 220)
    x = r.uniform(450, 800)
    frame = d.box(x, y - high / 2 - 2, r.uniform(260, 360), high)
    hub = (x + r.uniform(-20, 20), y - high / 2)
    wheel = d.ball(*hub, 0.36 * high)
    d.pivot(frame, wheel, hub, 9)
    d.arrow()


@kind
def nailed(d: Drawing) -> None:
    """Wheels and beams on pivots to the background."""
    r = d.rng
    for x in (300, 640, 980)[: r.integers(1, 4)]:
        y = r.uniform(250, 460)
        if r.random() < 0.5:
            body, at = d.ball(x, y, r.uniform(90, 125)), (float(x), y)
        else:
            body = d.box(x, y, r.uniform(200, 270), r.uniform(90, 120), r.uniform(-0.4, 0.4))
            at = (x + r.uniform(-20, 20), y + r.uniform(-5, 5))
        d.pivot(body, None, at, 8)
    d.arrow((80, 80))


@kind
def linkage(d: Drawing) -> None:
    """Four bars: a crank, a coupler and a rocker on an anchored base."""
    r = d.rng
    base = d.box(640, 620, 760, 80)
    d.anchor(base, (640, 620))
    a, e = (370.0, 612.0), (900.0, 612.0)
    b = (a[0] + r.uniform(-60, 40), a[1] - r.uniform(150, 190))
    c = (e[0] + r.uniform(-40, 60), e[1] - r.uniform(260, 320))
    before = base
    for p, q in ((a, b), (b, c), (c, e)):
        rod = d.beam(p, q, r.uniform(34, 42), 16)
        d.pivot(before, rod, p, 8)
        before = rod
    d.pivot(before, base, e, 8)
    d.arrow()


@kind
def lines(d: Drawing) -> None:
    """Open lines as ground and slopes."""
    r = d.rng
    y = r.uniform(600, 660)
    ground = d.bar([(120, y), (1160, y + r.uniform(-15, 15))])
    d.anchor(ground, (r.uniform(300, 900), y), 50)
    slope = d.bar([(180, 260), (560, 260 + r.uniform(120, 220))])
    d.anchor(slope, (370, float(d.bodies[slope].outline[:, 1].mean())), 44)
    d.ball(240, 220, r.uniform(30, 40))
    d.box(r.uniform(800, 1000), y - 58, 110, 100)
    d.arrow((1150, 120))


@kind
def loose(d: Drawing) -> None:
    """Shapes of the whole vocabulary on free paper, without gravity."""
    r = d.rng
    cells = [(x, y) for y in (140, 360, 580) for x in (180, 480, 800, 1100)]
    for i in r.permutation(len(cells))[: r.integers(4, 9)]:
        x, y = cells[i]
        n = r.integers(0, 4)
        if n == 0:
            d.oval(x, y, (r.uniform(100, 125), r.uniform(50, 65)), r.uniform(0, 3.1))
        elif n == 1:  # an L
            a, b = r.uniform(70, 90), r.uniform(-10, 15)
            d.polygon(turned([(-a, -a), (b, -a), (b, b), (a, b), (a, a), (-a, a)], r.uniform(0, 6.2), (x, y)))
        else:
            _something(d, x, y, r.uniform(60, 90))


@kind
def overlaps(d: Drawing) -> None:
    """Bodies that were drawn into one another a little."""
    r = d.rng
    top, foot = (130.0, r.uniform(260, 340)), (760.0, 640.0)
    ramp = d.polygon([top, foot, (130.0, 640.0)])
    d.anchor(ramp, (270, 560))
    slope = math.atan2(foot[1] - top[1], foot[0] - top[0])
    for s in (150, 360)[: r.integers(1, 3)]:
        radius = r.uniform(36, 50)
        off = radius - r.uniform(2, 8)
        x, y = top[0] + s * math.cos(slope), top[1] + s * math.sin(slope)
        d.ball(x + off * math.sin(slope), y - off * math.cos(slope), radius)
    first = d.box(950, 560, 150, 150)
    d.box(1045, 585, 120, 110, r.uniform(-0.1, 0.1))
    d.anchor(first, (920, 560), 44)
    d.arrow((1150, 100))


@kind
def pinned(d: Drawing) -> None:
    """Two beams held rigidly by two pivots; a ball on them."""
    r = d.rng
    y = _top(d, _floor(d))
    post = d.box(640, y - 120, 90, 236)
    plank = d.box(640, y - 210, r.uniform(380, 520), 66)
    for x in (618, 662):
        d.pivot(post, plank, (x + r.uniform(-2, 2), y - 208 + r.uniform(-3, 3)), 7.5)
    d.ball(500, y - 330, r.uniform(30, 44))
    d.arrow()


@kind
def sideways(d: Drawing) -> None:
    """Gravity in any direction."""
    r = d.rng
    wall = d.box(1180, 360, 64, r.uniform(420, 600))
    d.anchor(wall)
    for y in (170, 360, 550):
        _something(d, r.uniform(480, 800), y + r.uniform(-15, 15), r.uniform(44, 64))
    d.arrow((200, 360), r.uniform(-math.pi, math.pi))


# ---------------------------------------------------------------- ink without a meaning

LETTERS = {  # strokes through points of a grid of 4 by 6
    "A": ["06 20 46", "13 33"],
    "T": ["00 40", "20 26"],
    "H": ["00 06", "40 46", "03 43"],
    "E": ["40 00 06 46", "03 33"],
    "K": ["00 06", "40 03 46"],
    "N": ["06 00 46 40"],
    "Z": ["00 40 06 46"],
    "M": ["06 00 23 40 46"],
    "asterisk": ["00 46", "40 06", "03 43"],
}


def nonsense(name: str, at: Point, size: float, d: Drawing) -> None:
    """Ink that has no meaning here: a letter, a star, a question mark, a coil, a zigzag, a spiral, a scribble."""
    from sketch.synthetic import curve, line, scribble

    x, y = at
    t = np.linspace(0, 1, 160)
    if name in LETTERS:
        for stroke in LETTERS[name]:
            points = [
                (x + (int(p[0]) - 2) * size / 6, y + (int(p[1]) - 3) * size / 6) for p in stroke.split()
            ]
            d.strokes += line(points, d.hand, d.rng)
    elif name == "star":
        turn = [0.8 * math.pi * k - math.pi / 2 for k in range(6)]
        d.strokes += line(
            [(x + size / 2 * math.cos(a), y + size / 2 * math.sin(a)) for a in turn], d.hand, d.rng
        )
    elif name == "zigzag":
        points = [(x + (k - 4) * size / 8, y + (-1) ** k * size / 6) for k in range(9)]
        d.strokes += line(points, d.hand, d.rng)
    elif name == "scribble":
        d.strokes += scribble(at, size, d.rng)
    else:
        path = {
            "question mark": lambda: np.stack(
                [
                    np.where(t < 0.7, -np.cos(1.5 * math.pi * t / 0.7), 0) * size / 4,
                    np.where(t < 0.7, -np.sin(1.5 * math.pi * t / 0.7), 1 + (t - 0.7) / 0.3) * size / 4,
                ],
                axis=1,
            ),
            "coil": lambda: np.stack(
                [size * (t - 0.5) + size / 9 * np.cos(12 * math.pi * t), size / 6 * np.sin(12 * math.pi * t)],
                axis=1,
            ),
            "spiral": lambda: (size / 2 * t * np.stack([np.cos(18 * t), np.sin(18 * t)])).T,
        }[name]()
        d.strokes += curve(path + np.array(at), d.hand, d.rng)


NONSENSE = (*LETTERS, "star", "zigzag", "scribble", "question mark", "coil", "spiral")
