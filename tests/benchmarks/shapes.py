"""Shapes one by one as careless hands draw them: turned, stretched, with gaps, hooks, doubled sides, taps."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sketch.synthetic import Hand, arrow, circle, cross, line, outline
from tests.benchmarks.drawings import turned, writer

__all__ = ["CARELESS", "SHAPES", "draw_shape"]

Array = NDArray[np.float64]
Point = tuple[float, float]
Strokes = list[Array]

MIDDLE = (640.0, 360.0)

# what is drawn, and what that is: a number of sides or a kind of reading
SHAPES = {
    "circle": "circle",
    "square": "4",
    "rectangle": "4",
    "long rectangle": "4",
    "triangle": "3",
    "diamond": "4",
    "pentagon": "5",
    "hexagon": "6",
    "trapezoid": "4",
    "parallelogram": "4",
    "X": "anchor",
    "arrow": "gravity",
    "line": "bar",
}


def draw_shape(name: str, careless: str, writer_number: int, rng: np.random.Generator) -> Strokes:
    """The strokes of a shape, drawn carelessly in some way, about the middle of a page of 1280 by 720 pixels.

    name: of SHAPES.  careless: of CARELESS.
    """
    hand, way = writer(writer_number), CARELESS[careless]
    if careless == "rounded corners":
        hand = replace(hand, rounding=rng.uniform(0.15, 0.25))
    elif careless == "hooks and overshoots":
        hand = replace(hand, hook=rng.uniform(0.03, 0.06), overshoot=rng.uniform(0.03, 0.06))
    elif careless == "many strokes":
        hand = replace(hand, parts=(6,))
    size, angle = math.exp(rng.uniform(math.log(50), math.log(330))), rng.uniform(0, 2 * math.pi)
    if name == "circle":
        strokes = circle(MIDDLE, size / 2, hand, rng)
    elif name in ("X", "arrow", "line"):
        end = [turned([(k * size / 2, 0.0)], angle, MIDDLE)[0] for k in (-1, 1)]
        if name == "X":
            strokes = cross(MIDDLE, 0.7 * size, hand, rng)
        else:
            strokes = arrow(*end, hand, rng) if name == "arrow" else line(end, hand, rng)
    else:
        strokes = outline(turned(_corners(name, size, rng), angle, MIDDLE), hand, rng)
    return way(strokes, hand, rng)


def _corners(name: str, size: float, rng: np.random.Generator) -> list[Point]:
    """The corners of a polygon so large, of any proportions that its name allows."""
    if name in ("pentagon", "hexagon", "triangle"):
        n = {"triangle": 3, "pentagon": 5, "hexagon": 6}[name]
        even = np.arange(n) + (rng.uniform(-0.14, 0.14, n) if n == 3 else rng.uniform(-0.05, 0.05, n))
        wide = rng.uniform(0.6, 1.0)
        return [(size / 2 * math.cos(t), size / 2 * wide * math.sin(t)) for t in 2 * math.pi / n * even]
    aspect = {"square": 1.0, "long rectangle": rng.uniform(4, 9)}.get(name, rng.uniform(1.2, 2.5))
    w, h = size / 2, size / 2 / aspect
    if name == "diamond":
        return [(w, 0.0), (0.0, h), (-w, 0.0), (0.0, -h)]
    slant = h * rng.uniform(0.4, 0.9)
    if name == "trapezoid":
        return [(-w, -h), (w, -h), (w - slant, h), (slant * rng.uniform(0.5, 1) - w, h)]
    if name == "parallelogram":
        return [(-w - slant / 2, -h), (w - slant / 2, -h), (w + slant / 2, h), (slant / 2 - w, h)]
    return [(-w, -h), (w, -h), (w, h), (-w, h)]


# ---------------------------------------------------------------- ways of being careless


def _as_it_is(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    return strokes


def _with_gap(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """Some of what is drawn lacks, a tenth at most: at the end of its longest stroke."""
    total = sum(map(_length, strokes))
    k = max(range(len(strokes)), key=lambda i: _length(strokes[i]))
    lacking = min(rng.uniform(0.05, 0.1) * total, 0.3 * _length(strokes[k]))
    return [_part(s, 0.0, 1 - lacking / _length(s)) if i == k else s for i, s in enumerate(strokes)]


def _again(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """A part of a stroke is drawn once more, with another trembling."""
    s = strokes[int(rng.integers(len(strokes)))]
    begin = rng.uniform(0, 0.6)
    part = _part(s, begin, begin + rng.uniform(0.25, 0.4))
    return [*strokes, part + _drift(part, _size(strokes), rng)]


def _twice(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """All strokes are drawn once more."""
    return strokes + [s + _drift(s, _size(strokes), rng) for s in strokes]


def _forth_and_back(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """Each stroke begins with a part of it that the pen comes back along."""
    out = []
    for s in strokes:
        part = _part(s, 0.0, min(rng.uniform(0.08, 0.2), 0.5 * _size(strokes) / _length(s)))
        back = part + _drift(part, _size(strokes), rng)
        out.append(np.concatenate([back[::-1] + (part[0] - back[0]), s]))
    return out


def _with_tap(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """The pen rests on the paper once before it draws."""
    ink = np.concatenate(strokes)
    at = ink[int(rng.integers(len(ink)))] + rng.normal(0, 0.04 * _size(strokes), 2)
    tap = at + rng.normal(0, 0.5, (int(rng.integers(2, 5)), 2))
    return [tap, *strokes]


def _lifted(strokes: Strokes, hand: Hand, rng: np.random.Generator) -> Strokes:
    """The pen is lifted once within a stroke, and goes on a little off."""
    k = max(range(len(strokes)), key=lambda i: _length(strokes[i]))
    at = rng.uniform(0.3, 0.7)
    rest = _part(strokes[k], at, 1.0) + rng.normal(0, 0.008 * _size(strokes), 2)
    return [*strokes[:k], _part(strokes[k], 0.0, at), rest, *strokes[k + 1 :]]


CARELESS: dict[str, Callable[[Strokes, Hand, np.random.Generator], Strokes]] = {
    "any": _as_it_is,
    "a gap of a tenth": _with_gap,
    "hooks and overshoots": _as_it_is,
    "rounded corners": _as_it_is,
    "many strokes": _as_it_is,
    "a part drawn again": _again,
    "all drawn twice": _twice,
    "begun forth and back": _forth_and_back,
    "a tap": _with_tap,
    "the pen lifted": _lifted,
}


def _length(s: Array) -> float:
    return float(np.hypot(*np.diff(s, axis=0).T).sum())


def _size(strokes: Strokes) -> float:
    return float(np.hypot(*np.ptp(np.concatenate(strokes), axis=0)))


def _part(s: Array, begin: float, end: float) -> Array:
    """A stroke from one share of its length to another."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(s, axis=0).T))])
    between = along[(along > begin * along[-1]) & (along < end * along[-1])]
    t = np.concatenate([[begin * along[-1]], between, [end * along[-1]]])
    return np.stack([np.interp(t, along, s[:, k]) for k in (0, 1)], axis=1)


def _drift(s: Array, size: float, rng: np.random.Generator) -> Array:
    """How far off a stroke is where it is drawn once more: a slow wave, 1.5 % of its shape's size."""
    t = np.linspace(0, 1, len(s))[:, None]
    return np.asarray(
        size
        * 0.015
        * (rng.normal(0, 0.7, 2) + rng.normal(0, 0.7, 2) * np.sin(3 * t + rng.uniform(0, 6.28, 2)))
    )
