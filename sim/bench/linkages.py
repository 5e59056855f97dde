"""Reference cases of bodies on pivots alone: trees and loops of them, fixed to the background or free.

Truth: in the coordinates (x, y, angle) of every body, M a + J' f = M g and J a = -dJ/dt v with the pivots' rows J
(Featherstone, Rigid Body Dynamics Algorithms, section 3.6), which solve_ivp's DOP853 integrates to 1e-12; the drift
off the pivots is of that order.
"""

from __future__ import annotations

import math

import numpy as np

from sim.bench.parts import Array, Case, G, make_box, make_disk, make_scene
from sim.scene import Body, Joint, Polygon, Scene, area_properties

__all__ = ["LINKAGES"]


def _solve(scene: Scene, times: Array) -> Array:
    """Poses of the scene's bodies, all of them moving, on their pivots."""
    from scipy.integrate import solve_ivp

    index = {body.id: k for k, body in enumerate(scene.bodies)}
    n, m = len(scene.bodies), len(scene.joints)
    inverse = np.array(
        [[1 / b.mass_properties()[0]] * 2 + [1 / b.mass_properties()[1]] for b in scene.bodies]
    )
    start = np.array([(*b.position, b.angle) for b in scene.bodies])
    arms = []  # of each joint: a body, the pivot in its frame, and the sign of its rows
    for row, joint in enumerate(scene.joints):
        for name, sign in zip(joint.bodies, (1.0, -1.0), strict=True):
            if name is None:
                continue
            c, s = math.cos(start[index[name], 2]), math.sin(start[index[name], 2])
            x, y = np.array(joint.position) - start[index[name], :2]
            arms.append((row, index[name], np.array([c * x + s * y, c * y - s * x]), sign))

    def slope(_: float, state: Array) -> Array:
        q, v = state[: 3 * n].reshape(n, 3), state[3 * n :].reshape(n, 3)
        rows, bias = np.zeros((2 * m, n, 3)), np.zeros(2 * m)
        for row, k, local, sign in arms:
            c, s = math.cos(q[k, 2]), math.sin(q[k, 2])
            arm = np.array([c * local[0] - s * local[1], s * local[0] + c * local[1]])
            rows[2 * row : 2 * row + 2, k] += sign * np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
            bias[2 * row : 2 * row + 2] -= sign * v[k, 2] ** 2 * arm
        free = np.tile([*scene.gravity, 0.0], (n, 1))
        J = rows.reshape(2 * m, 3 * n)
        push = J * inverse.reshape(-1)
        force = np.linalg.solve(push @ J.T, -bias - J @ free.reshape(-1))
        return np.concatenate([v.reshape(-1), free.reshape(-1) + push.T @ force])

    moving = np.array([(*b.velocity, b.angular_velocity) for b in scene.bodies])
    run = solve_ivp(
        slope,
        (0, float(times[-1])),
        np.concatenate([start.reshape(-1), moving.reshape(-1)]),
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
        t_eval=times,
    )
    return np.asarray(run.y[: 3 * n].T.reshape(-1, n, 3))


def _linkage(name: str, about: str, scene: Scene, duration: float) -> Case:
    return Case(name, f"{about}; DOP853", scene, duration, lambda times: _solve(scene, times))


def _pivot(a: str | None, b: str, at: tuple[float, float]) -> Joint:
    return Joint(bodies=(a, b), position=at)


def _spun(bodies: list[Body], rate: float, about: tuple[float, float] = (0.0, 0.0)) -> list[Body]:
    """The bodies as they turn together about a point."""
    for b in bodies:
        b.angular_velocity = rate
        b.velocity = (-rate * (b.position[1] - about[1]), rate * (b.position[0] - about[0]))
    return bodies


def _whirl() -> Case:
    rods = _spun([make_box("a", (0.8, 0.05), (0.4, 0.0)), make_box("b", (0.5, 0.05), (1.05, 0.0))], 12.0)
    joints = [_pivot(None, "a", (0.0, 0.0)), _pivot("a", "b", (0.8, 0.0))]
    return _linkage("whirl", "two rods whirl at two turns a second", make_scene(rods, joints), 3.0)


def _compound_pendulum() -> Case:
    """A right angle hangs by one end, and a disk by its rim from the other."""
    drawn = [(0.0, 0.0), (0.8, 0.0), (0.8, 0.15), (0.15, 0.15), (0.15, 0.6), (0.0, 0.6)]
    _, (x, y), _ = area_properties(Polygon(drawn))
    ell = Polygon([(px - x, py - y) for px, py in drawn])
    at = (x - 0.075, y - 0.525)  # so that the pivot, 0.075 within the upper end, is the origin
    body = Body(id="a", shape=ell, position=at, friction=0.0, elasticity=0.0)
    disk = make_disk("b", 0.2, (0.82, -0.45), mass=0.3)
    joints = [_pivot(None, "a", (0.0, 0.0)), _pivot("a", "b", (0.65, -0.45))]
    return _linkage(
        "compound pendulum", "an angle iron and a disk by its rim", make_scene([body, disk], joints), 4.0
    )


def _heavy_below_light() -> Case:
    rods = [
        make_box("a", (0.6, 0.04), (0.3, 0.0), mass=0.01),
        make_box("b", (0.6, 0.04), (0.9, 0.0), mass=100.0),
    ]
    joints = [_pivot(None, "a", (0.0, 0.0)), _pivot("a", "b", (0.6, 0.0))]
    return _linkage("heavy below light", "100 kg hangs from 10 g", make_scene(rods, joints), 2.0)


