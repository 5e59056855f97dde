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
    ("data", "kind"),
    [
        (b"", "empty"),
        (b"this is text, not a picture", "format"),
        (b"\xff\xd8\xff", "format"),
        (b"\x89PNG\r\n\x1a\n", "format"),
        (png_header(100_000, 100_000), "size"),
        (png_header(0, 10), "format"),
    ],
)
def test_what_is_no_picture_is_refused(data: bytes, kind: str) -> None:
    with pytest.raises(InputError) as refused:
        read_picture(data)
    assert refused.value.kind == kind


FORMATS = [".png", ".jpg", ".webp", ".tiff", ".bmp", ".gif"]


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("share", [0.02, 0.4, 0.9])
def test_a_cut_file_is_refused_by_one_error_alone(
    ending: str, share: float, capfd: pytest.CaptureFixture[str]
) -> None:
    data = encoded(np.random.default_rng(1).integers(0, 255, (60, 80, 3)).astype(np.uint8), ending)
    with pytest.raises(InputError, match="damaged or cut short"):
        read_picture(data[: int(share * len(data))])
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("ending", FORMATS)
def test_a_file_with_wrong_bytes_is_refused_or_said_to_be_damaged(
    ending: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """An uncompressed picture shows such bytes as ink, and nothing can tell."""
    picture = white(300, 400)
    cv2.circle(picture, (200, 150), 90, (30, 30, 30), 4, cv2.LINE_AA)
    data = bytearray(encoded(picture, ending))
    middle = len(data) // 2
    data[middle : middle + 40] = b"\x5a" * 40
    try:
        sketch = read_picture(bytes(data))
    except InputError:
        pass
    else:
        assert ending == ".bmp" or any("damaged" in note for note in sketch.notes)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("shape", [(1, 1), (20, 30000), (30000, 20), (3, 3), (200, 300)])
@pytest.mark.parametrize("level", [0, 128, 255])
def test_a_picture_without_ink_is_refused_as_strokes_without_points_are(
    shape: tuple[int, int], level: int
) -> None:
    with pytest.raises(InputError, match="no ink was found") as refused:
        read_picture(encoded(np.full((*shape, 3), level, np.uint8)))
    assert refused.value.kind == "empty"


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
