"""Reference cases: scenes whose motion is known, by a closed form or by an ODE solved to 1e-12.

The truth of a case is a function of the sample times that gives the poses of its moving bodies.  Flight,
impacts, every regime of friction, rolling, pivots and rest are each there alone, so that an error in one can
be told from an error in another; linkages.py, mechanisms.py, slipping.py and contacts.py have more, and those in
which one turns into another.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.bench.contacts import CONTACTS
from sim.bench.linkages import LINKAGES
from sim.bench.mechanisms import MECHANISMS
from sim.bench.parts import (
    Array,
    Case,
    G,
    along,
    case_error,
    flights,
    make_box,
    make_disk,
    make_ground,
    make_scene,
    poses,
)
from sim.bench.slipping import SLIPPING
from sim.scene import Joint, Scene

__all__ = ["CASES", "Case", "case_error"]

# ---------------------------------------------------------------- flight and impacts


def _projectile() -> Case:
    def truth(t: Array) -> Array:
        return poses((5 * t, 10 + 8 * t - G / 2 * t**2, 7 * t), times=t)

    scene = make_scene([make_disk("a", 0.2, (0, 10), velocity=(5.0, 8.0), angular_velocity=7.0)])
    return Case("projectile", "free flight with spin: a parabola", scene, 2.0, truth)


def _heights(t: Array, drop: float, gravity: float, e: float) -> Array:
    """Height of a point dropped from `drop` that bounces with restitution e until it rests."""
    out = np.zeros_like(t)
    for here, _, height, _, _ in flights(t, drop, e, gravity=gravity):
        out[here] = height
    return out


def _bounces_to_rest() -> Case:
    def truth(t: Array) -> Array:
        return poses((0, 0.1 + _heights(t, 1.0, G, 0.5), 0), times=t)

    scene = make_scene([make_ground(), make_disk("a", 0.1, (0, 1.1), elasticity=0.5)])
    return Case(
        "bounces to rest",
        "a dropped ball, elasticity 0.5: infinitely many bounces in finite time",
        scene,
        2.0,
        truth,
    )


def _bounces_down_a_slope() -> Case:
    slope, r, drop = 0.3, 0.1, 0.5

    def truth(t: Array) -> Array:
        height = _heights(t, drop, G * math.cos(slope), 0.6)
        s = G / 2 * math.sin(slope) * t**2
        x, y = along(slope, s, 0.0)
        return poses((x + (r + height) * math.sin(slope), y + (r + height) * math.cos(slope), 0), times=t)

    start = ((r + drop) * math.sin(slope), (r + drop) * math.cos(slope))
    scene = make_scene([make_ground(slope), make_disk("a", r, start, elasticity=0.6)])
    return Case(
        "bounces down a slope", "no friction: bounces across the slope, slides along it", scene, 2.5, truth
    )


def _spinning_bounce() -> Case:
    """One impact with friction that slips, then one that sticks: j_t = min(mu j_n, what stops the slip)."""
    r, mu, e, drop, v, spin = 0.2, 0.2, 0.7, 1.0, 2.0, 6.0

    def truth(t: Array) -> Array:
        fall = math.sqrt(2 * drop / G)
        vx, w, vy = v, spin, G * fall
        x, angle = v * t, spin * t
        start = fall
        for _ in range(3):
            normal = (1 + e) * vy
            slip = vx + w * r  # of the lowest point, per unit mass: m = 1, I = r^2 / 2
            push = -math.copysign(min(mu * normal, abs(slip) / 3), slip)
            vx, w, vy = vx + push, w + 2 * push / r, e * vy
            later = t >= start
            x[later] = x[later] + push * (t[later] - start)
            angle[later] = angle[later] + 2 * push / r * (t[later] - start)
            start += 2 * vy / G
        return poses((x, r + _heights(t, drop, G, e), angle), times=t)

    ball = make_disk(
        "a", r, (0, r + drop), velocity=(v, 0.0), angular_velocity=spin, friction=mu, elasticity=e
    )
    scene = make_scene([make_ground(friction=mu), ball])
    return Case(
        "spinning bounce", "impacts with friction: slipping ones, then sticking ones", scene, 2.0, truth
    )


def _unequal_disks() -> Case:
    """A line of disks without gravity: masses 1, 2, 4, 3; elastic impacts one after the other."""
    masses, radii, xs, v0 = [1.0, 2.0, 4.0, 3.0], [0.2, 0.3, 0.25, 0.2], [-1.0, 0.5, 2.0, 3.2], 4.0

    def truth(t: Array) -> Array:
        x, v, now = list(xs), [v0, 0.0, 0.0, 0.0], 0.0
        out = np.zeros((len(t), 4, 3))
        events: list[tuple[float, list[float], list[float]]] = [(0.0, list(x), list(v))]
        while True:
            times = [
                (x[i + 1] - x[i] - radii[i] - radii[i + 1]) / (v[i] - v[i + 1])
                if v[i] > v[i + 1]
                else math.inf
                for i in range(3)
            ]
            i = int(np.argmin(times))
            if now + times[i] > t[-1]:
                break
            now += times[i]
            x = [p + u * times[i] for p, u in zip(x, v, strict=True)]
            m, k = masses[i], masses[i + 1]
            v[i], v[i + 1] = (
                ((m - k) * v[i] + 2 * k * v[i + 1]) / (m + k),
                ((k - m) * v[i + 1] + 2 * m * v[i]) / (m + k),
            )
            events.append((now, list(x), list(v)))
        for start, p, u in events:
            later = t >= start
            out[later, :, 0] = np.array(p) + np.outer(t[later] - start, u)
        return out

    bodies = [
        make_disk(n, r, (x, 0.0), mass=m, elasticity=1.0)
        for n, r, x, m in zip("abcd", radii, xs, masses, strict=True)
    ]
    bodies[0].velocity = (v0, 0.0)
    return Case(
        "unequal disks",
        "a line of disks, elastic impacts passed on",
        make_scene(bodies, gravity=0),
        3.0,
        truth,
    )


def _blow_on_a_rod() -> Case:
    """A ball hits a free rod off its centre: j = (1 + e) v / (1/m + 1/M + d^2 / I)."""
    m, v, d, length, e = 0.5, 3.0, 0.35, 1.2, 0.8
    mass, moment = 2.0, 2.0 * (1.2**2 + 0.1**2) / 12

    def truth(t: Array) -> Array:
        hit = 0.8 / v
        j = (1 + e) * v / (1 / m + 1 / mass + d * d / moment)
        later = np.maximum(t - hit, 0)
        ball = (-1.0 + v * t - j / m * later, d, 0.0)
        return poses(ball, (j / mass * later, 0.0, -j * d / moment * later), times=t)

    ball = make_disk("a", 0.15, (-1.0, d), mass=m, velocity=(v, 0.0), elasticity=e)
    rod = make_box("b", (0.1, length), (0.0, 0.0), mass=mass, moment=moment, elasticity=e)
    return Case(
        "blow on a rod",
        "a ball hits a free rod off its centre",
        make_scene([ball, rod], gravity=0),
        1.0,
        truth,
    )


def _corner_impact() -> Case:
    """A spinning box lands on a corner, no friction: j = -(1 + e) vn / (1/m + rx^2 / I)."""
    w, h, m, e, y0, v, spin, tilt = 0.8, 0.5, 1.0, 0.5, 1.0, -2.0, 2.0, 0.3
    moment = m * (w * w + h * h) / 12

    def lowest(t: float) -> tuple[float, float]:
        a = tilt + spin * t
        corners = [(sx * w / 2, sy * h / 2) for sx in (-1, 1) for sy in (-1, 1)]
        return min((x * math.sin(a) + y * math.cos(a), x * math.cos(a) - y * math.sin(a)) for x, y in corners)

    def truth(t: Array) -> Array:
        from scipy.optimize import brentq

        hit = brentq(lambda s: y0 + v * s - G / 2 * s * s + lowest(s)[0], 0.0, 0.6, xtol=1e-15, rtol=1e-15)
        arm = lowest(hit)[1]
        vy = v - G * hit
        j = -(1 + e) * (vy + spin * arm) / (1 / m + arm * arm / moment)
        later = np.maximum(t - hit, 0)
        y = y0 + v * t - G / 2 * t**2 + j / m * later
        return poses((t, y, tilt + spin * t + j * arm / moment * later), times=t)

    box = make_box(
        "a", (w, h), (0, y0), angle=tilt, velocity=(1.0, v), angular_velocity=spin, mass=m, elasticity=e
    )
    return Case(
        "corner impact", "a spinning box lands on a corner", make_scene([make_ground(), box]), 0.35, truth
    )


# ---------------------------------------------------------------- friction and rolling


def _sliding_block(name: str, slope: float, mu: float) -> Case:

    def truth(t: Array) -> Array:
        a = G * (math.sin(slope) - mu * math.cos(slope))
        return poses((*along(slope, a / 2 * t**2, 0.25), -slope), times=t)

    at = (0.25 * math.sin(slope), 0.25 * math.cos(slope))
    block = make_box("a", (0.5, 0.5), at, angle=-slope, friction=mu)
    scene = make_scene([make_ground(slope, friction=mu), block])
    about = f"down {math.degrees(slope):.0f} degrees with friction {mu:.3g}: a = g (sin - mu cos)"
    return Case(name, about, scene, 1.0, truth)


def _sliding_stops() -> Case:
    mu, v = 0.4, 3.0

    def truth(t: Array) -> Array:
        end = np.minimum(t, v / (mu * G))
        return poses((v * end - mu * G / 2 * end**2, 0.2, 0.0), times=t)

    block = make_box("a", (0.8, 0.4), (0.0, 0.2), velocity=(v, 0.0), friction=mu)
    scene = make_scene([make_ground(friction=mu), block])
    return Case("sliding stops", "a block slides until friction has stopped it, and stays", scene, 2.0, truth)


def _slip_to_roll() -> Case:
    r, mu, v = 0.25, 0.3, 4.0

    def truth(t: Array) -> Array:
        end = v / (3 * mu * G)  # when v - mu g t = w r with w = 2 mu g t / r
        s = np.minimum(t, end)
        x = v * s - mu * G / 2 * s**2 + (v - mu * G * end) * (t - s)
        spin = -2 * mu * G * end / r
        return poses((x, r, -mu * G / r * s**2 + spin * (t - s)), times=t)

    disk = make_disk("a", r, (0.0, r), velocity=(v, 0.0), friction=mu)
    scene = make_scene([make_ground(friction=mu), disk])
    return Case(
        "slip to roll", "a disk thrown along the ground slips, then rolls at two thirds", scene, 2.0, truth
    )


def _rolling_disk() -> Case:
    slope, r = 0.35, 0.25

    def truth(t: Array) -> Array:
        s = G * math.sin(slope) / 3 * t**2
        return poses((*along(slope, s, r), -s / r), times=t)

    disk = make_disk("a", r, (r * math.sin(slope), r * math.cos(slope)), friction=1.0)
    scene = make_scene([make_ground(slope, friction=1.0), disk])
    return Case("rolling disk", "down 20 degrees without slipping: a = 2/3 g sin", scene, 2.0, truth)


def _rolling_cart() -> Case:
    slope, r, frame, wheel = 0.15, 0.25, 4.0, 1.0

    def truth(t: Array) -> Array:
        a = (frame + 2 * wheel) * G * math.sin(slope) / (frame + 3 * wheel)
        s = a / 2 * t**2
        spots = [along(slope, s + k, r) for k in (0.0, -0.6, 0.6)]
        return poses((*spots[0], -slope), (*spots[1], -s / r), (*spots[2], -s / r), times=t)

    one = np.zeros(1)
    at = [tuple(float(c[0]) for c in along(slope, one + k, r)) for k in (0.0, -0.6, 0.6)]
    body = make_box("a", (1.6, 0.3), (at[0][0], at[0][1]), angle=-slope, mass=frame, friction=1.0)
    wheels = [
        make_disk(n, r, (p[0], p[1]), mass=wheel, friction=1.0) for n, p in zip("bc", at[1:], strict=True)
    ]
    joints = [Joint(bodies=("a", b.id), position=b.position) for b in wheels]
    scene = make_scene([make_ground(slope, friction=1.0), body, *wheels], joints)
    return Case("rolling cart", "a frame on two wheels: a = (M + 2m) g sin / (M + 3m)", scene, 2.0, truth)


# ---------------------------------------------------------------- pivots


def _chain(
    lengths: Sequence[float], masses: Sequence[float], start: Sequence[float], name: str, about: str
) -> Case:
    """Thin rods hanging from each other, angles from straight down; Lagrange's equations in those angles."""
    n = len(lengths)
    width = 0.02
    L, m = np.array(lengths), np.array(masses)
    moment = m * (L**2 + width**2) / 12
    below = np.array([m[k + 1 :].sum() for k in range(n)])
    # rod k's centre is the sum over i < k of L_i u_i plus L_k u_k / 2; c[i, j] multiplies cos(a_i - a_j)
    c = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            low, high = max(i, j), min(i, j)
            c[i, j] = L[high] * L[low] * (m[low] / (4 if i == j else 2) + below[low])
    pull = G * L * (m / 2 + below)

    def slope(_: float, y: Array) -> Array:
        a, w = y[:n], y[n:]
        d = a[:, None] - a[None, :]
        mass = c * np.cos(d) + np.diag(moment)
        return np.concatenate([w, np.linalg.solve(mass, -(c * np.sin(d)) @ w**2 - pull * np.sin(a))])

    def truth(t: Array) -> Array:
        from scipy.integrate import solve_ivp

        y0 = np.concatenate([np.array(start), np.zeros(n)])
        run = solve_ivp(slope, (0, float(t[-1])), y0, method="DOP853", rtol=1e-12, atol=1e-13, t_eval=t)
        a = run.y[:n].T
        u = np.stack([np.sin(a), -np.cos(a)], axis=2) * L[:, None]
        centres = np.cumsum(u, axis=1) - u / 2
        return np.concatenate([centres, (a - np.pi / 2)[..., None]], axis=2)

    bodies, joints, top = [], [], np.zeros(2)
    for k in range(n):
        u = L[k] * np.array([math.sin(start[k]), -math.cos(start[k])])
        at = (float(top[0] + u[0] / 2), float(top[1] + u[1] / 2))
        bodies.append(
            make_box("abcdef"[k], (lengths[k], width), at, angle=start[k] - math.pi / 2, mass=masses[k])
        )
        bodies[k].moment = float(moment[k])
        joints.append(
            Joint(
                bodies=("abcdef"[k - 1] if k else None, "abcdef"[k]), position=(float(top[0]), float(top[1]))
            )
        )
        top = top + u
    return Case(name, about, make_scene(bodies, joints), 5.0, truth)


