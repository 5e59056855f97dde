"""Picture files → pixels: upright, BGR, 8 bits, on white where transparent, or on black under white ink."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.scene import InputError
from sketch.scan.header import Header, probe, tiff_page

__all__ = ["decode", "is_picture"]

PDF_SIDE = 2000  # [pixels] of the longer side that a PDF page is drawn with
MAX_PIXELS = 64_000_000  # 192 MB as BGR; a phone's sharpest mode has 48 to 50 million


def is_picture(data: bytes) -> bool:
    """Whether the bytes begin as a picture file that `decode` knows."""
    return probe(data) is not None


def decode(data: bytes, page: int = 1) -> tuple[NDArray[np.uint8], bool]:
    """The picture in a file's bytes, as displayed upright: BGR, shape (h, w, 3); and whether the file is sound.

    PNG, JPEG, WebP, TIFF and BMP; with the extra `scan` also HEIC and PDF.  page: of a PDF or TIFF file, from 1.
    Raises InputError for anything else, for a file that ends too early and for a picture of more than MAX_PIXELS,
    which is refused by its header.
    """
    if not data:
        raise InputError("", "the file is empty", kind="empty")
    header = probe(data, page)
    if header is None:
        problem = "an AVIF picture, which is not read" if data[4:12] == b"ftypavif" else "not a picture"
        raise InputError("", problem, "PNG, JPEG, WebP, TIFF, BMP, HEIC and PDF are read", kind="format")
    if header.format == "pdf":
        return _to_bgr8(_decode_pdf(data, page)), True
    if not 1 <= page <= header.pages:
        has = f"the file has {header.pages}" if header.pages > 1 else "the picture has one"
        raise InputError("", f"there is no page {page}: {has}")
    if header.format == "heic":
        return _to_bgr8(_decode_heic(data)), True
    _check_size(header)
    picture, sound = _decode_with_cv2(tiff_page(data, page) if page > 1 else data, header)
    return _to_bgr8(picture), sound


def _check_size(header: Header) -> None:
    width, height = header.width, header.height
    if width < 1 or height < 1:
        raise _damaged(header)
    if width * height > MAX_PIXELS:
        raise InputError(
            "",
            f"a picture of {width} x {height} pixels; at most {MAX_PIXELS // 1_000_000} million are taken",
            "make it smaller: 2000 pixels across are plenty",
            kind="size",
        )


def _damaged(header: Header) -> InputError:
    return InputError("", f"a {header.format.upper()} picture that is damaged or cut short", kind="format")


def _decode_with_cv2(data: bytes, header: Header) -> tuple[NDArray[Any], bool]:
    import cv2

    raw = np.frombuffer(data, np.uint8)
    # a JPEG has neither transparency nor 16 bits, and is turned upright by cv2; the others are by us
    flags = cv2.IMREAD_COLOR if header.format == "jpeg" else cv2.IMREAD_UNCHANGED
    with _overheard() as said:
        try:
            picture = cv2.imdecode(raw, flags)
        except cv2.error:
            picture = None
    if picture is None:
        raise _damaged(header)
    stored = (header.height, header.width)
    if header.format != "jpeg" and header.orientation > 1 and picture.shape[:2] == stored:
        picture = _upright(picture, header.orientation)
    return np.asarray(picture), not any(word in said.lower() for word in (b"corrupt", b"error", b"premature"))


@contextmanager
def _overheard() -> Iterator[bytearray]:
    """Keep what the decoders' C libraries print on standard error from the user, who gets a line of ours."""
    said = bytearray()
    try:
        kept = os.dup(2)
    except OSError:  # a program without standard error
        yield said
        return
    reader, writer = os.pipe()
    with suppress(OSError, AttributeError):  # what does not fit the pipe is lost and nobody waits
        os.set_blocking(writer, False)
    os.dup2(writer, 2)
    os.close(writer)
    try:
        yield said
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        said += os.read(reader, 65536)  # of no length when nothing was said: the other end is closed
        os.close(reader)


def _decode_heic(data: bytes) -> NDArray[Any]:
    try:
        import pillow_heif
    except ImportError:
        raise _lacks_extra("HEIC pictures") from None
    try:
        file = pillow_heif.open_heif(data, convert_hdr_to_8bit=True)
        _check_size(Header("heic", *file.size))
        picture = np.asarray(file)  # turned upright by the library
    except (ValueError, RuntimeError, SyntaxError, EOFError):
        raise InputError("", "a HEIC picture that is damaged or cut short", kind="format") from None
    return picture if picture.ndim == 2 else picture[..., [2, 1, 0, *range(3, picture.shape[2])]]


def _decode_pdf(data: bytes, page: int) -> NDArray[Any]:
    try:
        import pypdfium2
    except ImportError:
        raise _lacks_extra("PDF pages") from None
    try:
        document = pypdfium2.PdfDocument(data)
    except pypdfium2.PdfiumError:
        raise InputError(
            "", "a PDF file that is damaged, cut short or locked by a password", kind="format"
        ) from None
    with document:
        if not 1 <= page <= len(document):
            raise InputError("", f"there is no page {page}: the file has {len(document)}")
        sheet = document[page - 1]
        longer = max(sheet.get_size())
        picture = sheet.render(scale=PDF_SIDE / max(longer, 1.0)).to_numpy()
        return np.array(picture)


def _lacks_extra(what: str) -> InputError:
    return InputError(
        "", f"{what} need packages of the extra 'scan'", "pip install pillow-heif pypdfium2", kind="extra"
    )


def _upright(picture: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Undo EXIF's orientation: 2, 4, 5, 7 are mirrored, 3 is upside down, 6 and 8 lie on a side."""
    if orientation in (5, 6, 7, 8):
        picture = picture.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        picture = picture[::-1]
    if orientation in (2, 3, 6, 7):
        picture = picture[:, ::-1]
    return np.ascontiguousarray(picture)


def _to_bgr8(picture: NDArray[Any]) -> NDArray[np.uint8]:
    import cv2

    if picture.dtype == np.uint16:
        picture = cv2.convertScaleAbs(picture, alpha=1 / 257)
    elif picture.dtype != np.uint8:  # floating-point TIFF: 0 to 1 by custom, or what whole numbers would have
        picture = np.nan_to_num(picture)
        white = next((most for most in (1, 255) if picture.max() <= most), 65535)
        picture = np.clip(picture * (255 / white), 0, 255).astype(np.uint8)
    if picture.ndim == 2:
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.uint8)
    if picture.shape[2] == 4:
        alpha = picture[..., 3:].astype(np.uint16)
        return ((picture[..., :3] * alpha + _ground(picture) * (255 - alpha)) // 255).astype(np.uint8)
    return np.ascontiguousarray(picture[..., :3], np.uint8)


def _ground(picture: NDArray[Any]) -> int:
    """What a BGRA picture is laid on: white, but black where nearly all that is to be seen is paler than grey."""
    inked = picture[picture[..., 3] > 127]
    if not len(inked) or 2 * len(inked) > picture.shape[0] * picture.shape[1]:
        return 255
    return 0 if inked[:, :3].min(axis=1).mean() > 127 else 255
