"""Readings of closed outlines: round, rectangle, polygon, any course; and ink that goes over one once more."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from sketch.kernel import ClosedFit, course_around, fit_closed, off_outline, ring
from sketch.page.loose import Chain
from sketch.page.pieces import Page, Piece
from sketch.page.sampling import arced, unevenness
from sketch.scoring import FREE, PARAMETER, Fitted, misfit
from sketch.typing import Array

__all__ = ["LEAST_AXIS", "gone_over", "read_borrowing", "read_outline"]

MOST_SIDES = 12
FEWEST = 5  # sides of polygons that are nearly round
MOST = 7  # sides of polygons beside whose corners something round turns more; as in core/outline.c
ROUND = 31.0  # nats that a round outline is rarer than its three parameters say
CORNER = 4.0  # nats to say a corner's coordinate, given those before: less than a free parameter
USUAL = {3: 2.0, 4: 4.0}  # nats that triangles and quadrilaterals are commoner than other polygons
IRREGULAR = 6.0  # nats that a quadrilateral is rarer of which no two sides are parallel
ALIKE = 0.1  # [rad]: how far opposite sides usually are from parallel that are meant to be
ALSO = 10.0  # nats: likelihoods of polygons that take so much more are not told apart
NEARLY = 1.5  # nats to say where a corner is, either way, that is off its place in a regular polygon by some REGULAR
REGULAR = 0.06  # of the radius: how far corners that are meant to be regular usually are off their places
BOX = 17.0  # nats to say a rectangle: five parameters, and that it is the commonest thing drawn
UNROUND = 0.115  # usual log of a drawn circle's length over its width, either way: nobody's circles are round
EVENLY = 0.4  # usual share of a round outline's turning that is at a polygon's corners, beyond what is there anyway
TURNING = 0.12  # how much the share of turning that is at corners differs from the usual: EVENLY, or all of a polygon's
MANY = 12  # steps between points around an outline: where there are more, one sees how the ink turns
EVEN_STEPS = 0.06  # of a step: how uneven they usually are along something round
CORNERED = 0.12  # of a step: how uneven they usually are around something with corners
STEPPING = 0.3  # of the logarithm of how uneven steps are: how much it differs from EVEN_STEPS' or CORNERED's
CHANCE = 3.0  # nats that all corners lie halfway between points, or at them: steps are even then
ELLIPSE = 7.5  # nats that an ellipse takes beyond a circle: with 1.6 times as long as wide it is either
FREEFORM = 29.0  # nats that an outline of any course, a hill or a cloud, is rarer than a polygon
ARC = 7.0  # nats to say each arc of an outline of any course: where along it one ends is hardly told
WIDE = 0.25  # of its ink: where more is missing, nobody can say which course it took; as in core/sides.c
RETRACE = 1.0  # nats an observation of ink that was drawn already; as in core/outline.h
SHARED = 10.0  # nats that an outline is rarer of which a side is another's
GAP = 4.0  # nats for each observation that an outline lacks
SIDE = 0.18  # of an outline's ink where it is made even: a wider gap may be a short side that nobody drew
TENTH = 0.12  # of an outline's ink as it is: a gap that may be such a side is no wider
OPEN = 0.7  # of the nats of its free ink: an outline that is said in fewer lacks no such side
CLEAN = 30.0  # nats that hardly any outline is said in fewer
CAP = 0.3  # distances count up to this share of the radius: hooks and flourishes
LEAST_AXIS = 0.002  # of the page: thinner outlines are judged as if they were this thick

_SAID = [2 * k * CORNER - USUAL.get(k, 0.0) for k in range(MOST_SIDES + 1)]  # nats to say k corners
_NEARLY_SAID = [
    6 * CORNER + (2 * k - 6) * NEARLY for k in range(MOST_SIDES + 1)
]  # if they are nearly regular
_ROOTS = {k: [cmath.exp(2j * math.pi * j / k) for j in range(k)] for k in range(FEWEST, MOST + 1)}  # of one
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
    free = sum(pieces[i].unread for i in names)
    fit = fit_closed(parts, LEAST_AXIS * page.size, CAP, count, 2 * CORNER, 2 * free, GAP)
    gaps = GAP * count * fit.gap / fit.ink + besides
    (p, q), (r, s) = fit.back.tolist()
    scale, narrow = math.sqrt(abs(p * s - q * r)), min(math.hypot(p, r), math.hypot(q, s))
    fitted = partial(Fitted, pieces=names, scale=scale, narrow=narrow, gap=fit.gap / fit.ink)
    said = _SAID.copy()
    if math.isfinite(fit.cost[4]):
        said[4] += min(0.5 * (_unlike(fit.corners[4, :4]) / ALIKE) ** 2, IRREGULAR)
    points, rough = _few(parts, [pieces[i].given for i in names]), fit.cost
    if points:
        rough = [c + _too_near(fit.residual[k], count, k, points) for k, c in enumerate(rough)]
    total = [far + lacks + own for far, lacks, own in zip(rough, fit.lacks, said, strict=True)]
    least = min(total[3:])
    for k in range(FEWEST, MOST + 1):
        clean = _NEARLY_SAID[k] - said[k]
        if total[k] + clean < least + ALSO:
            total[k] += min(clean + _irregular(fit, k), 0.0)
    rounded, ellipse = fit, _ellipse(fit)
    if points and ellipse is not None:
        # along something round the ink between two points is no chord, but an arc of it
        ink = [*(arced(few, *ellipse) for few in points), *parts[len(points) :]]
        rounded = fit_closed(ink, LEAST_AXIS * page.size, CAP, count, 2 * CORNER, 0.0, GAP)
        ellipse = _ellipse(rounded)
    steps, even, cornered = _stepping(points, ellipse)
    for k in range(3, MOST + 1):
        total[k] += cornered
    between = max(steps, min(sum(map(len, parts)) - len(parts), MANY))
    many = min(range(FEWEST, MOST_SIDES + 1), key=total.__getitem__)
    evenly, straight = _turning(fit, many, between)
    # what turns beside the corners speaks against few of them, where there are points enough to see it
    off = [straight] * (MOST_SIDES + 1)
    off[3], off[4] = (0.0 if points else _turning(fit, k, between)[1] for k in (3, 4))
    told = total if points else [nats + more for nats, more in zip(total, off, strict=True)]
    sides, second = sorted(range(3, MOST_SIDES + 1), key=told.__getitem__)[:2]
    if sides < FEWEST:
        evenly = 0.0
    out = _round(rounded, ellipse, fitted, gaps + evenly + even)
    if math.isfinite(fit.cost[sides]):
        outline = fit.vertices(sides)
        ahead = second, told[second] - told[sides]
        cost = total[sides] + besides + off[sides]
        model, far = 2 * sides * CORNER, rough[sides]
        out.append(fitted("polygon", cost=cost, outline=outline, model=model, rough=far, next=ahead))
    if math.isfinite(fit.extra):
        square = fit.residual[4]
        far = rough[4] + misfit(square + fit.extra, count) - misfit(square, count)
        cost = far + BOX + fit.lacks[4] + besides + cornered + off[4]
        out.append(fitted("rectangle", cost=cost, outline=fit.rectangle, model=BOX, rough=far))
    bent = _of_any_course(parts, fit, count, gaps, min(f.cost for f in out))
    if bent is not None:
        out.append(fitted("free", cost=bent[0], outline=bent[1], model=FREEFORM + 3 * ARC))
    return out


def _of_any_course(
    parts: list[Array], fit: ClosedFit, count: float, gaps: float, least: float
) -> tuple[float, Array] | None:
    """Nats to say ink as an outline of any course, and that outline; None where it takes more than `least`."""
    if fit.gap > WIDE * fit.ink or FREEFORM + gaps + 3 * ARC > least:
        return None
    arcs = range(3, MOST_SIDES + 1)
    bent = FREEFORM + gaps + min(misfit(fit.residual[k], count) + ARC * k for k in arcs)
    course = course_around(np.concatenate(parts)) if bent < least else None
    return None if course is None else (bent, course)


def _turning(fit: ClosedFit, sides: int, steps: int) -> tuple[float, float]:
    """Nats to say how much of the ink's turning is at a polygon's corners, of something round and of the polygon.

    Beside many corners nothing is left to turn.
    steps: between the points of its line, MANY where there are more: all turning is at these, and as many of them as
        the polygon has corners may be its corners.
    """
    if sides > MOST or not math.isfinite(fit.cost[sides]):
        return 0.0, 0.0
    off = 1 - min(max(float(fit.turning[sides]), 0.0), 1.0)
    off = min(off * (1 - sides / MANY) / (1 - sides / steps), 1 - EVENLY)
    return 0.5 * ((1 - off - EVENLY) / TURNING) ** 2, 0.5 * (off / TURNING) ** 2


def _few(parts: list[Array], given: list[Array | None]) -> list[Array]:
    """The points that ink came with, where they are few, in equal steps, and none of its parts is without; else none.

    parts: of the ink, those of pieces first, then sides that are none of theirs.  given: as of the pieces.
    """
    came = {(x, y) for points in given if points is not None for x, y in points.tolist()}
    own = [part[[(x, y) in came for x, y in part.tolist()]] for part in parts[: len(given)]] if came else []
    steps = sum(map(len, own)) - len(own)
    return own if MOST < steps < MANY and all(len(points) > 1 for points in own) else []


def _too_near(square: float, count: float, sides: int, points: list[Array]) -> float:
    """Nats that a polygon's ink is further off it than it seems, where its points are few: the corners follow them.

    n points in equal steps say 2 n - 1 numbers, of which the corners take two each.
    square: mean squared distance, in the frame.  count: observations.
    """
    said = 2 * sum(map(len, points)) - len(points)
    if not said or not math.isfinite(square):
        return 0.0
    return misfit(square * said / max(said - 2 * sides, 1), count) - misfit(square, count)


def _stepping(points: list[Array], ellipse: tuple[Array, Array] | None) -> tuple[int, float, float]:
    """How many steps the points of ink are apart, as far as there are few, and the nats to say how even they are, of
    something round and of a polygon of few sides.

    Between few points nobody sees how the ink turns; but in equal steps of length along it they are nearer where a
    corner lies between them, and equally far apart along something round.
    """
    if ellipse is None or not points:
        return MANY, 0.0, 0.0
    off = math.log(max(unevenness(points, *ellipse), EVEN_STEPS / 10))
    even, cornered = max(off - math.log(EVEN_STEPS), 0.0), max(math.log(CORNERED) - off, 0.0)
    steps = sum(map(len, points)) - len(points)
    return steps, 0.5 * (even / STEPPING) ** 2, min(0.5 * (cornered / STEPPING) ** 2, CHANCE)


def _irregular(fit: ClosedFit, k: int) -> float:
    """Nats to say how far a polygon's corners are off those of an affine image of a regular one.

    Such an image is a + b w^j + c w^-j, with w the k-th root of one: what the corners' other discrete Fourier
    coefficients hold is how far they are off it.
    """
    (p, q), (r, s) = fit.back.tolist()
    det, mean = p * s - q * r, complex(*fit.mean.tolist())
    corners = []
    for x, y in fit.corners[k, :k].tolist():
        x, y = x - mean.real, y - mean.imag
        corners.append(complex(s * x - q * y, p * y - r * x) / det)
    roots = _ROOTS[k]
    found = [sum(z * roots[j * f % k] for j, z in enumerate(corners)) for f in range(2, k - 1)]
    off2 = math.fsum(abs(z) ** 2 for z in found) / k
    return 0.5 * off2 / REGULAR**2


def _unlike(corners: Array) -> float:
    """The least angle between opposite sides of a quadrilateral [rad]."""
    a, b, c, d = (complex(x, y) for x, y in corners.tolist())
    return min(
        abs(cmath.phase((b - a) * (c - d).conjugate())), abs(cmath.phase((c - b) * (d - a).conjugate()))
    )


def gone_over(page: Page, fitted: Fitted, pieces: Sequence[Piece]) -> list[float]:
    """Nats to say each of some further pieces of ink, given that it runs along a closed outline that is there already.

    Sides are drawn twice, in pieces that overlap, or gone over once more.
    """
    off = off_outline(page.strokes, [p.stroke for p in pieces], fitted.outline)
    return [
        PARAMETER
        + RETRACE * p.observations
        + misfit(square / min(fitted.scale, max(p.scale, 1e-9)) ** 2, p.observations)
        for p, square in zip(pieces, off, strict=True)
    ]


def _ellipse(fit: ClosedFit) -> tuple[Array, Array] | None:
    """The middle of the ellipse [pixels], and half axes of it as columns, (2, 2); None where the conic is none."""
    a, b, c, d, e = fit.conic.tolist()
    if a * a + b * b > 0.5:  # in this frame whatever is round is nearly a circle
        return None
    # about its centre (u, v) the conic is zᵀ M z = level, M = [[1 - a, -b], [-b, 1 + a]]
    det = 1 - a * a - b * b
    u, v = (c * (1 + a) + d * b) / (2 * det), (c * b + d * (1 - a)) / (2 * det)
    level = e + (c * u + d * v) / 2
    if not 0.2 < level < 5:
        return None
    # half axes: z = sqrt(level) M^-1/2 (unit vector), then to pixels; as a matrix with those columns
    (p, q), (o, s) = fit.back.tolist()
    root = math.sqrt(det)
    f = math.sqrt(level / (det * (2 + 2 * root)))
    m00, m01, m11 = (
        f * (1 + a + root),
        f * b,
        f * (1 - a + root),
    )  # square root of M's inverse (Cayley-Hamilton)
    axes = np.array([[p * m00 + q * m01, p * m01 + q * m11], [o * m00 + s * m01, o * m01 + s * m11]])
    return fit.mean + fit.back @ np.array([u, v]), axes


def _round(
    fit: ClosedFit, ellipse: tuple[Array, Array] | None, fitted: Callable[..., Fitted], gaps: float
) -> list[Fitted]:
    """The circle and the ellipse; one hardly longer than wide is a circle too.

    fitted: makes a reading of what all readings of the outline have in common.
    """
    x, y, r = fit.circle
    at, price = np.array([x, y]), fit.circle_cost + ROUND + gaps
    if ellipse is None:
        return [fitted("circle", cost=price, outline=at + r * _RING, model=ROUND)]
    middle, axes = ellipse
    (k, ll), (m, n) = axes.tolist()
    total, area = k * k + ll * ll + m * m + n * n, abs(k * n - ll * m)
    longer = math.acosh(max(total / (2 * area), 1.0))  # log of the half axes' ratio
    cost = fit.ellipse_cost + ROUND + gaps
    if cost + 0.5 * (longer / UNROUND) ** 2 < price:
        at, r, price = middle, math.sqrt(area), cost + 0.5 * (longer / UNROUND) ** 2
    return [
        fitted("circle", cost=price, outline=at + r * _RING, model=ROUND),
        fitted("ellipse", cost=cost + ELLIPSE, outline=middle + _RING @ axes.T, model=ROUND + ELLIPSE),
    ]
