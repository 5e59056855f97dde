"""Strokes of very many points, and of very few: what their points say of the course of the ink."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sketch.typing import Array

__all__ = ["FEW", "Sampled", "arced", "sampled", "unevenness"]

ENOUGH = 4000  # points of a stroke: more say nothing further about its course
FEW = 24  # points of a stroke: in more a corner that lies between two of them is hardly cut
LEAST = 8  # points of a stroke: fewer are the corners of something drawn point by point, not samples of its course
# of the longest chord: one that is longer is straight; the second share where the first leaves few
FULL = 0.95, 0.9
STEPS = 3  # full chords, at least, and a third of all: else the points are not in equal steps
HAIRPIN = 1.2  # within so much of turning back [rad], a corner may be two: the end of something narrow
OFF = 0.05  # of a step: how far ink usually is off its side's line
LONGER = 0.1  # of a step: how much longer a way usually is than straight
CORNER = 8.0  # nats to say one more corner
# nats that one corner takes at most where its sides are parallel: such an end is likelier blunt
POINTED = -1.0
ALIKE = 0.1  # [rad]: how far the sides of a blunt end usually are from parallel
HALVINGS = 20  # halvings until a corner's cut is found
NEWTON = 8  # Newton's steps until a corner's place is found
SHORT = 0.72, 0.9  # of a step: a chord of such a length has a corner, and not two
LEG = 0.15  # of a step: what is shorter does not say where the ink comes from
ASTRAY = 0.5  # of a step: what is off by more is no part of the course
ARC = 6  # parts of the way between two points, along something round
LOOP = 4.0  # [rad]: what turns by more altogether goes around something, and has its corners outward
TURN = 0.35  # [rad]: what turns by less is no corner
SPIKE = 2.7  # [rad]: what turns by more is no corner that one side alone can tell


class Sampled(NamedTuple):
    """A stroke's points, (n, 2) [pixels]: of very many some, and very few with the corners that they cut.

    given: of few in equal steps of length along the ink those that it came with, else None.
    """

    points: Array
    given: Array | None = None


def sampled(points: Array) -> Sampled:
    """A stroke, given its points, (n, 2) [pixels]."""
    if len(points) > 2 * ENOUGH:
        return Sampled(_thinned(points))
    return _sharpened(points) if LEAST <= len(points) <= FEW else Sampled(points)


def unevenness(parts: list[Array], middle: Array, axes: Array) -> float:
    """How far the steps along an ellipse, between points that are in equal steps of length along the ink, are from
    equal ones: root mean square, as a share of a step.

    parts: the points of each stroke, (n, 2).  middle, axes: of the ellipse, half axes as columns, (2, 2) [pixels].
    """
    (p, q), (r, s) = axes.tolist()
    det, (u, v) = p * s - q * r, middle.tolist()
    squares, count = 0.0, 0
    for points in parts:
        at = [complex(s * (x - u) - q * (y - v), p * (y - v) - r * (x - u)) / det for x, y in points.tolist()]
        steps = []
        for a, b in pairwise(at):  # Simpson's rule for the length of the arc
            begin, by = cmath.phase(a), cmath.phase(b * a.conjugate())
            ways = [cmath.rect(1.0, begin + share * by) for share in (0.0, 0.5, 1.0)]
            speeds = [math.hypot(q * w.real - p * w.imag, s * w.real - r * w.imag) for w in ways]
            steps.append(abs(by) * (speeds[0] + 4 * speeds[1] + speeds[2]) / 6)
        ordered, half = sorted(steps), len(steps) // 2
        usual = max((ordered[half] + ordered[~half]) / 2, 1e-9)
        squares += sum(min(abs(step / usual - 1), ASTRAY) ** 2 for step in steps)
        count += len(steps)
    return math.sqrt(squares / count)


def arced(points: Array, middle: Array, axes: Array) -> Array:
    """Few points, (n, 2), with the ink between them if it goes along an ellipse; off which it is as far as they are.

    middle, axes: of the ellipse, half axes as columns, (2, 2) [pixels].
    """
    x, y = np.linalg.solve(axes, (points - middle).T)
    off, angle = np.hypot(x, y), np.unwrap(np.arctan2(y, x))
    share = np.arange(0, len(points) - 1 + 0.5 / ARC, 1 / ARC)
    off, angle = (np.interp(share, np.arange(len(points)), v) for v in (off, angle))
    return np.asarray(middle + (off * np.stack([np.cos(angle), np.sin(angle)])).T @ axes.T)


def _thinned(points: Array) -> Array:
    """Of very many points those at least a share of their stroke's length apart."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    step = np.floor(along * (ENOUGH / max(along[-1], 1e-9)))
    kept = np.flatnonzero(np.diff(step, prepend=-1.0))
    return np.asarray(points[np.append(kept, len(points) - 1)])


