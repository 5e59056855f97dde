"""`sketchsim simulate`: drawings or scenes in; video, pictures and data out."""

from __future__ import annotations

import argparse
import dataclasses
import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.arguments import STDIN, UsageError, add_input_options, matching, number, picture_size, vector
from cli.outputs import Outputs, check_outputs, ending
from cli.results import ENDINGS, SEEN, Look, Run

if TYPE_CHECKING:
    from cli.inputs import Loaded
    from cli.progress import Progress
    from sim.scene import Scene
    from sim.trajectory import Trajectory

__all__ = [
    "RUN_OPTIONS",
    "add_run_options",
    "check_samples",
    "configure",
    "motion_of",
    "until_rest",
]

MAX_SAMPLES = 1_000_000  # of the motion; a day at 10 fps
GRAVITY = 9.81  # [m/s²]
# what motion_of looks at
RUN_OPTIONS = ("duration", "until_rest", "fps", "tolerance", "engine", "gravity", "elasticity", "friction")

DESCRIPTION = "Run drawings or scenes, and write what happens."
EPILOG = """\
endings of OUT:
  .mp4 .webm .gif  video
  .html            a page to play it in, with graphs
  .png             the whole motion in one picture
  .svg             the scene before it moves
  .npz .json .csv  the motion as numbers; - is JSON on standard output
With several inputs OUT is an ending alone (.mp4, or films/.mp4): each file gets its input's name.

examples:
  sketchsim simulate cart.json
  sketchsim simulate photo.jpg -o run.mp4 -o run.csv --duration 5
  sketchsim simulate cart.json -o cart.html -o cart.gif --style ink --trails
  sketchsim simulate *.json -o .mp4 --until-rest
  sketchsim simulate scene.json -o - --fps 1000 --tolerance 1e-8
"""


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = DESCRIPTION
    p.epilog = EPILOG
    p.add_argument(
        "inputs", metavar="INPUT", nargs="+",
        help="strokes, a picture or a scene, told by content; - is standard input",
    )  # fmt: skip
    p.add_argument(
        "-o", dest="outputs", metavar="OUT", action="append", default=[],
        help="file to write, may be given several times (default: the input's name, .mp4, in this folder)",
    )  # fmt: skip
    add_run_options(p)
    add_input_options(p)
    look = p.add_argument_group("look")
    look.add_argument(
        "--size", type=picture_size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)"
    )
    look.add_argument(
        "--style", choices=("clean", "ink", "blueprint"), default="clean",
        help="ink moves the strokes that were drawn",
    )  # fmt: skip
    look.add_argument("--trails", action="store_true", help="draw the paths of the bodies' centres")
    look.add_argument("--vectors", action="store_true", help="draw velocities (blue) and net forces (red)")
    look.add_argument(
        "--camera",
        type=_camera,
        default=None,
        metavar="fit|follow:ID",
        help="follow keeps a body in the middle",
    )
    loudness = p.add_mutually_exclusive_group()
    loudness.add_argument("-q", "--quiet", action="store_true", help="no notes and no progress")
    loudness.add_argument(
        "-v", "--verbose", action="store_true", help="say what was done and how long it took"
    )
    p.set_defaults(run=run)


def add_run_options(p: argparse.ArgumentParser) -> None:
    """The options that say what is run, apart from how it is shown."""
    p.add_argument(
        "--duration", type=number(0, 86_400), default=10.0, metavar="SECONDS",
        help="how long to run (default: 10)",
    )  # fmt: skip
    p.add_argument("--until-rest", action="store_true", help="end a second after everything has come to rest")
    p.add_argument(
        "--fps", type=number(0, 100_000), default=60.0, help="frames and samples a second (default: 60)"
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
        "--elasticity", type=number(0, 1, or_equal=True), metavar="0-1",
        help="of every body: how much of its speed a bounce keeps (drawn: 0.3)",
    )  # fmt: skip
    p.add_argument(
        "--friction",
        type=number(0, 100, or_equal=True),
        metavar="COEFFICIENT",
        help="of every body (drawn: 0.5)",
    )


