"""Reference cases that hang on what several contacts do together: which take a blow on, which carry, which let go.

A body that turns about a point of contact has one degree of freedom until something lifts or slips; solve_ivp's DOP853
solves for it to 1e-12.
"""

from __future__ import annotations

import math

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

__all__ = ["CONTACTS"]


def _two_lifted() -> Case:
    """Two of five hanging disks are let go together: two leave on the other side, by blows that pass through all."""
    r, length, start, m = 0.15, 1.0, -0.9, 1.0
    about = m * length**2 + m * r**2 / 2  # the disks are fixed to what they hang from

    def truth(t: Array) -> Array:
        phases = Phases(t)
        phases.run(
            lambda _, y: np.array([y[1], -m * G * length / about * math.sin(y[0])]), np.array([start, 0.0])
        )
        ((_, y),) = phases.states()
        out = np.zeros((len(t), 5, 3))
        for k in range(
            5
        ):  # as one pendulum, whose left half is the one pair's and whose right half the other's
            a = np.minimum(y[:, 0], 0) if k < 2 else np.maximum(y[:, 0], 0) if k > 2 else 0 * t
            out[:, k] = np.stack([2 * r * k + length * np.sin(a), length - length * np.cos(a), a], axis=1)
        return out

    disks = []
    for k in range(5):
        a = start if k < 2 else 0.0
        at = (2 * r * k + length * math.sin(a), length - length * math.cos(a))
        disks.append(make_disk("abcde"[k], r, at, angle=a, mass=m, moment=m * r * r / 2, elasticity=1.0))
    joints = [Joint(bodies=(None, "abcde"[k]), position=(2 * r * k, length)) for k in range(5)]
    return Case("two lifted", "of a cradle of five, elastic; DOP853", make_scene(disks, joints), 4.0, truth)


def _on_a_wheel() -> Case:
    """A disk on top of one that spins on an axle slips, rolls with it, slips again and leaves.

    With q the angle of the line of centres, R its length, N the force along it and f across it on the upper disk:
    R q'' = g sin q + f / m and I w' = -r f for each; the slip is R q' - r w - r' w'.
    """
    low, high, mu, spin = 0.3, 0.2, 0.5, 10.0
    reach, big, m = low + high, 2.0, 1.0
    turns = (big * low**2 / 2, m * high**2 / 2)

    def press(y: Array) -> float:
        return float(m * (G * math.cos(y[0]) - reach * y[1] ** 2))

    def grip(y: Array) -> float:  # that keeps it from slipping
        return float(-G * math.sin(y[0]) / (3 / m + 2 / big))

    def slip(y: Array) -> float:
        return float(reach * y[1] - high * y[5] - low * y[3])

    def under(f: float, y: Array) -> Array:
        return np.array(
            [
                y[1],
                (G * math.sin(y[0]) + f / m) / reach,
                y[3],
                -low * f / turns[0],
                y[5],
                -high * f / turns[1],
            ]
        )

    def truth(t: Array) -> Array:
        phases = Phases(t)
        y = phases.run(
            lambda _, y: under(mu * press(y), y),
            np.array([0.0, 0.0, 0.0, spin, 0.0, 0.0]),
            lambda _, y: -slip(y),
        )
        y = phases.run(lambda _, y: under(grip(y), y), y, lambda _, y: mu * press(y) - abs(grip(y)))
        y = phases.run(lambda _, y: under(-mu * press(y), y), y, lambda _, y: press(y))
        out = np.zeros((len(t), 2, 3))
        for here, part in phases.states():
            q = part[:, 0]
            out[here, 0, 2] = part[:, 2]
            out[here, 1] = np.stack([-reach * np.sin(q), reach * np.cos(q), part[:, 4]], axis=1)
        later = t > phases.now
        d, s, c = t[later] - phases.now, math.sin(y[0]), math.cos(y[0])
        x, height = -reach * (s + c * y[1] * d), reach * (c - s * y[1] * d) - G / 2 * d**2
        out[later, 0, 2] = y[2] + y[3] * d
        out[later, 1] = np.stack([x, height, y[4] + y[5] * d], axis=1)
        return out

    wheel = make_disk("a", low, (0.0, 0.0), mass=big, moment=turns[0], angular_velocity=spin, friction=mu)
    rider = make_disk("b", high, (0.0, reach), mass=m, moment=turns[1], friction=mu)
    scene = make_scene([wheel, rider], [Joint(bodies=(None, "a"), position=(0.0, 0.0))])
    return Case("on a wheel", "slips, rolls, slips and leaves; DOP853", scene, 0.8, truth)