def _sharpened(points: Array) -> Sampled:
    """Few points in equal steps of length along the ink, with the corners that lie between two of them.

    The step s says how long the ink between two points is; where these are nearer, at a distance d, it turns.
    At one corner, if it comes straight from the point before: with the chord's angle f to that way, the corner is
    t = (s² - d²) / (2 (s - d cos f)) on, as the two legs make s together (law of cosines). The same holds
    backwards from the point behind. Where both are known, the corner is the likeliest place given either's line and
    the step; rounded, where the two lines meet further than a step on.
    """
    at = [complex(x, y) for x, y in points.tolist()]
    chords = [b - a for a, b in pairwise(at)]
    lengths = [abs(c) for c in chords]
    step = max(lengths)
    for share in FULL:
        full = [d > share * step for d in lengths]
        if sum(full) >= max(STEPS, len(chords) / 3):
            break
    else:
        return Sampled(points)
    if min(lengths) <= 0:
        return Sampled(points)
    step = sum(d for d, whole in zip(lengths, full, strict=True) if whole) / sum(full)
    before, behind = _legs(at, chords, full)
    around = sum(_turn(*three) for three in zip(at, at[1:], at[2:], strict=False))
    inward = -math.copysign(1.0, around) if abs(around) > LOOP else 0.0
    corners: dict[int, tuple[complex, ...]] = {}
    for sides in (2, 2, 1, 1):  # first where both say the same
        for k in range(len(chords)):
            if full[k] or k in corners:
                continue
            a, b = at[k], at[k + 1]
            found = _corners(before[k], a, b, behind[k + 1], step, sides)
            if found and not (len(found) == 1 and TURN < _turn(a, found[0], b) * inward < SPIKE):
                corners[k] = found
                before[k + 1] = found[-1] if abs(b - found[-1]) > LEG * step else None
                behind[k] = found[0] if abs(found[0] - a) > LEG * step else None
    for k, d in enumerate(
        lengths
    ):  # where neither says whence: halfway, to the side that the ink goes around
        if (
            0 < k < len(chords) - 1
            and before[k] is None
            and behind[k + 1] is None
            and k not in corners
            and SHORT[0] * step < d < SHORT[1] * step
        ):
            turns = [(chords[j].conjugate() * chords[j + 1]).imag for j in (k - 1, k)]
            if turns[0] * turns[1] > 0:
                off = math.sqrt(step * step - d * d) / 2
                side = -1j if turns[0] > 0 else 1j
                corners[k] = ((at[k] + at[k + 1]) / 2 + off * side * chords[k] / d,)
    out = []
    for k, z in enumerate(at):
        out.append(z)
        out += corners.get(k, ())
    return Sampled(np.array([[z.real, z.imag] for z in out]), points)


def _legs(
    at: list[complex], chords: list[complex], full: list[bool]
) -> tuple[list[complex | None], list[complex | None]]:
    """Where the ink comes from and goes on to at each point, as far as that is known: the other end of a straight leg.

    A leg is none if it turns at its other end where no corner was cut: round ink does.
    """
    legs = len(chords)
    bends = [
        full[k] and full[k + 1] and abs(_turn(at[k], at[k + 1], at[k + 2])) > TURN for k in range(legs - 1)
    ]
    before = [
        at[k - 1] if k and full[k - 1] and not (k > 1 and bends[k - 2]) else None for k in range(legs + 1)
    ]
    behind = [at[k + 1] if full[k] and not (k < legs - 1 and bends[k]) else None for k in range(legs)]
    return before, [*behind, None]


def _turn(a: complex, b: complex, c: complex) -> float:
    """By how much the way from a to b turns there to c [rad]."""
    return cmath.phase((c - b) * (b - a).conjugate())


