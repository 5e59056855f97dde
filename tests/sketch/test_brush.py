"""Outlines of brush strokes, made from strokes that are known: the stroke comes back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sketch import load_sketch, recognize
from sketch.formats.brush import centre_line

pytest.importorskip("svgelements")

Array = NDArray[np.float64]
PAGE = math.hypot(640, 480)


def outline_of(stroke: Array, widths: Array) -> Array:
    """One side, a round end, the other side back and a round beginning, as programs with brushes write it."""
    along = np.gradient(stroke, axis=0)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    left, right = stroke + normal * widths[:, None] / 2, stroke - normal * widths[:, None] / 2

    def cap(centre: Array, first: Array, side: float) -> Array:
        turns = side * np.linspace(0, math.pi, 7)[1:-1]
        arm = first - centre
        c, s = np.cos(turns), np.sin(turns)
        return centre + np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)

    return np.concatenate([left, cap(stroke[-1], left[-1], -1), right[::-1], cap(stroke[0], right[0], -1)])


def pen(points: list[list[float]], seed: int = 0) -> tuple[Array, Array]:
    """A stroke through the points with a shaky width of about 6 pixels."""
    corners = np.array(points, float)
    steps = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    at = np.arange(0, steps[-1], 4.0)
    stroke = np.stack([np.interp(at, steps, corners[:, k]) for k in range(2)], axis=1)
    rng = np.random.default_rng(seed)
    widths = 6 + np.convolve(rng.normal(size=len(stroke) + 8), np.ones(9) / 9, "valid")
    return stroke, widths


ROUND = [[200 + 80 * math.cos(t), 200 + 80 * math.sin(t)] for t in np.linspace(0, 6.2, 60)]
WAVE = [[50 + 5 * k, 240 + 60 * math.sin(k / 9)] for k in range(90)]

LONG = [[20 + 30 * k, 20 if k % 2 else 460] for k in range(20)]


@pytest.mark.parametrize(
    "points", [ROUND, WAVE, [[20, 20], [600, 60]], [[20, 20], [300, 30], [310, 200]], LONG]
)
def test_the_stroke_comes_back(points: list[list[float]]) -> None:
    stroke, widths = pen(points)
    middle = centre_line(outline_of(stroke, widths), PAGE)
    assert middle is not None
    gaps = np.hypot(*(middle[:, None] - stroke[None]).transpose(2, 0, 1))
    assert gaps.min(axis=1).max() < 4
    assert np.hypot(*(middle[0] - stroke[0])) < 10
    assert np.hypot(*(middle[-1] - stroke[-1])) < 10


@pytest.mark.parametrize("shift", [-7, 7])
def test_an_outline_may_begin_beside_an_end(shift: int) -> None:
    """Some programs begin within the round cap, or behind it: the ends are where they were."""
    stroke, widths = pen(WAVE)
    outline = outline_of(stroke, widths)
    assert abs(shift) / len(outline) > 0.015
    middle = centre_line(np.roll(outline, shift, axis=0), PAGE)
    assert middle is not None
    assert np.hypot(*(middle[0] - stroke[0])) < 8
    assert np.hypot(*(middle[-1] - stroke[-1])) < 8


@pytest.mark.parametrize(
    "body",
    [
        [[100 + 50 * math.cos(t), 100 + 50 * math.sin(t)] for t in np.linspace(0, 6.2, 60)],
        [[20, 20], [520, 20], [520, 40], [20, 40]],
        [[20 + 10 * k, 20] for k in range(50)] + [[510 - 10 * k, 40] for k in range(50)],
        [[5, 5]] * 20,
    ],
)
def test_bodies_that_are_filled_are_no_strokes(body: list[list[float]]) -> None:
    assert centre_line(np.array(body), PAGE) is None


def test_a_drawing_of_brush_strokes_is_read_like_one_of_lines() -> None:
    strokes = [
        [[60, 380], [560, 380], [560, 430], [60, 430], [60, 382]],
        [[300, 390], [330, 420]],
        [[330, 390], [300, 420]],
        ROUND,
        [[450, 60], [450, 180]],
        [[435, 150], [450, 180], [465, 150]],
    ]
    paths = ""
    for k, points in enumerate(strokes):
        outline = outline_of(*pen(points, k))
        curves = " ".join(
            f"Q{a[0]:.2f},{a[1]:.2f} {(a[0] + b[0]) / 2:.2f},{(a[1] + b[1]) / 2:.2f}"
            for a, b in zip(outline[1:], np.roll(outline, -1, axis=0)[1:], strict=True)
        )
        paths += f'<path fill="#1d1d1d" d="M{outline[0][0]:.2f},{outline[0][1]:.2f} {curves} Z"/>'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="480">{paths}</svg>'
    recognition = recognize(load_sketch(svg.encode()))
    assert [r.kind for r in recognition.readings] == ["rectangle", "anchor", "circle", "gravity"]
