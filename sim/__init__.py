"""Scenes of rigid bodies in the plane, and their motion.

>>> from sim import Scene, simulate
>>> scene = Scene.from_dict({"gravity": [0, -9.81], "bodies": [
...     {"id": "ball", "shape": {"type": "circle", "radius": 0.2}, "position": [0, 10]}]})
>>> simulate(scene, duration=1.0, fps=2).positions[-1, 0].round(3).tolist()
[0.0, 5.095]
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.scene import Body, Circle, InputError, Joint, Polygon, Rectangle, Scene, View

if TYPE_CHECKING:
    from sim.engine import simulate
    from sim.trajectory import Event, Trajectory

__all__ = [
    "Body",
    "Circle",
    "Event",
    "InputError",
    "Joint",
    "Polygon",
    "Rectangle",
    "Scene",
    "Trajectory",
    "View",
    "simulate",
]


def __getattr__(name: str) -> Any:
    # The recognizer needs scenes alone: the engine and numpy load when they are asked for.
    if name == "simulate":
        from sim.engine import simulate

        return simulate
    if name in ("Trajectory", "Event"):
        import sim.trajectory

        return getattr(sim.trajectory, name)
    raise AttributeError(f"module 'sim' has no attribute {name!r}")
