"""Scenes that are hard for any engine, by name."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any, NamedTuple

from sim.scene import Scene

__all__ = ["Case", "cases", "random_cases"]

G = 9.81
Parts = list[dict[str, Any]]


class Case(NamedTuple):
    """A scene to run, and what must hold of it.

    free: nothing outside acts on it, so its momentum stays.
    """

    name: str
    scene: Scene
    duration: float
    free: bool = False


def box(name: str, x: float, y: float, w: float = 1.0, h: float = 1.0, **more: Any) -> dict[str, Any]:
    return {"id": name, "shape": {"type": "rectangle", "size": [w, h]}, "position": [x, y], **more}


def ball(name: str, x: float, y: float, r: float = 0.5, **more: Any) -> dict[str, Any]:
    return {"id": name, "shape": {"type": "circle", "radius": r}, "position": [x, y], **more}


def polygon(
    name: str, vertices: list[tuple[float, float]], x: float, y: float, **more: Any
) -> dict[str, Any]:
    shape = {"type": "polygon", "vertices": [list(v) for v in vertices]}
    return {"id": name, "shape": shape, "position": [x, y], **more}


def ground(**more: Any) -> dict[str, Any]:
    return box("ground", 0, -1, 200, 2, anchored=True, **more)


def pivot(a: str | None, b: str | None, x: float, y: float) -> dict[str, Any]:
    return {"bodies": [a, b], "position": [x, y]}


def make(
    name: str,
    bodies: Parts,
    duration: float,
    *,
    joints: Parts | None = None,
    gravity: tuple[float, float] = (0, -G),
    free: bool = False,
    **common: Any,
) -> Case:
    d = {"bodies": [{**common, **b} for b in bodies], "joints": joints or [], "gravity": list(gravity)}
    return Case(name, Scene.from_dict(d), duration, free)


# ---------------------------------------------------------------- one function a kind


def stack(count: int) -> Case:
    return make(f"stack of {count}", [ground()] + [box(f"b{i}", 0, 0.5 + i) for i in range(count)], 5)


def pyramid(rows: int) -> Case:
    bricks = [
        box(f"b{r}-{k}", 1.1 * (k - r / 2), 0.5 + rows - 1 - r) for r in range(rows) for k in range(r + 1)
    ]
    return make(f"pyramid of {rows} rows", [ground(), *bricks], 5)


def mass_ratio(ratio: float) -> Case:
    bodies = [ground(), box("light", 0, 0.5, mass=1), box("heavy", 0, 1.5, mass=ratio)]
    return make(f"{ratio:.0e} kg on 1 kg", bodies, 5)


def chain(links: int) -> Case:
    bodies = [box(f"l{i}", 0.2 * (i + 0.5), 0, 0.2, 0.05) for i in range(links)]
    joints = [pivot(f"l{i - 1}" if i else None, f"l{i}", 0.2 * i, 0) for i in range(links)]
    bodies.append(ball("end", 0.2 * links + 0.3, 0, 0.3, density=20))
    joints.append(pivot(f"l{links - 1}", "end", 0.2 * links, 0))
    return make(f"chain of {links} with a heavy end", bodies, 5, joints=joints)


def bridge(planks: int) -> Case:
    bodies = [box(f"p{i}", i + 0.5, 0, 1, 0.2) for i in range(planks)]
    joints = [pivot(f"p{i - 1}" if i else None, f"p{i}", i, 0) for i in range(planks)]
    joints.append(pivot(f"p{planks - 1}", None, planks, 0))
    load = [box(f"w{i}", 3 + 4 * i, 1.5, 1, 1, density=3) for i in range(planks // 4)]
    return make(f"bridge of {planks} planks", bodies + load, 8, joints=joints)


def laden_bridge() -> Case:
    """A heap on a taut bridge: the crowd's pivots."""
    planks = [box(f"p{i}", 0.225 + 0.45 * i, 3, 0.5, 0.1) for i in range(12)]
    ends = [None, *(str(p["id"]) for p in planks), None]
    joints = [pivot(ends[i], ends[i + 1], 0.45 * i, 3) for i in range(13)]
    heap = [
        box(f"b{k}", 0.3 + 0.4 * (k % 12), 3.4 + 0.4 * (k // 12), 0.3, 0.3, angle=0.7 * math.sin(k))
        for k in range(25)
    ]
    return make("heap on a taut bridge", [ground(), *planks, *heap], 6, joints=joints)


def four_bar() -> Case:
    bars = [box("crank", 0, 0.5, 0.2, 1), box("coupler", 1, 1, 2, 0.2), box("rocker", 2, 0.25, 0.2, 1.5)]
    joints = [pivot(None, "crank", 0, 0), pivot("crank", "coupler", 0, 1), pivot("coupler", "rocker", 2, 1)]
    joints.append(pivot("rocker", None, 2, -0.5))
    return make("four-bar linkage", bars, 10, joints=joints, gravity=(1, -G))


def parallelogram() -> Case:
    """Three cranks of one length carry a bar: one of the loops says nothing new."""
    cranks = [box(f"c{i}", 2 * i, 0.5, 0.2, 1) for i in range(3)]
    joints = [pivot(None, f"c{i}", 2 * i, 0) for i in range(3)] + [
        pivot(f"c{i}", "bar", 2 * i, 1) for i in range(3)
    ]
    return make("redundant loops", [*cranks, box("bar", 2, 1, 5, 0.2)], 10, joints=joints, gravity=(1, -G))


def jammed_wheel() -> Case:
    sides = [box("l", -1.49, 0, 2, 4, anchored=True), box("r", 1.49, 0, 2, 4, anchored=True)]
    return make("wheel jammed between walls", [*sides, ball("w", 0, 0, 0.5, angular_velocity=5)], 5)


def wedge() -> Case:
    sides = [box("l", -1.2, 1, 2, 2, anchored=True), box("r", 1.2, 1, 2, 2, anchored=True)]
    tip = polygon("w", [(-0.5, 1), (0, -1), (0.5, 1)], 0, 3.3, density=50, velocity=[0, -5])
    return make("wedge forced into a gap", [*sides, tip], 5, friction=0.2)


def projectile(shape: str) -> Case:
    wall = box("wall", 3, 0, 0.001, 20, anchored=True)
    maker = ball if shape == "ball" else box
    shots = [
        maker(f"s{i}", -1 - 0.3 * i, -4 + i, 0.1, velocity=[1000, 40 * i], angular_velocity=20 * i)
        for i in range(8)
    ]
    return make(f"{shape} shots of 1000 m/s on a 1 mm wall", [wall, *shots], 2, gravity=(0, 0))


def grazing() -> Case:
    balls = [ball(f"a{i}", -2, 3 * i + 1.0 - 1e-9 * 10**i, velocity=[5, 0]) for i in range(6)]
    return make(
        "grazing contacts", balls + [ball(f"b{i}", 0, 3 * i) for i in range(6)], 3, gravity=(0, 0), free=True
    )


def corner_on_corner() -> Case:
    s = math.sqrt(2)
    bodies = [
        ground(),
        box("a", 0, s / 2, angle=math.pi / 4),
        box("b", 0, 3 * s / 2 + 0.1, angle=math.pi / 4),
    ]
    return make("corner on corner", bodies, 5)


def break_shot(elasticity: float) -> Case:
    rack = [
        ball(f"r{i}-{k}", i * 0.1 * math.sqrt(3), 0.2 * (k - i / 2), 0.1)
        for i in range(6)
        for k in range(i + 1)
    ]
    cue = ball("cue", -2, 0.013, 0.1, velocity=[20, 0])
    return make(
        f"break of 21 balls, elasticity {elasticity:g}",
        [cue, *rack],
        3,
        gravity=(0, 0),
        free=True,
        elasticity=elasticity,
        friction=0.1,
    )


def pile(friction: float, elasticity: float) -> Case:
    rng = random.Random(11)
    walls = [box("l", -3.5, 5, 1, 14, anchored=True), box("r", 3.5, 5, 1, 14, anchored=True)]
    bodies: Parts = []
    for i in range(60):
        x, y, w, h = -2.5 + i % 6, 0.6 + 0.7 * (i // 6), rng.uniform(0.2, 0.5), rng.uniform(0.2, 0.5)
        bodies.append(
            ball(f"b{i}", x, y, w / 2) if i % 2 else box(f"b{i}", x, y, w, h, angle=rng.uniform(0, 3))
        )
    name = f"pile, friction {friction:g}, elasticity {elasticity:g}"
    return make(name, [ground(), *walls, *bodies], 6, friction=friction, elasticity=elasticity)


def all_sizes() -> Case:
    x, bodies = 0.0, []
    for k in range(7):
        r = 10.0 ** (k - 3)
        x += 2.5 * r
        bodies.append(box(f"b{k}", x, 1.5 * r, 2 * r, 2 * r, angle=0.1))
        x += 2.5 * r
    return make("1 mm to 1 km", [box("g", 0, -1e4, 1e6, 2e4, anchored=True), *bodies], 20)


def slivers() -> Case:
    rng = random.Random(5)
    bodies = [ground()]
    for i in range(12):
        length, thickness = rng.uniform(0.5, 1.5), 10.0 ** rng.uniform(-6, -3)
        v = [(0.0, 0.0), (length, 0.0), (length * 0.7, thickness), (length * 0.2, thickness * 0.9)]
        bodies.append(
            polygon(
                f"s{i}", v, rng.uniform(-2, 2), 1 + 0.3 * i, angle=rng.uniform(-1, 1), mass=1.0, moment=0.1
            )
        )
    return make("slivers", bodies, 5)


def inside_one_another() -> Case:
    bodies = [ground(), box("big", 0, 2, 4, 4), ball("in", 0.5, 2.5, 0.3), box("deep", 0.6, 2.4, 0.5, 0.5)]
    return make("bodies drawn inside one another", [*bodies, box("edge", 2.05, 2.5, 0.6, 0.6)], 5)


def gravity(g: tuple[float, float], name: str) -> Case:
    c = pile(0.5, 0.3)
    bodies = [b for b in c.scene.to_dict()["bodies"] if b["id"] not in ("ground", "l", "r")]
    walls = [
        box("bottom", 0, -1, 60, 2, anchored=True),
        box("top", 0, 30, 60, 2, anchored=True),
        box("left", -29, 15, 2, 40, anchored=True),
        box("right", 29, 15, 2, 40, anchored=True),
    ]
    return make(f"gravity {name}", [*walls, *bodies], 5, gravity=g)


def an_hour() -> Case:
    bodies = [ground(), *(box(f"b{i}", 0.1 * i, 0.5 + i) for i in range(4)), ball("c", 5, 0.5)]
    return make("an hour at rest", bodies, 3600)


def hill(count: int) -> Case:
    top = [(x, 0.6 * math.sin(x)) for x in (-10 + 20 * k / count for k in range(count + 1))]
    outline = [(-10.0, -2.0), (10.0, -2.0), *reversed(top)]
    balls = [
        ball(f"b{i}", -8 + 2 * i, 2.5, 0.3) if i % 2 else box(f"b{i}", -8 + 2 * i, 2.5, 0.5, 0.5)
        for i in range(9)
    ]
    return make(f"hills of {count} vertices", [polygon("hill", outline, 0, 0, anchored=True), *balls], 6)


def cases() -> list[Case]:
    """All of them, in a fixed order."""
    simple: list[Callable[[], Case]] = [
        four_bar,
        parallelogram,
        jammed_wheel,
        wedge,
        grazing,
        corner_on_corner,
    ]
    return [
        *(stack(n) for n in (10, 30, 50)),
        pyramid(20),
        *(mass_ratio(10.0**k) for k in (2, 4, 6)),
        chain(100),
        bridge(16),
        laden_bridge(),
        *(f() for f in simple),
        projectile("ball"),
        projectile("box"),
        *(break_shot(e) for e in (0.0, 0.5, 1.0)),
        *(pile(f, e) for f, e in ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (10.0, 0.3))),
        all_sizes(),
        slivers(),
        inside_one_another(),
        gravity((-G, 0), "sideways"),
        gravity((0, -1000), "of 1000 m/s²"),
        gravity((0, 0), "none"),
        hill(400),
        an_hour(),
    ]


# ---------------------------------------------------------------- scenes as sketches have them


def sketch(seed: int) -> Case:
    """Bodies, anchors, pivots and overlaps as hands draw them."""
    rng = random.Random(seed)
    bodies: Parts = [ground()] if rng.random() < 0.7 else []
    joints: Parts = []
    for i in range(rng.randrange(1, 14)):
        x, y, r = rng.uniform(-4, 4), rng.uniform(0.2, 7), rng.uniform(0.15, 0.9)
        kind, more = (
            rng.random(),
            {"anchored": rng.random() < 0.15, "angle": rng.choice([0.0, rng.uniform(-3, 3)])},
        )
        if kind < 0.35:
            body = ball(f"b{i}", x, y, r, **more)
        elif kind < 0.75:
            body = box(f"b{i}", x, y, 2 * r, rng.uniform(0.1, 1.2), **more)
        else:
            n = rng.randrange(3, 12)
            v = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)) for k in range(n)]
            s = [r * rng.uniform(0.4, 1) for _ in v]
            body = polygon(f"b{i}", [(q * a, q * b) for q, (a, b) in zip(s, v, strict=True)], x, y, **more)
        if rng.random() < 0.1:
            body["velocity"] = [rng.uniform(-20, 20), rng.uniform(-20, 20)]
        bodies.append(body)
        if rng.random() < 0.25:
            other = rng.choice([None, *(b["id"] for b in bodies[:-1])])
            joints.append(pivot(other, body["id"], x + rng.uniform(-r, r) / 2, y))
    material: dict[str, Any] = {
        "friction": rng.choice([0.0, 0.3, 0.5, 0.9]),
        "elasticity": rng.choice([0.0, 0.3, 0.9]),
    }
    return make(
        f"sketch {seed}", bodies, 4, joints=joints, gravity=rng.choice([(0, -G), (0, -G), (0, 0)]), **material
    )


def random_cases(count: int, seed: int = 0) -> list[Case]:
    """As many scenes of the kind that sketches give; some hold bodies in one another, or jammed ones."""
    return [sketch(seed + k) for k in range(count)]
