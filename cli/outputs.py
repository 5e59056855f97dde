"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from cli.arguments import UsageError

__all__ = ["STDOUT", "Outputs", "check_outputs", "ending"]

STDOUT = "-"


def ending(target: str) -> str:
    """What is to be written: ``.mp4``, ``.json``, ...; standard output takes JSON."""
    if target == STDOUT:
        return ".json"
    path = Path(target)
    return (path.suffix or (path.name if path.name.startswith(".") else "")).lower()


def check_outputs(
    targets: Iterable[str], endings: Iterable[str], inputs: Iterable[str] = (), option: str = "-o"
) -> None:
    """Raise UsageError for what could not be written, before any work is done; `option` asked for it."""
    known = sorted(endings)
    seen: set[str] = set()
    sources = {os.path.realpath(name) for name in inputs if name != STDOUT}
    for target in targets:
        asked = f"{option} {target}"
        if target != STDOUT and os.path.isdir(target):
            raise UsageError(f"{asked}: this is a folder")
        if ending(target) not in known:
            what = f"{ending(target)!r} is not a known ending" if ending(target) else "no ending"
            raise UsageError(f"{asked}: {what}", "the ending says what is written: " + " ".join(known))
        path = target if target == STDOUT else os.path.realpath(target)
        if path in seen:
            raise UsageError(f"{asked}: given twice")
        seen.add(path)
        if target == STDOUT:
            continue
        if path in sources:
            raise UsageError(f"{asked}: this is the input itself")
        folder, named = os.path.dirname(path), os.path.dirname(target) or "."
        if not os.path.isdir(folder):
            raise UsageError(f"{asked}: there is no folder {named}", "make it first")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise UsageError(f"{asked}: the folder {named} cannot be written to")


class Outputs:
    """Several files as one deed: written beside their targets and renamed together at the end.

    Where anything fails on the way nothing is renamed, and what stood there before stays.
    """

    def __init__(self) -> None:
        self._beside: list[tuple[str, str]] = []
        self._stdout: list[bytes] = []

    def __enter__(self) -> Outputs:
        return self

    def stage(self, target: str) -> str:
        """A path to write `target`'s content to; the same folder, so that renaming cannot fail half-way."""
        path = os.path.realpath(target)
        folder, name = os.path.split(path)
        beside = os.path.join(folder, f".{name}.{os.urandom(6).hex()}{Path(name).suffix}")
        self._beside.append((beside, path))  # before it exists: an interrupt may come at any time
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
        return beside

    def write(self, target: str, content: bytes) -> None:
        if target == STDOUT:
            self._stdout.append(content)
        else:
            beside = self.stage(target)
            try:
                Path(beside).write_bytes(content)
            except OSError as e:
                e.filename = beside  # which a failing write leaves out
                raise

    def __exit__(
        self, kind: type[BaseException] | None, e: BaseException | None, tb: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                for beside, path in self._beside:
                    os.chmod(beside, _mode(path))
                for beside, path in self._beside:
                    os.replace(beside, path)
                for content in self._stdout:
                    sys.stdout.buffer.write(content)
                sys.stdout.flush()
        finally:
            if isinstance(e, OSError):  # in the words of who asked for the file
                e.filename = dict(self._beside).get(e.filename, e.filename)
            for beside, _ in self._beside:
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(beside)


def _mode(path: str) -> int:
    """The permissions of the file that is replaced, or those that a new file would have."""
    with contextlib.suppress(FileNotFoundError):
        return os.stat(path).st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
