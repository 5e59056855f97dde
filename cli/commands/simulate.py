"""`sketchsim simulate`: a drawing or a scene in; video, pictures and data out."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.arguments import UsageError, number, picture_size, vector
from cli.outputs import STDOUT, Outputs, check_outputs, ending

if TYPE_CHECKING:
    from cli.inputs import Loaded
    from cli.progress import Progress
    from sim.trajectory import Trajectory

__all__ = ["add_to"]

ENDINGS = (".mp4", ".html", ".png", ".npz", ".json", ".csv")
DATA = {".npz": "to_npz", ".json": "to_json", ".csv": "to_csv"}
MAX_SAMPLES = 1_000_000  # of the motion; a day at 10 fps
GRAVITY = 9.81  # [m/s²]

DESCRIPTION = "Run a drawing or a scene, and write what happens."
EPILOG = """\
endings of OUT:
  .mp4             video (H.264)
  .html            a page to play it in, with graphs
  .png             one picture of the whole motion
  .npz .json .csv  the motion as numbers; - is JSON on standard output

examples:
  sketchsim simulate cart.json
  sketchsim simulate photo.jpg -o run.mp4 -o run.csv --duration 5
  sketchsim simulate scene.json -o - --fps 1000 --tolerance 1e-8
"""


def add_to(commands: argparse._SubParsersAction[Any]) -> None:
    p = commands.add_parser(
        "simulate", help="run a drawing or a scene", description=DESCRIPTION, epilog=EPILOG
    )
    p.add_argument(
        "input", metavar="INPUT", help="strokes, a picture or a scene, told by content; - is standard input"
    )
    p.add_argument(
        "-o", dest="outputs", metavar="OUT", action="append", default=[],
        help="file to write, may be given several times (default: the input's name, .mp4, in this folder)",
    )  # fmt: skip
    p.add_argument(
        "--duration",
        type=number(0, 86_400),
        default=10.0,
        metavar="SECONDS",
        help="how long to run (default: 10)",
    )
    p.add_argument(
        "--fps", type=number(0, 100_000), default=60.0, help="frames and samples a second (default: 60)"
    )
    p.add_argument(
        "--size", type=picture_size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)"
    )
    p.add_argument(
        "--tolerance", type=number(0, 1), default=1e-4, metavar="METRES", help="error allowed (default: 1e-4)"
    )
    p.add_argument(
        "--engine", choices=("impulse", "pymunk"), default="impulse", help="pymunk is there to compare with"
    )
    p.add_argument(
        "--gravity", type=_gravity, metavar="none|down|GX,GY", help="instead of what was drawn [m/s², y up]"
    )
    p.add_argument(
        "--scale", type=number(0, 1e9), metavar="PX_PER_M", help="pixels of the drawing in a metre"
    )
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    outputs = options.outputs or [_default_output(options.input)]
    check_outputs(outputs, ENDINGS, [options.input])
    if options.duration * options.fps > MAX_SAMPLES:
        raise UsageError(
            f"--duration {options.duration:g} at --fps {options.fps:g} is more than {MAX_SAMPLES:,} samples",
            "make either smaller",
        )
    from cli.inputs import load
    from cli.progress import Progress, note
    from sim import simulate

    loaded = load(options.input, options.scale)
    scene = loaded.scene
    if options.gravity is not None:
        scene.gravity = options.gravity
    for text in scene.notes:
        if options.gravity is None or "gravity" not in text:
            note(text)
    with Progress() as progress:
        progress.say("simulating")
        motion = simulate(
            scene,
            duration=options.duration,
            fps=options.fps,
            tolerance=options.tolerance,
            engine=options.engine,
        )
        _check_finite(motion)
        with Outputs() as files:
            for target in outputs:
                _write(files, target, loaded, motion, options, progress)
    return 0


def _write(
    files: Outputs,
    target: str,
    loaded: Loaded,
    motion: Trajectory,
    options: argparse.Namespace,
    progress: Progress,
) -> None:
    kind = ending(target)
    if kind in DATA:
        files.write(target, getattr(motion, DATA[kind])())
        return
    from cli.render.camera import fit
    from cli.render.figure import Figure
    from cli.render.style import CLEAN

    scene = loaded.scene
    camera = fit(scene, options.size, motion)
    sketch = loaded.recognition.sketch if loaded.recognition else None
    figure = Figure(scene, camera, CLEAN, sketch)
    if kind == ".html":
        from cli.render.page import page

        title = Path(options.input).stem if options.input != STDOUT else "sketch"
        files.write(target, page(figure, motion, title, sketch))
        return
    if kind == ".png":
        from cli.render.still import png, strobe

        files.write(target, png(strobe(figure, motion)))
        return
    from cli.render.camera import outside
    from cli.render.video import write_video

    write_video(
        files.stage(target), figure, motion, options.fps, lambda done: progress.say(f"drawing {target}", done)
    )
    _tell_what_left(outside(scene, motion, camera))


def _check_finite(motion: Trajectory) -> None:
    import numpy as np

    lost = np.argwhere(~np.isfinite(motion.positions).all(axis=2))
    if len(lost):
        sample, body = lost[0]
        raise RuntimeError(f"the engine lost {motion.body_ids[body]} at {motion.times[sample]:g} s")


def _tell_what_left(lost: list[tuple[str, float]]) -> None:
    from cli.progress import note

    for name, time in lost[:5]:
        note(f"{name} leaves the picture at {time:.1f} s")
    if len(lost) > 5:
        note(f"{len(lost) - 5} more bodies leave the picture")


def _default_output(source: str) -> str:
    return f"{Path(source).stem or 'sketch'}.mp4" if source != STDOUT else "sketch.mp4"


def _gravity(text: str) -> tuple[float, float]:
    named = {"none": (0.0, 0.0), "down": (0.0, -GRAVITY)}
    if text in named:
        return named[text]
    g = vector(text)
    if math.hypot(*g) > 1e6:
        raise argparse.ArgumentTypeError(f"{text} m/s² is more than 1e6")
    return g
