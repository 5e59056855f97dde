"""`sketchsim recognize`: what a drawing was taken for."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from cli.arguments import number
from cli.outputs import STDOUT, Outputs, check_outputs

if TYPE_CHECKING:
    from sketch.recognize import Recognition

__all__ = ["configure"]

EPILOG = """\
examples:
  sketchsim recognize cart.json                    the scene as JSON on standard output
  sketchsim recognize photo.jpg -o scene.json --overlay seen.png
  sketchsim recognize cart.json --explain          every reading, its score and what else it could be
"""


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Read a drawing as a scene of bodies, anchors, pivots and gravity."
    p.epilog = EPILOG
    p.add_argument(
        "input", metavar="INPUT", help="strokes or a picture, told by content; - is standard input"
    )
    p.add_argument("-o", dest="output", metavar="OUT", help="scene.json; - is standard output")
    p.add_argument("--overlay", metavar="PNG", help="a picture of what was recognized, over the ink")
    p.add_argument(
        "--explain", action="store_true", help="print every reading, its score and the alternatives"
    )
    p.add_argument(
        "--scale", type=number(0, 1e9), metavar="PX_PER_M", help="pixels of the drawing in a metre"
    )
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    output = options.output or (None if options.overlay or options.explain else STDOUT)
    if output is not None:
        check_outputs([output], (".json",), [options.input])
    if options.overlay is not None:
        check_outputs([options.overlay], (".png",), [options.input])
    from cli.inputs import is_scene, read, recognize_bytes
    from cli.progress import note
    from sim.scene import InputError

    data = read(options.input)
    if is_scene(data):
        raise InputError("", f"{options.input} is a scene already", "`sketchsim simulate` runs it")
    recognition = recognize_bytes(data, options.scale)
    for text in recognition.scene.notes:
        note(text)
    with Outputs() as files:
        if output is not None:
            files.write(output, recognition.scene.to_json())
        if options.overlay is not None:
            from cli.render.overlay import overlay
            from cli.render.still import png

            files.write(options.overlay, png(overlay(recognition)))
    if options.explain:
        print(explanation(recognition), file=sys.stderr if output == STDOUT else sys.stdout)
    return 0


def explanation(recognition: Recognition) -> str:
    """Every reading in a line: kind, score, strokes, what else; then what the scene was made of them."""
    lines = []
    for reading in recognition.readings:
        strokes = ", ".join(str(k) for k in reading.strokes)
        score = "" if reading.kind == "unread" else f"{reading.score:.0%}"
        line = f"{reading.kind:<10} {score:>4}   strokes {strokes}"
        if reading.alternatives:
            line += "   or " + ", ".join(f"{kind} {score:.0%}" for kind, score in reading.alternatives[:3])
        lines.append(line)
    scene = recognition.scene
    for body in scene.bodies:
        kind = type(body.shape).__name__.lower()
        x, y = body.position
        lines.append(
            f"body {body.id}: {kind} at ({x:.2f}, {y:.2f}) m" + (", anchored" if body.anchored else "")
        )
    for joint in scene.joints:
        a, b = (name or "the background" for name in joint.bodies)
        lines.append(f"pivot: {a} on {b} at ({joint.position[0]:.2f}, {joint.position[1]:.2f}) m")
    lines.append("gravity: ({:.2f}, {:.2f}) m/s²".format(*scene.gravity))
    return "\n".join(lines)
