"""Excalidraw files: free-hand strokes, lines and arrows as they are shown, its ready shapes as their outlines.

Corners that the program rounds are taken as sharp: its rounding is an ornament, not the person's line.
"""

from __future__ import annotations

import math
from typing import Any

import msgspec

from sim.scene import InputError, parse_json
from sketch.formats import arrowheads, strokes
from sketch.ink import Sketch
from sketch.typing import Point

__all__ = ["read"]

PIECES = 12  # straight pieces of a curve between two of its points


class _Element(msgspec.Struct):
    type: str
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0
    angle: float = 0.0  # [rad], clockwise as seen, about the middle
    points: list[list[float]] = []
    roundness: dict[str, Any] | None = None
    startArrowhead: str | None = None
    endArrowhead: str | msgspec.UnsetType | None = msgspec.UNSET
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
        element = _element(one, f"elements[{i}]")
        if element.isDeleted:
            continue
        drawn = _drawn(element)
        found += drawn
        if not drawn:
            left[element.type] = left.get(element.type, 0) + 1
    sketch = strokes.from_objects({"strokes": [[list(p) for p in stroke] for stroke in found]})
    sketch.notes.extend(f"left out: {count} x {kind}" for kind, count in sorted(left.items()))
    return sketch


def _element(one: Any, path: str) -> _Element:
    try:
        element = msgspec.convert(one, _Element)
    except msgspec.ValidationError as e:
        problem, _, inside = str(e).partition(" - at `$")
        problem = problem[:1].lower() + problem[1:].replace("`", "")
        raise InputError(path + inside.rstrip("`"), problem) from None
    numbers = {name: getattr(element, name) for name in ("x", "y", "width", "height", "angle")}
    numbers |= {f"points[{k}]": math.fsum(map(abs, point)) for k, point in enumerate(element.points)}
    for name, value in numbers.items():
        if not math.isfinite(value):
            raise InputError(f"{path}.{name}", "not a finite number")
    return element


def _drawn(e: _Element) -> list[list[Point]]:
    """An element's strokes on the page [pixels]."""
    w, h = e.width, e.height
    mx, my = w / 2, h / 2
    if e.type in ("freedraw", "line", "arrow"):
        path = [(p[0], p[1]) for p in e.points if len(p) > 1]
        if not path:
            return []
        if e.roundness is not None and e.type != "freedraw":
            path = _smooth(path)
        # These turn about the middle of what is drawn; their points count from the first one.
        mx, my = (((min(column) + max(column)) / 2) for column in zip(*path, strict=True))
        strokes_of = [path]
        end = e.endArrowhead
        if end is msgspec.UNSET:
            end = "arrow" if e.type == "arrow" else None
        for tip, shaft in ((e.startArrowhead, path[::-1]), (end, path)):
            if tip is not None and len(path) > 1:
                strokes_of.append(arrowheads.head(shaft[-2], shaft[-1]))
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
    return [
        [(e.x + mx + c * (x - mx) - s * (y - my), e.y + my + s * (x - mx) + c * (y - my)) for x, y in stroke]
        for stroke in strokes_of
        if stroke
    ]


def _smooth(path: list[Point]) -> list[Point]:
    """The curve through the points that rounded lines are shown as: Catmull and Rom's."""
    if len(path) < 3:
        return path
    out = [path[0]]
    for k in range(len(path) - 1):
        a, b, c, d = (path[min(max(k + i, 0), len(path) - 1)] for i in (-1, 0, 1, 2))
        for step in range(1, PIECES + 1):
            t = step / PIECES
            out.append((_through(a[0], b[0], c[0], d[0], t), _through(a[1], b[1], c[1], d[1], t)))
    return out


def _through(a: float, b: float, c: float, d: float, t: float) -> float:
    """One coordinate between b and c; a and d are the neighbours before and after."""
    return b + t / 2 * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))
