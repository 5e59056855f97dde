"""Draws the README's pictures of the vocabulary: the ink on the left, what the program reads on the right.

python .pictures/draw.py
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import cv2  # noqa: TID253
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "samples")]

import draw  # noqa: E402
from on_paper import picture  # noqa: E402
from page import Page  # noqa: E402

from cli.render.canvas import Canvas  # noqa: E402
from cli.render.overlay import overlay  # noqa: E402
from cli.render.still import png  # noqa: E402
from sketch import Recognition, load_sketch, recognize  # noqa: E402

WIDTH, HEIGHT = 460, 250


def bodies(page: Page) -> None:
    page.circle((80, 80), 44)
    page.rectangle((215, 80), (130, 70), -6)
    page.polygon([(330, 130), (425, 120), (370, 36)])
    page.polygon([(50, 160), (90, 160), (90, 200), (170, 200), (170, 236), (50, 236)])
    page.polygon([(250, 232), (225, 190), (262, 158), (305, 180), (300, 226)])


def anchor(page: Page) -> None:
    page.polygon([(60, 215), (400, 215), (60, 60)], anchor=(140, 165))


def pivot(page: Page) -> None:
    frame = page.rectangle((230, 100), (300, 80))
    for x in (140, 320):
        wheel = page.circle((x, 150), 52)
        page.pivot(frame, wheel, (x, 132), 11)


def gravity(page: Page) -> None:
    page.arrow((230, 50), (230, 200))


def bar(page: Page) -> None:
    ground = page.bar([(40, 190), (420, 170)])
    page.anchor(ground, (340, 174), 44)
    page.circle((150, 134), 46)


def unread(page: Page) -> None:
    page.rectangle((330, 140), (120, 110))
    zigzag = [(50, 180), (70, 70), (95, 190), (110, 80), (140, 185), (150, 90), (175, 170), (190, 75)]
    page.strokes.append(page.hand.line(list(zigzag)))


def panels(word: Callable[[Page], None]) -> Canvas:
    page = Page(word.__name__)
    word(page)
    strokes = [{"points": stroke} for stroke in page.strokes]
    data = {"width": WIDTH, "height": HEIGHT, "pixels_per_metre": 100, "strokes": strokes}
    seen = recognize(load_sketch(json.dumps(data).encode()))
    ink = overlay(Recognition(seen.sketch, seen.scene, []))
    gap = np.full((HEIGHT, 4, 3), 225, np.uint8)
    return Canvas((np.hstack([ink.planes[0], gap, overlay(seen).planes[0]]),))


def sheet() -> Canvas:
    """The ink of every sample, four in a row."""
    tiles = []
    for name in draw.MACHINES:
        ink = picture(draw.page_of(name), "scan")
        ink = cv2.copyMakeBorder(ink, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=(225, 225, 225))
        small = cv2.resize(ink, (320, 180), interpolation=cv2.INTER_AREA)
        tiles.append(
            np.minimum(small.astype(int) // 12 * 12 + 16, 255).astype(np.uint8)
        )  # few greys: a small file
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % 4)
    return Canvas((np.vstack([np.hstack(tiles[k : k + 4]) for k in range(0, len(tiles), 4)]),))


if __name__ == "__main__":
    (HERE / "samples.png").write_bytes(png(sheet()))
    for word in (bodies, anchor, pivot, gravity, bar, unread):
        (HERE / f"{word.__name__}.png").write_bytes(png(panels(word)))
