"""Files appear whole or not at all."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import time
import weakref
from pathlib import Path

import pytest

from cli.main import main
from cli.outputs import Outputs

ROOT = Path(__file__).resolve().parents[2]


def test_all_files_or_none(tmp_path: Path) -> None:
    old = tmp_path / "a.json"
    old.write_text("old")

    def fail_half_way() -> None:
        with Outputs() as files:
            files.write(str(old), b"new")
            files.write(str(tmp_path / "b.json"), b"new")
            raise RuntimeError("half-way")

    with pytest.raises(RuntimeError, match="half-way"):
        fail_half_way()
    assert old.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.json"]


def test_written_files_replace_old_ones_and_keep_their_permissions(tmp_path: Path) -> None:
    old, new, link = tmp_path / "a.json", tmp_path / "b.json", tmp_path / "link.json"
    old.write_text("old")
    old.chmod(0o640)
    link.symlink_to(old)
    with Outputs() as files:
        files.write(str(link), b"x")
        files.write(str(new), b"y")
        assert old.read_text() == "old"
    assert link.is_symlink()
    assert old.read_bytes() == b"x"
    assert old.stat().st_mode & 0o777 == 0o640
    mask = os.umask(0)
    os.umask(mask)
    assert new.stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_failure_while_encoding_keeps_the_old_video(
    scene_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    video = scene_file.parent / "run.mp4"
    video.write_bytes(b"the old video")

    def fail(path: str, *_: object) -> None:
        Path(path).write_bytes(b"half a video")
        raise OSError(28, "No space left on device", path)

    monkeypatch.setattr("cli.render.video.write_video", fail)
    assert main(["simulate", str(scene_file), "-o", str(video), "-o", str(video.with_suffix(".csv"))]) == 1
    assert capsys.readouterr().err.rstrip().endswith("no space left on device [write]")
    assert video.read_bytes() == b"the old video"
    assert sorted(os.listdir(scene_file.parent)) == ["run.mp4", "scene.json"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_leaves_nothing(scene_file: Path, number: signal.Signals) -> None:
    folder = scene_file.parent
    # An hour of video: it is surely still being drawn when the signal comes.
    command = [sys.executable, "-m", "cli", "simulate", str(scene_file), "-o", str(folder / "run.mp4")]
    with subprocess.Popen(
        [*command, "--duration", "3600", "--size", "64x64"],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a job in the background ignores it
    ) as process:
        deadline = time.monotonic() + 30
        while len(os.listdir(folder)) == 1 and time.monotonic() < deadline:
            time.sleep(0.02)
        assert len(os.listdir(folder)) == 2, "the file beside did not appear"
        process.send_signal(number)
        _, stderr = process.communicate(timeout=30)
    # A shell sees 130 either way: Python ends itself by SIGINT where the interrupt came within an exec().
    assert process.returncode in (130, -signal.SIGINT)
    assert stderr.splitlines()[-1] == "error: interrupted; nothing was left half-written [interrupted]"
    assert os.listdir(folder) == ["scene.json"]


def test_an_interrupt_within_a_callback_is_not_lost(
    scene_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Thing:
        pass

    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    def run(_: object) -> int:
        thing = Thing()
        watch = weakref.ref(thing, interrupted)
        del thing
        assert watch() is None
        for _ in range(1000):
            time.sleep(0.01)
        return 0

    monkeypatch.setattr("cli.commands.simulate.run", run)
    hook = sys.unraisablehook
    assert main(["simulate", str(scene_file)]) == 130
    assert capsys.readouterr().err.splitlines()[-1].endswith("[interrupted]")
    assert sys.unraisablehook is hook


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_within_an_import_is_neither_lost_nor_another_error(
    number: signal.Signals,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Modules that Cython compiled say that something could not be imported, whatever came between."""
    (tmp_path / "compiled_so.py").write_text(
        f"import os, time\ntry:\n    os.kill(os.getpid(), {int(number)})\n    time.sleep(0.05)\n"
        "except BaseException:\n    raise ImportError('a part of it')\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "compiled_so", raising=False)
    signal.signal(signal.SIGINT, signal.default_int_handler)

    def run(_: object) -> int:
        importlib.import_module("compiled_so")
        time.sleep(10)
        return 0

    monkeypatch.setattr("cli.commands.simulate.run", run)
    assert main(["simulate", "scene.json"]) == 130
    assert capsys.readouterr().err.splitlines()[-1].endswith("[interrupted]")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_closed_pipe_is_no_traceback(scene_file: Path) -> None:
    command = [sys.executable, "-m", "cli", "simulate", str(scene_file), "-o", "-"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        stderr = process.stderr.read().decode()
    assert process.returncode == 1
    assert stderr == "error: standard output was closed before all was written [write]\n"


@pytest.mark.parametrize("ending", ["mp4", "webm", "gif", "html", "json"])
def test_a_disk_that_is_full_is_told_and_nothing_is_left(scene_file: Path, ending: str) -> None:
    """Files of more than 4 kB are refused, as a full disk would."""
    resource = pytest.importorskip("resource")
    out = scene_file.parent / f"run.{ending}"
    run = subprocess.run(
        [sys.executable, "-m", "cli", "simulate", str(scene_file), "-o", str(out), "--size", "320x240"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=30,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
    )
    assert run.returncode == 1
    assert run.stderr.splitlines()[-1] == f"error: {out}: file too large [write]"
    assert os.listdir(scene_file.parent) == ["scene.json"]


@pytest.mark.parametrize(
    ("closed", "argv", "status"),
    [
        ("0<&-", "simulate - -o -", 3),
        ("1>&-", "--version", 0),
        ("2>&-", "simulate {scene} -o {folder}/a.json", 0),
        ("2>&-", "simulate {scene} -o {folder}/a.avi", 2),
        ("1>/dev/full", "completion bash", 1),
        ("1>/dev/full", "simulate {scene} -o -", 1),
    ],
)
def test_streams_that_are_closed_or_full(scene_file: Path, closed: str, argv: str, status: int) -> None:
    words = argv.format(scene=scene_file, folder=scene_file.parent)
    run = subprocess.run(
        ["sh", "-c", f"exec {sys.executable} -m cli {words} {closed}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert run.returncode == status
    assert "Traceback" not in run.stderr
    assert len(run.stderr.splitlines()) <= 2
    if status and closed[0] != "2":
        assert run.stderr.startswith("error: ")
