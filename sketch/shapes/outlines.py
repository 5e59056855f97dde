"""Readings of closed outlines: round, rectangle, polygon, any course; and ink that goes over one once more."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sketch.kernel import course_around, ring
from sketch.page.loose import Chain
from sketch.page.pieces import Page
from sketch.page.sampling import arced, unevenness
from sketch.scoring import FREE, PARAMETER, Fitted
from sketch.shapes.closed import Few, closed_readings, fit_closed
from sketch.typing import Array

__all__ = ["LEAST_AXIS", "read_borrowing", "read_outline"]

FEWER, MANY = (
    7,
    12,
)  # as in core/readings.c: polygons of more sides, and ink of more steps, are seen as they are
EVEN_STEPS = 0.06  # of a step: how uneven they usually are along something round
CORNERED = 0.12  # of a step: how uneven they usually are around something with corners
STEPPING = 0.3  # of the logarithm of how uneven steps are: how much it differs from EVEN_STEPS' or CORNERED's
CHANCE = 3.0  # nats that all corners lie halfway between points, or at them: steps are even then
RETRACE = 1.0  # nats an observation of ink that was drawn already; as in core/fit.h
SHARED = 10.0  # nats that an outline is rarer of which a side is another's
GAP = 4.0  # nats for each observation that an outline lacks; as in core/closed.h
SIDE = 0.18  # of an outline's ink where it is made even: a wider gap may be a short side that nobody drew
TENTH = 0.12  # of an outline's ink as it is: a gap that may be such a side is no wider
OPEN = 0.7  # of the nats of its free ink: an outline that is said in fewer lacks no such side
CLEAN = 30.0  # nats that hardly any outline is said in fewer
LEAST_AXIS = 0.002  # of the page: thinner outlines are judged as if they were this thick

_NO_FEW = Few(0.0, MANY, 0.0, 0.0)  # of ink that came in many points
_ANGLES = np.linspace(0, 2 * math.pi, 24, endpoint=False)
_RING = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)


def read_outline(page: Page, chain: Chain) -> list[Fitted]:
    """The readings of pieces that go once around, one of each kind."""
    pieces = page.pieces
    names = tuple(sorted(i for i, _ in chain))
    count = sum(pieces[i].observations for i in names)
    parts = [pieces[i].points[::-1] if back else pieces[i].points for i, back in chain]
    out = _read(page, names, parts, count)
    least = min(f.cost for f in out)
    p = pieces[names[0]]
    if len(chain) > 1:
        return out
    if p.gap < TENTH * p.length and out[0].gap > SIDE and least > OPEN * p.unread:
        # perhaps a short side lacks: it goes from end to end
        side = [*parts, np.array([p.ends[1], p.ends[0]])]
        bridged = [
            replace(f, gap=out[0].gap)
            for f in _read(page, names, side, count, GAP * count * p.gap / p.length)
            if f.kind in ("polygon", "rectangle") and f.cost < least
        ]
        return bridged or out
    closed = ring(parts[0], p.length)
    if closed is None:
        return out
    # what runs on beyond where the ends cross is said freely
    tails = count * closed[1] / p.length
    if FREE * tails + CLEAN >= least:
        return out
    other = _read(page, names, [closed[0]], count - tails, FREE * tails)
    return other if min(f.cost for f in other) < least else out


def read_borrowing(page: Page, way: Chain, lender: int, side: Array) -> list[Fitted]:
    """The readings of pieces that lack a side, which another piece lends: its ink from their last end to their first
    [pixels], (n, 2)."""
    names = tuple(sorted(i for i, _ in way))
    count = sum(page.pieces[i].observations for i in names)
    parts = [page.pieces[i].points[::-1] if back else page.pieces[i].points for i, back in way]
    said = SHARED + PARAMETER * (len(way) - 1)  # whoever drew several sides mostly drew all
    return [replace(f, lender=lender) for f in _read(page, names, [*parts, side], count, said)]


def _read(
    page: Page,
    names: tuple[int, ...],
    parts: list[Array],
    count: float,
    besides: float = 0.0,
) -> list[Fitted]:
    """The readings of ink that goes once around.

    besides: nats to say what else there is: ink of these pieces that does not, or a side that is not theirs.
    """
    pieces = page.pieces
    free = sum([pieces[i].unread for i in names])
    least_axis = LEAST_AXIS * page.size
    fit = rounded = fit_closed(parts, least_axis, count, 2 * free)
    points, few = _few(parts, [pieces[i].given for i in names]), _NO_FEW
    if points:
        ellipse = fit.ellipse
        if ellipse is not None:
            # along something round the ink between two points is no chord, but an arc of it
            ink = [*(arced(its, *ellipse) for its in points), *parts[len(points) :]]
            rounded = fit_closed(ink, least_axis, count, 0.0)
        few = _stepping(points, rounded.ellipse, sum(map(len, parts)) - len(parts))
    found = closed_readings(fit, rounded, count, besides, few)
    its = found.scale, found.narrow, found.gap
    circle, (x, y, r) = found.circle, found.at
    out = [Fitted("circle", names, circle.cost, np.array([x, y]) + r * _RING, circle.model, *its)]
    ellipse = rounded.ellipse
    if ellipse is not None:
        outline = ellipse[0] + _RING @ ellipse[1].T
        out.append(Fitted("ellipse", names, found.ellipse.cost, outline, found.ellipse.model, *its))
    said = found.polygon
    if said.cost < math.inf:
        outline, ahead = fit.vertices(int(found.sides)), (int(found.next), found.ahead)
        out.append(Fitted("polygon", names, said.cost, outline, said.model, *its, said.rough, ahead))
    said = found.rectangle
    if said.cost < math.inf:
        out.append(Fitted("rectangle", names, said.cost, fit.rectangle, said.model, *its, said.rough))
    said = found.free
    course = course_around(parts) if said.cost < math.inf else None
    if course is not None:
        out.append(Fitted("free", names, said.cost, course, said.model, *its))
    return out


def _few(parts: list[Array], given: list[Array | None]) -> list[Array]:
    """The points that ink came with, where they are few, in equal steps, and none of its parts is without; else none.

    parts: of the ink, those of pieces first, then sides that are none of theirs.  given: as of the pieces.
    """
    came = {(x, y) for points in given if points is not None for x, y in points.tolist()}
    own = [part[[(x, y) in came for x, y in part.tolist()]] for part in parts[: len(given)]] if came else []
    steps = sum(map(len, own)) - len(own)
    return own if FEWER < steps < MANY and all(len(points) > 1 for points in own) else []


def _stepping(points: list[Array], ellipse: tuple[Array, Array] | None, along: int) -> Few:
    """What few points say, and how even the steps between them are, where an ellipse tells that.

    Between few points nobody sees how the ink turns; but in equal steps of length along it they are nearer where a
    corner lies between them, and equally far apart along something round.
    along: steps between the points of its line, corners among them.
    """
    every = sum(map(len, points))
    said = 2 * every - len(points)
    if ellipse is None:
        return Few(said, MANY, 0.0, 0.0)
    off = math.log(max(unevenness(points, *ellipse), EVEN_STEPS / 10))
    even, cornered = max(off - math.log(EVEN_STEPS), 0.0), max(math.log(CORNERED) - off, 0.0)
    return Few(
        said,
        max(every - len(points), min(along, MANY)),
        0.5 * (even / STEPPING) ** 2,
        min(0.5 * (cornered / STEPPING) ** 2, CHANCE),
    )
