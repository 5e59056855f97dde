"""A picture of paper → strokes, by which the drawing goes on as if it had been made on a tablet."""

from __future__ import annotations

import os

from sim.scene import InputError
from sketch.ink import Sketch
from sketch.scan.decode import decode, is_picture

__all__ = ["is_picture", "read_picture"]


def read_picture(data: bytes, *, page: int = 1, stages: str | os.PathLike[str] | None = None) -> Sketch:
    """The strokes on a picture of paper, from the bytes of its file.

    Args:
        data: a PNG, JPEG, WebP, TIFF or BMP file; with the extra `scan` also HEIC and PDF.
        page: of a PDF or TIFF file, from 1.
        stages: a folder for pictures of what was seen: page, mask, skeleton and strokes.

    The strokes are in the pixels of the picture as displayed upright, y down.  Raises InputError for what
    cannot be read, and where no ink is found.
    """
    from sketch.scan.tracing import trace_picture

    picture, sound = decode(data, page)
    height, width = picture.shape[:2]
    traced = trace_picture(picture)
    if stages is not None:
        from sketch.scan.stages import write_stages

        write_stages(stages, picture, traced)
    notes = []
    if not sound:
        notes.append("the picture's file is damaged: what could be decoded was read")
    if (seen := traced.seen) is not None:
        if seen.specks:
            notes.append(f"left out {seen.specks} specks on the paper")
        notes += seen.left_out
    if not traced.strokes:
        problem = traced.problem or "no ink was found on the picture: nothing was drawn"
        raise InputError("", problem, "; ".join(notes), kind="empty")
    return Sketch(traced.strokes, float(width), float(height), None, picture, notes)
