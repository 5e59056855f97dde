"""The vocabulary: each primitive fitted to a group of ink, with its cost in nats.

Everything is scored on one scale, the length of a description (Rissanen 1978): what it takes to say the primitive's
parameters, plus what it then takes to say where the ink is, given the primitive.  See scoring in `sketch.recognize`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sketch.kernel import ClosedFit, fit_closed
from sketch.pieces import Piece

__all__ = ["Fitted", "arrow", "bar", "closed", "cross", "unread"]

Array = NDArray[np.float64]

TREMOR = 0.05  # spread of ink about what was meant, as a share of the radius
SLOPPY = 0.1  # nobody's ink is off by much more than this, as a share of the radius
PARAMETER = 4.0  # nats to say one parameter to that precision: ln(page / tremor)
ROUND = 36.0  # nats that a round outline is less usual than one of no corners and no sides would be
UNROUND = 0.085  # usual log of a drawn circle's length over its width
ELLIPSE = 11.0  # nats that an ellipse is said in beyond a circle: two parameters, and that it is rarer
RETRACE = 1.0  # nats an observation of ink that was drawn already, as in core/outline.c
FREE = 4.0  # nats an observation to say ink freely, point by point
STRANGE = 8.0  # nats to say that something was drawn that has no meaning here
BEND = 8.0  # nats for each corner of a bar, and for each that folds it back
RARE = 12.0  # nats that an open line is rarer than an outline
GAP = 4.0  # nats for each observation that an outline lacks
CAP = 0.3  # distances count up to this share of the radius: hooks and flourishes


@dataclass(frozen=True, eq=False)
class Fitted:
    """A primitive fitted to some ink.

    Attributes:
        kind: "circle", "ellipse", "rectangle", "polygon", "cross", "arrow", "bar" or "unread".
        pieces: indices of the pieces that it explains.
        cost: description length [nats].
        outline: [pixels], as in `sketch.recognize.Reading`.
        sides: of a polygon, else 0.
        residual: root mean square distance of the ink [share of the radius].
        scale: of a closed outline: the geometric mean of its half axes [pixels].
    """

    kind: str
    pieces: tuple[int, ...]
    cost: float
    outline: Array
    sides: int = 0
    residual: float = 0.0
    scale: float = 0.0


def unread(piece: Piece) -> float:
    """Cost of ink that means nothing: said point by point."""
    return STRANGE + FREE * piece.observations


def _misfit(mean_square: float, count: float) -> float:
    """Nats to say `count` observations' distances from a primitive, as `misfit` in core/outline.c."""
    return 0.5 * count * (math.log1p(mean_square / TREMOR**2) + mean_square / SLOPPY**2)


def _misfit_of(piece: Piece, mean_square: float, scale: float | None = None) -> float:
    """Nats to say where a piece's ink is, given lines that it is off by `mean_square` [pixels²].

    The writer's precision goes with the size of what is drawn, not with the group's: a small loop is no careless
    line of something large.
    """
    off = mean_square / max(scale or piece.scale, 1e-9) ** 2
    return 0.5 * piece.observations * (math.log1p(off / TREMOR**2) + off / SLOPPY**2)


# ---------------------------------------------------------------- closed outlines


def closed(pieces: list[Piece], order: list[tuple[int, bool]], least_axis: float) -> list[Fitted]:
    """Readings of pieces that, one after another (index, reversed), go once around: round or with corners."""
    names = tuple(sorted({i for i, _ in order}))
    count = sum(pieces[i].observations for i in names)
    parts = [pieces[i].points[::-1] if back else pieces[i].points for i, back in order]
    fit = fit_closed(parts, least_axis, CAP, count)
    gaps = GAP * count * fit.gap / fit.ink
    out = _round(fit, names, gaps)
    for k in range(3, 13):
        cost = fit.cost[k] + gaps
        vertices = fit.vertices(k)
        out.append(
            Fitted("polygon", names, cost + 2 * k * PARAMETER, vertices, k, math.sqrt(fit.residual[k]))
        )
        if k == 4:
            box, extra = _rectangle(fit, vertices)
            residual = fit.residual[4] + extra
            cost = fit.cost[4] + _misfit(residual, count) - _misfit(fit.residual[4], count) + gaps + 5 * PARAMETER
            out.append(Fitted("rectangle", names, cost, box, 4, math.sqrt(residual)))
    scale = math.sqrt(abs(float(np.linalg.det(fit.back))))
    return [replace(f, scale=scale) for f in out]


def absorb(fitted: Fitted, pieces: list[Piece], index: int) -> float:
    """Nats to say a further piece of ink, given that it runs along a closed outline that is there already.

    Sides are drawn twice, in pieces that overlap, or gone over once more.
    """
    piece = pieces[index]
    reach = 0.3 * fitted.scale
    lo, hi = fitted.outline.min(axis=0) - reach, fitted.outline.max(axis=0) + reach
    box = piece.box
    if box[0] < lo[0] or box[1] < lo[1] or box[2] > hi[0] or box[3] > hi[1]:
        return math.inf
    ends = np.roll(fitted.outline, -1, axis=0)
    off = np.minimum.reduce(
        [_from_segment(piece.fit.samples, a, b) for a, b in zip(fitted.outline, ends, strict=True)]
    )
    mean_square = float((off * off).mean()) / min(fitted.scale, max(piece.scale, 1e-9)) ** 2
    return PARAMETER + RETRACE * piece.observations + _misfit(mean_square, piece.observations)