def _train() -> Case:
    """Four wheels under one frame share its weight, so that all of them roll: a = (M + 4 m) g sin / (M + 6 m)."""
    slope, r, frame, wheel = 0.15, 0.2, 4.0, 0.6
    spots = (-0.75, -0.25, 0.25, 0.75)

    def truth(t: Array) -> Array:
        s = (frame + 4 * wheel) * G * math.sin(slope) / (frame + 6 * wheel) / 2 * t**2
        return poses(
            (*along(slope, s, r), -slope), *((*along(slope, s + k, r), -s / r) for k in spots), times=t
        )

    def at(k: float) -> tuple[float, float]:
        x, y = along(slope, np.array(k), r)
        return float(x), float(y)

    body = make_box("a", (1.9, 0.2), at(0.0), angle=-slope, mass=frame)
    wheels = [
        make_disk(n, r, at(k), mass=wheel, moment=wheel * r * r / 2, friction=0.8)
        for n, k in zip("bcde", spots, strict=True)
    ]
    joints = [Joint(bodies=("a", w.id), position=w.position) for w in wheels]
    scene = make_scene([make_ground(slope, friction=0.8), body, *wheels], joints)
    return Case("train", "four wheels on a slope: more contacts than it needs", scene, 2.5, truth)


def _sled() -> Case:
    """Three round feet pinned to a frame slide down a slope: however they share the load, a = g (sin - mu cos)."""
    slope, mu, feet = 0.4, 0.2, (-0.5, 0.0, 0.5)

    def at(k: float, height: float) -> tuple[float, float]:
        x, y = along(slope, np.array(k), height)
        return float(x), float(y)

    def truth(t: Array) -> Array:
        s = G / 2 * (math.sin(slope) - mu * math.cos(slope)) * t**2
        return poses(
            (*along(slope, s, 0.2), -slope), *((*along(slope, s + k, 0.1), 0.0) for k in feet), times=t
        )

    frame = make_box("a", (1.2, 0.2), at(0.0, 0.2), angle=-slope, mass=2.0)
    disks = [make_disk(n, 0.1, at(k, 0.1), mass=0.3, friction=mu) for n, k in zip("bcd", feet, strict=True)]
    joints = [
        Joint(bodies=("a", n), position=at(k + aside, 0.13))
        for n, k in zip("bcd", feet, strict=True)
        for aside in (-0.02, 0.02)
    ]
    scene = make_scene([make_ground(slope, friction=mu), frame, *disks], joints)
    return Case("sled", "three feet slide: more contacts than it needs", scene, 1.5, truth)


def _over_a_joint() -> Case:
    """A block slides from one slab on to another, flush with it, and stops as it would on one."""
    mu, v, tilt = 0.3, 3.0, 0.17
    s, c = math.sin(tilt), math.cos(tilt)

    def place(x: float, y: float) -> tuple[float, float]:
        return x * c - y * s, x * s + y * c

    def truth(t: Array) -> Array:
        brake = G * (s + mu * c)
        u = np.minimum(t, v / brake)
        x = -1.0 + v * u - brake / 2 * u**2
        return poses((x * c - 0.2 * s, x * s + 0.2 * c, tilt), times=t)

    slabs = [
        make_box(n, (4.0, 1.0), place(x, -0.5), angle=tilt, anchored=True, friction=mu)
        for n, x in (("left", -2.0), ("right", 2.0))
    ]
    block = make_box("a", (0.6, 0.4), place(-1.0, 0.2), angle=tilt, velocity=(v * c, v * s), friction=mu)
    return Case(
        "over a joint", "a block slides over two flush slabs", make_scene([*slabs, block]), 1.5, truth
    )


def _skips() -> Case:
    """A disk skips along the floor, too low to be seen at a coarse tolerance; what it is rubbed by is seen."""
    r, mu, e, v, up = 0.2, 0.3, 0.2, 3.0, 0.1

    def truth(t: Array) -> Array:
        x, angle, height = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        now, at, turned, vx, w = 0.0, 0.0, 0.0, v, 0.0
        for here, d, h, length, down in flights(t, 0.0, e, up):
            x[here], angle[here], height[here] = at + vx * d, turned + w * d, h
            now, at, turned = now + length, at + vx * length, turned + w * length
            vx, w = vx - mu * (1 + e) * down, w - 2 * mu * (1 + e) * down / r
        slips = np.clip(t - now, 0, (vx + w * r) / (3 * mu * G))
        rolls = np.maximum(t - now - (vx + w * r) / (3 * mu * G), 0)
        later = t >= now
        last = (vx + w * r) / (3 * mu * G)
        x[later] = (at + vx * slips - mu * G / 2 * slips**2 + (vx - mu * G * last) * rolls)[later]
        angle[later] = (turned + w * slips - mu * G / r * slips**2 + (w - 2 * mu * G / r * last) * rolls)[
            later
        ]
        return poses((x, r + height, angle), times=t)

    disk = make_disk("a", r, (0.0, r), velocity=(v, up), friction=mu, elasticity=e)
    scene = make_scene([make_ground(friction=mu), disk])
    return Case("skips", "a disk hops low, slips and rolls", scene, 2.0, truth)


