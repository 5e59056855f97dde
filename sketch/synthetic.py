"""Hand-drawn ink made up: shapes as people of several hands would draw them, for tests, benchmarks and
samples.

A stroke is an ideal path (straight or round), its corners rounded, bent by a slow drift of the hand and a
fast tremor, with a hook where the pen goes down and an overshoot or a gap where strokes should meet. All
lengths but one are shares of the shape's size, so that ink scales; a long thin outline is drawn with the care
that its area takes. Nothing is random but the generator that is passed in::

    rng = np.random.default_rng(7)
    strokes = outline([(0, 0), (200, 0), (200, 100), (0, 100)], HANDS["quick"], rng)
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sketch.typing import Array, Point

__all__ = ["HANDS", "Hand", "arrow", "circle", "cross", "curve", "ellipse", "line", "outline", "scribble"]


@dataclass(frozen=True)
class Hand:
    """How somebody draws.

    Attributes:
        tremor: fast trembling, root mean square, as a share of the shape's size.
        drift: slow wandering of the pen, likewise: sides bow, circles are no circles.
        rounding: how much of a side a corner rounds off, 0 to 0.5.
        hook: length of the turn back where the pen goes down, as a share of the size; drawn half of the time.
        overshoot: how far strokes run past where they should end (negative: how much they lack), as a share of the
            size: a spread about zero.
        parts: the numbers of strokes that outlines are drawn in.
        spacing: between points, as a share of the size.
        unsteady: trembling that is no less for a small shape, root mean square [pixels].
    """

    tremor: float = 0.003
    drift: float = 0.01
    rounding: float = 0.05
    hook: float = 0.0
    overshoot: float = 0.01
    parts: tuple[int, ...] = (1,)
    spacing: float = 0.02
    unsteady: float = 0.0


HANDS = {
    "neat": Hand(tremor=0.002, drift=0.006, rounding=0.02, overshoot=0.005, parts=(1, 4)),
    "quick": Hand(
        tremor=0.003, drift=0.016, rounding=0.12, hook=0.03, overshoot=0.03, parts=(1,), spacing=0.04
    ),
    "shaky": Hand(tremor=0.007, drift=0.01, rounding=0.04, overshoot=0.015, parts=(1, 2)),
    "pieces": Hand(tremor=0.003, drift=0.01, rounding=0.03, hook=0.02, overshoot=0.03, parts=(2, 3, 4)),
    "sparse": Hand(tremor=0.001, drift=0.008, rounding=0.0, overshoot=0.01, parts=(1, 2), spacing=0.12),
}


def line(points: Sequence[Point], hand: Hand, rng: np.random.Generator) -> list[Array]:
    """An open polyline, in one stroke."""
    path = np.array(points, dtype=np.float64)
    size = _size(path)
    return [_pen(_cornered(path, hand), size, hand, rng)]


def outline(vertices: Sequence[Point], hand: Hand, rng: np.random.Generator) -> list[Array]:
    """A closed polygon, in as many strokes as the hand likes: each begins and ends at a corner."""
    v = np.array(vertices, dtype=np.float64)
    n, size = len(v), min(_size(v), math.sqrt(2 * _area(v)))
    first = int(rng.integers(n))
    v = np.roll(v, -first, axis=0)
    if rng.random() < 0.5:
        v = v[::-1]
    parts = min(int(rng.choice(hand.parts)), n)
    cuts = [0, *sorted(rng.choice(np.arange(1, n), parts - 1, replace=False).tolist()), n]
    ring = np.concatenate([v, v[:1]])
    strokes = []
    for a, b in itertools.pairwise(cuts):
        path = _stretched(ring[a : b + 1], hand.overshoot * size * rng.standard_normal(2))
        stroke = _pen(_cornered(path, hand), size, hand, rng)
        strokes.append(stroke[::-1] if rng.random() < 0.3 else stroke)
    return strokes


def circle(centre: Point, radius: float, hand: Hand, rng: np.random.Generator) -> list[Array]:
    """A circle, in one stroke, a little more or less than once around."""
    return ellipse(centre, (radius, radius), 0.0, hand, rng)


def ellipse(
    centre: Point, radii: tuple[float, float], angle: float, hand: Hand, rng: np.random.Generator
) -> list[Array]:
    """An ellipse with half axes `radii`, turned by `angle` [rad]."""
    size = 2 * max(radii)
    start, turn = rng.uniform(0, 2 * math.pi), math.copysign(1, rng.random() - 0.5)
    stop = 2 * math.pi + 3 * hand.overshoot * rng.standard_normal()
    t = start + turn * np.linspace(0, stop, max(round(math.pi / hand.spacing), 12))
    c, s = math.cos(angle), math.sin(angle)
    local = np.stack([radii[0] * np.cos(t), radii[1] * np.sin(t)], axis=1)
    return [_pen(np.array(centre) + local @ np.array([[c, s], [-s, c]]), size, hand, rng)]


def curve(path: Array, hand: Hand, rng: np.random.Generator) -> list[Array]:
    """Any path of points close together, (n, 2), in one stroke."""
    step = hand.spacing * _size(path)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    t = np.linspace(0, along[-1], max(round(along[-1] / step), 12))
    even = np.stack([np.interp(t, along, path[:, k]) for k in (0, 1)], axis=1)
    return [_pen(even, _size(path), hand, rng)]


def cross(centre: Point, size: float, hand: Hand, rng: np.random.Generator) -> list[Array]:
    """An X of two strokes; one hand in three joins them by a side."""
    h = size / 2
    a, b, c, d = ((centre[0] + x * h, centre[1] + y * h) for x, y in ((-1, -1), (1, 1), (1, -1), (-1, 1)))
    if rng.random() < 1 / 3:
        return line([a, b, c, d], hand, rng)
    return line([a, b], hand, rng) + line([c, d], hand, rng)


def arrow(tail: Point, head: Point, hand: Hand, rng: np.random.Generator) -> list[Array]:
    """An arrow: shaft and head in two strokes, or all in one, or in three."""
    shaft = np.array(head) - tail
    barbs = []
    for side in (-1, 1):
        angle, share = side * rng.uniform(0.4, 0.65), rng.uniform(0.25, 0.45)
        c, s = math.cos(angle), math.sin(angle)
        back = share * np.array([c * shaft[0] - s * shaft[1], s * shaft[0] + c * shaft[1]])
        barbs.append((float(head[0] - back[0]), float(head[1] - back[1])))
    left, right = barbs
    ways = [
        [[tail, head], [left, head, right]],
        [[tail, head, left, head, right]],
        [[tail, head], [head, left], [head, right]],
    ]
    return [stroke for path in ways[rng.integers(3)] for stroke in line(path, hand, rng)]


def scribble(centre: Point, size: float, rng: np.random.Generator) -> list[Array]:
    """Ink without a meaning: a wandering curve that crosses itself again and again."""
    steps = rng.standard_normal((160, 2))
    for _ in range(3):
        steps = _smooth(steps)
    path = np.cumsum(steps, axis=0)
    path -= path.mean(axis=0)
    return [np.array(centre) + path * (size / 2 / np.abs(path).max())]


# ---------------------------------------------------------------- the pen


def _size(path: Array) -> float:
    return float(np.hypot(*np.ptp(path, axis=0)))


def _area(v: Array) -> float:
    """Of a polygon, by the shoelace formula."""
    x, y = v[:, 0], v[:, 1]
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2


def _stretched(path: Array, ends: Array) -> Array:
    """The path with its first and last point moved outward along their sides."""
    out = path.copy()
    for end, by, inner in ((0, ends[0], 1), (-1, ends[1], -2)):
        d = path[end] - path[inner]
        side = max(float(np.hypot(*d)), 1e-9)
        out[end] += min(max(by / side, -0.25), 0.5) * d  # a side stays a side
    return out


def _cornered(path: Array, hand: Hand) -> Array:
    """A dense path along a polyline, its inner corners rounded (quadratic Bézier curves over the corner)."""
    step = hand.spacing * _size(path)
    pieces, begin = [], path[0]
    for before, corner, after in zip(path, path[1:], path[2:], strict=False):
        a = corner + hand.rounding * (before - corner)
        b = corner + hand.rounding * (after - corner)
        pieces.append(_straight(begin, a, step))
        if hand.rounding > 0:
            t = np.linspace(0, 1, 5)[:, None]
            pieces.append((1 - t) ** 2 * a + 2 * t * (1 - t) * corner + t * t * b)
        begin = b
    pieces.append(_straight(begin, path[-1], step))
    return np.concatenate([*pieces, path[-1:]])


def _straight(a: Array, b: Array, step: float) -> Array:
    n = max(int(np.hypot(*(b - a)) / step), 1)
    return np.asarray(a + np.linspace(0, 1, n, endpoint=False)[:, None] * (b - a))


def _smooth(values: Array) -> Array:
    padded = np.concatenate([values[:1], values, values[-1:]])
    return np.asarray((padded[:-2] + padded[1:-1] + padded[2:]) / 3)


def _pen(path: Array, size: float, hand: Hand, rng: np.random.Generator) -> Array:
    """The path as the hand draws it."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))]) / size
    drift = np.zeros_like(path)
    for frequency in (0.4, 0.9):  # waves over the shape's size: slower ones would only move it
        amplitude, phase = rng.standard_normal(2) / 2, rng.uniform(0, 2 * math.pi, 2)
        drift += amplitude * np.sin(2 * math.pi * frequency * along[:, None] + phase)
    tremor = _smooth(rng.standard_normal(path.shape)) * math.sqrt(3)
    drawn = path + size * hand.drift * drift + (size * hand.tremor + hand.unsteady) * tremor
    if hand.hook and rng.random() < 0.5 and len(drawn) > 2:
        side = rng.uniform(2.0, 2.8) * math.copysign(1, rng.random() - 0.5)
        d = drawn[1] - drawn[0]
        d = d / max(float(np.hypot(*d)), 1e-9)
        c, s = math.cos(side), math.sin(side)
        tip = drawn[0] - hand.hook * size * np.array([c * d[0] - s * d[1], s * d[0] + c * d[1]])
        drawn = np.concatenate([tip[None], drawn])
    return drawn
