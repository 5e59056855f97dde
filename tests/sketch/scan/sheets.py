"""Drawings on made-up paper, for the tests: kinder and crueller than what a phone brings home."""

from __future__ import annotations

import math
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from sketch.ink import Sketch

Image = NDArray[np.uint8]

HEIGHT, WIDTH = 560, 720
RING = ((500.0, 300.0), 90.0)
BOX = np.array([[120.0, 200.0], [330.0, 220.0], [320.0, 380.0], [110.0, 360.0]])
CROSS = (np.array([[190.0, 260.0], [250.0, 320.0]]), np.array([[250.0, 260.0], [190.0, 320.0]]))


def ink(
    shape: tuple[int, int] = (HEIGHT, WIDTH), pen: float = 4.0, filled: bool = False
) -> NDArray[np.float64]:
    """A ring, a box, and a cross in the box: 1 where there is ink, 0 on paper, smooth between."""
    height, width = shape
    image = np.zeros((height * 4, width * 4), np.uint8)  # drawn four times as large, then reduced

    def at(points: object) -> NDArray[np.int32]:
        return np.round((np.asarray(points, float) + 0.5) * 4 - 0.5).astype(np.int32)

    wide = cv2.FILLED if filled else round(4 * pen)
    (x, y), radius = RING
    cv2.circle(image, at((x, y)).tolist(), round(4 * radius), 255, wide)
    if filled:
        cv2.fillPoly(image, [at(BOX)], 255)
    else:
        cv2.polylines(image, [at(BOX)], True, 255, wide)
        for bar in CROSS:
            cv2.line(image, at(bar[0]).tolist(), at(bar[1]).tolist(), 255, wide)
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA) / 255.0


def drawn(
    ink: NDArray[np.float64],
    paper: object = (245, 245, 245),
    pen: object = (35, 35, 35),
    noise: float = 0.0,
    seed: int = 1,
) -> Image:
    """Ink of a colour on paper of a colour (BGR), or on a picture of paper."""
    page = np.broadcast_to(np.asarray(paper, float), (*ink.shape, 3))
    image = page * (1 - ink[..., None]) + np.asarray(pen, float) * ink[..., None]
    if noise:
        image += np.random.default_rng(seed).normal(0, noise, image.shape)
    return np.clip(np.round(image), 0, 255).astype(np.uint8)


def lit(image: Image, light: NDArray[np.float64]) -> Image:
    return np.clip(image * light[..., None], 0, 255).astype(np.uint8)


def encoded(picture: NDArray[np.generic], ending: str = ".png", *options: int) -> bytes:
    return bytes(cv2.imencode(ending, picture, list(options))[1])


def off_ring(points: NDArray[np.float64]) -> NDArray[np.float64]:
    (x, y), radius = RING
    return np.asarray(np.abs(np.hypot(points[:, 0] - x, points[:, 1] - y) - radius))


def off_box(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of points from the box's outline [pixels]."""
    best = np.full(len(points), np.inf)
    for a, b in zip(BOX, np.roll(BOX, -1, axis=0), strict=True):
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = np.minimum(best, np.hypot(*(points - a - along[:, None] * (b - a)).T))
    return best


def assert_ring_and_box(sketch: Sketch, within: float) -> list[NDArray[np.float64]]:
    """One closed stroke along the ring and one along the box; returns the others."""
    strokes = [s.points for s in sketch.strokes]
    ring = [s for s in strokes if off_ring(s).max() < within]
    box = [s for s in strokes if off_box(s).max() < within]
    assert len(ring) == 1
    assert len(box) == 1
    for outline in (ring[0], box[0]):
        assert np.hypot(*(outline[0] - outline[-1])) < within
    return [s for s in strokes if s is not ring[0] and s is not box[0]]


def assert_all(sketch: Sketch, within: float = 1.5) -> None:
    bars = assert_ring_and_box(sketch, within)
    assert len(bars) == 2
    for bar in CROSS:
        ends = [min(np.hypot(*(s[[0, -1]] - end).T).min() for s in bars) for end in bar]
        assert max(ends) < 3 * within


def even(*corners: tuple[float, float]) -> NDArray[np.float64]:
    """Points about a pixel apart along a line, shape (n, 2)."""
    sides = [np.linspace(a, b, round(math.dist(a, b)) + 1) for a, b in pairwise(corners)]
    return np.concatenate([side[min(k, 1) :] for k, side in enumerate(sides)])
