"""`sketchsim bench`: how right and how fast this installation is."""

from __future__ import annotations

import argparse
import importlib
from typing import Any

from cli.arguments import UsageError

__all__ = ["add_to"]

SUBJECTS = {
    "physics": "tests.benchmarks.physics",
    "recognition": "tests.benchmarks.recognition",
    "pipeline": "tests.benchmarks.pipeline",
}


def add_to(commands: argparse._SubParsersAction[Any]) -> None:
    p = commands.add_parser(
        "bench",
        help="measure this installation",
        description="Measure the engine, the recognizer or the whole way to a video, in the source folder.",
    )
    p.add_argument("subject", choices=tuple(SUBJECTS))
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    name = SUBJECTS[options.subject]
    try:
        benchmark = importlib.import_module(name)
    except ModuleNotFoundError as e:
        if e.name is None or not name.startswith(e.name):
            raise
        raise UsageError(
            f"bench {options.subject}: its benchmark is not here", "run it in the project's source folder"
        ) from None
    status: int = benchmark.main([])
    return status
