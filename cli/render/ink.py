"""Which of the person's strokes belong to which body: they can move with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.scene import Scene

if TYPE_CHECKING:
    from sketch.recognize import Recognition

__all__ = ["Ink", "world_strokes"]

Array = NDArray[np.float64]

Ink = list[tuple[int | None, Array]]  # strokes [m], shape (n, 2), each with its body's index or None


def world_strokes(recognition: Recognition) -> Ink:
    """All strokes in the scene's frame, as they were drawn.

    A body takes its own strokes along, and those of the pivots that it carries; anchored bodies, anchors, the
    arrow and what was not read stay.
    """
    scene = recognition.scene
    scale = scene.view.pixels_per_metre if scene.view is not None else 100.0
    owners: dict[int, int] = {}
    for k, body in enumerate(scene.bodies):
        if not body.anchored:
            owners |= dict.fromkeys(body.strokes or (), k)
    for reading in recognition.readings:
        if reading.kind == "pivot" and scene.joints and len(reading.outline):
            carrier = _carrier(scene, reading.outline.mean(axis=0) * (1, -1) / scale)
            for stroke in reading.strokes:
                if carrier is not None:
                    owners.setdefault(stroke, carrier)
    return [(owners.get(i), s.points * (1, -1) / scale) for i, s in enumerate(recognition.sketch.strokes)]


def _carrier(scene: Scene, at: Array) -> int | None:
    """The moving body of the pivot that is nearest to a point [m]."""
    joint = min(scene.joints, key=lambda j: float(np.hypot(*(np.array(j.position) - at))))
    moving = [k for k, body in enumerate(scene.bodies) if body.id in joint.bodies and not body.anchored]
    return moving[0] if moving else None
