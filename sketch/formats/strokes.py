"""The project's own stroke JSON: ``{"strokes": [{"points": [[x, y, t], ...]}, ...]}``.

A stroke is ``{"points": [[x, y], [x, y, t], ...]}``, a bare list of points, or columns ``{"x": [...], "y":
[...], "t": [...]}``. Pixels, y down; t in milliseconds, optional. Keys that are not named here are left
alone.
"""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np

from sim.scene import InputError, check_format, parse_json
from sketch.ink import Sketch, Stroke
from sketch.typing import Array

__all__ = ["from_objects", "read"]

MAX_BYTES = 24 << 20  # a point takes some 20 bytes: MAX_POINTS of them
MAX_POINTS = 1_000_000  # a page of 200 strokes of 500 points has a tenth of that
MAX_STROKES = 5_000  # in a machine there are some hundred; as many lines as this, all crossing, take minutes
MAX_COORDINATE = 1e7  # pixels: squares and fourth powers of it stay exact enough

_LAYOUT = 'a stroke is {"points": [[x, y], ...]}, a list of points, or {"x": [...], "y": [...]}'


def read(data: bytes) -> Sketch:
    """Read stroke JSON. Raises InputError with the path to the bad element."""
    # Counted before any object is built: ten million points are refused in milliseconds.
    if len(data) <= MAX_BYTES and data.count(b",") > 4 * MAX_POINTS:
        raise InputError("strokes", f"more than {MAX_POINTS} points", "resample the strokes", kind="size")
    return from_objects(parse_json(data, MAX_BYTES))


def from_objects(d: Any) -> Sketch:
    """A sketch from stroke JSON's objects. Raises InputError with the path to the bad element."""
    if isinstance(d, list):
        d = {"strokes": d}
    if not isinstance(d, dict):
        raise InputError("", "a sketch is a JSON object with a list of strokes", _LAYOUT)
    check_format(d, "sketchsim-strokes")
    if "strokes" not in d:
        raise InputError("strokes", "missing", 'a sketch is {"strokes": [...]}; ' + _LAYOUT)
    raw = d["strokes"]
    if not isinstance(raw, list):
        raise InputError("strokes", "not a list", _LAYOUT)
    if not raw:
        raise InputError("strokes", "there are no strokes: nothing was drawn", kind="empty")
    if len(raw) > MAX_STROKES:
        raise InputError("strokes", f"{len(raw)} strokes; at most {MAX_STROKES} are taken", kind="size")
    strokes = [_stroke(s, f"strokes[{i}]") for i, s in enumerate(raw)]
    total = sum(len(s.points) for s in strokes)
    if total > MAX_POINTS:
        raise InputError(
            "strokes", f"{total} points; at most {MAX_POINTS} are taken", "resample the strokes", kind="size"
        )
    if not any(s.has_length for s in strokes):
        n = len(strokes[0].points)
        what = {0: "no points", 1: "only one point"}.get(n, f"{n} points at one place")
        raise InputError(
            "strokes[0].points", f"{what}: a stroke goes from one place to another", kind="empty"
        )
    return Sketch(
        strokes=strokes,
        width=_size(d, "width"),
        height=_size(d, "height"),
        pixels_per_metre=_size(d, "pixels_per_metre"),
    )


def _size(d: dict[str, Any], key: str) -> float | None:
    value = d.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(key, "not a number")
    if not math.isfinite(value):
        raise InputError(key, f"{value} is not a finite number")
    if value <= 0:
        raise InputError(key, f"{value:g} is not greater than 0")
    return float(value)


def _stroke(raw: Any, path: str) -> Stroke:
    if isinstance(raw, list):
        return _points(raw, path)
    if not isinstance(raw, dict):
        raise InputError(path, "not a stroke", _LAYOUT)
    if "points" in raw:
        if not isinstance(raw["points"], list):
            raise InputError(f"{path}.points", "not a list of points", _LAYOUT)
        return _points(raw["points"], f"{path}.points")
    if "x" in raw or "y" in raw:
        return _columns(raw, path)
    raise InputError(f"{path}.points", "missing", _LAYOUT)


def _points(raw: list[Any], path: str) -> Stroke:
    try:
        rows = msgspec.convert(raw, list[list[float]])
        width = min(3, min(map(len, rows), default=2))
        if width < 2:
            raise ValueError
        table = np.array([row[:width] for row in rows], dtype=np.float64).reshape(-1, width)
    except (msgspec.ValidationError, ValueError, OverflowError):
        table = _rows_with_gaps(raw, path)
    xy = np.ascontiguousarray(table[:, :2])
    bad = np.flatnonzero(~(np.abs(xy) <= MAX_COORDINATE).all(axis=1))
    if len(bad):
        i = int(bad[0])
        _check(float(xy[i, 0]), f"{path}[{i}]", "x")
        _check(float(xy[i, 1]), f"{path}[{i}]", "y")
    return Stroke(xy, _times(table[:, 2]) if table.shape[1] > 2 else None)


def _rows_with_gaps(raw: list[Any], path: str) -> Array:
    """The points one by one: names the bad one; a time that is missing or null is no error."""
    table = np.empty((len(raw), 2))
    for i, p in enumerate(raw):
        if not isinstance(p, list) or len(p) < 2:
            raise InputError(f"{path}[{i}]", "not a point", "a point is [x, y] or [x, y, t]")
        for k, name in enumerate("xy"):
            _check(p[k], f"{path}[{i}]", name)
            table[i, k] = p[k]
    return table


def _columns(raw: dict[str, Any], path: str) -> Stroke:
    columns = []
    for name in "xy":
        if name not in raw:
            raise InputError(f"{path}.{name}", "missing", "columns are x, y and, if known, t")
        values = raw[name]
        if not isinstance(values, list):
            raise InputError(f"{path}.{name}", "not a list of numbers")
        try:
            column = np.array(msgspec.convert(values, list[float]), dtype=np.float64)
        except (msgspec.ValidationError, OverflowError):
            column = np.full(len(values), np.nan)
        for i in np.flatnonzero(~(np.abs(column) <= MAX_COORDINATE)).tolist():
            _check(values[i], f"{path}.{name}[{i}]", name)
        columns.append(column)
    if len(columns[0]) != len(columns[1]):
        raise InputError(path, f"{len(columns[0])} values of x but {len(columns[1])} of y")
    times = raw.get("t")
    if isinstance(times, list) and len(times) == len(columns[0]):
        try:
            return Stroke(
                np.stack(columns, axis=1), _times(np.array(msgspec.convert(times, list[float]), float))
            )
        except (msgspec.ValidationError, OverflowError):
            pass  # times are never relied on
    return Stroke(np.stack(columns, axis=1))


def _times(t: Array) -> Array | None:
    return t if len(t) and bool(np.isfinite(t).all()) else None


def _check(value: Any, path: str, name: str) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(path, f"{name} is not a number")
    if not math.isfinite(value):
        raise InputError(path, f"{name} is not a finite number")
    if abs(value) > MAX_COORDINATE:
        raise InputError(path, f"{name} is beyond {MAX_COORDINATE:.0e} pixels")
