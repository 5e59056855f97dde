"""Reference cases of sliding, slipping and rolling that turn into each other, and of blows with friction.

A disk of radius r on a line: s along it, turning by -s / r as it rolls.  Where its lowest point slips at u = s' + r w,
friction f = -sign(u) mu n per unit mass gives s'' = f + g_s and r w' = 2 f, so that u' = 3 f + g_s, until u is 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.bench.parts import (
    Array,
    Case,
    G,
    along,
    flights,
    make_box,
    make_disk,
    make_ground,
    make_scene,
    poses,
)
from sim.bench.phases import Phases
from sim.scene import Body, Joint, Polygon

__all__ = ["SLIPPING"]

Stretch = tuple[float, float, float]  # how long [s], and the accelerations of s and of r times the angle


def _stretches(parts: Sequence[Stretch], start: tuple[float, float], t: Array) -> tuple[Array, Array]:
    """s and r times the angle at times t, through stretches of constant accelerations; start: their rates."""
    s, turn = np.zeros_like(t), np.zeros_like(t)
    (v, w), (at, turned), begin = start, (0.0, 0.0), 0.0
    for length, a, b in parts:
        here = (t >= begin) & (t <= begin + length)
        x = t[here] - begin
        s[here], turn[here] = at + v * x + a / 2 * x * x, turned + w * x + b / 2 * x * x
        if not math.isfinite(length):
            break
        at, turned = at + v * length + a / 2 * length**2, turned + w * length + b / 2 * length**2
        v, w, begin = v + a * length, w + b * length, begin + length
    return s, turn


# ---------------------------------------------------------------- disks on a line


def _disk_on_a_line(
    name: str, about: str, slope: float, mu: float, start: tuple[float, float], parts: Sequence[Stretch]
) -> Case:
    r = 0.2

    def truth(t: Array) -> Array:
        s, turn = _stretches(parts, start, t)
        return poses((*along(slope, s, r), turn / r), times=t)

    x, y = (float(c) for c in along(slope, np.array(0.0), r))
    velocity = (start[0] * math.cos(slope), -start[0] * math.sin(slope))
    disk = make_disk("a", r, (x, y), velocity=velocity, angular_velocity=start[1] / r, friction=mu)
    return Case(name, about, make_scene([make_ground(slope, friction=mu), disk]), 2.0, truth)


def _comes_back() -> Case:
    mu, v, back = 0.3, 1.5, 6.0
    f = mu * G
    parts = [((v + back) / (3 * f), -f, -2 * f), (math.inf, 0.0, 0.0)]
    return _disk_on_a_line(
        "comes back", "a disk thrown with backspin slips, and rolls back", 0.0, mu, (v, back), parts
    )


def _up_a_slope(mu: float) -> Case:
    """Thrown up without spin: friction pulls it down until it does not slip; then it rolls, if mu >= tan / 3."""
    slope, v = 0.5, 4.0
    pull, f = G * math.sin(slope), mu * G * math.cos(slope)
    sticks = mu > math.tan(slope) / 3
    then = (math.inf, 2 / 3 * pull, -2 / 3 * pull) if sticks else (math.inf, pull - f, -2 * f)
    parts = [(v / (pull + 3 * f), pull + f, 2 * f), then]
    name = "rolls up a slope" if sticks else "slips up and down a slope"
    return _disk_on_a_line(name, "a disk thrown up without spin", slope, mu, (-v, 0.0), parts)


def _bounces_then_rolls() -> Case:
    """Bounces die out while each rubs at the spin; what slip is left goes as the disk slides on, then it rolls."""
    r, mu, e, drop, v, spin = 0.2, 0.15, 0.5, 0.3, 3.0, 0.0

    def truth(t: Array) -> Array:
        x, angle, height = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        now, at, turned, vx, w = 0.0, 0.0, 0.0, v, spin
        for here, d, h, length, down in flights(t, drop, e):
            x[here], angle[here], height[here] = at + vx * d, turned + w * d, h
            now, at, turned = now + length, at + vx * length, turned + w * length
            slip = vx + w * r
            push = -math.copysign(min(mu * (1 + e) * down, abs(slip) / 3), slip)
            vx, w = vx + push, w + 2 * push / r
        slip = vx + w * r
        f = -math.copysign(mu * G, slip)
        length = abs(slip) / (3 * mu * G)
        later = t >= now
        s, turn = _stretches([(length, f, 2 * f), (math.inf, 0, 0)], (vx, w * r), t[later] - now)
        x[later], angle[later] = at + s, turned + turn / r
        return poses((x, r + height, angle), times=t)

    ball = make_disk(
        "a", r, (0.0, r + drop), velocity=(v, 0.0), angular_velocity=spin, friction=mu, elasticity=e
    )
    scene = make_scene([make_ground(friction=mu), ball])
    return Case(
        "bounces, slips, rolls", "infinitely many bounces with friction, then the floor", scene, 2.5, truth
    )


# ---------------------------------------------------------------- blocks


def _block_up_a_slope(mu: float) -> Case:
    slope, v = 0.4, 3.0
    pull, f = G * math.sin(slope), mu * G * math.cos(slope)
    stays = mu > math.tan(slope)
    parts = [(v / (pull + f), pull + f, 0.0), (math.inf, 0.0 if stays else pull - f, 0.0)]

    def truth(t: Array) -> Array:
        s, _ = _stretches(parts, (-v, 0.0), t)
        return poses((*along(slope, s, 0.2), -slope), times=t)

    x, y = (float(c) for c in along(slope, np.array(0.0), 0.2))
    velocity = (-v * math.cos(slope), v * math.sin(slope))
    block = make_box("a", (0.8, 0.4), (x, y), angle=-slope, velocity=velocity, friction=mu)
    name = "stays up a slope" if stays else "slides up and back"
    scene = make_scene([make_ground(slope, friction=mu), block])
    return Case(name, f"a block thrown up a slope with friction {mu}", scene, 2.0, truth)


def _block_on_a_plank() -> Case:
    """Friction takes from the one what it gives to the other, until both go alike: u / (mu g (1 + m / M))."""
    mu, v, m, mass = 0.3, 3.0, 1.0, 2.5
    end = v / (mu * G * (1 + m / mass))

    def truth(t: Array) -> Array:
        rubs, goes_on = np.minimum(t, end), np.maximum(t - end, 0)
        both = v * m / (m + mass)
        x = -1.2 + v * rubs - mu * G / 2 * rubs**2 + both * goes_on
        return poses((mu * G * m / mass / 2 * rubs**2 + both * goes_on, 0.1, 0.0), (x, 0.35, 0.0), times=t)

    plank = make_box("a", (4.0, 0.2), (0.0, 0.1), mass=mass, friction=mu)
    block = make_box("b", (0.5, 0.3), (-1.2, 0.35), mass=m, velocity=(v, 0.0), friction=mu)
    scene = make_scene([make_ground(), plank, block])
    return Case("block on a plank", "that slides without friction: both end alike", scene, 1.5, truth)


def _block_on_a_wedge() -> Case:
    """No friction: the wedge gives way by m g sin cos / (M + m sin^2), the block goes (M + m) / (m cos) of that."""
    m, mass, length, rise = 1.0, 3.0, 3.0, 1.5
    tilt = math.atan2(rise, length)
    s, c = math.sin(tilt), math.cos(tilt)
    back, down = m * G * s * c / (mass + m * s * s), (mass + m) * G * s / (mass + m * s * s)
    x, y = length / 3, rise / 3
    wedge = Polygon([(-x, -y), (length - x, -y), (-x, rise - y)])
    w, start = 0.3, 0.5  # half the block's side, and how far down it starts

    def truth(t: Array) -> Array:
        moved, gone = -back / 2 * t**2, start + down / 2 * t**2
        block = (moved + gone * c + w * s, rise - gone * s + w * c, -tilt)
        return poses((x + moved, y, 0.0), block, times=t)

    slider = Body(id="a", shape=wedge, position=(x, y), mass=mass, friction=0.0, elasticity=0.0)
    at = (start * c + w * s, rise - start * s + w * c)
    block = make_box("b", (2 * w, 2 * w), at, angle=-tilt, mass=m)
    return Case(
        "block on a wedge",
        "that slides away under it: both accelerations are constant",
        make_scene([make_ground(), slider, block]),
        0.8,
        truth,
    )


def _off_a_wall() -> Case:
    """Slides with friction, is thrown back by a wall with e of its speed, and stops."""
    mu, v, e, gap = 0.25, 4.0, 0.7, 1.0
    speed = math.sqrt(v * v - 2 * mu * G * gap)
    hit = (v - speed) / (mu * G)
    parts = [(hit, -mu * G, 0.0)]
    back = [(e * speed / (mu * G), mu * G, 0.0), (math.inf, 0.0, 0.0)]

    def truth(t: Array) -> Array:
        x = np.where(
            t < hit,
            _stretches([*parts, (math.inf, 0.0, 0.0)], (v, 0.0), t)[0],
            gap + _stretches(back, (-e * speed, 0.0), np.maximum(t - hit, 0))[0],
        )
        return poses((x, 0.2, 0.0), times=t)

    block = make_box("a", (0.8, 0.4), (0.0, 0.2), velocity=(v, 0.0), friction=mu, elasticity=e)
    wall = make_box("wall", (1.0, 4.0), (gap + 0.9, 2.0), anchored=True)
    scene = make_scene([make_ground(friction=mu), wall, block])
    return Case("off a wall", "a block slides, is thrown back, stops", scene, 2.0, truth)


def _lands_flat() -> Case:
    e, drop = 0.6, 0.8

    def truth(t: Array) -> Array:
        height = np.zeros_like(t)
        for here, _, h, _, _ in flights(t, drop, e):
            height[here] = h
        return poses((0.0, 0.25 + height, 0.0), times=t)

    box = make_box("a", (0.9, 0.5), (0.0, 0.25 + drop), elasticity=e, friction=0.5)
    scene = make_scene([make_ground(friction=0.5), box])
    return Case("lands flat", "a box bounces on its whole side until it rests", scene, 3.0, truth)


# ---------------------------------------------------------------- blows


def _oblique_blow(mu: float) -> Case:
    """Two disks meet off centre: j = (1 + e) m' v_n, friction min(mu j, slip / (3 / m + 3 / M)) across it."""
    m, mass, r, big, e, v, off = 1.0, 2.0, 0.2, 0.3, 0.8, 3.0, 0.3
    reach = r + big
    hit = (1.5 - math.sqrt(reach**2 - off**2)) / v

    def truth(t: Array) -> Array:
        n = np.array([math.sqrt(reach**2 - off**2), -off]) / reach  # from a to b
        side = np.array([-n[1], n[0]])
        slip = v * side[0]  # of a's surface against b's; the spins are none
        j = (1 + e) * v * n[0] / (1 / m + 1 / mass)
        f = math.copysign(min(mu * j, abs(slip) / (3 / m + 3 / mass)), slip)
        later = np.maximum(t - hit, 0)
        a = np.array([v, 0.0]) - (j * n + f * side) / m
        b = (j * n + f * side) / mass
        turn_a, turn_b = -2 * f / (m * r), -2 * f / (mass * big)
        x, y = v * np.minimum(t, hit) - 1.5 + a[0] * later, off + a[1] * later
        return poses((x, y, turn_a * later), (b[0] * later, b[1] * later, turn_b * later), times=t)

    ball = make_disk("a", r, (-1.5, off), mass=m, velocity=(v, 0.0), elasticity=e, friction=mu)
    other = make_disk("b", big, (0.0, 0.0), mass=mass, elasticity=e, friction=mu)
    name = "oblique blow, slips" if mu < 0.2 else "oblique blow, sticks"
    return Case(name, "two disks meet off centre", make_scene([ball, other], gravity=0), 1.5, truth)


