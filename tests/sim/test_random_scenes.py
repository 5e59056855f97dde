"""Random machines in a closed room: whatever they do, energy does not grow, nothing passes through anything."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sim import Body, Circle, Joint, Polygon, Rectangle, Scene, simulate

Array = NDArray[np.float64]
TOLERANCE = 1e-5


def room(rng: np.random.Generator) -> Scene:
    friction, elasticity = float(rng.choice([0, 0.1, 0.5, 1])), float(rng.choice([0, 0.2, 0.5, 0.9, 1]))
    walls = [((0, -0.5), (12, 1)), ((0, 10.5), (12, 1)), ((-5.5, 5), (1, 12)), ((5.5, 5), (1, 12))]
    bodies = [
        Body(
            id=f"wall{k}", shape=Rectangle((float(w), float(h))), position=(float(x), float(y)), anchored=True
        )
        for k, ((x, y), (w, h)) in enumerate(walls)
    ]
    cells = [(x, y) for x in (-3.3, -1.1, 1.1, 3.3) for y in (1.4, 3.6, 5.8, 8.0)]
    count = int(rng.integers(1, 9))
    for k, cell in enumerate(rng.permutation(len(cells))[:count]):
        bodies.append(
            Body(
                id=f"b{k}",
                shape=shape(rng, float(rng.uniform(0.25, 0.9))),
                position=cells[cell],
                angle=float(rng.uniform(0, 6)),
                velocity=(float(rng.normal(0, 3)), float(rng.normal(0, 3))),
                angular_velocity=float(rng.normal(0, 3)),
                density=float(10 ** rng.uniform(-1, 1)),
            )
        )
    for body in bodies:
        body.friction, body.elasticity = friction, elasticity
    joints = []
    if count > 1 and rng.random() < 0.4:
        for a, b in itertools.pairwise(bodies[4 : 5 + int(rng.integers(1, count))]):
            middle = ((a.position[0] + b.position[0]) / 2, (a.position[1] + b.position[1]) / 2)
            joints.append(Joint(bodies=(a.id, b.id), position=middle))
    return Scene(bodies=bodies, joints=joints, gravity=(0.0, -9.81) if rng.random() < 0.75 else (0.0, 0.0))


def shape(rng: np.random.Generator, size: float) -> Circle | Rectangle | Polygon:
    kind = rng.integers(3)
    if kind == 0:
        return Circle(size)
    if kind == 1:
        return Rectangle((2 * size * float(rng.uniform(0.2, 0.75)), 2 * size * float(rng.uniform(0.2, 0.75))))
    corners = int(rng.integers(3, 8))
    turns = (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) * 2 * math.pi / corners
    return Polygon([(size * math.cos(t), size * math.sin(t)) for t in turns])


def placed(body: Body, position: Array, angle: float) -> tuple[Array, float]:
    if isinstance(body.shape, Circle):
        return np.array([position]), body.shape.radius
    c, s = math.cos(angle), math.sin(angle)
    return np.array(body.shape.vertices) @ np.array([[c, s], [-s, c]]) + position, 0.0


def depth(a: tuple[Array, float], b: tuple[Array, float]) -> float:
    """How far two placed convex shapes overlap, by the axes that could separate them; negative apart [m]."""
    axes = []
    for p, q in ((a[0], b[0]), (b[0], a[0])):
        if len(p) > 1:
            side = np.roll(p, -1, 0) - p
            axes.append(np.stack([side[:, 1], -side[:, 0]], 1))
        else:
            axes.append(q[[np.argmin(np.hypot(*(q - p[0]).T))]] - p[0])
    n = np.concatenate(axes)
    n = n[np.hypot(*n.T) > 1e-12]
    n = np.concatenate([n, -n]) / np.hypot(*np.concatenate([n, -n]).T)[:, None]
    return float(np.min((a[0] @ n.T).max(0) + a[1] - (b[0] @ n.T).min(0) + b[1]))


def close_by(parts: list[tuple[Array, float]]) -> list[list[int]]:
    """Pairs of placed shapes whose boxes overlap, as numbers: no others do."""
    low = np.array([points.min(axis=0) - radius for points, radius in parts])
    high = np.array([points.max(axis=0) + radius for points, radius in parts])
    under = (low[:, None] < high).all(axis=2)
    found: list[list[int]] = np.argwhere(np.triu(under & under.T, 1)).tolist()
    return found


def deepest(scene: Scene, positions: Array, angles: Array) -> float:
    joined = {frozenset(joint.bodies) for joint in scene.joints}
    worst = -math.inf
    for p, angle in zip(positions, angles, strict=True):
        parts = [placed(body, p[k], angle[k]) for k, body in enumerate(scene.bodies)]
        for j, i in close_by(parts):
            if i >= 4 and frozenset((scene.bodies[i].id, scene.bodies[j].id)) not in joined:
                worst = max(worst, depth(parts[i], parts[j]))
    return worst


@pytest.mark.parametrize("seed", range(40))
def test_random_machines_obey_the_laws(seed: int) -> None:
    scene = room(np.random.default_rng(seed))
    run = simulate(scene, duration=3.0, fps=60, tolerance=TOLERANCE)
    assert np.isfinite(run.positions).all()
    assert np.abs(run.positions[:, 4:, 0]).max() < 5.5
    exact = run.profile["crowd_steps"] == 0
    total, scale = run.energy[:, 2], max(1.0, float(np.abs(run.energy).max()))
    assert np.max(total - np.minimum.accumulate(total)) < (1e-5 if exact else 1e-2) * scale
    assert deepest(scene, run.positions[::10], run.angles[::10]) < (10 * TOLERANCE if exact else 0.2)


def test_most_random_machines_need_no_crowd() -> None:
    runs = [
        simulate(room(np.random.default_rng(seed)), duration=2.0, tolerance=TOLERANCE) for seed in range(40)
    ]
    assert sum(run.profile["crowd_steps"] == 0 for run in runs) >= 36