def _mobile() -> Case:
    """A beam on a pivot with a rod hanging from each end, and one from one of these: a tree."""
    beam = make_box("a", (1.6, 0.08), (0.0, 0.0), mass=2.0)
    rods = [
        make_box("b", (0.05, 0.5), (-0.75, -0.25), mass=0.5, angular_velocity=0.0),
        make_box("c", (0.05, 0.7), (0.75, -0.35), mass=0.8),
        make_box("d", (0.4, 0.05), (0.95, -0.7), mass=0.4),
    ]
    joints = [
        _pivot(None, "a", (0.0, 0.04)),
        _pivot("a", "b", (-0.75, 0.0)),
        _pivot("a", "c", (0.75, 0.0)),
        _pivot("c", "d", (0.75, -0.7)),
    ]
    return _linkage("mobile", "a tree of four on pivots", make_scene([beam, *rods], joints), 3.0)


def _floppy_star() -> Case:
    """Free of gravity and background, three rods on pivots near a disk's rim, each with a spin of its own."""
    hub = make_disk("a", 0.3, (0.0, 0.0), mass=1.0, angular_velocity=-1.0)
    arms, joints = [], []
    for k in range(3):
        u = (math.cos(2.1 * k), math.sin(2.1 * k))
        rod = make_box("bcd"[k], (0.6, 0.06), (0.55 * u[0], 0.55 * u[1]), angle=2.1 * k, mass=0.3 + 0.2 * k)
        rod.angular_velocity = spin = 2.0 + 0.5 * k
        along = -0.25 + 0.3 * spin  # the pivot goes with the disk, the rod's centre about the pivot
        rod.velocity = (-along * u[1], along * u[0])
        arms.append(rod)
        joints.append(_pivot("a", "bcd"[k], (0.25 * u[0], 0.25 * u[1])))
    bodies = [hub, *arms]
    return _linkage("floppy star", "three rods on a free disk", make_scene(bodies, joints, gravity=0), 2.0)


def _hanging_chain() -> Case:
    """Twelve unequal links, let go a little off the straight line down."""
    bodies, joints, top = [], [], np.zeros(2)
    for k in range(12):
        length, lean = 0.2 + 0.03 * (k % 4), 0.25 - 0.02 * k
        u = length * np.array([math.sin(lean), -math.cos(lean)])
        at = top + u / 2
        bodies.append(
            make_box(
                "abcdefghijkl"[k],
                (length, 0.03),
                (float(at[0]), float(at[1])),
                angle=lean - math.pi / 2,
                mass=0.5 + 0.1 * (k % 3),
            )
        )
        joints.append(
            _pivot("abcdefghijkl"[k - 1] if k else None, "abcdefghijkl"[k], (float(top[0]), float(top[1])))
        )
        top = top + u
    return _linkage("chain of 12", "unequal links hang and swing", make_scene(bodies, joints), 2.0)


def _parallelogram() -> Case:
    """Three cranks of one length carry a bar, so that one loop says nothing new: the bar's centre moves on a circle.
    T = (3 I + M L^2) a'^2 / 2 with I about a crank's pivot, so (3 I + M L^2) a'' = -(3 m / 2 + M) g L sin a."""
    L, m, bar, width, start = 0.8, 0.7, 2.0, 0.05, 1.2
    moment = 3 * m * ((L * L + width * width) / 12 + L * L / 4) + bar * L * L

    def truth(t: Array) -> Array:
        from scipy.integrate import solve_ivp

        def slope(_: float, y: Array) -> Array:
            return np.array([y[1], -(1.5 * m + bar) * G * L * math.sin(y[0]) / moment])

        run = solve_ivp(
            slope, (0, float(t[-1])), (start, 0.0), method="DOP853", rtol=1e-12, atol=1e-13, t_eval=t
        )
        a = run.y[0]
        out = np.zeros((len(t), 4, 3))
        for k in range(3):
            out[:, k] = np.stack([0.9 * k + L / 2 * np.sin(a), -L / 2 * np.cos(a), a], axis=1)
        out[:, 3, :2] = np.stack([0.9 + L * np.sin(a), -L * np.cos(a)], axis=1)
        return out

    s, c = math.sin(start), math.cos(start)
    bodies = [
        make_box(
            "abc"[k],
            (width, L),
            (0.9 * k + L / 2 * s, -L / 2 * c),
            angle=start,
            mass=m,
            moment=m * (L * L + width * width) / 12,
        )
        for k in range(3)
    ]
    bodies.append(make_box("d", (2.2, 0.06), (0.9 + L * s, -L * c), mass=bar))
    joints = [_pivot(None, "abc"[k], (0.9 * k, 0.0)) for k in range(3)]
    joints += [_pivot("abc"[k], "d", (0.9 * k + L * s, -L * c)) for k in range(3)]
    return Case(
        "parallelogram",
        "three equal cranks: a redundant loop; DOP853",
        make_scene(bodies, joints),
        4.0,
        truth,
    )


LINKAGES: list[Case] = [
    _whirl(),
    _compound_pendulum(),
    _heavy_below_light(),
    _mobile(),
    _floppy_star(),
    _hanging_chain(),
    _parallelogram(),
]
