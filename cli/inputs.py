"""Reads an INPUT of the command line: strokes, a picture or a scene, told by content."""

from __future__ import annotations

import contextlib
import dataclasses
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from cli.arguments import STDIN, UsageError
from sim.scene import InputError, Scene

if TYPE_CHECKING:
    import argparse

    from sketch.recognize import Recognition

__all__ = ["Loaded", "Way", "load", "load_bytes", "naming", "read", "recognize_bytes"]

MAX_BYTES = 64 << 20  # of any input; as sketch.formats.MAX_PICTURE_BYTES, which scenes are spared importing


@dataclass(frozen=True)
class Way:
    """How a drawing is to be read.

    scale: the ink's pixels per metre.  readings: what some strokes are, by their numbers.  page: of a PDF or
    TIFF, from 1.  index: of a file with many drawings, from 0.  tidy: whether to undo what the hand did to level
    sides, equal wheels, touching bodies.  stages: a folder for pictures of what was seen on a picture.
    """

    scale: float | None = None
    readings: Mapping[int | tuple[int, ...], str] = field(default_factory=dict)
    page: int = 1
    index: int | None = None
    tidy: bool = False
    stages: str | None = None

    @classmethod
    def of(cls, options: argparse.Namespace) -> Way:
        """From the options of add_input_options."""
        stages = getattr(options, "stages", None)
        readings = _readings(options.read)
        return cls(options.scale, readings, options.page, options.index, options.tidy, stages)


def _readings(given: Iterable[tuple[tuple[int, ...], str]]) -> dict[int | tuple[int, ...], str]:
    """What --read says, which may be given several times, but once of the same strokes."""
    readings: dict[int | tuple[int, ...], str] = {}
    for strokes, kind in given:
        if readings.setdefault(strokes, kind) != kind:
            name = ",".join(map(str, strokes))
            raise UsageError(f"--read {name}: it cannot be both {readings[strokes]} and {kind}")
    return readings


@dataclass(frozen=True)
class Loaded:
    """An input as a scene, and how it was recognized where it was ink."""

    scene: Scene
    recognition: Recognition | None = None


def read(source: str) -> bytes:
    """The bytes of a file or of standard input. Raises InputError for what cannot be read."""
    if source == STDIN:
        return _check_size(sys.stdin.buffer.read(MAX_BYTES + 1), source)
    try:
        with open(source, "rb") as f:
            return _check_size(f.read(MAX_BYTES + 1), source)
    except FileNotFoundError:
        raise InputError(source or "''", "there is no such file", kind="file") from None
    except IsADirectoryError:
        hint = "`sketchsim batch` runs all that is in a folder"
        raise InputError(source, "this is a folder, not a file", hint, kind="file") from None
    except OSError as e:
        raise InputError(source, (e.strerror or str(e)).lower(), kind="file") from None


def _check_size(data: bytes, source: str) -> bytes:
    if len(data) > MAX_BYTES:
        raise InputError("" if source == STDIN else source, f"more than {MAX_BYTES >> 20} MB", kind="size")
    return data


def load(source: str, way: Way) -> Loaded:
    """The scene that `source` holds or shows."""
    return load_bytes(read(source), source, way)


def load_bytes(data: bytes, source: str, way: Way) -> Loaded:
    """The scene that an input's bytes hold or show."""
    if is_scene(data):
        if way.scale is not None:
            raise UsageError(
                f"--scale: {source} is a scene, which is in metres already",
                "--scale is for strokes and pictures",
            )
        if way.readings:
            raise UsageError(f"--read: {source} is a scene, without strokes", "edit the scene itself")
        if way.tidy:
            raise UsageError(f"--tidy: {source} is a scene, not a drawing", "edit the scene itself")
        if way.page != 1 or way.index:
            raise UsageError(f"--page, --index: {source} is a scene, there are no others in it")
        return Loaded(Scene.from_json(data))
    recognition = recognize_bytes(data, way)
    return Loaded(recognition.scene, recognition)


@contextlib.contextmanager
def naming(source: str, wanted: bool) -> Iterator[None]:
    """Put the input's name before the path of what is wrong in it, where there are several inputs."""
    try:
        yield
    except InputError as e:
        if wanted and source not in e.path:
            path = f"{source}: {e.path}" if e.path else source
            raise InputError(path, e.problem, e.hint, kind=e.kind) from e
        raise


def is_scene(data: bytes) -> bool:
    """Whether this is scene JSON rather than ink."""
    # What is plainly a scene is spared importing the recognizer.
    if b'"sketchsim-scene"' in data[:4096]:
        return True
    if data.lstrip()[:1] == b"{" and b'"bodies"' in data and b'"strokes"' not in data:
        return True
    from sketch.formats import kind_of

    return kind_of(data) == "scene"


def recognize_bytes(data: bytes, way: Way) -> Recognition:
    """Read ink and understand it."""
    from sketch import load_sketch, recognize

    sketch = load_sketch(data, page=way.page, index=way.index, stages=way.stages)
    if way.scale is not None:
        sketch = dataclasses.replace(sketch, pixels_per_metre=way.scale)
    try:
        return recognize(sketch, overrides=way.readings, tidy=way.tidy)
    except InputError as e:
        if e.path.startswith("overrides["):  # what the command calls --read
            raise UsageError(f"--read {e.path[10:-1]}: {e.problem}", e.hint) from None
        raise