def _struck_pendulum() -> Case:
    """A ball hits a hanging rod at d below its pivot: j = (1 + e) v / (1 / m + d^2 / I)."""
    length, width, mass, m, r, v, d, e = 1.2, 0.08, 2.0, 0.5, 0.1, 6.0, 0.9, 0.7
    moment = mass * (length**2 + width**2) / 12
    about = moment + mass * length**2 / 4
    gap = 0.3
    hit, j = gap / v, (1 + e) * v / (1 / m + d * d / about)

    def truth(t: Array) -> Array:
        phases = Phases(t)
        phases.now = hit
        phases.run(
            lambda _, y: np.array([y[1], -mass * G * length / 2 / about * math.sin(y[0])]),
            np.array([0.0, j * d / about]),
        )
        ((here, y),) = phases.states()
        a = np.zeros_like(t)
        a[here] = y[:, 0]
        later = np.maximum(t - hit, 0)
        x = -gap - r - width / 2 + v * np.minimum(t, hit) + (v - j / m) * later
        rod = (length / 2 * np.sin(a), -length / 2 * np.cos(a), a)
        # the ball falls through the blow, which is level and without friction
        return poses(rod, (x, -d + G / 2 * hit**2 - G / 2 * t**2, 0.0), times=t)

    rod = make_box("a", (width, length), (0.0, -length / 2), mass=mass, moment=moment, elasticity=e)
    lift = G / 2 * hit**2  # so that it is at d when it hits
    ball = make_disk("b", r, (-gap - r - width / 2, -d + lift), mass=m, velocity=(v, 0.0), elasticity=e)
    scene = make_scene([rod, ball], [Joint(bodies=(None, "a"), position=(0.0, 0.0))])
    return Case("struck pendulum", "a ball hits a hanging rod, which swings; DOP853", scene, 1.0, truth)


