"""What the header of a picture file says: its format, size and orientation, before anything is decoded."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Header", "probe", "tiff_page"]

MOST_PAGES = 1000  # of a TIFF file that are counted


@dataclass(frozen=True)
class Header:
    """format: "png", "jpeg", "webp", "tiff", "bmp", "gif", "heic" or "pdf".

    width, height: [pixels] as stored, 0 where the header does not give them (HEIC and PDF, whose own
    libraries are asked; a file that ends within its header).  orientation: EXIF's, 1 (upright) to 8.
    pages: of a TIFF file; the others are taken to have one.
    """

    format: str
    width: int = 0
    height: int = 0
    orientation: int = 1
    pages: int = 1


def probe(data: bytes, page: int = 1) -> Header | None:
    """The header of a picture file, of no size where the file ends within it; None for what is no picture.

    page: of a TIFF file, from 1, whose size and orientation are told; the last one where there are fewer.
    """
    kind = next((kind for kind, begins in _BEGINNINGS.items() if begins(data)), None)
    if kind is None:
        return None
    try:
        if kind == "tiff":
            return _tiff(data, page)
        return _READERS[kind](data) if kind in _READERS else Header(kind)
    except (struct.error, IndexError):
        return Header(kind)


def _is_heic(data: bytes) -> bool:
    return data[4:8] == b"ftyp" and data[8:12] in (
        b"heic",
        b"heix",
        b"hevc",
        b"heim",
        b"heis",
        b"mif1",
        b"msf1",
    )


_BEGINNINGS: dict[str, Callable[[bytes], bool]] = {
    "png": lambda data: data.startswith(b"\x89PNG\r\n\x1a\n"),
    "jpeg": lambda data: data.startswith(b"\xff\xd8\xff"),
    "webp": lambda data: data.startswith(b"RIFF") and data[8:12] == b"WEBP",
    "tiff": lambda data: data.startswith((b"II*\0", b"MM\0*")),
    "bmp": lambda data: data.startswith(b"BM") and data[6:10] == b"\0\0\0\0",
    "gif": lambda data: data.startswith((b"GIF87a", b"GIF89a")),
    "heic": _is_heic,
    "pdf": lambda data: data.startswith(b"%PDF-"),
}


def _png(data: bytes) -> Header:
    width, height = struct.unpack(">II", data[16:24])
    return Header("png", width, height, _png_orientation(data))


def _tiff(data: bytes, page: int) -> Header:
    at = _tiff_directories(data)
    tags = _tiff_tags(data, at[min(page, len(at)) - 1])
    return Header("tiff", tags.get(256, 0), tags.get(257, 0), _valid(tags.get(274, 1)), len(at))


def _bmp(data: bytes) -> Header:
    width, height = struct.unpack("<ii", data[18:26])
    return Header("bmp", abs(width), abs(height))


def _gif(data: bytes) -> Header:
    width, height = struct.unpack("<HH", data[6:10])
    return Header("gif", width, height)


def _valid(orientation: int) -> int:
    return orientation if 1 <= orientation <= 8 else 1


def _tiff_directories(data: bytes) -> list[int]:
    """Where the directories of a TIFF file's pages are, the first at least; a chain that comes back ends there."""
    order = "<" if data[:2] == b"II" else ">"
    (at,) = struct.unpack_from(order + "I", data, 4)
    found = [at]
    while len(found) < MOST_PAGES:
        try:
            (count,) = struct.unpack_from(order + "H", data, at)
            (at,) = struct.unpack_from(order + "I", data, at + 2 + 12 * count)
        except struct.error:
            break
        if not at or at in found:
            break
        found.append(at)
    return found


def tiff_page(data: bytes, page: int) -> bytes:
    """A TIFF file with a page of it, from 1, for its first."""
    order = "<" if data[:2] == b"II" else ">"
    return data[:4] + struct.pack(order + "I", _tiff_directories(data)[page - 1]) + data[8:]


def _tiff_tags(data: bytes, at: int) -> dict[int, int]:
    """The tags of the directory at a place that hold one short or long (TIFF 6.0, section 2)."""
    order = "<" if data[:2] == b"II" else ">"
    (count,) = struct.unpack_from(order + "H", data, at)
    tags = {}
    for k in range(count):
        tag, kind, n = struct.unpack_from(order + "HHI", data, at + 2 + 12 * k)
        if n == 1 and kind in (3, 4):
            tags[tag] = struct.unpack_from(order + ("H" if kind == 3 else "I"), data, at + 10 + 12 * k)[0]
    return tags


def _exif_orientation(exif: bytes) -> int:
    try:
        return _valid(_tiff_tags(exif, _tiff_directories(exif)[0]).get(274, 1))
    except (struct.error, IndexError):
        return 1


def _png_orientation(data: bytes) -> int:
    at = 8
    while at + 8 <= len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"eXIf":
            return _exif_orientation(data[at + 8 : at + 8 + size])
        if kind == b"IDAT":
            break
        at += 12 + size
    return 1


def _jpeg(data: bytes) -> Header:
    at, orientation = 2, 1
    while True:
        while data[at] == 0xFF and data[at + 1] == 0xFF:  # fill bytes
            at += 1
        marker, size = struct.unpack_from(">xBH", data, at)
        if data[at] != 0xFF:
            return Header("jpeg")
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):  # start of frame
            height, width = struct.unpack_from(">HH", data, at + 5)
            return Header("jpeg", width, height, orientation)
        if marker == 0xE1 and data[at + 4 : at + 10] == b"Exif\0\0":
            orientation = _exif_orientation(data[at + 10 : at + 2 + size])
        at += 2 + size


def _webp(data: bytes) -> Header:
    kind = data[12:16]
    if kind == b"VP8X":
        width = 1 + int.from_bytes(data[24:27], "little")
        height = 1 + int.from_bytes(data[27:30], "little")
        return Header("webp", width, height, _webp_orientation(data))
    if kind == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        return Header("webp", 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF))
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return Header("webp", width & 0x3FFF, height & 0x3FFF)
    return Header("webp")


def _webp_orientation(data: bytes) -> int:
    at = 12
    while at + 8 <= len(data):
        kind, size = struct.unpack_from("<4sI", data, at)
        if kind == b"EXIF":
            exif = data[at + 8 : at + 8 + size]
            return _exif_orientation(exif.removeprefix(b"Exif\0\0"))
        at += 8 + size + (size & 1)
    return 1


_READERS: dict[str, Callable[[bytes], Header]] = {
    "png": _png,
    "jpeg": _jpeg,
    "webp": _webp,
    "bmp": _bmp,
    "gif": _gif,
}