def _up_a_step() -> Case:
    """A disk rolls against a step: of its motion is left what turns it about the step's corner; it climbs on."""
    r, h, v, m = 0.4, 0.1, 1.65, 1.0
    first, start = math.acos((r - h) / r), -1.0

    def truth(t: Array) -> Array:
        hit = (-r * math.sin(first) - start) / v
        before = np.minimum(t, hit)
        out = np.stack([start + v * before, np.full_like(t, r), -v / r * before], axis=1)[:, None]
        phases = Phases(t)
        phases.now = hit
        spin = v * (1.5 * r - h) / (1.5 * r * r)  # about the corner: I v / r + m v (r - h) of 3/2 m r^2
        y = phases.run(
            lambda _, y: np.array([y[1], 2 / 3 * G / r * math.sin(y[0])]),
            np.array([first, -spin]),
            lambda _, y: float(y[0]),
        )
        turned = -v / r * hit - first
        ((here, part),) = phases.states()
        q = part[:, 0]
        out[here, 0] = np.stack([-r * np.sin(q), h + r * np.cos(q), turned + q], axis=1)
        later = t > phases.now
        gone = -y[1] * r * (t[later] - phases.now)
        out[later, 0] = np.stack([gone, np.full_like(gone, h + r), turned - gone / r], axis=1)
        return out

    step = make_box("step", (6.0, 1.0), (3.0, h - 0.5), anchored=True, friction=3.0)
    disk = make_disk(
        "a",
        r,
        (start, r),
        mass=m,
        moment=m * r * r / 2,
        velocity=(v, 0.0),
        angular_velocity=-v / r,
        friction=3.0,
    )
    scene = make_scene([make_ground(friction=3.0), step, disk])
    return Case("up a step", "a disk climbs it and rolls on; DOP853", scene, 2.0, truth)


def _hexagon() -> Case:
    """Rolls from corner to corner down a slope; each landing keeps (I + m R^2 cos 60) / (I + m R^2) of the spin."""
    radius, slope, m, start = 0.4, 0.26, 1.0, 2.2
    moment = 5 / 12 * m * radius**2
    about = moment + m * radius**2
    kept = (moment + m * radius**2 / 2) / about

    def truth(t: Array) -> Array:
        phases = Phases(t)
        y = np.array([0.0, start])  # turned since it lay flat, and how fast
        while not phases.done:
            y = phases.run(
                lambda _, y: np.array([y[1], m * G * radius / about * math.sin(y[0] - math.pi / 6 + slope)]),
                y,
                lambda _, y: math.pi / 3 - float(y[0]),
            )
            y = np.array([0.0, kept * y[1]])
        out = np.empty((len(t), 1, 3))
        for k, (here, part) in enumerate(phases.states()):
            q = part[:, 0] - math.pi / 6
            x, height = along(slope, radius * (k + 0.5 + np.sin(q)), 0.0)
            lift = radius * np.cos(q)
            angle = -slope - k * math.pi / 3 - part[:, 0]
            out[here, 0] = np.stack(
                [x + lift * math.sin(slope), height + lift * math.cos(slope), angle], axis=1
            )
        return out

    corners = [(radius * math.cos(k * math.pi / 3), radius * math.sin(k * math.pi / 3)) for k in range(6)]
    x, y = (float(c) for c in along(slope, np.array(0.0), radius * math.cos(math.pi / 6)))
    px, py = (float(c) for c in along(slope, np.array(radius / 2), 0.0))
    body = Body(
        id="a",
        shape=Polygon(corners),
        position=(x, y),
        angle=-slope,
        mass=m,
        moment=moment,
        velocity=(start * (y - py), start * (px - x)),
        angular_velocity=-start,
        friction=2.0,
        elasticity=0.0,
    )
    scene = make_scene([make_ground(slope, friction=2.0), body])
    return Case("hexagon", "from corner to corner down a slope; DOP853", scene, 2.5, truth)


CONTACTS: list[Case] = [
    _two_lifted(),
    _on_a_wheel(),
    _train(),
    _sled(),
    _over_a_joint(),
    _skips(),
    _up_a_step(),
    _hexagon(),
]