# ---------------------------------------------------------------- over the top, and on wheels


def _off_a_dome(mu: float) -> Case:
    """A disk on top of a fixed one rolls, slips and leaves; without friction where cos a = 2/3 cos a0."""
    r, big, start = 0.2, 0.8, 0.15
    reach = r + big
    rolls = mu > 0

    def sticking(_: float, y: Array) -> Array:  # angle from straight up, rate, turn of the disk, spin
        a = G / reach * math.sin(y[0]) / (1.5 if rolls else 1.0)
        return np.array([y[1], a, y[3], -a * reach / r if rolls else 0.0])

    def press(_: float, y: Array) -> float:
        return float(G * math.cos(y[0]) - reach * y[1] ** 2)

    def grip(_: float, y: Array) -> float:
        return mu * press(0, y) - float(G * math.sin(y[0])) / 3

    def slipping(_: float, y: Array) -> Array:
        f = mu * press(0, y)
        return np.array([y[1], (G * math.sin(y[0]) - f) / reach, y[3], -2 * f / r])

    def truth(t: Array) -> Array:
        phases = Phases(t)
        y = np.array([start, 0.0, 0.0, 0.0])
        if rolls:
            y = phases.run(sticking, y, grip)
            y = phases.run(slipping, y, press)
        else:
            y = phases.run(sticking, y, press)
        out = np.empty((len(t), 1, 3))
        for here, part in phases.states():
            a = part[:, 0]
            out[here, 0] = np.stack([reach * np.sin(a), reach * np.cos(a), part[:, 2]], axis=1)
        later = t > phases.now
        d = t[later] - phases.now
        s, c = math.sin(y[0]), math.cos(y[0])
        x, height = reach * (s + y[1] * c * d), reach * (c - y[1] * s * d) - G / 2 * d**2
        out[later, 0] = np.stack([x, height, y[2] + y[3] * d], axis=1)
        return out

    dome = make_disk("dome", big, (0.0, 0.0), anchored=True, friction=mu)
    disk = make_disk("a", r, (reach * math.sin(start), reach * math.cos(start)), friction=mu)
    name = "rolls off a dome" if rolls else "slides off a dome"
    return Case(name, "a disk leaves the top of a fixed one; DOP853", make_scene([dome, disk]), 1.5, truth)