def _round(fit: ClosedFit, names: tuple[int, ...], gaps: float) -> list[Fitted]:
    """The circle, and the ellipse: which is a circle too where it is hardly longer than wide, as nobody's are round."""
    angles = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    x, y, r = fit.circle
    out = [Fitted("circle", names, fit.circle_cost + ROUND + gaps, np.array([x, y]) + r * ring)]
    a, b, c, d, e = fit.conic.tolist()
    if a * a + b * b > 0.5:  # in this frame whatever is round is nearly a circle
        return out
    m = np.array([[1 - a, -b], [-b, 1 + a]])
    centre = np.linalg.solve(m, np.array([c, d]) / 2)
    level = e + float(centre @ m @ centre)
    if not 0.2 < level < 5:
        return out
    to = np.linalg.inv(fit.back)
    values, axes = np.linalg.eigh(to.T @ m @ to / level)  # (p - middle)ᵀ shape (p - middle) = 1, in pixels
    radii = 1 / np.sqrt(values)
    middle = fit.mean + fit.back @ centre
    longer = math.log(radii[0] / radii[1])
    cost = fit.ellipse_cost + ROUND + gaps
    circle = Fitted(
        "circle", names, cost + 0.5 * (longer / UNROUND) ** 2, middle + math.sqrt(radii[0] * radii[1]) * ring
    )
    ellipse = Fitted("ellipse", names, cost + ELLIPSE, middle + (ring * radii) @ axes.T, len(ring))
    return [min(out[0], circle, key=lambda f: f.cost), ellipse]


def _rectangle(fit: ClosedFit, corners: Array) -> tuple[Array, float]:
    """The rectangle nearest to a quadrilateral, and the mean squared distance that it adds, in the frame."""
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    angles = np.arctan2(sides[:, 1], sides[:, 0])
    turn = (
        math.atan2(float((lengths * np.sin(4 * angles)).sum()), float((lengths * np.cos(4 * angles)).sum()))
        / 4
    )
    u = np.array([math.cos(turn), math.sin(turn)])
    v = np.array([-u[1], u[0]])
    mids = corners + sides / 2
    along = np.abs(sides @ u) > np.abs(sides @ v)  # sides that run along u
    if along.sum() != 2 or along[0] == along[1]:
        return corners, 1.0
    across, up = (mids @ u)[~along], (mids @ v)[along]
    box = np.array([[across[k], up[j]] for k, j in ((0, 0), (1, 0), (1, 1), (0, 1))]) @ np.stack([u, v])
    # in the order of the corners that it replaces
    order = [int(np.argmin(np.hypot(*(box - c).T))) for c in corners]
    if sorted(order) != [0, 1, 2, 3]:
        return corners, 1.0
    box = box[order]
    to = np.linalg.inv(fit.back)
    off = (corners - box) @ to.T
    z = (box - fit.mean) @ to.T
    edge = np.roll(z, -1, axis=0) - z
    normal = (
        np.stack([-edge[:, 1], edge[:, 0]], axis=1)
        / np.maximum(np.hypot(edge[:, 0], edge[:, 1]), 1e-9)[:, None]
    )
    p = (off * normal).sum(axis=1)
    q = (np.roll(off, -1, axis=0) * normal).sum(axis=1)
    return box, float(((p * p + p * q + q * q) / 3).mean())


# ---------------------------------------------------------------- open lines


def bar(index: int, piece: Piece) -> Fitted | None:
    """An open line or polyline: a thin bar."""
    if piece.gap < 0.3 * piece.length:
        return None
    best = None
    for k in range(1, 6):
        v = piece.fit.vertices(k)
        u = np.diff(v, axis=0)
        turns = np.abs(np.angle((u[1:, 0] + 1j * u[1:, 1]) * (u[:-1, 0] - 1j * u[:-1, 1])))
        folds = int(np.count_nonzero(turns > 2.0))  # a bar seldom runs back along itself
        cost = (
            _misfit_of(piece, piece.fit.residual[k]) + RARE + 2 * (k + 1) * PARAMETER + BEND * (k - 1 + folds)
        )
        if best is None or cost < best.cost:
            residual = math.sqrt(piece.fit.residual[k]) / max(piece.scale, 1e-9)
            best = Fitted("bar", (index,), cost, v, k, residual)
    return best


