"""Excalidraw files: free-hand strokes, lines and arrows as they are; its ready shapes as the outlines that
they show."""

from __future__ import annotations

import math

import msgspec

from sim.scene import InputError, parse_json
from sketch.formats import strokes
from sketch.ink import Sketch

__all__ = ["read"]

Point = tuple[float, float]


class _Element(msgspec.Struct):
    type: str
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0
    angle: float = 0.0  # [rad], clockwise as seen, about the middle
    points: list[list[float]] = []
    isDeleted: bool = False


def read(data: bytes) -> Sketch:
    """Read a drawing. Elements that are no ink (text, frames, images) are named in the notes."""
    d = parse_json(data, strokes.MAX_BYTES)
    raw = d.get("elements") if isinstance(d, dict) else None
    if not isinstance(raw, list):
        raise InputError("elements", "not a list", 'write {"type": "excalidraw", "elements": [...]}')
    found: list[list[Point]] = []
    left: dict[str, int] = {}
    for i, one in enumerate(raw):
        try:
            element = msgspec.convert(one, _Element)
        except msgspec.ValidationError as e:
            raise InputError(f"elements[{i}]", str(e).split(" - at ")[0]) from None
        if element.isDeleted:
            continue
        drawn = _drawn(element)
        found += drawn
        if not drawn:
            left[element.type] = left.get(element.type, 0) + 1
    sketch = strokes.from_objects({"strokes": [[list(p) for p in stroke] for stroke in found]})
    sketch.notes.extend(f"left out: {count} elements of type {kind}" for kind, count in sorted(left.items()))
    return sketch


def _drawn(e: _Element) -> list[list[Point]]:
    """An element's strokes on the page [pixels]."""
    w, h = e.width, e.height
    if e.type in ("freedraw", "line", "arrow"):
        path = [(p[0], p[1]) for p in e.points if len(p) > 1]
        strokes_of = [path]
        if e.type == "arrow" and len(path) > 1:
            strokes_of.append(_head(path[-2], path[-1]))
    elif e.type == "rectangle":
        strokes_of = [[(0, 0), (w, 0), (w, h), (0, h), (0, 0)]]
    elif e.type == "diamond":
        strokes_of = [[(w / 2, 0), (w, h / 2), (w / 2, h), (0, h / 2), (w / 2, 0)]]
    elif e.type == "ellipse":
        turns = [2 * math.pi * k / 48 for k in range(49)]
        strokes_of = [[(w / 2 * (1 + math.cos(t)), h / 2 * (1 + math.sin(t))) for t in turns]]
    else:
        return []
    c, s = math.cos(e.angle), math.sin(e.angle)
    mx, my = w / 2, h / 2
    return [
        [(e.x + mx + c * (x - mx) - s * (y - my), e.y + my + s * (x - mx) + c * (y - my)) for x, y in stroke]
        for stroke in strokes_of
    ]


def _head(before: Point, tip: Point) -> list[Point]:
    """The head that an arrow is shown with: two barbs at 30 degrees."""
    dx, dy = before[0] - tip[0], before[1] - tip[1]
    out = []
    for angle in (math.pi / 6, -math.pi / 6):
        c, s = 0.35 * math.cos(angle), 0.35 * math.sin(angle)
        out.append((tip[0] + c * dx - s * dy, tip[1] + s * dx + c * dy))
    return [out[0], tip, out[1]]
