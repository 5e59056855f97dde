"""What a person meant but for the hand: level sides level, equal wheels equal, bodies that nearly touch touching.

Only where it was asked for, and every change is said in a note. Pivots stay where they were drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Set
from dataclasses import replace
from itertools import pairwise

import numpy as np

from sketch.kernel import is_simple
from sketch.reading import Reading
from sketch.scene.bodies import Drawn
from sketch.typing import Array

__all__ = ["close_gaps", "straighten"]

# By judgement; what they change is a note each, and happens only where it was asked for.
LEVEL = math.radians(4)  # nobody draws a line more level than this by hand, and nobody means a ramp by less
SIDED = 8  # sides up to which each is meant
ALIKE = 1.1  # times that one wheel may be as large as another that was meant to be its equal
GAP = 0.08  # of the smaller body's size: as close as hands come to touching
REACH = 0.5  # of a body's size: none is moved farther


def straighten(readings: list[Reading]) -> list[str]:
    """Make near-level and near-upright sides so, near-equal circles equal, a near-level or near-upright arrow so.

    Changes the readings' outlines; returns what was done, a line a change.
    """
    notes = []
    for r in readings:
        if (r.solid and r.kind != "circle" and len(r.outline) <= SIDED) or r.kind == "gravity":
            level = _levelled(r.outline, r.solid and r.kind != "bar")
            by = float(np.hypot(*(level - r.outline).T).max())
            if by > 0 and (r.kind != "polygon" or is_simple(level)):
                r.outline = level
                name = "arrow" if r.kind == "gravity" else r.kind
                notes.append(
                    f"tidied: the {name} of {r.named} lies level or upright, moved by up to {by:.1f} pixels"
                )
    return notes + _equal(readings)


def _levelled(outline: Array, closed: bool) -> Array:
    """An outline whose sides are level or upright where they nearly are: each such side at its middle."""
    out = outline.copy()
    ends = [*range(len(outline)), *([0] if closed else [])]
    for a, b in pairwise(ends):
        dx, dy = np.abs(outline[b] - outline[a]).tolist()
        for axis, across, along in ((1, dy, dx), (0, dx, dy)):
            if 0 < across < math.tan(LEVEL) * along:
                out[[a, b], axis] = outline[[a, b], axis].mean()
    return out


def _equal(readings: list[Reading]) -> list[str]:
    """Give circles of nearly one size their mean radius."""
    circles = [r for r in readings if r.kind == "circle"]
    radius = {r: _radius(r.outline) for r in circles}
    circles.sort(key=lambda r: radius[r])
    notes, k = [], 0
    while k < len(circles):
        group = [r for r in circles[k:] if radius[r] <= ALIKE * radius[circles[k]]]
        k += len(group)
        mean = sum(radius[r] for r in group) / len(group)
        if len(group) > 1:
            for r in group:
                middle = r.outline.mean(axis=0)
                r.outline = middle + (r.outline - middle) * (mean / radius[r])
            strokes = ", ".join(str(s) for r in group for s in r.strokes)
            notes.append(f"tidied: the circles of strokes {strokes} have one radius, {mean:.1f} pixels")
    return notes


def _radius(ring: Array) -> float:
    return float(np.hypot(*(ring - ring.mean(axis=0)).T).mean())


def close_gaps(
    names: Mapping[Drawn, str], held: Set[Drawn], pull: tuple[float, float], ppm: float
) -> tuple[dict[Drawn, Drawn], list[str]]:
    """Move bodies that nearly touch another until they do, but those that are held: each as it lies then; and what was
    done, a line a body.

    What stands on others moves after them, if it was drawn close to them, as gravity `pull` (y up) goes.
    ppm: [pixels per metre].
    """
    down = np.array([pull[0], -pull[1]])
    order = sorted(names, key=lambda d: -float((d.outline @ down).max()))
    settled = [d for d in order if d in held]
    lies = {d: d for d in names}
    notes = []
    for d in order:
        if d in held:
            continue
        near = []
        for other in settled:
            step = _gap(d, lies[other])
            far = float(np.hypot(*step))
            if 0 < far < REACH * d.size and not _inside(d, lies[other]) and _close(d, other):
                near.append((far, step, other))
        if near:
            far, step, other = min(near, key=lambda t: t[0])
            x, y = d.position
            position = x + float(step[0]) / ppm, y - float(step[1]) / ppm
            lies[d] = replace(d, outline=d.outline + step, position=position)
            notes.append(f"tidied: {names[d]} touches {names[other]}, moved by {far:.1f} pixels")
        settled.append(d)
    return lies, notes


def _close(a: Drawn, b: Drawn) -> bool:
    """Whether two bodies nearly touch, or more than that."""
    return float(np.hypot(*_gap(a, b))) < GAP * min(a.size, b.size) or _inside(a, b)


def _inside(a: Drawn, b: Drawn) -> bool:
    """Whether the outlines cross, or one body lies in the other."""
    return any(b.depth(p) < 0 for p in a.outline) or any(a.depth(p) < 0 for p in b.outline)


def _gap(a: Drawn, b: Drawn) -> Array:
    """The shortest step from body a to body b [pixels]; none where they have a point in common."""
    (p, r), (q, s) = _core(a), _core(b)
    steps = np.concatenate([_to_sides(p, q), -_to_sides(q, p)])
    step = steps[int(np.hypot(*steps.T).argmin())]
    far = math.hypot(*step)
    return np.asarray(step * max(1 - (r + s) / far, 0.0)) if far > 0 else np.zeros(2)


def _core(d: Drawn) -> tuple[Array, float]:
    """An outline, and how far the body reaches beyond it: a circle is its centre, and its radius beyond."""
    if d.kind != "circle":
        return d.outline, 0.0
    return d.outline.mean(axis=0)[None], _radius(d.outline)


def _to_sides(points: Array, outline: Array) -> Array:
    """From each point the shortest step to an outline's sides."""
    side = np.roll(outline, -1, axis=0) - outline
    off = points[:, None] - outline
    t = np.clip((off * side).sum(axis=2) / np.maximum((side * side).sum(axis=1), 1e-9), 0, 1)
    step = t[..., None] * side - off
    best = np.hypot(step[..., 0], step[..., 1]).argmin(axis=1)
    return np.asarray(step[np.arange(len(points)), best])
