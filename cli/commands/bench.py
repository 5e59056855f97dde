"""`sketchsim bench`: how right and how fast this installation is."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from cli.arguments import UsageError

__all__ = ["configure"]

SUBJECTS = ("physics", "stress", "recognition", "pipeline")
ROOT = Path(__file__).resolve().parents[2]  # of the source; an installed package has no benchmarks beside it


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Measure the engine, the recognizer or the whole way to a video, in the source folder."
    p.add_argument("subject", choices=SUBJECTS)
    p.add_argument(
        "rest", nargs=argparse.REMAINDER, metavar="...", help="its options; -h after it lists them"
    )
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    if not (ROOT / "tests" / "benchmarks" / f"{options.subject}.py").is_file():
        raise UsageError(
            f"bench {options.subject}: its benchmark is not in {ROOT}",
            "run `python -m cli` in the project's source",
        )
    if str(ROOT) not in sys.path:
        sys.path.insert(0, str(ROOT))
    benchmark = importlib.import_module(f"tests.benchmarks.{options.subject}")
    status: int = benchmark.main(options.rest)
    return status
