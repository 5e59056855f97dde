"""The README: its commands and snippets run, its links lead somewhere, its tables are complete."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from cli.commands.simulate import ENDINGS
from cli.main import build_parser, main
from sim import Scene
from sketch import load_sketch
from sketch.formats import kind_of

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, re.M | re.S)


COMMANDS = [line for block in blocks("sh")[2:] for line in block.splitlines()]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_first_two_commands_stand_alone() -> None:
    first, second = blocks("sh")[:2]
    for command in (first, second):
        assert command.count("\n") == 1, "one line"
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install ")
    (sample,) = re.findall(r"samples/\S+", first)
    assert (ROOT / sample).exists()


def test_the_commands_run(workplace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In the README's order, since later ones use the files of earlier ones."""
    assert len(COMMANDS) >= 3
    for command in COMMANDS:
        program, *arguments = shlex.split(command)
        assert program == "sketchsim"
        assert main(arguments) == 0, capsys.readouterr().err
        made = [arguments[k + 1] for k, a in enumerate(arguments) if a in ("-o", "--overlay")]
        assert all((workplace / name).stat().st_size > 0 for name in made)


@pytest.mark.parametrize("snippet", blocks("python"))
def test_the_snippets_run(snippet: str, workplace: Path) -> None:
    exec(compile(snippet, "README.md", "exec"), {})


@pytest.mark.parametrize("example", blocks("json"))
def test_the_examples_of_formats_are_read(example: str) -> None:
    if kind_of(example.encode()) == "scene":
        assert Scene.from_json(example).bodies
    else:
        assert load_sketch(example.encode()).strokes


def test_the_error_is_what_the_command_prints(workplace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (shown,) = re.findall(r"^    (error: .*)$", TEXT, re.M)
    body = '{{"id": "b{}", "position": [0, 0], "shape": {{"type": "circle", "radius": {}}}}}'
    bodies = ", ".join(body.format(k, -0.4 if k == 3 else 1) for k in range(4))
    (workplace / "scene.json").write_text('{"bodies": [' + bodies + "]}")
    assert main(["simulate", "scene.json", "-o", "-"]) == 3
    assert shown in capsys.readouterr().err


def test_links_and_pictures_lead_somewhere() -> None:
    links = re.findall(r"\]\(([^)]+)\)", TEXT) + re.findall(r'src="([^"]+)"', TEXT)
    assert links
    assert [link for link in links if "://" not in link and not (ROOT / link).exists()] == []


def test_the_options_of_simulate_are_all_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "--help"]) == 0
    options = set(re.findall(r"(?<![\w-])--[a-z-]+", capsys.readouterr().out)) - {"--help"}
    table = TEXT[TEXT.index("| `simulate` |") :]
    assert {option for option in options if f"`{option}" not in table} == set()


def test_the_endings_of_outputs_are_all_listed() -> None:
    (row,) = re.findall(r"^\| `-o OUT` \|(.*)$", TEXT, re.M)
    assert set(re.findall(r"`(\.\w+)`", row)) == set(ENDINGS)


def test_the_subcommands_are_all_named() -> None:
    commands = re.findall(r"^    (\w+) ", build_parser().format_help(), re.M)
    assert commands
    assert [c for c in commands if f"`sketchsim {c}" not in TEXT and f"sketchsim {c} " not in TEXT] == []
