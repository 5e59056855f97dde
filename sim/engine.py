"""simulate(): the impulse engine of core/ through ctypes."""

from __future__ import annotations

from sim.scene import Scene
from sim.trajectory import Trajectory

__all__ = ["simulate"]


def simulate(
    scene: Scene, duration: float = 10.0, fps: float = 60.0, tolerance: float = 1e-4, engine: str = "impulse"
) -> Trajectory:
    raise NotImplementedError
