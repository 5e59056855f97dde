"""Readers of sketches, one format a file; the format is told by content, never by a file's name."""

from __future__ import annotations

import os
import re
from pathlib import Path

from sim.scene import InputError
from sketch.ink import Sketch

__all__ = ["kind_of", "load_sketch"]

MAX_PICTURE_BYTES = 64 << 20  # a photo of 12 megapixels has 2 to 15 MB; as in cli/inputs.py

# The first bytes of each picture format, and where they stand.
_PICTURES = [
    (0, b"\x89PNG\r\n\x1a\n"),
    (0, b"\xff\xd8\xff"),  # JPEG
    (0, b"GIF8"),
    (0, b"BM"),
    (0, b"II*\0"),  # TIFF
    (0, b"MM\0*"),
    (8, b"WEBP"),
    (4, b"ftyphei"),  # HEIC
    (4, b"ftypmif1"),
    (4, b"ftypavif"),
    (0, b"%PDF"),
]

# The name of the outermost element, after declarations, comments and the document type.
_ROOT = re.compile(
    rb"(?><\?.*?\?>|<!--.*?-->|<!DOCTYPE(?>[^\[>]|\[[^\]]*\])*+>|\s)*+<(?:[\w.-]+:)?([\w.-]+)",
    re.DOTALL,  # nothing in it is tried in two ways: no input takes long
)


def kind_of(data: bytes) -> str:
    """What some input is, by its content: "strokes", "scene", "picture", "quickdraw", "excalidraw", "svg", "inkml" or
    "unknown".

    JSON is told by its keys without parsing it: a scene has "bodies", a sketch "strokes"; a file that has
    both says what it is in "format".  XML is told by its outermost element.
    """
    if any(data[at : at + len(magic)] == magic for at, magic in _PICTURES):
        return "picture"
    head = data[:4096]
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):  # XML may be UTF-16
        head = head.decode("utf-16", "ignore").encode()
    head = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    if head[:1] == b"<":
        root = _ROOT.match(head)
        return {b"svg": "svg", b"ink": "inkml"}.get(root[1] if root else b"", "unknown")
    if head[:1] not in (b"{", b"["):
        return "unknown"
    if b"sketchsim-scene" in head:
        return "scene"
    if b"sketchsim-strokes" in head:
        return "strokes"
    if b'"excalidraw' in head and b'"elements"' in data:
        return "excalidraw"
    if b'"drawing"' in head and b'"strokes"' not in head:
        return "quickdraw"
    bodies, strokes = data.find(b'"bodies"'), data.find(b'"strokes"')
    if bodies >= 0 and (strokes < 0 or bodies < strokes):
        return "scene"
    return "strokes"


def load_sketch(
    source: str | os.PathLike[str] | bytes,
    *,
    page: int = 1,
    index: int | None = None,
    stages: str | os.PathLike[str] | None = None,
) -> Sketch:
    """Read a sketch from a file or from its bytes: strokes in any of the formats here, or a picture of paper.

    Args:
        source: a path, or what a file holds.
        page: of a PDF or TIFF file, from 1.
        index: of a file with many drawings (Quick, Draw!), from 0.
        stages: a folder for pictures of what was seen on a picture, from page to strokes.

    Raises InputError, which names the bad element, for what is no sketch; OSError for a file that cannot be
    read.
    """
    data = source if isinstance(source, bytes) else _contents(Path(source))
    if not data.strip():
        raise InputError("", "the input is empty", kind="empty")
    kind = kind_of(data)
    if kind == "picture":
        from sketch.scan import read_picture

        return read_picture(data, page=page, stages=stages)
    if page != 1:
        raise InputError("", f"there is no page {page}: the input has one")
    if stages is not None:
        raise InputError("", "there are no stages of reading strokes", "stages are those of a picture")
    if kind == "quickdraw":
        from sketch.formats import quickdraw

        return quickdraw.read(data, index)
    if index:
        raise InputError("", f"there is no drawing {index}: the input has one")
    return _read(data, kind)


def _contents(path: Path) -> bytes:
    size = path.stat().st_size
    if size > MAX_PICTURE_BYTES:  # said before reading: a huge file costs neither time nor memory
        raise InputError(
            "", f"{size / 1e6:.0f} MB; at most {MAX_PICTURE_BYTES / 1e6:.0f} MB are taken", kind="size"
        )
    return path.read_bytes()


def _read(data: bytes, kind: str) -> Sketch:
    """A drawing of a format that keeps one in a file; each reader is loaded when it is needed."""
    if kind == "strokes":
        from sketch.formats import strokes

        return strokes.read(data)
    if kind == "excalidraw":
        from sketch.formats import excalidraw

        return excalidraw.read(data)
    if kind == "svg":
        from sketch.formats import svg

        return svg.read(data)
    if kind == "inkml":
        from sketch.formats import inkml

        return inkml.read(data)
    if kind == "scene":
        raise InputError(
            "", "this is a scene, not a sketch", "a scene needs no recognition: simulate it", kind="format"
        )
    raise InputError(
        "line 1 column 1",
        "not JSON, SVG or InkML, and no picture either",
        "drawings: JSON, Excalidraw, Quick, Draw!, SVG, InkML; pictures: PNG, JPEG, WebP, TIFF, HEIC, PDF",
        kind="format",
    )
