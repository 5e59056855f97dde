"""`sketchsim recognize`: what a drawing was taken for."""

from __future__ import annotations

import argparse
import sys

from cli.arguments import number, reading, whole_number
from cli.outputs import STDOUT, Outputs, check_outputs

__all__ = ["READ_HELP", "configure"]

READ_HELP = "what strokes are, as 3,4=anchor or 9=ignore; may be given several times"
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
    p.add_argument(
        "--scale", type=number(0, 1e9), metavar="PX_PER_M", help="pixels of the drawing in a metre"
    )
    p.add_argument(
        "--read", action="append", default=[], type=reading, metavar="STROKES=KIND", help=READ_HELP
    )
    p.add_argument(
        "--page", type=whole_number(1, 100_000), default=1, metavar="N", help="of a PDF; the first without it"
    )
    p.add_argument(
        "--stages",
        metavar="DIR",
        help="pictures of what was seen on a picture: page, mask, skeleton, strokes",
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
    recognition = recognize_bytes(data, options.scale, options.read, options.page, options.stages)
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
        print(recognition.explain(), file=sys.stderr if output == STDOUT else sys.stdout)
    return 0