def run(options: argparse.Namespace) -> int:
    options.inputs = matching(options.inputs)
    if options.inputs.count(STDIN) > 1:
        raise UsageError("-: standard input is read once, and was named twice")
    targets = [_targets(source, options) for source in options.inputs]
    check_outputs([target for each in targets for target in each], ENDINGS, options.inputs)
    check_samples(options)
    for source, each in zip(options.inputs, targets, strict=True):
        _simulate(source, each, options)
    return 0


def check_samples(options: argparse.Namespace) -> None:
    if options.duration * options.fps > MAX_SAMPLES:
        raise UsageError(
            f"--duration {options.duration:g} at --fps {options.fps:g} is more than {MAX_SAMPLES:,} samples",
            "make either smaller",
        )


def _simulate(source: str, targets: list[str], options: argparse.Namespace) -> None:
    from cli.inputs import naming
    from cli.progress import Progress, note

    tell = (lambda _: None) if options.quiet else note
    with naming(source, len(options.inputs) > 1), Progress(not options.quiet) as progress:
        result = _run_of(source, options, tell, progress)
        if options.verbose:
            _tell_profile(result, note)
        began = time.perf_counter()
        with Outputs() as files:
            for target in targets:
                result.write(files, target, partial(progress.say, f"drawing {target}"))
        if options.verbose:
            note(f"wrote {' '.join(targets)} in {time.perf_counter() - began:.3f} s")
        elif not options.outputs:
            tell(f"wrote {' '.join(targets)}")
        still = [target for target in targets if ending(target) in (".png", ".svg")]
        if options.vectors and still:
            tell(f"{' '.join(still)}: vectors are drawn where the motion is played")
        if any(ending(target) in SEEN for target in targets):
            _tell_what_left(result.lost(), tell)


def _run_of(
    source: str, options: argparse.Namespace, tell: Callable[[str], object], progress: Progress
) -> Run:
    """Read an input and simulate it; `tell` is given the notes."""
    from cli.inputs import Way, load

    progress.say("reading")
    loaded = load(source, Way.of(options))
    look = _look(options, loaded.scene)
    progress.say("simulating")
    motion = motion_of(loaded, options, tell)
    if look.style == "ink" and loaded.recognition is None:
        tell("a scene has no ink to move: bodies are drawn plain")
    title = Path(source).stem if source != STDIN else "sketch"
    return Run(title, loaded.scene, motion, options.fps, look, loaded.recognition)


def motion_of(loaded: Loaded, options: argparse.Namespace, tell: Callable[[str], object]) -> Trajectory:
    """Run what was loaded by the options of add_run_options."""
    from sim import simulate

    scene = loaded.scene
    if options.gravity is not None:
        scene.gravity = options.gravity
    for body in scene.bodies:
        if options.elasticity is not None:
            body.elasticity = options.elasticity
        if options.friction is not None:
            body.friction = options.friction
    for text in scene.notes:
        if options.gravity is None or "gravity" not in text:
            tell(text)
    motion: Trajectory = simulate(
        scene,
        duration=options.duration,
        fps=options.fps,
        tolerance=options.tolerance,
        engine=options.engine,
    )
    _check_finite(motion)
    if motion.profile.get("let_overlap"):
        tell("bodies that were drawn too far into one another to be moved apart pass through each other")
    if options.until_rest:
        motion, rested = until_rest(motion, options.fps)
        if not rested:
            tell(f"still moving after {options.duration:g} s")
    return motion


def _look(options: argparse.Namespace, scene: Scene) -> Look:
    if options.camera is not None and options.camera not in {body.id for body in scene.bodies}:
        names = " ".join(body.id for body in scene.bodies[:20])
        raise UsageError(f"--camera: there is no body {options.camera!r}", f"the bodies are: {names}")
    return Look(options.size, options.style, options.trails, options.vectors, options.camera)


