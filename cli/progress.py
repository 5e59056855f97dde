"""What the program tells a person while it works: notes, and a progress line where there is a terminal."""

from __future__ import annotations

import sys
import time

__all__ = ["Progress", "error", "note"]


def note(text: str) -> None:
    """A line about something that the person may want to know."""
    print(f"note: {text}", file=sys.stderr)


def error(problem: str, kind: str, hint: str = "") -> None:
    """A line about what is wrong, with its kind at the end, and one about what to do."""
    print(f"error: {problem} [{kind}]", file=sys.stderr)
    if hint:
        print(f"hint: {hint}", file=sys.stderr)


class Progress:
    """One line that is written over itself, on a terminal only, and gone at the end."""

    EVERY = 0.1  # seconds between two changes of the line

    def __init__(self, wanted: bool = True) -> None:
        self._on = wanted and sys.stderr.isatty()
        self._last = 0.0
        self._what = ""
        self._began = 0.0
        self._width = 0

    def say(self, what: str, done: float | None = None) -> None:
        """Show what is under way; `done` is the share from 0 to 1."""
        if not self._on:
            return
        now = time.monotonic()
        if what != self._what:
            self._what, self._began, self._last = what, now, 0.0
        if now - self._last < self.EVERY:
            return
        self._last = now
        line = what
        if done is not None:
            line += f"  {done:4.0%}"
            if done > 0.02:
                line += f"  {(now - self._began) * (1 - done) / done:.0f} s left"
        from shutil import get_terminal_size

        line = line[: get_terminal_size().columns - 1]
        self._show(line)

    def _show(self, line: str) -> None:
        sys.stderr.write("\r" + line.ljust(self._width) + ("\r" if not line else ""))
        sys.stderr.flush()
        self._width = len(line)

    def clear(self) -> None:
        """Take the line away, so that another can be written."""
        if self._on and self._width:
            self._show("")

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.clear()
