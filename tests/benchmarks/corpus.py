"""Real ink of a corpus folder: shapes drawn one by one, and sketches composed of them by its own program."""

from __future__ import annotations

import gzip
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.drawings import Drawing

__all__ = ["MEANT", "Sample", "composed", "samples"]

Array = NDArray[np.float64]

# What a label means in this vocabulary: a circle, a number of sides, an outline of many, or a mark.
MEANT = {
    "circle": "circle",
    "connection": "circle",
    "oval": "round",
    "ellipse": "round",
    "terminator": "round",
    "octagon": "round",
    "triangle": "3",
    "rectangle": "4",
    "square": "4",
    "process": "4",
    "diamond": "4",
    "decision": "4",
    "trapezoid": "4",
    "parallelogram": "4",
    "data": "4",
    "pentagon": "5",
    "hexagon": "6",
    "x": "anchor",
    "X": "anchor",
    "arrow": "gravity",
    "arrowhead": "gravity",
    "line": "bar",
}
UNLIKE = {("quickdraw", "diamond")}  # cut stones with their facets
LONGER = 1.22  # than wide: an ellipse


@dataclass(frozen=True, eq=False)
class Sample:
    """One shape that a person drew. meant: as in MEANT, or None for ink outside the vocabulary."""

    source: str
    name: str
    label: str
    writer: str
    strokes: list[Array]
    meant: str | None


def samples(folder: Path) -> Iterator[Sample]:
    """Every sample of ``folder/dev/*.jsonl.gz`` that a person could read as what its label says."""
    for path in sorted((folder / "dev").glob("*.jsonl.gz")):
        source = path.name.split(".")[0]
        with gzip.open(path, "rt", encoding="utf-8") as f:
            for row in map(json.loads, f):
                strokes = [
                    np.array([p[:2] for p in s], dtype=np.float64) for s in row["strokes"] if len(s) > 1
                ]
                meant = MEANT.get(row["label"])
                if (source, row["label"]) in UNLIKE:
                    continue
                if meant == "round" and row["label"] in ("oval", "ellipse") and _longer(strokes) < LONGER:
                    meant = "circle"
                if _usable(strokes, meant):
                    user = str(row.get("user", source))
                    yield Sample(source, str(row["id"]), row["label"], user, strokes, meant)


def composed(folder: Path, count: int, seed: int) -> list[Drawing]:
    """Sketches of the corpus' composer, run as the program that it is."""
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch, "sketches.jsonl")
        program = [sys.executable, str(folder / "compose.py"), "--count", str(count), "--seed", str(seed)]
        subprocess.run([*program, "--out", str(out)], check=True)
        return [Drawing.composed(line) for line in out.read_text().splitlines()]


def _usable(strokes: list[Array], meant: str | None) -> bool:
    ink = np.concatenate(strokes)
    longer = _longer(strokes)
    if meant == "circle":
        return longer < LONGER
    if meant == "anchor":
        return longer < 2.5
    if meant == "gravity":  # a shaft that is longer than its head is wide; routed arrows have bends
        ends = max(((a, b) for s in strokes for a in s for b in s), key=lambda t: math.dist(*t))
        way = (ends[1] - ends[0]) / max(math.dist(*ends), 1e-9)
        across = float(np.ptp(ink @ [-way[1], way[0]]))
        return across < 0.8 * math.dist(*ends) and all(_straight_or_head(s, ends) for s in strokes)
    if meant in ("3", "4", "5", "6"):
        return longer < 8 and _drawn_whole(strokes)
    return True


def _longer(strokes: list[Array]) -> float:
    """How many times as long as wide, or as wide as long, some ink is."""
    width, height = np.maximum(np.ptp(np.concatenate(strokes), axis=0), 1e-9).tolist()
    return max(width / height, height / width)


def _straight_or_head(stroke: Array, ends: tuple[Array, Array]) -> bool:
    """Whether a stroke's ink is near the line between the ends, or near one of them."""
    a, b = ends
    long = math.dist(a, b)
    off = np.abs((stroke - a) @ np.array([a[1] - b[1], b[0] - a[0]])) / long
    near = np.minimum(np.hypot(*(stroke - a).T), np.hypot(*(stroke - b).T))
    return bool(((off < 0.15 * long) | (near < 0.6 * long)).all())


def _drawn_whole(strokes: list[Array]) -> bool:
    """Whether 95 % of the ink's convex hull has ink along it."""
    import cv2

    hull = cv2.convexHull(np.concatenate(strokes).astype(np.float32))[:, 0].astype(np.float64)
    share = np.linspace(0, 1, 12)[:, None, None]
    rim = (hull + share * (np.roll(hull, -1, axis=0) - hull)).reshape(-1, 2)
    ink = np.concatenate([_dense(s) for s in strokes])
    gaps = np.array([np.hypot(*(ink - p).T).min() for p in rim])
    return bool(np.mean(gaps < 0.1 * np.ptp(hull, axis=0).max()) > 0.95)


def _dense(stroke: Array) -> Array:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(stroke, axis=0).T))])
    t = np.linspace(0, along[-1], 120)
    return np.stack([np.interp(t, along, stroke[:, k]) for k in (0, 1)], axis=1)
