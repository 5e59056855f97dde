"""The command line's own types: numbers within bounds, sizes, vectors; errors in the style of all others."""

from __future__ import annotations

import argparse
import math
import os
import re
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

__all__ = [
    "STDIN",
    "Parser",
    "PrintVersion",
    "UsageError",
    "add_input_options",
    "matching",
    "number",
    "picture_size",
    "reading",
    "vector",
    "whole_number",
]

STDIN = "-"
MAX_SIDE = 7680  # 8K; beyond it players and H.264 levels give up


class UsageError(Exception):
    """The command line asks for what cannot be done."""

    def __init__(self, problem: str, hint: str = "") -> None:
        super().__init__(problem)
        self.hint = hint


class Parser(argparse.ArgumentParser):
    """An ArgumentParser that raises UsageError and leaves its text's line breaks alone."""

    def __init__(self, **options: Any) -> None:
        self._width = 80
        super().__init__(allow_abbrev=False, **options)

    def _get_formatter(self) -> argparse.HelpFormatter:
        """One of a given width: asked for by every option, it would load shutil to look at the terminal."""
        return argparse.RawDescriptionHelpFormatter(prog=self.prog, width=self._width)

    def format_help(self) -> str:
        from shutil import get_terminal_size

        self._width = get_terminal_size().columns - 2
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        raise UsageError(re.sub(r"^argument ", "", message), f"`{self.prog} --help` lists the options")


class PrintVersion(argparse.Action):
    """Looks the version up only when asked: importlib.metadata takes longer than the rest of the parser."""

    def __init__(self, option_strings: Sequence[str], dest: str) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help="print the version")

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"sketchsim {version('sketchsim')}")
        except PackageNotFoundError:
            print("sketchsim, running from its source folder")
        parser.exit(0)


def number(above: float, at_most: float, or_equal: bool = False) -> Callable[[str], float]:
    """A type of argument: a finite number in (above, at_most], or in [above, at_most]."""

    def parse(text: str) -> float:
        value = _float(text)
        if value < above if or_equal else value <= above:
            raise argparse.ArgumentTypeError(
                f"{text} is {'less' if or_equal else 'not greater'} than {above:g}"
            )
        if value > at_most:
            raise argparse.ArgumentTypeError(f"{text} is more than {at_most:g}")
        return value

    return parse


def whole_number(least: int, most: int) -> Callable[[str], int]:
    """A type of argument: an integer from `least` to `most`."""

    def parse(text: str) -> int:
        if not re.fullmatch(r"\d{1,9}", text) or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {most}")
        return int(text)

    return parse


def picture_size(text: str) -> tuple[int, int]:
    """``1280x720``: even, because H.264 keeps one colour for every 2x2 pixels."""
    found = re.fullmatch(r"(\d{1,9})[x×](\d{1,9})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, as in 1280x720")
    width, height = int(found[1]), int(found[2])
    for side in (width, height):
        if not 64 <= side <= MAX_SIDE:
            raise argparse.ArgumentTypeError(f"{side} is not between 64 and {MAX_SIDE}")
        if side % 2:
            raise argparse.ArgumentTypeError(f"{side} is odd; video needs an even width and height")
    return width, height


def vector(text: str) -> tuple[float, float]:
    """``0,-9.81``."""
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y, as in 0,-9.81")
    return _float(parts[0]), _float(parts[1])


def _float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number")
    return value


def reading(text: str) -> tuple[tuple[int, ...], str]:
    """STROKES=KIND, as 3,4=anchor, told apart; which kinds there are the recognizer knows."""
    strokes, equals, kind = text.partition("=")
    if not equals or re.fullmatch(r"\d+(,\d+)*", strokes) is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not STROKES=KIND, as 3,4=anchor")
    return tuple(int(k) for k in strokes.split(",")), kind.strip()


def matching(inputs: Sequence[str]) -> list[str]:
    """The inputs, the files that match in place of a pattern: the shells of Windows leave ``*.json`` to the program."""
    found: list[str] = []
    for source in inputs:
        names: list[str] = []
        if re.search(r"[*?[]", source) and not os.path.exists(source):
            import glob

            names = sorted(glob.glob(source))
        found += names or [source]
    return found


def add_input_options(p: argparse.ArgumentParser) -> None:
    """The options that say how a drawing is read."""
    p.add_argument(
        "--scale", type=number(0, 1e9), metavar="PX_PER_M", help="pixels of the drawing in a metre"
    )
    p.add_argument(
        "--read", action="append", default=[], type=reading, metavar="STROKES=KIND",
        help="what strokes are, as 3,4=anchor or 9=ignore; may be given several times",
    )  # fmt: skip
    p.add_argument(
        "--page",
        type=whole_number(1, 100_000),
        default=1,
        metavar="N",
        help="of a PDF or TIFF; the first without it",
    )
    p.add_argument(
        "--index", type=whole_number(0, 999_999_999), metavar="K",
        help="which drawing of a file with many (Quick, Draw!), from 0; the first without it",
    )  # fmt: skip
    p.add_argument(
        "--tidy", action="store_true",
        help="near-level sides level, near-equal wheels equal, what nearly touches touching",
    )  # fmt: skip