def until_rest(motion: Trajectory, fps: float) -> tuple[Trajectory, bool]:
    """The motion up to a second after the last movement, and whether it comes to rest at all."""
    import numpy as np

    moving = np.hypot(*np.moveaxis(motion.velocities, 2, 0)) + np.abs(motion.angular_velocities) > 1e-3
    last = np.flatnonzero(moving.any(axis=1))
    end = (int(last[-1]) if len(last) else 0) + math.ceil(fps)
    if end >= len(motion) - 1:
        return motion, len(last) == 0 or int(last[-1]) < len(motion) - 1
    return _cut(motion, end), True


def _cut(motion: Trajectory, end: int) -> Trajectory:
    """The motion up to and with sample `end`."""
    names = ("times", "positions", "angles", "velocities", "angular_velocities", "energy")
    arrays: dict[str, Any] = {name: getattr(motion, name)[: end + 1] for name in names}
    events = [event for event in motion.events if event.time <= motion.times[end]]
    return dataclasses.replace(motion, events=events, **arrays)


def _check_finite(motion: Trajectory) -> None:
    import numpy as np

    lost = np.argwhere(~np.isfinite(motion.positions).all(axis=2))
    if len(lost):
        sample, body = lost[0]
        raise RuntimeError(f"the engine lost {motion.body_ids[body]} at {motion.times[sample]:g} s")


def _tell_what_left(lost: list[tuple[str, float]], tell: Callable[[str], object]) -> None:
    together: dict[str, list[str]] = {}  # a cart and its wheels
    for name, at in sorted(lost, key=lambda t: t[1]):
        together.setdefault(f"{at:.1f} s", []).append(name)
    first, rest = list(together.items())[:5], list(together.values())[5:]
    for when, (*most, last) in first:
        who = f"{', '.join(most)} and {last} leave" if most else f"{last} leaves"
        tell(f"{who} the picture at {when}")
    if rest:
        tell(f"others that leave the picture later: {sum(map(len, rest))}")


def _tell_profile(result: Run, tell: Callable[[str], object]) -> None:
    """What the engine did: times in seconds, the rest are counts; what was not needed is left out."""
    bodies, joints = len(result.scene.bodies), len(result.scene.joints)
    tell(
        f"{bodies} bodies, {joints} joints, {len(result.motion)} samples, {len(result.motion.events)} events"
    )
    used = [f"{name} {value:.6g}" for name, value in result.motion.profile.items() if value]
    if used:
        tell("engine: " + ", ".join(used))


def _targets(source: str, options: argparse.Namespace) -> list[str]:
    """The files of one input; an OUT that is an ending alone gets the input's name."""
    name = "sketch" if source == STDIN else Path(source).stem or "sketch"
    targets = []
    for out in options.outputs or [".mp4"]:
        path = Path(out)
        if path.name in ENDINGS:
            targets.append(str(path.with_name(name + path.name)))
        elif len(options.inputs) > 1:
            raise UsageError(
                f"-o {out}: one file cannot hold {len(options.inputs)} runs",
                "give an ending alone, as in -o .mp4",
            )
        else:
            targets.append(out)
    return targets


def _camera(text: str) -> str | None:
    if text == "fit":
        return None
    if text.startswith("follow:") and len(text) > 7:
        return text[7:]
    raise argparse.ArgumentTypeError(f"{text!r} is neither fit nor follow:ID")


def _gravity(text: str) -> tuple[float, float]:
    named = {"none": (0.0, 0.0), "down": (0.0, -GRAVITY)}
    if text in named:
        return named[text]
    g = vector(text)
    if math.hypot(*g) > 1e6:
        raise argparse.ArgumentTypeError(f"{text} m/s² is more than 1e6")
    return g
