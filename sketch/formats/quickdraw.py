"""Quick, Draw! drawings, one JSON object a line: ``{"drawing": [[[x, ...], [y, ...], [t, ...]], ...]}``."""

from __future__ import annotations

from typing import Any

from sim.scene import InputError, parse_json
from sketch.formats import strokes
from sketch.ink import Sketch

__all__ = ["read"]


def read(data: bytes, index: int | None = None) -> Sketch:
    """Read one of the drawings, by its index from 0; of several the first without it, and a note says so.

    Raises InputError with the path to what is wrong.
    """
    lines = [line for line in data.splitlines() if line.strip()]
    if index is not None and index >= len(lines):
        raise InputError("", f"there is no drawing {index}", f"drawings are 0 to {len(lines) - 1}")
    try:
        d = parse_json(lines[index or 0], strokes.MAX_BYTES)
    except InputError as e:
        place = e.path.replace("line 1 ", f"line {(index or 0) + 1} ", 1)
        raise InputError(place, e.problem, e.hint, kind=e.kind) from None
    drawing = d.get("drawing") if isinstance(d, dict) else None
    if not isinstance(drawing, list):
        raise InputError("drawing", "not a list of strokes", 'write {"drawing": [[[x, ...], [y, ...]], ...]}')
    sketch = strokes.from_objects({"strokes": [_columns(s, f"drawing[{i}]") for i, s in enumerate(drawing)]})
    if index is None and len(lines) > 1:
        sketch.notes.append(f"the first of {len(lines)} drawings was read")
    return sketch


def _columns(raw: Any, path: str) -> dict[str, Any]:
    if not isinstance(raw, list) or len(raw) < 2:
        raise InputError(path, "not a stroke", "a stroke is [[x, ...], [y, ...]], or with [t, ...]")
    return dict(zip("xyt", raw, strict=False))
