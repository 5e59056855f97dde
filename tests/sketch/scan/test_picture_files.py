"""Kinds of picture files: whatever holds the drawing, its strokes are the same."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from sheets import HEIGHT, WIDTH, assert_all, drawn, encoded, ink, lit

from sim.scene import InputError
from sketch.scan import read_picture

FLAT = drawn(ink())
NOISY = drawn(ink(), noise=9)
ACROSS, DOWN = np.meshgrid(np.linspace(0, 1, WIDTH), np.linspace(0, 1, HEIGHT))
SHADED = lit(drawn(ink(), noise=4), 0.45 + 0.5 * ACROSS * DOWN)


@pytest.mark.parametrize("quality", [30, 60, 90])
def test_the_drawing_survives_compression(quality: int) -> None:
    assert_all(read_picture(encoded(SHADED, ".jpg", cv2.IMWRITE_JPEG_QUALITY, quality)))


@pytest.mark.parametrize("kind", ["grey", "16 bits", "16 bits grey", "transparent", "white and transparent"])
def test_kinds_of_pixels(kind: str) -> None:
    picture: np.ndarray = NOISY
    if "grey" in kind:
        picture = picture[..., 1]
    if "16" in kind:
        picture = picture.astype(np.uint16) * 257
    if "transparent" in kind:
        alpha = np.round(255 * ink()).astype(np.uint8)
        picture = np.dstack([np.full((HEIGHT, WIDTH, 3), 255 * ("white" in kind), np.uint8), alpha])
    assert_all(read_picture(encoded(picture)))


def with_orientation(jpeg: bytes, orientation: int) -> bytes:
    tags = struct.pack("<2sHIHHHII", b"II", 42, 8, 1, 274, 3, 1, orientation) + b"\0\0\0\0"
    exif = b"Exif\0\0" + tags
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + jpeg[2:]


@pytest.mark.parametrize("orientation", range(1, 9))
def test_a_picture_is_read_as_it_is_displayed(orientation: int) -> None:
    upright = FLAT
    stored = {
        1: upright,
        2: upright[:, ::-1],
        3: upright[::-1, ::-1],
        4: upright[::-1],
        5: upright.swapaxes(0, 1),
        6: upright.swapaxes(0, 1)[::-1],
        7: upright.swapaxes(0, 1)[::-1, ::-1],
        8: upright.swapaxes(0, 1)[:, ::-1],
    }[orientation]
    sketch = read_picture(with_orientation(encoded(np.ascontiguousarray(stored), ".jpg"), orientation))
    assert (sketch.width, sketch.height) == (WIDTH, HEIGHT)
    assert_all(sketch)


def test_stages_are_written(tmp_path: Path) -> None:
    read_picture(encoded(FLAT), stages=tmp_path / "seen")
    names = sorted(p.name for p in (tmp_path / "seen").iterdir())
    assert names == ["1-page.png", "2-mask.png", "3-skeleton.png", "4-strokes.png"]
    mask = cv2.imread(str(tmp_path / "seen" / "2-mask.png"), cv2.IMREAD_GRAYSCALE)
    assert set(np.unique(mask)) == {0, 255}


def test_pages_of_a_tiff() -> None:
    """A scanner puts many sheets into one file."""
    blank = np.full((300, 400, 3), 250, np.uint8)
    data = bytes(cv2.imencodemulti(".tiff", [blank, FLAT])[1])
    with pytest.raises(InputError, match="no ink was found"):
        read_picture(data)
    sketch = read_picture(data, page=2)
    assert (sketch.width, sketch.height) == (WIDTH, HEIGHT)
    assert_all(sketch)
    with pytest.raises(InputError, match="no page 3: the file has 2"):
        read_picture(data, page=3)


@pytest.mark.parametrize("white", [1.0, 255.0, 65535.0])
def test_floating_point_values_are_shares_of_white_or_whole_numbers(white: float) -> None:
    picture = NOISY.astype(np.float32) * np.float32(white / 255)
    assert_all(read_picture(encoded(picture, ".tiff")))


def test_heic() -> None:
    pillow_heif = pytest.importorskip("pillow_heif")
    import io

    picture = np.ascontiguousarray(FLAT[..., ::-1])
    file = io.BytesIO()
    pillow_heif.from_bytes("RGB", (WIDTH, HEIGHT), picture.tobytes()).save(file, quality=90)
    assert_all(read_picture(file.getvalue()))


def test_pdf_pages() -> None:
    pypdfium2 = pytest.importorskip("pypdfium2")
    import io

    document = pypdfium2.PdfDocument.new()
    document.new_page(WIDTH, HEIGHT)
    image = pypdfium2.PdfImage.new(document)
    image.load_jpeg(io.BytesIO(encoded(FLAT, ".jpg")))
    image.set_matrix(pypdfium2.PdfMatrix().scale(WIDTH, HEIGHT))
    sheet = document.new_page(WIDTH, HEIGHT)
    sheet.insert_obj(image)
    sheet.gen_content()
    file = io.BytesIO()
    document.save(file)
    document.close()
    data = file.getvalue()
    with pytest.raises(InputError, match="no ink was found"):
        read_picture(data)
    sketch = read_picture(data, page=2)
    for stroke in sketch.strokes:
        stroke.points[:] *= WIDTH / sketch.width
    assert_all(sketch, 2.2)
    with pytest.raises(InputError, match="no page 3"):
        read_picture(data, page=3)


@pytest.mark.parametrize(
    ("module", "data"), [("pillow_heif", b"\0\0\0\x18ftypheic" + b"\0" * 20), ("pypdfium2", b"%PDF-1.7")]
)
def test_what_needs_the_extra_names_it(module: str, data: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(InputError, match="extra 'scan'"):
        read_picture(data)
