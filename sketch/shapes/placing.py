"""Where a body lies: the outline of its kind that differs least in area from what was drawn, and how sure that is."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sketch.kernel import SIDES, off_outline, place
from sketch.page.pieces import Page
from sketch.scoring import Fitted
from sketch.typing import Array

__all__ = ["Placed", "placed"]


class Placed(NamedTuple):
    """A reading's place on the page.

    Attributes:
        outline: [pixels], as in `sketch.reading.Reading`.
        error: standard error of a body's corners, or of its centre and radius [pixels]; 0 for marks.
        stray: how far its ink is off the outline that was fitted to it, at most [pixels]; 0 for marks.
    """

    outline: Array
    error: float
    stray: float


def placed(page: Page, fitted: Fitted) -> Placed:
    """The place of a reading: a fit says what was meant, by the middle of the ink; a body reaches to its edge.

    An outline of any course, or one that turns inward, is where its ink is.
    """
    outline, kind = fitted.outline, fitted.kind
    sides = 0 if kind == "circle" else len(outline)
    if kind == "circle" or (kind in ("rectangle", "polygon") and sides <= SIDES):
        ink = np.concatenate([page.pieces[i].points for i in fitted.pieces])
        if kind == "circle":
            ring = outline - fitted.middle
            radius = math.hypot(*ring[0].tolist())
            found = place(ink, np.array([*fitted.middle, radius]), 0)
            if found is not None:
                outline = found[:2] + ring * (found[2] / radius)
        else:
            found = place(ink, outline, sides, kind == "rectangle")
            outline = outline if found is None else found
    return Placed(outline, *_off(page, fitted))


def _off(page: Page, c: Fitted) -> tuple[float, float]:
    """The root mean square distance of the ink, times the square root of parameters over independent observations;
    and the greatest distance."""
    if not (c.closed or c.kind == "bar"):
        return 0.0, 0.0
    pieces = [page.pieces[i] for i in c.pieces]
    if c.kind == "circle":
        radius = math.dist(c.outline[0].tolist(), c.middle)
        off = [np.hypot(*(page.strokes.samples[p.stroke] - c.middle).T) - radius for p in pieces]
        squares = [float(np.add.reduce(d * d)) / len(d) for d in off]
        greatest = [float(np.maximum.reduce(d * d)) for d in off]
    else:
        around = c.outline if c.closed else np.concatenate([c.outline, c.outline[-2:0:-1]])  # forth and back
        squares, greatest = off_outline(page.strokes, [p.stroke for p in pieces], around)
    square = sum(p.length * d for p, d in zip(pieces, squares, strict=True)) / sum(p.length for p in pieces)
    parameters = {"circle": 3, "ellipse": 5, "rectangle": 5}.get(c.kind, 2 * len(c.outline))
    error = math.sqrt(square * parameters / max(sum(p.observations for p in pieces), parameters))
    return error, math.sqrt(max(greatest))
