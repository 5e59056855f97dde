"""The commands about the program itself: doctor, completion, bench."""

from __future__ import annotations

import shutil
import subprocess
from importlib.metadata import version

import pytest

from cli.commands.completion import words_of
from cli.main import build_parser, main


def test_doctor_tries_every_part(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    fine = {line.split()[1] for line in lines if line.startswith("ok ")}
    assert fine >= {"numpy", "av", "engine", "recognizer", "pictures", ".mp4", ".webm"}
    assert not [line for line in lines if line.startswith("FAILED")]
    named = [line.split() for line in lines if line.startswith("ok ")]
    versions = {
        words[1]: words[2] for words in named if words[1] in ("numpy", "scipy", "pymunk", "pypdfium2")
    }
    assert versions == {name: version(name) for name in versions}


def test_doctor_says_which_part_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("no library")

    monkeypatch.setattr("sim.engine.simulate", fail)
    assert main(["doctor"]) == 1
    out = capsys.readouterr().out
    assert "FAILED   engine: OSError: no library" in out
    assert "ok       recognizer" in out


def test_every_option_is_completed() -> None:
    words = words_of(build_parser())
    assert set(words) == {"simulate", "recognize", "batch", "bench", "doctor", "completion"}
    assert {"--duration", "--style", "-o"} <= set(words["simulate"])
    assert words["simulate"]["--style"] == ["clean", "ink", "blueprint"]
    assert words["bench"][""] == ["physics", "stress", "recognition", "pipeline"]


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("sketchsim si", "simulate"),
        ("sketchsim simulate --du", "--duration"),
        ("sketchsim simulate --style bl", "blueprint"),
        ("sketchsim bench ph", "physics"),
    ],
)
def test_completion_in_bash(line: str, completed: str, capsys: pytest.CaptureFixture[str]) -> None:
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("no bash")
    assert main(["completion", "bash"]) == 0
    words = line.split(" ")
    script = capsys.readouterr().out + (
        f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _sketchsim; echo ${{COMPREPLY[@]}}"
    )
    run = subprocess.run([bash, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.split() == [completed]
    assert run.stderr == ""


def test_other_shells(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "zsh"]) == 0
    assert capsys.readouterr().out.startswith("#compdef sketchsim\n")
    assert main(["completion", "fish"]) == 0
    assert "-l style -x -a 'clean ink blueprint'" in capsys.readouterr().out
