"""`sketchsim recognize`: what a drawing was taken for."""

from __future__ import annotations

import argparse
import sys

from cli.arguments import add_input_options
from cli.outputs import STDOUT, Outputs, check_outputs

__all__ = ["configure"]

EPILOG = """\
examples:
  sketchsim recognize cart.json                    the scene as JSON on standard output
  sketchsim recognize photo.jpg -o scene.json --overlay seen.png
  sketchsim recognize cart.json --explain          why each stroke was taken for what it was
  sketchsim recognize cart.json --read 3,4=anchor --read 9=ignore -o scene.json
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
        "--explain", action="store_true", help="say of every reading why it is this and not the next"
    )
    add_input_options(p)
    p.add_argument(
        "--stages",
        metavar="DIR",
        help="pictures of what was seen on a picture: page, mask, skeleton, strokes",
    )
    p.add_argument("-q", "--quiet", action="store_true", help="no notes")
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    output = options.output or (None if options.overlay or options.explain else STDOUT)
    if output is not None:
        check_outputs([output], (".json",), [options.input])
    if options.overlay is not None:
        check_outputs([options.overlay], (".png",), [options.input], "--overlay")
    from cli.inputs import Way, is_scene, read, recognize_bytes
    from cli.progress import note
    from sim.scene import InputError

    way = Way.of(options)
    data = read(options.input)
    if is_scene(data):
        raise InputError(
            "", f"{options.input} is a scene already", "`sketchsim simulate` runs it", kind="format"
        )
    recognition = recognize_bytes(data, way)
    for text in recognition.scene.notes if not options.quiet else ():
        note(text)
    with Outputs() as files:
        if output is not None:
            files.write(output, recognition.scene.to_json())
        if options.overlay is not None:
            from cli.render.overlay import overlay
            from cli.render.still import png

            files.write(options.overlay, png(overlay(recognition)))
    if options.explain:
        print(recognition.explain(), file=sys.stderr if output == STDOUT else sys.stdout)
    return 0