# ---------------------------------------------------------------- rest


def _at_rest(name: str, about: str, scene: Scene, duration: float = 10.0) -> Case:
    def truth(t: Array) -> Array:
        return poses(*((*b.position, b.angle) for b in scene.bodies if not b.anchored), times=t)

    return Case(name, about, scene, duration, truth)


def _tower(count: int) -> Case:
    boxes = [make_box(f"box{k}", (0.5, 0.4), (0.0, 0.2 + 0.4 * k), friction=0.5) for k in range(count)]
    return _at_rest(
        f"tower of {count}",
        "boxes on each other: must not move",
        make_scene([make_ground(friction=0.5), *boxes]),
    )


def _resting_block(name: str, mu: float) -> Case:
    slope = 0.5
    block = make_box(
        "a", (0.5, 0.5), (0.25 * math.sin(slope), 0.25 * math.cos(slope)), angle=-slope, friction=mu
    )
    scene = make_scene([make_ground(slope, friction=mu), block])
    return _at_rest(name, f"on 29 degrees with friction {mu:.3g}: must not creep", scene)


def _light_under_heavy() -> Case:
    light = make_box("a", (0.5, 0.5), (0, 0.25), mass=1.0, friction=0.5)
    heavy = make_box("b", (1.0, 1.0), (0, 1.0), mass=100.0, friction=0.5)
    scene = make_scene([make_ground(friction=0.5), light, heavy])
    return _at_rest("light under heavy", "1 kg under 100 kg: must not move", scene)


