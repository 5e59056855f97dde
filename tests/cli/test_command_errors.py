"""Wrong usage and bad input: one clear line, a hint, the right exit status, and nothing written."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from cli.main import main
from sim.trajectory import Trajectory


def stderr_of(capsys: pytest.CaptureFixture[str]) -> list[str]:
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.splitlines()
    assert "Traceback" not in captured.err
    return lines


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--fps", "0"], "error: --fps: 0 is not greater than 0"),
        (["--fps", "nan"], "error: --fps: nan is not a finite number"),
        (["--fps", "fast"], "error: --fps: 'fast' is not a number"),
        (["--duration", "-1"], "error: --duration: -1 is not greater than 0"),
        (["--duration", "inf"], "error: --duration: inf is not a finite number"),
        (["--duration", "1e9"], "error: --duration: 1e9 is more than 86400"),
        (
            ["--duration", "8e4", "--fps", "100"],
            "error: --duration 80000 at --fps 100 is more than 1,000,000 samples",
        ),
        (["--tolerance", "0"], "error: --tolerance: 0 is not greater than 0"),
        (["--size", "big"], "error: --size: 'big' is not WIDTHxHEIGHT, as in 1280x720"),
        (["--size", "1281x720"], "error: --size: 1281 is odd; video needs an even width and height"),
        (["--size", "99999x720"], "error: --size: 99999 is not between 64 and 7680"),
        (["--size", "2x2"], "error: --size: 2 is not between 64 and 7680"),
        (["--gravity", "sideways"], "error: --gravity: 'sideways' is not X,Y, as in 0,-9.81"),
        (["--gravity", "-1,x"], "error: --gravity: 'x' is not a number"),
        (["--gravity", "0,-1e9"], "error: --gravity: 0,-1e9 m/s² is more than 1e6"),
        (["--scale", "100"], "error: --scale: {scene} is a scene, which is in metres already"),
        (["--colour"], "error: unrecognized arguments: --colour"),
        (["-o", "run.avi"], "error: -o run.avi: '.avi' is not a known ending"),
        (["-o", "run"], "error: -o run: no ending"),
        (["-o", ".avi"], "error: -o .avi: '.avi' is not a known ending"),
        (["--page", "2"], "error: --page, --index: {scene} is a scene, there are no others in it"),
        (["-o", "nowhere/run.mp4"], "error: -o nowhere/run.mp4: there is no folder nowhere"),
        (["-o", "{scene}"], "error: -o {scene}: this is the input itself"),
        (["-o", "."], "error: -o .: this is a folder"),
        (["-q", "-v"], "error: -v/--verbose: not allowed with argument -q/--quiet"),
        (["-o", "a.csv", "-o", "./a.csv"], "error: -o ./a.csv: given twice"),
    ],
)
def test_wrong_usage_is_told_before_any_work(
    options: list[str],
    line: str,
    scene_file: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(scene_file.parent)
    before = scene_file.read_bytes()
    status = main(["simulate", str(scene_file), *(o.format(scene=scene_file) for o in options)])
    assert status == 2
    assert stderr_of(capsys)[0] == line.format(scene=scene_file) + " [usage]"
    assert [path.name for path in scene_file.parent.iterdir()] == ["scene.json"]
    assert scene_file.read_bytes() == before


def test_output_that_is_a_folder(scene_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = scene_file.parent / "run.mp4"
    folder.mkdir()
    assert main(["simulate", str(scene_file), "-o", str(folder)]) == 2
    assert stderr_of(capsys) == [f"error: -o {folder}: this is a folder [usage]"]


@pytest.mark.parametrize(
    ("argv", "line"),
    [
        (["simulate", "-", "-", "-o", ".csv"], "error: -: standard input is read once, and was named twice"),
        (
            ["recognize", "-", "--read", "3=anchor", "--read", "0=bar", "--read", "3=ball"],
            "error: --read 3: it cannot be both anchor and ball",
        ),
        (
            ["bench", "recognition", "--count", "0"],
            "error: --count: '0' is not a whole number from 1 to 1000000",
        ),
        (["bench", "physics", "--only", "no such"], "error: --only: no case has 'no such' in its name"),
        (
            ["recognize", "-", "--overlay", "seen.jpg"],
            "error: --overlay seen.jpg: '.jpg' is not a known ending",
        ),
    ],
)
def test_what_contradicts_is_told_before_standard_input_is_read(
    argv: list[str], line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert main(argv) == 2
    assert stderr_of(capsys)[0] == line + " [usage]"


def test_patterns_that_the_shell_left_name_the_files_that_match(
    scene_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = scene_file.parent
    (folder / "other.json").write_bytes(scene_file.read_bytes())
    argv = ["simulate", str(folder / "*.json"), "-o", str(folder / ".csv"), "--duration", "0.1"]
    assert main(argv) == 0
    assert sorted(path.name for path in folder.glob("*.csv")) == ["other.csv", "scene.csv"]
    nothing = str(folder / "*.jpg")
    assert main(["simulate", nothing, "-o", "-"]) == 3
    assert stderr_of(capsys)[-1] == f"error: {nothing}: there is no such file [file]"


def test_without_outputs_the_name_of_the_video_is_told(
    scene_file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(scene_file.parent)
    assert main(["simulate", scene_file.name, "--duration", "0.1", "--size", "64x64"]) == 0
    assert stderr_of(capsys)[-1] == "note: wrote scene.mp4"
    assert (scene_file.parent / "scene.mp4").stat().st_size > 0


def test_an_unknown_option_names_the_help_of_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["recognize", "drawing.json", "--duration"]) == 2
    assert stderr_of(capsys)[1] == "hint: `sketchsim recognize --help` lists the options"


@pytest.mark.parametrize("argv", [[], ["dance"], ["simulate"], ["recognize"], ["bench", "everything"]])
def test_incomplete_command_lines_point_to_help(argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(argv) == 2
    error, hint = stderr_of(capsys)
    assert error.startswith("error: ")
    assert hint.startswith("hint: `sketchsim ")
    assert hint.endswith("--help` lists the options")


BAD_SCENES = [
    (b"", "error: the input is empty [empty]", 0),
    (b"  \n", "error: the input is empty [empty]", 0),
    (b'{"bodies": [}', "error: line 1 column 13: not JSON: expecting value [format]", 0),
    (b'{"bodies": 3}', "error: bodies: expected array, got int [value]", 0),
    (
        b'{"bodies": [{"id": "a", "shape": {"type": "circle", "radius": -1}, "position": [0, 0]}]}',
        "error: bodies[0].shape.radius: -1 is not greater than 0 [value]",
        0,
    ),
    (
        b'{"bodies": [{"id": "a", "shape": {"type": "circle", "radius": 1}, "position": [NaN, 0]}]}',
        "error: bodies[0].position[0]: nan is not a finite number [value]",
        0,
    ),
    (
        b'{"bodies": [], "joints": [{"type": "pivot", "bodies": ["b", null], "position": [0, 0]}]}',
        "error: joints[0].bodies[0]: there is no body 'b' [value]",
        1,
    ),
]


@pytest.mark.parametrize(("content", "line", "hints"), BAD_SCENES)
def test_bad_scenes_name_the_place(
    content: bytes, line: str, hints: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "bad.json"
    bad.write_bytes(content)
    out = tmp_path / "out.json"
    assert main(["simulate", str(bad), "-o", str(out)]) == 3
    lines = stderr_of(capsys)
    assert lines[0] == line
    assert [text[:6] for text in lines[1:]] == ["hint: "] * hints
    assert not out.exists()


@pytest.mark.parametrize("command", ["simulate", "recognize"])
def test_input_that_cannot_be_read(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([command, "nothing.json"]) == 3
    assert stderr_of(capsys) == ["error: nothing.json: there is no such file [file]"]
    assert main([command, "."]) == 3
    assert stderr_of(capsys) == [
        "error: .: this is a folder, not a file [file]",
        "hint: `sketchsim batch` runs all that is in a folder",
    ]
    assert not list(tmp_path.iterdir())


def test_recognizing_a_scene_says_what_to_do(scene_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["recognize", str(scene_file)]) == 3
    assert stderr_of(capsys) == [
        f"error: {scene_file} is a scene already [format]",
        "hint: `sketchsim simulate` runs it",
    ]


def test_failures_inside_are_one_line(
    scene_file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("sim.engine.simulate", fail)
    monkeypatch.delenv("SKETCHSIM_TRACEBACK", raising=False)
    assert main(["simulate", str(scene_file), "-o", "-"]) == 1
    lines = stderr_of(capsys)
    assert lines[0] == "error: something inside failed: ZeroDivisionError: division by zero [inside]"


def test_standard_input_and_output(
    scene_file: Path, capfdbinary: pytest.CaptureFixture[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(scene_file.read_bytes())))
    assert main(["simulate", "-", "-o", "-", "--duration", "0.5", "--fps", "4"]) == 0
    captured = capfdbinary.readouterr()
    run = json.loads(captured.out)
    assert run["times"] == [0, 0.25, 0.5]
    assert run["body_ids"] == ["floor", "ball", "box"]
    assert captured.err == b""


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("sketchsim")
    for command in ("simulate", "recognize", "bench"):
        assert main([command, "--help"]) == 0
        assert command in capsys.readouterr().out


def test_a_motion_that_is_not_finite_is_not_drawn(
    scene_file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from sim.engine import simulate

    def lose(*arguments: Any, **options: Any) -> Trajectory:
        motion = simulate(*arguments, **options)
        motion.positions[2:, 1] = float("nan")
        return motion

    monkeypatch.setattr("sim.engine.simulate", lose)
    out = scene_file.parent / "run.mp4"
    assert main(["simulate", str(scene_file), "-o", str(out), "--fps", "4"]) == 1
    assert stderr_of(capsys)[0].endswith("the engine lost ball at 0.5 s [inside]")
    assert not out.exists()


@pytest.mark.parametrize("command", ["simulate", "recognize"])
def test_a_picture_without_ink_is_empty(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paper, out = tmp_path / "paper.png", tmp_path / "out.json"
    paper.write_bytes(cv2.imencode(".png", np.full((300, 400, 3), 250, np.uint8))[1].tobytes())
    assert main([command, str(paper), "-o", str(out)]) == 3
    assert stderr_of(capsys) == ["error: no ink was found on the picture: nothing was drawn [empty]"]
    assert not out.exists()


def test_the_command_takes_as_much_as_the_reader_of_sketches() -> None:
    from cli import inputs
    from sketch import formats

    assert inputs.MAX_BYTES == formats.MAX_PICTURE_BYTES
