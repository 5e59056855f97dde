"""Entry point: parses the command line, runs a command, reports failures in one line and an exit status."""

from __future__ import annotations

import _thread
import importlib
import os
import re
import signal
import sys
import time
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Any

from cli.arguments import Parser, PrintVersion, UsageError
from cli.progress import error

__all__ = ["main"]

FAILED, USAGE, BAD_INPUT, INTERRUPTED = 1, 2, 3, 130  # exit statuses; 0 is done

COMMANDS = {
    "simulate": "run a drawing or a scene",
    "recognize": "read a drawing as a scene",
    "batch": "run many drawings or scenes at once",
    "bench": "measure this installation",
    "doctor": "say what is installed and what works",
    "completion": "print what a shell needs to complete this command",
}

EPILOG = """\
examples:
  sketchsim simulate cart.json                     draw cart.mp4, ten seconds of it
  sketchsim simulate photo.jpg -o run.mp4 -o run.csv --duration 5
  sketchsim recognize cart.json -o scene.json --overlay seen.png
  sketchsim recognize cart.json | sketchsim simulate - -o cart.mp4

exit status: 0 done, 1 something inside failed, 2 wrong usage, 3 bad input
"""


def build_parser(wanted: str | None = None) -> Parser:
    """The parser of the command line, with the options of all commands or of one; each one's import takes time."""
    parser = Parser(prog="sketchsim", description="Draw a machine, watch it run.", epilog=EPILOG)
    parser.add_argument("--version", action=PrintVersion)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, prog="sketchsim")
    for name, summary in COMMANDS.items():
        command = commands.add_parser(name, help=summary)
        if wanted in (None, name):
            importlib.import_module(f"cli.commands.{name}").configure(command)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` (of the process by default) and return the exit status."""
    arguments = _join_negative_vectors(sys.argv[1:] if argv is None else argv)
    restore = _terminate_as_interrupt()
    try:
        wanted = next((word for word in arguments if not word.startswith("-")), "")
        options, unknown = build_parser(wanted).parse_known_args(arguments)
        if unknown:
            words = " ".join(unknown)
            raise UsageError(
                f"unrecognized arguments: {words}", f"`sketchsim {wanted} --help` lists the options"
            )
        status: int = options.run(options)
        sys.stdout.flush()
        return status
    except SystemExit as e:  # --help and --version
        return e.code if isinstance(e.code, int) else FAILED
    except UsageError as e:
        return _report(USAGE, str(e), "usage", e.hint)
    except KeyboardInterrupt:
        return _report(INTERRUPTED, "interrupted; nothing was left half-written", "interrupted")
    except BrokenPipeError:
        # Whoever read standard output is gone; Python would complain again on closing it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _report(FAILED, "standard output was closed before all was written", "write")
    except Exception as e:
        return _report_exception(e)
    finally:
        restore()


def _report(status: int, problem: str, kind: str, hint: str = "") -> int:
    error(problem, kind, hint)
    return status


def _report_exception(e: Exception) -> int:
    from sim.scene import InputError

    if isinstance(e, InputError):
        return _report(BAD_INPUT, str(e), e.kind, e.hint)
    if os.environ.get("SKETCHSIM_TRACEBACK"):
        raise e
    if isinstance(e, OSError) and e.strerror:
        where = f"{e.filename}: " if e.filename else ""
        return _report(FAILED, f"{where}{e.strerror[:1].lower()}{e.strerror[1:]}", "write")
    return _report(
        FAILED,
        f"something inside failed: {type(e).__name__}: {e}",
        "inside",
        "set SKETCHSIM_TRACEBACK=1 to see where, and please report it",
    )


def _join_negative_vectors(argv: Sequence[str]) -> list[str]:
    """``--gravity -1,-9`` as ``--gravity=-1,-9``: argparse would take the vector for an option."""
    joined: list[str] = []
    for argument in argv:
        if joined and joined[-1] == "--gravity" and re.match(r"-[\d.]", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _terminate_as_interrupt() -> Callable[[], object]:
    """Let SIGTERM unwind like Ctrl-C, so that nothing half-written stays behind; returns how to undo it.

    An interrupt that comes where it would go lost comes again a little later: while a module is imported, which may
    turn it into an error of its own (whatever Cython compiled does), and within a callback of the garbage collector's,
    where Python can only print and forget it.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        if not _is_importing(frame):
            raise KeyboardInterrupt
        _thread.start_new_thread(once_more, (signal.Signals(number),))

    def once_more(number: signal.Signals = signal.SIGTERM) -> None:
        time.sleep(0.01)
        if signal.getsignal(number) is not interrupt:  # all is done meanwhile
            return
        if hasattr(signal, "pthread_kill"):  # which also ends what waits
            signal.pthread_kill(main_thread, number)
        else:
            _thread.interrupt_main(number)

    def unraisable(what: sys.UnraisableHookArgs) -> None:
        if what.exc_type is KeyboardInterrupt:
            _thread.start_new_thread(once_more, ())
        else:
            forgotten(what)

    main_thread = _thread.get_ident()
    before: dict[int, Any] = {}
    try:
        before[signal.SIGTERM] = signal.signal(signal.SIGTERM, interrupt)
    except ValueError:  # not in the main thread, which alone is told
        return lambda: None
    if (
        signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ):  # else whoever started this has it ignored
        before[signal.SIGINT] = signal.signal(signal.SIGINT, interrupt)
    forgotten, sys.unraisablehook = sys.unraisablehook, unraisable

    def restore() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = forgotten

    return restore


def _is_importing(frame: FrameType | None) -> bool:
    """Whether a frame is reached through an import."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
