"""A recognition in a person's words: each body, from which strokes, why this and not the next reading."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.scene import Scene
from sketch.reading import Reading

if TYPE_CHECKING:
    from sketch.recognize import Recognition

__all__ = ["explain"]

_MEANING = {
    "anchor": "an anchor, an X: it fixes the body under it",
    "gravity": "gravity, along an arrow",
    "unread": "without a meaning: left out",
}


def explain(recognition: Recognition) -> str:
    """One line a reading, and one for what speaks for it; then the scene's notes."""
    scene = recognition.scene
    bodies = {tuple(b.strokes or ()): b for b in scene.bodies}
    lines = []
    for reading in recognition.readings:
        body = bodies.get(reading.strokes) if reading.solid else None
        if body is not None:
            what = f"{body.id}: {_shape(reading)}"
            if body.anchored:
                what += ", anchored"
        else:
            what = _MEANING.get(reading.kind) or _pivot(reading, scene)
        lines.append(f"{what}, from {reading.named}")
        lines.append("    " + _why(reading))
    return "\n".join(lines + [f"note: {text}" for text in scene.notes])


def _shape(reading: Reading) -> str:
    n = len(reading.outline)
    if reading.kind == "polygon":
        return {3: "a triangle", 5: "a pentagon", 6: "a hexagon"}.get(n, f"a polygon of {n} sides")
    if reading.kind == "bar":
        return "a straight open line" if n == 2 else f"an open line of {n - 1} pieces"
    return f"a {reading.kind}"


def _pivot(reading: Reading, scene: Scene) -> str:
    """What turns about a pivot: the bodies of the joints that stand where it was drawn."""
    ppm = scene.view.pixels_per_metre if scene.view else 1.0
    x, y = reading.outline.mean(axis=0) / ppm
    joined = {name for j in scene.joints if math.dist(j.position, (x, -y)) * ppm < 1e-6 for name in j.bodies}
    *most, last = [body.id for body in scene.bodies if body.id in joined] or [""]
    if None in joined:
        return f"a pivot that holds {last} to the page"
    return f"a pivot of {', '.join(most)} and {last}" if most else "a pivot, together with another"


def _why(reading: Reading) -> str:
    if reading.forced is not None:
        return f"because it was said to be: {reading.forced}"
    if reading.kind == "unread":
        return "because no shape says where the ink is in fewer words than the ink itself"
    rivals = [f"{_rival(kind)} ({_percent(score)})" for kind, score in reading.alternatives if score >= 0.001]
    text = f"{_percent(reading.score)} sure, " + (
        f"or else {' or '.join(rivals[:2])}" if rivals else "nothing else comes near"
    )
    if reading.error:
        text += f"; its place is known to {reading.error:.1f} pixels"
    text += f"; {reading.gain:.0f} nats shorter to say than the bare ink"
    return text + (f", {reading.margin:.0f} than the next reading" if reading.margin < reading.gain else "")


def _rival(kind: str) -> str:
    return {"unread": "no meaning", "gravity": "the arrow", "anchor": "an X"}.get(kind, f"a {kind}")


def _percent(share: float) -> str:
    return f"{share:.1%}" if share > 0.99 or share < 0.01 else f"{share:.0%}"
