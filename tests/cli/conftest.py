"""Scenes and motions made by hand: these tests need neither the engine nor the recognizer to be right."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.scene import Scene
from sim.trajectory import Trajectory

# 128 x 96 pixels of page at 32 pixels a metre: a floor, a blue ball and a red box in free space.
SCENE: dict[str, Any] = {
    "format": "sketchsim-scene",
    "version": 1,
    "gravity": [0, 0],
    "bodies": [
        {
            "id": "floor",
            "shape": {"type": "rectangle", "size": [4.0, 0.5]},
            "position": [2, -2.75],
            "anchored": True,
        },
        {
            "id": "ball",
            "shape": {"type": "circle", "radius": 0.5},
            "position": [0.75, -1.5],
            "velocity": [2.0, 0],
            "color": "#0000ff",
        },
        {
            "id": "box",
            "shape": {"type": "rectangle", "size": [0.8, 0.8]},
            "position": [3, -0.45],
            "color": "#ff0000",
        },
    ],
    "view": {"pixels_per_metre": 32, "width": 128, "height": 96},
}


@pytest.fixture
def scene() -> Scene:
    return Scene.from_dict(json.loads(json.dumps(SCENE)))


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(SCENE))
    return path


def _straight(scene: Scene, duration: float = 1.0, fps: float = 20.0) -> Trajectory:
    """Every body at its starting velocity: what the engine must give for a scene without forces."""
    times = np.arange(round(duration * fps) + 1) / fps
    velocities = np.array([body.velocity for body in scene.bodies])
    positions = np.array([body.position for body in scene.bodies]) + times[:, None, None] * velocities
    spins = np.array([body.angular_velocity for body in scene.bodies])
    angles = np.array([body.angle for body in scene.bodies]) + times[:, None] * spins
    n = len(times)
    return Trajectory(
        times=times,
        positions=positions,
        angles=angles,
        velocities=np.broadcast_to(velocities, positions.shape).copy(),
        angular_velocities=np.broadcast_to(spins, angles.shape).copy(),
        body_ids=[body.id for body in scene.bodies],
        energy=np.zeros((n, 3)),
    )


@pytest.fixture
def straight() -> Callable[..., Trajectory]:
    return _straight
