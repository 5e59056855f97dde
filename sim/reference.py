"""The same scene in pymunk: the engine that this project's own is compared with."""

from __future__ import annotations

import ctypes
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.scene import Circle, Scene, Vector
from sim.trajectory import Trajectory

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["convex_pieces", "run_pymunk"]

DEFAULT_RATE = 60.0  # steps a second, as in pymunk's own examples


def run_pymunk(
    scene: Scene, duration: float = 10.0, fps: float = 60.0, rate: float | None = None, iterations: int = 10
) -> Trajectory:
    """Run a scene by pymunk (Chipmunk's fixed steps) and sample it at 0, 1/fps, ... up to duration.

    Pairs have the scene's own rules: friction √(μa μb), elasticity max(ea, eb), and bodies joined by a
    joint do not collide. Overlaps are left as drawn.

    Args:
        rate: steps a second; rounded up to a whole number of steps a sample. 60 without it.
        iterations: of the solver in a step.
    """
    scene.check()
    samples = math.floor(duration * fps * (1 + 1e-12) + 1e-9) + 1
    steps = max(1, math.ceil((rate or DEFAULT_RATE) / fps - 1e-9))
    space, bodies = _build(scene)
    space.iterations = iterations
    data = _run(space, samples, steps, 1 / (fps * steps))
    return _trajectory(scene, bodies, data, np.arange(samples) / fps)


def convex_pieces(vertices: list[Vector]) -> list[list[Vector]]:
    """Cut a simple polygon, either way round, into convex pieces, each counter-clockwise."""
    from sim.engine import load_core

    area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(vertices, [*vertices[1:], vertices[0]], strict=True))
    ordered = list(vertices) if area > 0 else list(reversed(vertices))
    n = len(ordered)
    flat = (ctypes.c_double * (2 * n))(*(c for v in ordered for c in v))
    start, index = (ctypes.c_int32 * (n + 1))(), (ctypes.c_int32 * (3 * n))()
    count = load_core().sim_decompose(flat, n, start, index)
    if count < 0:
        raise MemoryError
    return [[ordered[i] for i in index[start[k] : start[k + 1]]] for k in range(count)]


def _build(scene: Scene) -> tuple[Any, list[Any]]:
    """The space, and its body of each body of the scene."""
    import pymunk

    space = pymunk.Space()
    space.gravity = scene.gravity
    bodies: list[Any] = []
    made: dict[str | None, Any] = {None: space.static_body}
    for b in scene.bodies:
        if b.anchored:
            body = pymunk.Body(body_type=pymunk.Body.STATIC)
        else:
            body = pymunk.Body(*b.mass_properties())
            body.velocity, body.angular_velocity = b.velocity, b.angular_velocity
        body.position, body.angle = b.position, b.angle
        shapes: list[Any]
        if isinstance(b.shape, Circle):
            shapes = [pymunk.Circle(body, b.shape.radius)]
        else:
            shapes = [pymunk.Poly(body, piece) for piece in convex_pieces(b.shape.vertices)]
        for shape in shapes:  # Chipmunk multiplies the pair's values
            shape.friction, shape.elasticity = math.sqrt(b.friction), math.sqrt(b.elasticity)
        space.add(body, *shapes)
        bodies.append(body)
        made[b.id] = body
    for j in scene.joints:
        first, second = made[j.bodies[0]], made[j.bodies[1]]
        if first.body_type == second.body_type == pymunk.Body.STATIC:
            continue
        pivot = pymunk.PivotJoint(first, second, j.position)
        pivot.collide_bodies = False
        space.add(pivot)
    if len({b.elasticity for b in scene.bodies}) > 1:
        space.on_collision(None, None, pre_solve=_greater_elasticity)
    return space, bodies


def _greater_elasticity(arbiter: Any, space: Any, data: Any) -> None:
    arbiter.restitution = max(shape.elasticity for shape in arbiter.shapes) ** 2


def _run(space: Any, samples: int, steps: int, dt: float) -> dict[int, NDArray[np.float64]]:
    """Of each moving body, by pymunk's number: x, y, angle, vx, vy, spin at each sample."""
    from pymunk.batch import BodyFields, Buffer, get_space_bodies

    fields = BodyFields.BODY_ID | BodyFields.POSITION | BodyFields.ANGLE
    fields |= BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
    frames = []
    ids = np.empty(0, dtype=np.int64)
    for k in range(samples):
        buffer = Buffer()
        get_space_bodies(space, fields, buffer)
        frames.append(bytes(buffer.float_buf()))
        if k == 0:
            ids = np.frombuffer(bytes(buffer.int_buf()), dtype=np.int64)
        if k + 1 < samples:
            for _ in range(steps):
                space.step(dt)
    data = np.array([np.frombuffer(f) for f in frames]).reshape(samples, len(ids), 6)
    return {int(number): data[:, k] for k, number in enumerate(ids)}


def _trajectory(
    scene: Scene, bodies: list[Any], data: dict[int, NDArray[np.float64]], times: NDArray[np.float64]
) -> Trajectory:
    n = len(times)
    frames = np.zeros((n, len(bodies), 6))
    energy = np.zeros((n, 3))
    gravity = np.array(scene.gravity)
    for k, (b, body) in enumerate(zip(scene.bodies, bodies, strict=True)):
        if b.anchored:
            frames[:, k, :3] = (*b.position, b.angle)
            continue
        frames[:, k] = f = data[body.id]
        mass, moment = b.mass_properties()
        energy[:, 0] += 0.5 * mass * (f[:, 3] ** 2 + f[:, 4] ** 2) + 0.5 * moment * f[:, 5] ** 2
        energy[:, 1] -= mass * (f[:, :2] @ gravity)
    energy[:, 2] = energy[:, 0] + energy[:, 1]
    return Trajectory(
        times=times,
        positions=frames[:, :, 0:2],
        angles=frames[:, :, 2],
        velocities=frames[:, :, 3:5],
        angular_velocities=frames[:, :, 5],
        body_ids=[b.id for b in scene.bodies],
        energy=energy,
    )
