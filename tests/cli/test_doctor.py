"""The commands about the program itself: doctor, completion, bench."""

from __future__ import annotations

import shutil
import subprocess
from importlib.metadata import version
from pathlib import Path

import pytest

from cli.main import main

ROOT = Path(__file__).resolve().parents[2]


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


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("sketchsim si", "simulate"),
        ("sketchsim simulate --du", "--duration"),
        ("sketchsim simulate --style bl", "blueprint"),
        ("sketchsim bench ph", "physics"),
        ("sketchsim simulate LICEN", "LICENSE"),
        ("sketchsim batch -o sampl", "samples"),
        ("sketchsim bench rec", "recognition"),
    ],
)
def test_completion_in_bash(line: str, completed: str, capsys: pytest.CaptureFixture[str]) -> None:
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("no bash")
    assert main(["completion", "bash"]) == 0
    words = line.split(" ")
    script = capsys.readouterr().out + (
        f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _shtab_sketchsim; echo ${{COMPREPLY[@]}}"
    )
    run = subprocess.run([bash, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    assert run.stdout.split() == [completed]
    assert run.stderr == ""


def test_other_shells(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "zsh"]) == 0
    assert capsys.readouterr().out.startswith("#compdef sketchsim\n")
    assert main(["completion", "fish"]) == 0
    (style,) = [line for line in capsys.readouterr().out.splitlines() if " -l style " in line]
    assert '"clean ink blueprint"' in style