def _pendulum_on_a_cart() -> Case:
    """(M + m) x'' + m l (a'' cos a - a'^2 sin a) = 0 and (I + m l^2) a'' + m l x'' cos a + m g l sin a = 0."""
    mass, m, length, width, start, high = 6.0, 1.0, 0.9, 0.05, 1.3, 1.2
    half = length / 2
    moment = m * (length**2 + width**2) / 12

    def slope(_: float, y: Array) -> Array:
        s, c = math.sin(y[0]), math.cos(y[0])
        matrix = np.array([[moment + m * half**2, m * half * c], [m * half * c, mass + m]])
        a, x = np.linalg.solve(matrix, [-m * G * half * s, m * half * s * y[2] ** 2])
        return np.array([y[2], y[3], a, x])

    def truth(t: Array) -> Array:
        phases = Phases(t)
        phases.run(slope, np.array([start, 0.0, 0.0, 0.0]))
        ((_, y),) = phases.states()
        a, x = y[:, 0], y[:, 1]
        rod = (x + half * np.sin(a), high - half * np.cos(a), a)
        return poses((x, high / 2 + 0.1, 0.0), rod, times=t)

    cart = make_box("a", (1.6, high + 0.2), (0.0, high / 2 + 0.1), mass=mass)
    at = (half * math.sin(start), high - half * math.cos(start))
    rod = make_box("b", (width, length), at, angle=start, mass=m, moment=moment)
    scene = make_scene([make_ground(), cart, rod], [Joint(bodies=("a", "b"), position=(0.0, high))])
    return Case("pendulum on a cart", "a heavy box slides under a swinging rod; DOP853", scene, 3.0, truth)


SLIPPING: list[Case] = [
    _comes_back(),
    _up_a_slope(0.3),
    _up_a_slope(0.1),
    _bounces_then_rolls(),
    _block_up_a_slope(0.2),
    _block_up_a_slope(0.6),
    _block_on_a_plank(),
    _block_on_a_wedge(),
    _off_a_wall(),
    _lands_flat(),
    _oblique_blow(0.1),
    _oblique_blow(0.9),
    _struck_pendulum(),
    _off_a_dome(0.0),
    _off_a_dome(0.5),
    _pendulum_on_a_cart(),
]
