"""Reference cases in which one kind of motion turns into another: what leaves a wall, tips, is struck.

Most have one degree of freedom q until something happens.  With the centre of mass on a curve c(q) and the body
turning as it goes, T = M(q) q'^2 / 2 with M = m |c_q|^2 + I (a body whose angle is q), so that Lagrange's equation is
M q'' = -m c_q . (c_qq q'^2 + g up); solve_ivp's DOP853 solves it to 1e-12.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sim.bench.parts import Array, Case, G, make_box, make_disk, make_ground, make_scene, poses
from sim.bench.phases import Phases
from sim.scene import Body, Joint, Polygon

__all__ = ["MECHANISMS"]

Curve = Callable[
    [float], tuple[tuple[float, float], tuple[float, float]]
]  # q to the first and second derivative of c


def _one_freedom(m: float, moment: float, curve: Curve) -> Callable[[float, Array], Array]:
    def slope(_: float, y: Array) -> Array:
        (x1, y1), (x2, y2) = curve(y[0])
        mass = m * (x1 * x1 + y1 * y1) + moment
        return np.array([y[1], -m * (x1 * x2 * y[1] ** 2 + y1 * (y2 * y[1] ** 2 + G)) / mass])

    return slope


def _box_moment(m: float, width: float, height: float) -> float:
    return m * (width**2 + height**2) / 12


# ---------------------------------------------------------------- leaving what it leans on


def _ladder() -> Case:
    """Slides without friction, its top down a wall and its foot along the floor; leaves the wall; falls on."""
    length, w, m, start = 2.0, 0.1, 1.5, 0.35
    moment = _box_moment(m, length, w)

    def curve(q: float) -> tuple[tuple[float, float], tuple[float, float]]:
        s, c = (
            math.sin(q),
            math.cos(q),
        )  # the two corners that touch are L apart, the centre w / 2 off their line
        first = (length / 2 * c - w / 2 * s, -length / 2 * s + w / 2 * c)
        return first, (-length / 2 * s - w / 2 * c, -length / 2 * c - w / 2 * s)

    leaning = _one_freedom(m, moment, curve)

    def push(_: float, y: Array) -> float:  # of the wall, m x''
        (x1, _y1), (x2, _y2) = curve(y[0])
        return float(x1 * leaning(0, y)[1] + x2 * y[1] ** 2)

    def falling(_: float, y: Array) -> Array:  # y: angle, rate, x, its rate; the floor pushes up alone
        (_x1, y1), (_x2, y2) = curve(y[0])
        return np.array([y[1], -m * y1 * (y2 * y[1] ** 2 + G) / (m * y1 * y1 + moment), y[3], 0.0])

    def truth(t: Array) -> Array:
        phases = Phases(t)
        q, rate = phases.run(leaning, np.array([start, 0.0]), push)
        (x1, _), _second = curve(q)
        x = length / 2 * math.sin(q) + w / 2 * math.cos(q)
        phases.run(falling, np.array([q, rate, x, x1 * rate]))
        out = np.empty((len(t), 1, 3))
        for here, y in phases.states():
            q_, s, c = y[:, 0], np.sin(y[:, 0]), np.cos(y[:, 0])
            out[here, 0, 0] = y[:, 2] if y.shape[1] == 4 else length / 2 * s + w / 2 * c
            out[here, 0, 1] = length / 2 * c + w / 2 * s
            out[here, 0, 2] = math.pi / 2 + q_
        return out

    s, c = math.sin(start), math.cos(start)
    at = (length / 2 * s + w / 2 * c, length / 2 * c + w / 2 * s)
    wall = make_box("wall", (2.0, 8.0), (-1.0, 2.0), anchored=True)
    ladder = make_box("a", (length, w), at, angle=math.pi / 2 + start, mass=m, moment=moment)
    scene = make_scene([make_ground(), wall, ladder])
    return Case("ladder", "slides down a wall, leaves it, falls on; DOP853", scene, 0.8, truth)


def _off_a_ledge(mu: float) -> Case:
    """A disk comes to the edge of a table so slowly that it turns about it; it rolls, then slips."""
    r, v, m, edge = 0.3, 0.8, 2.0, 0.4
    moment = m * r * r / 2
    rolls = mu > 0

    def sticking(
        _: float, y: Array
    ) -> Array:  # y: angle about the edge from straight up, its rate, turn, spin
        turning = G / r * math.sin(y[0]) / (1.5 if rolls else 1.0)
        return np.array([y[1], turning, y[3], -turning if rolls else 0.0])

    def press(y: Array) -> float:
        return float(G * math.cos(y[0]) - r * y[1] ** 2)

    def grip(_: float, y: Array) -> float:
        return mu * press(y) - abs(float(G * math.sin(y[0]) - r * sticking(0, y)[1]))

    def slipping(_: float, y: Array) -> Array:  # friction is up the disk's back, and spins it
        f = mu * press(y)
        return np.array([y[1], (G * math.sin(y[0]) - f) / r, y[3], -2 * f / r])

    def presses(_: float, y: Array) -> float:
        return press(y)

    def truth(t: Array) -> Array:
        reach = edge / v
        out = np.empty((len(t), 1, 3))
        spin = -v / r if rolls else 0.0
        before = t <= reach
        out[before, 0] = np.stack([v * t[before], 0 * t[before] + r, spin * t[before]], axis=1)
        phases = Phases(t)
        phases.now = reach
        y = np.array([0.0, v / r, spin * reach, spin])
        if rolls:
            y = phases.run(sticking, y, grip)
            y = phases.run(slipping, y, presses)
        else:
            y = phases.run(sticking, y, presses)
        for here, part in phases.states():
            a = part[:, 0]
            out[here, 0] = np.stack([edge + r * np.sin(a), r * np.cos(a), part[:, 2]], axis=1)
        later = t > phases.now
        s = t[later] - phases.now
        x, height = edge + r * math.sin(y[0]), r * math.cos(y[0])
        vx, vy = r * y[1] * math.cos(y[0]), -r * y[1] * math.sin(y[0])
        out[later, 0] = np.stack([x + vx * s, height + vy * s - G / 2 * s**2, y[2] + y[3] * s], axis=1)
        return out

    table = make_box("table", (10.0, 4.0), (edge - 5.0, -2.0), anchored=True, friction=mu)
    spin = -v / r if rolls else 0.0
    disk = make_disk(
        "a", r, (0.0, r), velocity=(v, 0.0), angular_velocity=spin, friction=mu, mass=m, moment=moment
    )
    name, about = (
        ("rolls off a ledge", "rolls, slips, leaves") if rolls else ("slides off a ledge", "no friction")
    )
    return Case(
        name,
        f"a disk turns about the edge of a table: {about}; DOP853",
        make_scene([table, disk]),
        1.1,
        truth,
    )


# ---------------------------------------------------------------- rocking and rolling


def _rocking_block() -> Case:
    """Rocks from corner to corner; each landing takes what turns it into the floor (Housner 1963)."""
    w, h, m, start = 0.6, 1.8, 3.0, 0.12
    moment = _box_moment(m, w, h)
    reach, slim = math.hypot(w, h) / 2, math.atan2(w, h)
    about = moment + m * reach**2
    kept = 1 - m * reach**2 / about * (1 - math.cos(2 * slim))

    def truth(t: Array) -> Array:
        phases = Phases(t)
        side, y = 1.0, np.array([start, 0.0])  # y: tilt from flat, on the corner of this side
        sides = []
        while not phases.done:
            y = phases.run(
                lambda _, y: np.array([y[1], -m * G * reach / about * math.sin(slim - y[0])]),
                y,
                lambda _, y: float(y[0]),
            )
            sides.append(side)
            y = np.array([0.0, -kept * y[1]])
            side = -side
        out = np.empty((len(t), 1, 3))
        for sign, (here, part) in zip(sides, phases.states(), strict=True):
            a = slim - part[:, 0]  # of the diagonal from straight up
            x = sign * (w / 2 - reach * np.sin(a))
            out[here, 0] = np.stack([x, reach * np.cos(a), -sign * part[:, 0]], axis=1)
        return out

    a = slim - start
    at = (w / 2 - reach * math.sin(a), reach * math.cos(a))
    block = make_box("a", (w, h), at, angle=-start, mass=m, moment=moment, friction=1.0)
    scene = make_scene([make_ground(friction=1.0), block])
    return Case("rocking block", "from corner to corner, inelastic; DOP853", scene, 2.5, truth)


def _plank_on_a_disk() -> Case:
    """A plank rocks on a fixed disk, rolling without slip: stable, as half its thickness is less than the radius."""
    radius, length, thick, m, start = 0.5, 1.6, 0.2, 2.0, 0.3
    moment, h = _box_moment(m, length, thick), thick / 2

    def curve(q: float) -> tuple[tuple[float, float], tuple[float, float]]:
        s, c = math.sin(q), math.cos(q)  # c = (R + h) n + R q t with t along the plank, n across it
        first = (-h * c - radius * q * s, -h * s + radius * q * c)
        return first, (-(radius - h) * s - radius * q * c, (radius - h) * c - radius * q * s)

    def truth(t: Array) -> Array:
        phases = Phases(t)
        phases.run(_one_freedom(m, moment, curve), np.array([start, 0.0]))
        ((_, y),) = phases.states()
        q, s, c = y[:, 0], np.sin(y[:, 0]), np.cos(y[:, 0])
        return poses((-(radius + h) * s + radius * q * c, (radius + h) * c + radius * q * s, q), times=t)

    s, c = math.sin(start), math.cos(start)
    at = (-(radius + h) * s + radius * start * c, (radius + h) * c + radius * start * s)
    plank = make_box("a", (length, thick), at, angle=start, mass=m, moment=moment, friction=2.0)
    log = make_disk("log", radius, (0.0, 0.0), anchored=True, friction=2.0)
    return Case(
        "plank on a disk", "rocks on it without slipping; DOP853", make_scene([log, plank]), 3.0, truth
    )


def _bowl() -> Case:
    """A disk rolls in a bowl of straight sides: 2/3 g sin along each, (1 + 2 cos d) / 3 of the speed round a bend."""
    r, slopes, sides = 0.2, (-0.9, -0.45, 0.0, 0.45, 0.9), 0.8
    turns = [0.0, *np.cumsum([sides * math.cos(a) for a in slopes])]
    rise = [0.0, *np.cumsum([sides * math.sin(a) for a in slopes])]
    corners = [(x - turns[-1] / 2, y) for x, y in zip(turns, rise, strict=True)]
    bend = r * math.tan(0.225)  # the disk's centre turns so far before the corner
    ways = [sides - bend, sides - 2 * bend, sides - 2 * bend, sides - 2 * bend, sides - bend]
    kept = (1 + 2 * math.cos(0.45)) / 3

    def centre(side: int, s: Array) -> Array:
        """The disk's centre when its point of contact is s along the side."""
        a = slopes[side]
        x = corners[side][0] + s * math.cos(a) - r * math.sin(a)
        return np.stack([x, corners[side][1] + s * math.sin(a) + r * math.cos(a)], axis=-1)

    def truth(t: Array) -> Array:
        out = np.empty((len(t), 1, 3))
        side, s, v, now, angle = 0, 0.3, 0.0, 0.0, 0.0
        while now < t[-1]:
            a = -2 / 3 * G * math.sin(slopes[side])
            low = 0.0 if side == 0 else bend
            high = low + ways[side]
            stops = []
            for target in (low, high):
                root = v * v + 2 * a * (target - s)
                if a == 0:
                    stops += [((target - s) / v, target)] if v else []
                elif root >= 0:
                    stops += [((-v + sign * math.sqrt(root)) / a, target) for sign in (-1, 1)]
            took, end = min((q for q in stops if q[0] > 1e-12), default=(math.inf, 0.0))
            here = (t >= now) & (t <= now + took)
            gone = v * (t[here] - now) + a / 2 * (t[here] - now) ** 2
            out[here, 0, :2] = centre(side, s + gone)
            out[here, 0, 2] = angle - gone / r
            if not math.isfinite(took):
                break
            angle -= (end - s) / r
            now, v = now + took, (v + a * took) * kept
            side += 1 if end == high else -1
            s = bend if end == high else (0.0 if side == 0 else bend) + ways[side]
        return out

    outline = [*corners, (corners[-1][0] + 0.5, -2.0), (corners[0][0] - 0.5, -2.0)]
    middle = np.mean(outline, axis=0)
    shape = Polygon([(float(x - middle[0]), float(y - middle[1])) for x, y in outline])
    # the frame of a polygon is its centroid's: find where that has gone
    offset = np.array(outline[0]) - np.array(shape.vertices[0])
    bowl = Body(id="bowl", shape=shape, position=(float(offset[0]), float(offset[1])), anchored=True)
    bowl.friction, bowl.elasticity = 2.0, 0.0
    x, y = centre(0, np.array(0.3))
    disk = make_disk("a", r, (float(x), float(y)), friction=2.0)
    scene = make_scene([bowl, disk])
    return Case("disk in a bowl", "rolls over straight sides and their bends", scene, 3.0, truth)


