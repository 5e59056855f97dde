"""Whole pictures: what is read from them, and what is refused."""

from __future__ import annotations

import struct
import zlib

import cv2
import numpy as np
import pytest

from sim.scene import InputError
from sketch.scan import read_picture


def encoded(picture: np.ndarray, ending: str = ".png") -> bytes:
    return bytes(cv2.imencode(ending, picture)[1])


def white(height: int, width: int) -> np.ndarray:
    return np.full((height, width, 3), 245, np.uint8)


def png_header(width: int, height: int) -> bytes:
    chunk = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk))


@pytest.mark.parametrize("ending", [".png", ".jpg", ".webp", ".tiff", ".bmp"])
def test_cross_and_ring_give_two_lines_and_a_closed_stroke(ending: str) -> None:
    picture = white(300, 400)
    cv2.line(picture, (40, 60), (160, 180), (30, 30, 30), 4, cv2.LINE_AA)
    cv2.line(picture, (160, 60), (40, 180), (30, 30, 30), 4, cv2.LINE_AA)
    cv2.circle(picture, (290, 150), 60, (30, 30, 30), 4, cv2.LINE_AA)
    sketch = read_picture(encoded(picture, ending))
    assert (sketch.width, sketch.height) == (400, 300)
    assert len(sketch.strokes) == 3
    ring = max(sketch.strokes, key=lambda s: s.points[:, 0].max()).points
    assert np.array_equal(ring[0], ring[-1])
    assert np.abs(np.hypot(*(ring - [290, 150]).T) - 60).max() < 1
    lines = [s.points for s in sketch.strokes if s.points[:, 0].max() < 200]
    for points in lines:
        assert np.hypot(*(points[0] - points[-1])) == pytest.approx(120 * np.sqrt(2), abs=4)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"this is text, not a picture",
        encoded(white(50, 50))[:60],
        b"\xff\xd8\xff",
        b"\x89PNG\r\n\x1a\n",
        png_header(100_000, 100_000),
        png_header(0, 10),
    ],
)
def test_what_is_no_picture_is_refused(data: bytes) -> None:
    with pytest.raises(InputError):
        read_picture(data)


@pytest.mark.parametrize("shape", [(1, 1), (20, 30000), (30000, 20), (3, 3), (200, 300)])
@pytest.mark.parametrize("level", [0, 128, 255])
def test_a_picture_without_ink_gives_no_strokes_and_says_so(shape: tuple[int, int], level: int) -> None:
    sketch = read_picture(encoded(np.full((*shape, 3), level, np.uint8)))
    assert sketch.strokes == []
    assert any("no ink" in note for note in sketch.notes)


def test_a_sheet_on_a_dark_table_gives_the_ink_on_it_and_no_outline_of_the_sheet() -> None:
    picture = np.full((600, 800, 3), 60, np.uint8)
    sheet = np.array([[60, 40], [760, 70], [730, 570], [30, 540]])
    cv2.fillPoly(picture, [sheet], (210, 225, 230), cv2.LINE_AA)
    cv2.rectangle(picture, (300, 200), (480, 330), (90, 60, 40), 4, cv2.LINE_AA)
    light = np.linspace(0.6, 1.1, 800)[None, :, None]
    noise = np.random.default_rng(3).normal(0, 3, picture.shape)
    sketch = read_picture(encoded(np.clip(picture * light + noise, 0, 255).astype(np.uint8), ".jpg"))
    points = np.concatenate([stroke.points for stroke in sketch.strokes])
    assert points.min(axis=0) == pytest.approx([300, 200], abs=2)
    assert points.max(axis=0) == pytest.approx([480, 330], abs=2)
