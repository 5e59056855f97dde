"""Where the world lies in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.scene import Circle, Scene

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["Camera", "about", "along", "fit", "outside", "reach"]

Array = NDArray[np.float64]

MARGIN = 0.06  # of the picture, left free around a scene that has no page of its own
CLOSER = 3.0
SMALLEST = 60  # a picture shows at most so many times the largest moving body, however far things fly


@dataclass(frozen=True)
class Camera:
    """A fixed camera: world (x, y) [m], y up, to picture (column, row) [pixels], y down.

    Attributes:
        size: of the picture [pixels], width and height.
        scale: [pixels/m].
        corner: the world point in the picture's upper left corner [m].
    """

    size: tuple[int, int]
    scale: float
    corner: tuple[float, float]

    def pixels(self, world: Array) -> Array:
        """Points [m], shape (..., 2), to [pixels]; a pixel's centre is at a half."""
        return (np.asarray(world) - self.corner) * (self.scale, -self.scale)

    def page(self, ink: Array, pixels_per_metre: float) -> Array:
        """Points of the sketch's page [its pixels], y down, to the picture's pixels."""
        return self.pixels(np.asarray(ink) * (1, -1) / pixels_per_metre)


def fit(scene: Scene, size: tuple[int, int], motion: Trajectory | None = None) -> Camera:
    """The sketch's page where the scene has one; else the bodies with the room that their motion takes."""
    view = scene.view
    if view is not None and view.width and view.height:
        low = np.array([0.0, -view.height / view.pixels_per_metre])
        high = np.array([view.width / view.pixels_per_metre, 0.0])
        margin = 0.0
    else:
        low, high = _box_of_interest(scene, motion)
        margin = MARGIN
    extent = np.maximum(high - low, 1e-9)
    scale = float(min(np.array(size) * (1 - 2 * margin) / extent))
    middle = (low + high) / 2
    corner = middle + np.array([-size[0], size[1]]) / (2 * scale)
    return Camera(size, scale, (float(corner[0]), float(corner[1])))


def _box_of_interest(scene: Scene, motion: Trajectory | None) -> tuple[Array, Array]:
    """Lower left and upper right corner [m] of what should be seen.

    Moving bodies where they start; where they go, as far as they stay large enough to be seen; the anchored
    ones as far as they are near (a floor may be a kilometre long).
    """
    moving = [k for k, body in enumerate(scene.bodies) if not body.anchored]
    outlines = [np.array(body.outline()) for body in scene.bodies]
    if not outlines:
        return np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    if not moving:
        points = np.concatenate(outlines)
        return points.min(axis=0), points.max(axis=0)
    points = np.concatenate([outlines[k] for k in moving])
    low, high = points.min(axis=0), points.max(axis=0)
    if motion is not None:
        radii = np.array([reach(scene, k) for k in moving])
        most = max(float(max(high - low)), SMALLEST * 2 * float(radii.max()))
        at = motion.positions[:, moving]
        low, high = _clip(
            (low, high),
            ((at - radii[:, None]).min(axis=(0, 1)), (at + radii[:, None]).max(axis=(0, 1))),
            most,
        )
    around = 0.5 * max(high - low)
    for k, body in enumerate(scene.bodies):
        if body.anchored:
            near = np.clip(outlines[k], low - around, high + around)
            inside = bool(
                np.all(near.max(axis=0) > low - around) and np.all(near.min(axis=0) < high + around)
            )
            if inside:
                low, high = np.minimum(low, near.min(axis=0)), np.maximum(high, near.max(axis=0))
    return low, high


def _clip(start: tuple[Array, Array], motion: tuple[Array, Array], most: float) -> tuple[Array, Array]:
    """The union of both boxes, no longer than `most` on either side and always with all of `start`."""
    low, high = np.minimum(start[0], motion[0]), np.maximum(start[1], motion[1])
    over = np.maximum(high - low - most, 0.0)
    below, above = start[0] - low, high - start[1]
    share = np.divide(below, below + above, out=np.zeros(2), where=below + above > 0)
    return low + over * share, high - over * (1 - share)


def along(camera: Camera, path: Array) -> Camera:
    """A camera of the same scale that takes in all that `camera` would with each point of a path (n, 2) [m]
    in its middle.
    """
    half = np.array(camera.size) / (2 * camera.scale)
    low, high = path.min(axis=0) - half, path.max(axis=0) + half
    width, height = (2 * math.ceil(x / 2) for x in (high - low) * camera.scale)
    return Camera((width, height), camera.scale, (float(low[0]), float(high[1])))


def about(camera: Camera, path: Array, radius: float) -> Camera:
    """A camera of the same size for a still about a path (n, 2) [m], with three times `radius` around it.

    It comes at most CLOSER times as near as `camera`.
    """
    low, high = path.min(axis=0) - 3 * radius, path.max(axis=0) + 3 * radius
    scale = min(CLOSER * camera.scale, *(np.array(camera.size) / np.maximum(high - low, 1e-9)))
    middle = (low + high) / 2
    half = np.array(camera.size) / (2 * scale)
    return Camera(camera.size, float(scale), (float(middle[0] - half[0]), float(middle[1] + half[1])))


def reach(scene: Scene, k: int) -> float:
    """The distance from body k's centre of mass to its farthest point [m]."""
    shape = scene.bodies[k].shape
    if isinstance(shape, Circle):
        return shape.radius
    return float(np.hypot(*np.array(shape.vertices).T).max())


def outside(scene: Scene, motion: Trajectory, camera: Camera) -> list[tuple[str, float]]:
    """Moving bodies that end wholly out of the picture, and when each was last seen [s]."""
    lost = []
    width, height = camera.size
    for k, body in enumerate(scene.bodies):
        if body.anchored:
            continue
        at, r = camera.pixels(motion.positions[:, k]), reach(scene, k) * camera.scale
        seen = (at[:, 0] > -r) & (at[:, 0] < width + r) & (at[:, 1] > -r) & (at[:, 1] < height + r)
        if not seen[-1] and seen[0]:
            lost.append((body.id, float(motion.times[np.flatnonzero(seen)[-1]])))
    return lost