# ---------------------------------------------------------------- struck, stopped, linked


def _stop_peg() -> Case:
    """A rod on a pivot swings against a fixed peg and is thrown back with e of its speed."""
    length, w, m, start, e = 1.2, 0.06, 1.0, 1.1, 0.7
    moment = _box_moment(m, length, w)
    about, radius, down = moment + m * length**2 / 4, 0.05, 0.8
    stop = -0.2  # the rod's angle when it touches: the peg's centre is w / 2 + radius beside its middle line

    def truth(t: Array) -> Array:
        phases = Phases(t)
        y = np.array([start, 0.0])
        while not phases.done:
            y = phases.run(
                lambda _, y: np.array([y[1], -m * G * length / 2 / about * math.sin(y[0])]),
                y,
                lambda _, y: float(y[0] - stop),
            )
            y = np.array([stop, -e * y[1]])
        out = np.empty((len(t), 1, 3))
        for here, part in phases.states():
            a = part[:, 0]
            out[here, 0] = np.stack(
                [length / 2 * np.sin(a), -length / 2 * np.cos(a), a - math.pi / 2], axis=1
            )
        return out

    at = (length / 2 * math.sin(start), -length / 2 * math.cos(start))
    rod = make_box("a", (length, w), at, angle=start - math.pi / 2, mass=m, moment=moment, elasticity=e)
    s, c, off = math.sin(stop), math.cos(stop), w / 2 + radius
    peg = make_disk("peg", radius, (down * s - off * c, -down * c - off * s), anchored=True, elasticity=e)
    scene = make_scene([peg, rod], [Joint(bodies=(None, "a"), position=(0.0, 0.0))])
    return Case("stop peg", "a pendulum is thrown back by a peg; DOP853", scene, 3.0, truth)


