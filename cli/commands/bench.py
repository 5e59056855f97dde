"""`sketchsim bench`: how right and how fast this installation is."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from cli.arguments import UsageError

__all__ = ["configure"]

SUBJECTS = ("physics", "stress", "recognition", "pipeline")
EPILOG = """\
subjects:
  physics      error against time, for cases whose motion is known, beside pymunk
  stress       piles, stacks and jams: energy, overlap, time
  recognition  how many drawings are read rightly, and how fast
  pipeline     whole processes, from a drawing to a video and to numbers

examples:
  sketchsim bench physics --plot error.png
  sketchsim bench pipeline --runs 3
"""
SOURCE = Path(__file__).resolve().parents[2]  # or, of an installed package, a folder without benchmarks


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Measure the engine, the recognizer or the whole way to a video, in the source folder."
    p.epilog = EPILOG
    p.add_argument("subject", choices=SUBJECTS)
    p.add_argument(
        "rest", nargs=argparse.REMAINDER, metavar="...", help="its options; -h after it lists them"
    )
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    benchmark = Path("tests", "benchmarks", f"{options.subject}.py")
    root = next((folder for folder in (SOURCE, Path.cwd()) if (folder / benchmark).is_file()), None)
    if root is None:
        raise UsageError(
            f"bench {options.subject}: its benchmark is neither in {SOURCE} nor here",
            "run it in the project's source folder",
        )
    if str(root) not in sys.path:
        sys.path.append(str(root))  # last: what is measured is what is installed
    module = importlib.import_module(f"tests.benchmarks.{options.subject}")
    status: int = module.main(options.rest)
    return status
