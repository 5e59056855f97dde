"""What reference cases are made of: a scene, its truth, and the parts of scenes that several of them share."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.scene import Body, Circle, Joint, Rectangle, Scene

__all__ = [
    "Array",
    "Case",
    "G",
    "along",
    "case_error",
    "flights",
    "make_box",
    "make_disk",
    "make_ground",
    "make_scene",
    "poses",
]

Array = NDArray[np.float64]
G = 9.81


@dataclass(frozen=True)
class Case:
    """A scene with known motion.

    Attributes:
        name: a word or two.
        about: what moves, and where the truth comes from.
        scene: with moving bodies "a", "b", ... and anchored ones.
        duration: [s].
        truth: sample times [s], shape (n,), to poses (x, y, angle) of the moving bodies in the scene's order,
            shape (n, moving, 3).
    """

    name: str
    about: str
    scene: Scene
    duration: float
    truth: Callable[[Array], Array]
    _known: dict[bytes, Array] = field(default_factory=dict, repr=False, compare=False)

    def at(self, times: Array) -> Array:
        """The truth at sample times, solved for once: it is asked for at many tolerances."""
        key = times.tobytes()
        if key not in self._known:
            self._known[key] = self.truth(times)
        return self._known[key]


def case_error(case: Case, times: Array, positions: Array, angles: Array) -> float:
    """The largest error over samples and bodies [m]: of position, plus radius times that of the angle."""
    moving = [k for k, b in enumerate(case.scene.bodies) if not b.anchored]
    want = case.at(times)
    reach = np.array([_reach(case.scene.bodies[k]) for k in moving])
    off = np.hypot(positions[:, moving, 0] - want[..., 0], positions[:, moving, 1] - want[..., 1])
    return float(np.max(off + reach * np.abs(angles[:, moving] - want[..., 2])))


def _reach(body: Body) -> float:
    return body.shape.radius if isinstance(body.shape, Circle) else math.hypot(*body.shape.vertices[0])


def make_disk(name: str, radius: float, at: tuple[float, float], **more: object) -> Body:
    return Body(id=name, shape=Circle(radius), position=at, **{"friction": 0.0, "elasticity": 0.0, **more})  # type: ignore[arg-type]


def make_box(name: str, size: tuple[float, float], at: tuple[float, float], **more: object) -> Body:
    return Body(id=name, shape=Rectangle(size), position=at, **{"friction": 0.0, "elasticity": 0.0, **more})  # type: ignore[arg-type]


def make_ground(slope: float = 0.0, **more: object) -> Body:
    """A wide slab whose upper side goes through the origin, falling to the right by `slope` [rad]."""
    return make_box(
        "ground", (60.0, 2.0), (-math.sin(slope), -math.cos(slope)), angle=-slope, anchored=True, **more
    )


def make_scene(bodies: Sequence[Body], joints: Sequence[Joint] = (), gravity: float = G) -> Scene:
    return Scene(bodies=list(bodies), joints=list(joints), gravity=(0.0, -gravity))


def along(slope: float, s: Array, height: float) -> tuple[Array, Array]:
    """The point at s down the slope and `height` above it."""
    return s * math.cos(slope) + height * math.sin(slope), -s * math.sin(slope) + height * math.cos(slope)


def poses(*bodies: tuple[Array | float, Array | float, Array | float], times: Array) -> Array:
    return np.stack([np.stack([np.broadcast_to(v, times.shape) for v in b], axis=1) for b in bodies], axis=1)


def flights(
    t: Array, drop: float, e: float, up: float = 0.0, gravity: float = G
) -> Iterator[tuple[NDArray[np.bool_], Array, Array, float, float]]:
    """The flights of a point from `drop` above a floor at speed `up`, which bounces with restitution e until it rests.

    Yields of each: which samples are in it, the times since it began and the heights at those, how long it
    lasts [s] and how fast it ends [m/s].
    """
    now, height = 0.0, drop
    while (length := (up + math.sqrt(up * up + 2 * gravity * height)) / gravity) > 1e-13:
        here = (t >= now) & (t < now + length)
        since, down = t[here] - now, gravity * length - up
        yield here, since, height + up * since - gravity / 2 * since**2, length, down
        now, height, up = now + length, 0.0, e * down
