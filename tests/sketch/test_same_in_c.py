"""Constants that Python and the C library both need have one value: where a comment says "as in core/...", they are."""

from __future__ import annotations

import ast
import contextlib
import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
IN_C = re.compile(r"\b([A-Z][A-Z_]+)\s*=\s*([^,;}]+)")


def twins() -> list[tuple[str, str, list[str]]]:
    """Module, name and C files of every such constant."""
    found = []
    for path in sorted((ROOT / "sketch").rglob("*.py")):
        text = path.read_text()
        lines = text.splitlines()
        for node in ast.parse(text).body:
            said = "\n".join(lines[node.lineno - 1 : node.end_lineno])
            if isinstance(node, ast.Assign) and "as in core/" in said:
                names = [n.id for n in ast.walk(node.targets[0]) if isinstance(n, ast.Name)]
                module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
                found += [(module, name, re.findall(r"core/\w+\.[ch]", said)) for name in names]
    return found


@pytest.mark.parametrize(("module", "name", "files"), twins())
def test_a_constant_has_one_value_in_both_languages(module: str, name: str, files: list[str]) -> None:
    values: dict[str, float] = {}
    for file in files:
        text = re.sub(r"/\*.*?\*/", "", (ROOT / "sketch" / file).read_text(), flags=re.DOTALL)
        for key, value in IN_C.findall(text):
            with contextlib.suppress(NameError, SyntaxError, TypeError):  # no constant, or of another file
                values[key] = eval(value, {}, values)
    assert name in values, f"{files} know no {name}"
    assert values[name] == pytest.approx(getattr(importlib.import_module(module), name), rel=1e-12)


def test_there_are_some() -> None:
    assert len(twins()) > 15