def cross(pieces: list[Piece], names: tuple[int, ...]) -> Fitted | None:
    """An X: two bars that cross near their middles; in one stroke, further ink joins them."""
    if len(names) == 2:
        p, q = (pieces[i] for i in names)
        a, b = p.fit.vertices(1)
        c, d = q.fit.vertices(1)
        misfit = _misfit_of(p, p.fit.residual[1]) + _misfit_of(q, q.fit.residual[1])
        return _cross_of(a, b, c, d, names, misfit)
    piece = pieces[names[0]]
    best = None
    for k in (3, 4, 5):
        v = piece.fit.vertices(k)
        lengths = np.hypot(*np.diff(v, axis=0).T)
        misfit = _misfit_of(piece, piece.fit.residual[k])
        for i, j in ((i, j) for i in range(k) for j in range(i + 2, k)):
            joining = float(lengths.sum() - lengths[i] - lengths[j]) / piece.length
            extra = PARAMETER + _misfit_free(piece) * max(
                joining - 0.35, 0.0
            )  # a third is what one side takes
            found = _cross_of(v[i], v[i + 1], v[j], v[j + 1], names, misfit + extra)
            if found is not None and (best is None or found.cost < best.cost):
                best = found
    return best


def _misfit_free(piece: Piece) -> float:
    return unread(piece) - STRANGE


def _cross_of(a: Array, b: Array, c: Array, d: Array, names: tuple[int, ...], misfit: float) -> Fitted | None:
    where = _crossing(a, b, c, d)
    if where is None:
        return None
    t, s = where
    if not (0.1 < t < 0.9 and 0.1 < s < 0.9):
        return None
    p, q = float(np.hypot(*(b - a))), float(np.hypot(*(d - c)))
    sine = abs((b - a)[0] * (d - c)[1] - (b - a)[1] * (d - c)[0]) / max(p * q, 1e-9)
    if sine < 0.3 or max(p, q) > 3 * min(p, q):
        return None
    off_centre = ((t - 0.5) ** 2 + (s - 0.5) ** 2) / (2 * 0.12**2) + 0.5 * (math.log(p / q) / 0.3) ** 2
    cost = 6 * PARAMETER + misfit + off_centre
    return Fitted("cross", names, cost, np.array([a, b, c, d]))


def _crossing(a: Array, b: Array, c: Array, d: Array) -> tuple[float, float] | None:
    u, v, w = b - a, d - c, c - a
    det = float(u[0] * v[1] - u[1] * v[0])
    if abs(det) < 1e-9:
        return None
    return float(w[0] * v[1] - w[1] * v[0]) / det, float(w[0] * u[1] - w[1] * u[0]) / det


def arrow(pieces: list[Piece], names: tuple[int, ...], tail: Array, toward: Array) -> Fitted | None:
    """A shaft from `tail` toward the tip, and a head of two barbs; fitted to all the ink of the pieces."""
    axis = toward - tail
    long = float(np.hypot(*axis))
    if long <= 0:
        return None
    u = axis / long
    v = np.array([-u[1], u[0]])
    q = np.concatenate([pieces[i].fit.samples for i in names]) - tail
    s, h = q @ u, q @ v
    reach = float(s.max())
    if reach <= 0:
        return None
    left, right = int(np.argmax(h)), int(np.argmin(h))
    tip = np.array([reach, float(np.median(h[s > 0.96 * reach]))])
    z = np.stack([s, h], axis=1)
    barbs = [tip - z[left], tip - z[right]]
    lengths = [float(np.hypot(*b)) for b in barbs]
    angles = [math.atan2(-b[1] * side, b[0]) for b, side in zip(barbs, (1, -1), strict=True)]
    if min(angles) < 0.15 or max(angles) > 1.4 or min(lengths) < 0.1 * reach:
        return None
    distance = np.minimum.reduce(
        [_from_segment(z, np.zeros(2), tip), _from_segment(z, tip, z[left]), _from_segment(z, tip, z[right])]
    )
    radius = reach / 2
    each = (distance**2).reshape(len(names), -1).mean(axis=1).tolist()
    whole = pieces[names[0]].extent / 2 if len(names) == 1 else None  # its ends may meet, yet it is no loop
    misfit = sum(_misfit_of(pieces[i], square, whole) for i, square in zip(names, each, strict=True))
    mean_square = sum(each) / len(each) / radius**2
    drawn = sum(pieces[i].length for i in names)
    twice = max(1 - (reach + sum(lengths)) / drawn, 0.0)  # the share of the ink that was drawn twice
    # a head: two barbs alike, at some 35 degrees, less than half as long as the shaft
    likeness = (math.log(lengths[0] / lengths[1]) / 0.35) ** 2
    size = (math.log(sum(lengths) / 2 / reach / 0.45) / 0.4) ** 2
    spread = sum(((a - 0.6) / 0.25) ** 2 for a in angles)
    cost = 6 * PARAMETER + misfit + FREE * twice * sum(pieces[i].observations for i in names) + 0.5 * (likeness + size + spread)
    head = tail + u * tip[0] + v * tip[1]
    return Fitted("arrow", names, cost, np.array([tail, head]), 0, math.sqrt(mean_square))


def _from_segment(z: Array, a: Array, b: Array) -> Array:
    d = b - a
    t = np.clip((z - a) @ d / max(float(d @ d), 1e-12), 0, 1)
    return np.asarray(np.hypot(*(z - a - t[:, None] * d).T))
