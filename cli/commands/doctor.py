"""`sketchsim doctor`: what is installed and what works."""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Callable
from functools import partial
from itertools import pairwise

__all__ = ["configure"]

NEEDED = {
    "numpy": "numpy",
    "msgspec": "msgspec",
    "cv2": "opencv-python-headless",
    "av": "av",
    "scipy": "scipy",
    "pymunk": "pymunk",
    "shtab": "shtab",
}
EXTRAS = {
    "pillow_heif": ("pillow-heif", "HEIC pictures: pip install pillow-heif"),
    "pypdfium2": ("pypdfium2", "pages of PDF files: pip install pypdfium2"),
    "svgelements": ("svgelements", "SVG drawings: pip install svgelements"),
    "distributed": ("distributed", "batch on a cluster: pip install distributed"),
}


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Say what is installed and try every part once. Exit status 1 where a part fails."
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    print(f"Python {platform.python_version()} on {platform.system()} {platform.machine()}, {sys.executable}")
    checks: list[tuple[str, Callable[[], str]]] = [
        (name, partial(_version, module, name)) for module, name in NEEDED.items()
    ]
    checks += [
        ("engine", _try_engine),
        ("recognizer", _try_recognizer),
        ("pictures", _try_picture),
        *((ending, partial(_try_codec, ending)) for ending in (".mp4", ".webm")),
    ]
    failed = sum(not _check(name, check) for name, check in checks)
    for module, (name, use) in EXTRAS.items():
        try:
            print(f"ok       {name} {_version(module, name)}")
        except ImportError:
            print(f"absent   {name}: {use}")
    return 1 if failed else 0


def _check(name: str, check: Callable[[], str]) -> bool:
    try:
        print(f"ok       {name} {check()}".rstrip())
    except Exception as e:  # whatever is wrong with a part, the others are tried
        print(f"FAILED   {name}: {type(e).__name__}: {e}")
        return False
    return True


def _version(module: str, name: str) -> str:
    """The version of an installed package that can be imported. cv2 is in four packages of different names."""
    import importlib
    from importlib.metadata import PackageNotFoundError, version

    found = importlib.import_module(module)
    try:
        return version(name)
    except PackageNotFoundError:
        return str(getattr(found, "__version__", "of unknown version"))


def _try_engine() -> str:
    """A second of free fall: 4.905 m."""
    from sim import Scene, simulate

    ball = {"id": "ball", "shape": {"type": "circle", "radius": 0.1}, "position": [0, 0]}
    run = simulate(Scene.from_dict({"gravity": [0, -9.81], "bodies": [ball]}), duration=1.0, fps=1)
    fallen = -float(run.positions[-1, 0, 1])
    if abs(fallen - 4.905) > 1e-6:
        raise RuntimeError(f"a body fell {fallen} m in a second, not 4.905")
    return ""


def _try_recognizer() -> str:
    """A square of one stroke."""
    from sketch import load_sketch, recognize

    corners = [(100, 100), (300, 100), (300, 300), (100, 300), (100, 100)]
    points = [
        [ax + (bx - ax) * k / 20, ay + (by - ay) * k / 20]
        for (ax, ay), (bx, by) in pairwise(corners)
        for k in range(20)
    ]
    scene = recognize(load_sketch(f'{{"strokes": [{{"points": {points}}}]}}'.encode())).scene
    if [type(body.shape).__name__ for body in scene.bodies] != ["Rectangle"]:
        raise RuntimeError("a square was not recognized")
    return ""


def _try_picture() -> str:
    from cli.render.canvas import Canvas
    from cli.render.still import png

    return f"({len(png(Canvas.plain((64, 64), (255, 255, 255))))} bytes of PNG)"


def _try_codec(ending: str) -> str:
    import tempfile
    from pathlib import Path

    import numpy as np

    from cli.render.camera import fit
    from cli.render.figure import Figure
    from cli.render.style import CLEAN
    from cli.render.video import CODECS, write_video
    from sim.scene import Scene
    from sim.trajectory import Trajectory

    nothing = np.zeros((3, 0, 2))
    still = Trajectory(
        np.arange(3) / 10, nothing, nothing[..., 0], nothing, nothing[..., 0], [], np.zeros((3, 3))
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"try{ending}"
        write_video(str(path), Figure(Scene(), fit(Scene(), (64, 64)), CLEAN), still, 10, ending)
        return f"by {CODECS[ending].name}, {path.stat().st_size} bytes"