def _seesaw() -> Case:
    """A ball falls on one arm: j = (1 + e) v / (1/m + d^2 / I); the plank, in balance, turns on at a constant rate."""
    m, r, drop, d, e, thick = 1.0, 0.15, 0.7, 0.9, 0.4, 0.1
    mass, length = 4.0, 2.4
    moment = _box_moment(mass, length, thick)

    def truth(t: Array) -> Array:
        hit, v = math.sqrt(2 * drop / G), math.sqrt(2 * drop * G)
        j = (1 + e) * v / (1 / m + d * d / moment)
        later = np.maximum(t - hit, 0)
        y = thick / 2 + r + drop - G / 2 * t**2 + j / m * later
        return poses((0.0, 0.0, -d * j / moment * later), (d, y, 0.0), times=t)

    plank = make_box("a", (length, thick), (0.0, 0.0), mass=mass, moment=moment, elasticity=e)
    ball = make_disk("b", r, (d, thick / 2 + r + drop), mass=m, elasticity=e)
    scene = make_scene([plank, ball], [Joint(bodies=(None, "a"), position=(0.0, 0.0))])
    return Case("see-saw", "a ball falls on one arm of a plank in balance", scene, 0.6, truth)


def _four_bar() -> Case:
    """A four-bar linkage swings: angles of the three rods with the loop's two equations, by multipliers."""
    lengths, masses, base, width = np.array([0.5, 1.1, 0.8]), np.array([1.0, 2.0, 1.5]), 1.0, 0.04
    moments = np.array([_box_moment(m, a, width) for m, a in zip(masses, lengths, strict=True)])
    # centre of rod k = fixed point + sum over i of part[k, i] (cos, sin) of rod i's angle; the loop closes with `loop`
    part = np.array([[0.5, 0, 0], [1, 0.5, 0], [0, 0, 0.5]]) * lengths
    loop = np.array([1, 1, -1]) * lengths
    fixed = np.array([[0.0, 0.0], [0.0, 0.0], [base, 0.0]])
    first = 2.2

    def assembled() -> Array:
        """Angles of the coupler and the rocker where their circles meet."""
        joint = lengths[0] * np.array([math.cos(first), math.sin(first)])
        to = np.array([base, 0.0]) - joint
        far = float(np.hypot(*to))
        bend = math.acos((lengths[1] ** 2 + far**2 - lengths[2] ** 2) / (2 * lengths[1] * far))
        coupler = math.atan2(to[1], to[0]) + bend
        end = joint + lengths[1] * np.array([math.cos(coupler), math.sin(coupler)]) - np.array([base, 0.0])
        return np.array([first, coupler, math.atan2(end[1], end[0])])

    def slope(_: float, y: Array) -> Array:
        a, w = y[:3], y[3:]
        u = np.stack([np.cos(a), np.sin(a)])  # along each rod
        n = np.stack([-u[1], u[0]])
        mass = np.diag(moments) + sum(masses[k] * np.outer(part[k], part[k]) * (n.T @ n) for k in range(3))
        force = np.zeros(3)
        for k in range(3):
            pull = np.array([0.0, -G]) + u @ (part[k] * w**2)
            force += masses[k] * part[k] * (n.T @ pull)
        rows = n * loop
        matrix = np.block([[mass, rows.T], [rows, np.zeros((2, 2))]])
        found = np.linalg.solve(matrix, np.concatenate([force, u @ (loop * w**2)]))
        return np.concatenate([w, found[:3]])

    def truth(t: Array) -> Array:
        phases = Phases(t)
        phases.run(slope, np.concatenate([assembled(), np.zeros(3)]))
        ((_, y),) = phases.states()
        a = y[:, :3]
        u = np.stack([np.cos(a), np.sin(a)], axis=2)
        centres = fixed + np.einsum("ki,tic->tkc", part, u)
        return np.concatenate([centres, a[..., None]], axis=2)

    a = assembled()
    u = np.stack([np.cos(a), np.sin(a)], axis=1)
    centres, ends = fixed + part @ u, np.cumsum(lengths[:2, None] * u[:2], axis=0)
    rods = [
        make_box(
            "abc"[k],
            (float(lengths[k]), width),
            (float(c[0]), float(c[1])),
            angle=float(a[k]),
            mass=float(masses[k]),
            moment=float(moments[k]),
        )
        for k, c in enumerate(centres)
    ]
    spots = [
        ((None, "a"), (0.0, 0.0)),
        (("a", "b"), ends[0]),
        (("b", "c"), ends[1]),
        ((None, "c"), (base, 0.0)),
    ]
    joints = [Joint(bodies=pair, position=(float(p[0]), float(p[1]))) for pair, p in spots]
    return Case(
        "four-bar",
        "a closed loop of three rods and the background; DOP853",
        make_scene(rods, joints),
        3.0,
        truth,
    )


MECHANISMS: list[Case] = [
    _ladder(),
    _off_a_ledge(0.0),
    _off_a_ledge(0.8),
    _rocking_block(),
    _plank_on_a_disk(),
    _bowl(),
    _stop_peg(),
    _seesaw(),
    _four_bar(),
]