def _corners(
    before: complex | None, a: complex, b: complex, behind: complex | None, step: float, sides: int
) -> tuple[complex, ...]:
    """The corners between two points, a way of `step` apart, as reckoned from so many sides; mostly none.

    before, behind: where the ink comes from to the first, and goes on to from the second, if that is known.
    """
    found = [c for c in (_corner(before, a, b, step), _corner(behind, b, a, step)) if c is not None]
    if len(found) < sides:
        return ()
    if before is not None and behind is not None:
        corner, said = min((_likeliest(before, a, b, behind, step, c) for c in found), key=lambda t: t[1])
        come, go = (a - before) / abs(a - before), (behind - b) / abs(behind - b)
        turn = cmath.phase(go * come.conjugate())
        alike = math.pi - abs(turn)
        if alike > HAIRPIN:
            return _rounded(a, b, come, go, step, corner) if abs(turn) > TURN and said < CORNER else ()
        if said < min(POINTED + 0.5 * (alike / ALIKE) ** 2, CORNER):
            return (corner,)
        # two corners, the end of something narrow: straight across, where both ways and it make a step
        out = (come - go) / abs(come - go)
        chord = (b - a) * out.conjugate()
        rest = (step - abs(chord.imag) - chord.real) / 2
        return (a + (rest + chord.real) * out, b + rest * out) if 0 <= rest <= step else ()
    corner = found[0]
    turn = abs(_turn(a, corner, b))
    sure = turn < SPIKE or min(abs(corner - a), abs(corner - b)) < LEG * step
    return (corner,) if turn > TURN and sure else ()


def _rounded(
    a: complex, b: complex, come: complex, go: complex, step: float, corner: complex
) -> tuple[complex, ...]:
    """A corner from a to b, cut as much as makes it a step long; where it needs no cut, `corner`."""
    sine = (come.conjugate() * go).imag
    on, back = ((b - a).conjugate() * go).imag / sine, (come.conjugate() * (b - a)).imag / sine
    if on < 0 or back < 0 or on + back <= step:
        return (corner,)
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        share = (low + high) / 2
        first, second = a + share * on * come, b - share * back * go
        if share * (on + back) + abs(second - first) < step:
            low = share
        else:
            high = share
    return first, second


def _likeliest(
    before: complex, a: complex, b: complex, behind: complex, step: float, corner: complex
) -> tuple[complex, float]:
    """The likeliest corner between two points, a way of `step` apart, and the nats to say that the ink is so.

    It lies near where the ink goes on to from either side, and the ways to it make a step (Gauss-Newton, begun
    at `corner`).
    """
    # of both lines: where they begin, which way they go, and how far apart the points are that tell it
    lines = [
        (near, (near - far) / abs(near - far), abs(near - far)) for far, near in ((before, a), (behind, b))
    ]
    along, across = OFF * step, LONGER * step
    said = 0.0
    for _ in range(NEWTON):
        off: list[tuple[float, complex]] = []  # in spreads, and the way in which it grows, by pixels
        for near, way, apart in lines:
            on = (corner - near) * way.conjugate()
            ahead = max(on.real, 0.0) / apart
            spread = along * math.hypot(1 + ahead, ahead)  # of a line through two points, so far beyond
            off.append((on.imag / spread, 1j * way / spread))
            if on.real < 0:  # not back on the way that the ink has come
                off.append((on.real / along, way / along))
        first, second = corner - a, corner - b
        one, other = max(abs(first), 1e-9), max(abs(second), 1e-9)
        off.append(((one + other - step) / across, (first / one + second / other) / across))
        squares = xx = xy = yy = 0.0
        down = 0j
        for o, n in off:  # in one loop: this is what strokes of few points take
            squares += o * o
            down += o * n
            xx, xy, yy = xx + n.real * n.real, xy + n.real * n.imag, yy + n.imag * n.imag
        said = squares / 2
        det = xx * yy - xy * xy
        if det < 1e-12 * (xx + yy) ** 2:
            break
        corner -= complex(yy * down.real - xy * down.imag, xx * down.imag - xy * down.real) / det
    return corner, said


def _corner(before: complex | None, a: complex, b: complex, step: float) -> complex | None:
    """The corner between two points, a way of `step` apart, where the ink comes straight from `before` to the first."""
    if before is None or before == a:
        return None
    way = (a - before) / abs(a - before)
    chord = b - a
    d, along = abs(chord), (chord * way.conjugate()).real
    return None if step <= along else a + way * (step * step - d * d) / (2 * (step - along))