def _balance() -> Case:
    plank = make_box("a", (4.0, 0.2), (0.0, 1.1), mass=3.0, friction=0.6)
    near = make_box("b", (0.4, 0.4), (0.8, 1.4), mass=4.0, friction=0.6)
    far = make_box("c", (0.4, 0.4), (-1.6, 1.4), mass=2.0, friction=0.6)
    scene = make_scene([plank, near, far], [Joint(bodies=(None, "a"), position=(0.0, 1.1))])
    return _at_rest("balance", "2 kg at twice the distance of 4 kg on a see-saw: must not move", scene)


CASES: list[Case] = [
    _projectile(),
    _bounces_to_rest(),
    _bounces_down_a_slope(),
    _spinning_bounce(),
    _unequal_disks(),
    _blow_on_a_rod(),
    _corner_impact(),
    _sliding_block("sliding block", math.pi / 6, 0.3),
    _sliding_block("barely slides", 0.5, 0.999 * math.tan(0.5)),
    _sliding_stops(),
    _slip_to_roll(),
    _rolling_disk(),
    _rolling_cart(),
    _chain([1.0], [1.0], [1.5], "pendulum", "a rod on a pivot; DOP853"),
    _chain([1.0, 0.7], [1.0, 2.0], [0.5, 0.3], "double pendulum", "two rods; DOP853"),
    _chain([0.8, 0.6, 0.9], [1.0, 0.5, 2.0], [0.4, -0.2, 0.3], "triple pendulum", "three rods; DOP853"),
    _resting_block("resting block", 0.7),
    _resting_block("barely rests", 1.001 * math.tan(0.5)),
    _light_under_heavy(),
    _balance(),
    _tower(10),
    _tower(30),
    *MECHANISMS,
    *LINKAGES,
    *SLIPPING,
    *CONTACTS,
]
