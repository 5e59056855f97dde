"""The .html output: one file with the motion and a player of it, without network or framework."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from cli.render.animation import PLAIN, Extras
from cli.render.backdrop import grid_step
from cli.render.figure import Figure, carried
from cli.render.ink import Ink
from cli.render.style import RGB
from sim.scene import Circle, Joint

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["page"]

Array = NDArray[np.float64]

PLAYER = Path(__file__).with_name("player")
SCRIPTS = ("recording", "stage", "graphs", "controls")


def page(
    figure: Figure, motion: Trajectory, title: str, ink: Ink | None = None, extras: Extras = PLAIN
) -> bytes:
    """The whole page as UTF-8. extras: what is switched on at first, and what body stays in the middle."""
    # Within a script element only these two could end it or start a comment.
    data = msgspec.json.encode(_data(figure, motion, ink or [], extras)).decode().replace("<", "\\u003c")
    parts = {
        "title": title.replace("&", "&amp;").replace("<", "&lt;"),
        "style": (PLAYER / "player.css").read_text("utf-8").strip(),
        "script": "\n".join((PLAYER / f"{name}.js").read_text("utf-8") for name in SCRIPTS).strip(),
        "data": data,
    }
    html = (PLAYER / "player.html").read_text("utf-8")
    before, *rest = html.split("{{")
    out = [before]
    for piece in rest:
        name, _, after = piece.partition("}}")
        out += [parts[name], after]
    return "".join(out).encode()


def _data(figure: Figure, motion: Trajectory, ink: Ink, extras: Extras) -> dict[str, Any]:
    scene, camera, style, bar = figure.scene, figure.camera, figure.style, figure.bar
    samples = np.concatenate(
        [motion.positions, motion.angles[..., None], motion.velocities, motion.angular_velocities[..., None]],
        axis=2,
    )
    interval = float(motion.times[1] - motion.times[0]) if len(motion) > 1 else 1.0
    return {
        "fps": 1 / interval,
        "count": len(motion),
        "gravity": list(scene.gravity),
        "size": list(camera.size),
        "scale": camera.scale,
        "corner": list(camera.corner),
        "follow": -1 if extras.follow is None else extras.follow,
        "body": _farthest(motion) if extras.follow is None else extras.follow,
        "vectors": extras.vectors,
        "trails": extras.trails,
        "bar": {"metres": bar.metres, "label": bar.label, "at": [bar.left, bar.bottom]},
        "paper": _css(style.paper),
        "dark": _css(style.ink),
        "drawn": _css(style.drawn),
        "velocityPaint": _css(style.velocity),
        "forcePaint": _css(style.force),
        "bodies": [_body(figure, k) for k in range(len(scene.bodies))],
        "pivots": [_pivot(figure, joint) for joint in scene.joints],
        "grid": _grid(figure),
        "ink": [_stroke(figure, body, stroke) for body, stroke in ink],
        "movesInk": style.moves_ink,
        "motion": base64.b64encode(samples.astype("<f4").tobytes()).decode(),
    }


def _farthest(motion: Trajectory) -> int:
    """The body whose way is the longest; 0 where there is none."""
    steps = np.hypot(*np.moveaxis(np.diff(motion.positions, axis=0), 2, 0))
    return int(np.argmax(steps.sum(axis=0))) if steps.size else 0


def _body(figure: Figure, k: int) -> dict[str, Any]:
    body = figure.scene.bodies[k]
    mass, moment = body.mass_properties()
    paints = figure.paints[k]
    round_ = isinstance(body.shape, Circle)
    return {
        "id": body.id,
        "anchored": body.anchored,
        "angle": body.angle,
        "radius": body.shape.radius if isinstance(body.shape, Circle) else 0,
        "outline": [] if round_ else [list(p) for p in body.shape.vertices],  # type: ignore[union-attr]
        "mass": mass,
        "moment": moment,
        "color": _css(paints.color),
        "fill": _css(paints.filling),
        "edge": _css(paints.edge),
        "stripes": _css(paints.stripes),
    }


def _pivot(figure: Figure, joint: Joint) -> dict[str, Any]:
    """The body that carries the pivot, and the point in its frame; on the page where no body moves."""
    bodies = figure.scene.bodies
    moving = [k for k, body in enumerate(bodies) if body.id in joint.bodies and not body.anchored]
    at = (
        carried(bodies[moving[0]], np.array([joint.position]))[0].tolist() if moving else list(joint.position)
    )
    k = moving[0] if moving else -1
    return {"body": k, "at": at, "world": list(joint.position), "ground": None in joint.bodies}


def _stroke(figure: Figure, body: int | None, stroke: Array) -> dict[str, Any]:
    """A stroke to the millimetre of a page of ten metres: in the frame of the body that takes it along, if any."""
    if body is None or not figure.style.moves_ink:
        return {"body": -1, "points": np.round(stroke, 3).tolist()}
    return {"body": body, "points": np.round(carried(figure.scene.bodies[body], stroke), 3).tolist()}


def _grid(figure: Figure) -> dict[str, Any] | None:
    if figure.style.grid is None:
        return None
    return {"step": grid_step(figure.camera), "color": _css(figure.style.grid)}


def _css(color: RGB) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)
