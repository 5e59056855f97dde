"""A page of strokes as a picture of paper: a scan, or a photo in the light of a lamp."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from page import HEIGHT, WIDTH, Page

Picture = NDArray[np.uint8]

INK = {"scan": (110, 50, 30), "photo": (70, 62, 58)}  # BGR: a blue ballpoint, a soft pencil


def picture(page: Page, kind: str, seed: int = 0) -> Picture:
    """kind: "scan" or "photo". BGR, shape (720, 1280, 3)."""
    rng = np.random.default_rng(seed)
    cover = _pen(page, 2.6 if kind == "scan" else 3.2, rng)
    if kind == "photo":  # graphite catches on the grain of the paper
        cover *= 0.72 + 0.28 * _grain(rng, 1.0)
    sheet = 244 + 2.5 * _grain(rng, 1.5)
    image = sheet[..., None] * (1 - cover[..., None]) + np.array(INK[kind], np.float32) * cover[..., None]
    if kind == "photo":
        image = _through_a_camera(image.astype(np.float32), rng)
    image += rng.normal(0, 1.5 if kind == "scan" else 3, image.shape)
    return np.clip(image, 0, 255).astype(np.uint8)


def _pen(page: Page, width: float, rng: np.random.Generator) -> NDArray[np.float32]:
    """How much ink lies on each pixel, 0 to 1; a quick pen draws thinner."""
    import cv2

    up = 3
    cover = np.zeros((HEIGHT * up, WIDTH * up), np.uint8)
    for stroke in page.strokes:
        points = np.array(stroke)[:, :2] * up
        for a, b in itertools.pairwise(points):
            slow = float(np.clip(1.1 - 0.012 * np.hypot(*(b - a)) / up, 0.75, 1.1))
            ends = [tuple(np.round(p * 16).astype(int).tolist()) for p in (a, b)]
            cv2.line(cover, *ends, 255, max(1, round(width * up * slow)), cv2.LINE_AA, 4)
    small = cv2.resize(cover, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    return (small.astype(np.float32) / 255) * np.float32(rng.uniform(0.88, 0.95))


def _grain(rng: np.random.Generator, size: float) -> NDArray[np.float32]:
    import cv2

    return cv2.GaussianBlur(rng.normal(0, size, (HEIGHT, WIDTH)).astype(np.float32), (0, 0), size)


def _through_a_camera(image: Any, rng: np.random.Generator) -> Any:
    """The sheet on a dark table, a little turned and tilted, in yellow light from one side."""
    import cv2

    corners = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]], np.float32)
    middle = corners.mean(axis=0)
    seen = middle + 0.94 * (corners - middle) + rng.uniform(-18, 18, (4, 2)).astype(np.float32)
    view = cv2.getPerspectiveTransform(corners, seen.astype(np.float32))
    image = cv2.warpPerspective(
        image, view, (WIDTH, HEIGHT), flags=cv2.INTER_LINEAR, borderValue=(52, 66, 84)
    )
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float32)
    light = 0.62 + 0.36 * np.exp(-(((x - 300) / 900) ** 2 + ((y - 160) / 620) ** 2))
    return cv2.GaussianBlur(image * light[..., None] * np.array([0.86, 0.96, 1.0], np.float32), (0, 0), 0.7)
