"""JSON that people and programs write, and errors that say where it is wrong."""

from __future__ import annotations

import contextlib
import json
from typing import Any, TypeVar

import msgspec

__all__ = ["InputError", "check_format", "convert", "kind_of_value", "parse_json"]

T = TypeVar("T")

MAX_BYTES = 16 << 20  # a scene of 50,000 bodies


class InputError(ValueError):
    """Input that cannot be used: where, what is wrong, and what to do about it.

    Attributes:
        path: the element, as ``bodies[3].position[0]`` or ``line 3 column 5``; empty for the whole input.
        problem: what is wrong there, in a few words.
        hint: what to do; may be empty.
        kind: "value" for something in it that is not as it has to be; "file" for what cannot be read, "format"
            for a format that is not known or not kept, "empty" where nothing is drawn, "size" for what is too
            large, "extra" for what takes a package that is not installed.
    """

    def __init__(self, path: str, problem: str, hint: str = "", *, kind: str = "value") -> None:
        super().__init__(f"{path}: {problem}" if path else problem)
        self.path, self.problem, self.hint, self.kind = path, problem, hint, kind


def parse_json(data: bytes | str, max_bytes: int = MAX_BYTES) -> Any:
    """JSON to objects. Raises InputError with line and column for what is not JSON, or when it is too long.

    NaN and Infinity are no JSON, but programs write them: they are let through here, so that the check that
    follows can name the element that has one.
    """
    if len(data) > max_bytes:
        raise InputError(
            "", f"{len(data) / 1e6:.0f} MB of JSON; at most {max_bytes / 1e6:.0f} MB are taken", kind="size"
        )
    if not data.strip():
        raise InputError("", "the input is empty", kind="empty")
    try:
        return msgspec.json.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError) as e:
        with contextlib.suppress(ValueError, RecursionError):
            return json.loads(data)
        raise _not_json(data, e) from None
    except RecursionError:
        raise InputError("", "JSON nested too deeply", kind="format") from None


def _not_json(data: bytes | str, cause: Exception) -> InputError:
    try:
        json.loads(data)
    except json.JSONDecodeError as e:
        return InputError(
            f"line {e.lineno} column {e.colno}", f"not JSON: {e.msg[:1].lower()}{e.msg[1:]}", kind="format"
        )
    except UnicodeDecodeError as e:
        return InputError(f"byte {e.start}", "not JSON: not UTF-8 text", kind="format")
    except RecursionError:
        return InputError("", "JSON nested too deeply", kind="format")
    except ValueError:
        pass
    return InputError("", f"not JSON: {cause}", kind="format")


def check_format(d: dict[str, Any], name: str) -> None:
    """Raise InputError where an object says that it is of another format or version than `name`, version 1."""
    found = d.get("format", name)
    if found != name:
        raise InputError("format", f"{found!r} is not {name!r}", kind="format")
    if d.get("version", 1) != 1:
        raise InputError(
            "version", f"{d['version']!r} is not 1", "this program reads version 1", kind="format"
        )


def convert(value: Any, to: type[T]) -> T:
    """JSON's objects as a struct, numpy's numbers and arrays too. Raises InputError with the path."""
    try:
        return msgspec.convert(value, to)
    except msgspec.ValidationError:
        with contextlib.suppress(TypeError, ValueError, AttributeError, RecursionError):
            value = json.loads(json.dumps(value, default=lambda v: v.tolist()))
    try:
        return msgspec.convert(value, to)
    except msgspec.ValidationError as e:
        raise _with_path(e) from None


def _with_path(e: msgspec.ValidationError) -> InputError:
    """msgspec's 'Expected `float`, got `str` - at `$.bodies[0].angle`' as path and problem."""
    text, _, path = str(e).partition(" - at `")
    path = path.rstrip("`").removeprefix("$").removeprefix(".")
    if text.startswith("Object missing required field "):
        name = text.split("`")[1]
        path, text = f"{path}.{name}" if path else name, "missing"
    hint = "a shape is a circle, a rectangle or a polygon" if path.endswith("shape.type") else ""
    return InputError(path, text[:1].lower() + text[1:].replace("`", ""), hint)


def kind_of_value(value: Any) -> str:
    if value is None:
        return "null"
    names = {
        bool: "a boolean",
        int: "a number",
        float: "a number",
        str: "a string",
        list: "a list",
        dict: "an object",
    }
    return names.get(type(value), type(value).__name__)
