"""Many inputs at once, on this machine and on a cluster."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cli.commands.batch import tasks_of
from cli.main import main
from sim.scene import Scene

from_cluster = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="dask.distributed is not installed"
)

BALL = {"id": "ball", "shape": {"type": "circle", "radius": 0.5}, "position": [0, 0]}


def scene_with(height: float) -> dict[str, object]:
    return {"gravity": [0, -10], "bodies": [{**BALL, "position": [0, height]}]}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three scenes, and what is none."""
    inside = tmp_path / "scenes"
    inside.mkdir()
    for k in range(3):
        (inside / f"s{k}.json").write_text(json.dumps(scene_with(k)))
    (inside / "README.md").write_text("# scenes")
    (inside / ".hidden.json").write_text("{}")
    return inside


def check_runs(out: Path, names: list[str]) -> None:
    """Every ball has fallen 5 m in a second."""
    for k, name in enumerate(names):
        assert Scene.load(out / f"{name}.scene.json").bodies[0].position == (0, k)
        run = np.load(out / f"{name}.npz")
        assert run["positions"][-1, 0] == pytest.approx([0, k - 5])


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_folder_becomes_scenes_and_motions(
    folder: Path, workers: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = folder.parent / "runs"
    assert main(["batch", str(folder), "-o", str(out), "--duration", "1", "--workers", workers]) == 0
    names = ["s0", "s1", "s2"]
    check_runs(out, names)
    assert len(list(out.iterdir())) == 6
    assert capsys.readouterr() == ("", "")


def test_a_file_with_a_scene_on_each_line(folder: Path) -> None:
    lines = folder / "many.jsonl"
    lines.write_text("\n".join(json.dumps(scene_with(k)) for k in range(3)) + "\n")
    out = folder.parent / "runs"
    assert main(["batch", str(lines), "-o", str(out), "--duration", "1", "--workers", "1"]) == 0
    check_runs(out, ["many-1", "many-2", "many-3"])


def test_what_cannot_be_read_is_told_and_the_rest_is_run(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "s1.json").write_text('{"bodies": [{"id": "a"}]}')
    out = folder.parent / "runs"
    argv = [
        "batch",
        str(folder),
        str(folder / "gone.json"),
        "-o",
        str(out),
        "--duration",
        "1",
        "--data",
        "csv",
    ]
    assert main([*argv, "--workers", "2"]) == 3
    errors = capsys.readouterr().err.splitlines()
    assert errors[0].startswith(f"error: {folder / 's1.json'}: bodies[0].")
    assert errors[-1] == f"error: {folder / 'gone.json'}: there is no such file [file]"
    assert sorted(path.name for path in out.iterdir()) == [
        "s0.csv",
        "s0.scene.json",
        "s2.csv",
        "s2.scene.json",
    ]


def test_a_bad_line_is_told_and_the_others_are_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = folder / "many.jsonl"
    lines.write_text("\n".join([json.dumps(scene_with(0)), "{oops", json.dumps(scene_with(1))]))
    out = folder.parent / "runs"
    argv = ["batch", str(lines), "-o", str(out), "--data", "csv", "--duration", "1", "--workers", "1"]
    assert main(argv) == 3
    (error,) = capsys.readouterr().err.splitlines()
    assert error.startswith(f"error: {lines} line 2 column 2: not JSON: ")
    assert sorted(path.name for path in out.glob("*.csv")) == ["many-1.csv", "many-3.csv"]


def test_inputs_of_one_name_keep_their_files_apart(folder: Path) -> None:
    other = folder.parent / "other"
    other.mkdir()
    (other / "s1.json").write_text(json.dumps(scene_with(1)))
    names = [task.name for task in tasks_of([str(folder), str(other)])]
    assert len(set(names)) == 4
    (folder / "s1.txt").write_text(json.dumps(scene_with(1)))
    assert [task.name for task in tasks_of([str(folder)])] == ["s0.json", "s1.json", "s1.txt", "s2.json"]


def test_wrong_usage(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = folder.parent / "empty"
    empty.mkdir()
    assert main(["batch", str(empty), "-o", str(empty)]) == 2
    assert main(["batch", str(folder)]) == 2
    assert main(["batch", str(folder), "-o", str(folder / "s0.json")]) == 2
    assert main(["batch", str(folder), "-o", str(empty), "--workers", "0"]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error")]
    assert lines == [
        "error: nothing to run: there are no drawings, pictures or scenes [usage]",
        "error: the following arguments are required: -o [usage]",
        f"error: -o {folder / 's0.json'}: this is not a folder [usage]",
        "error: --workers: '0' is not a whole number from 1 to 1024 [usage]",
    ]


@pytest.fixture
def cluster() -> Iterator[str]:
    """The address of a cluster of two worker processes."""
    code = """
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        print(cluster.scheduler_address, flush=True)
        input()
"""
    root = Path(__file__).resolve().parents[2]
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=root
    ) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        yield process.stdout.readline().strip()
        process.stdin.write("\n")
        process.stdin.close()
        process.wait(timeout=30)


@from_cluster
@pytest.mark.filterwarnings("ignore")  # those of the cluster's own
def test_a_cluster_gives_the_same(folder: Path, cluster: str) -> None:
    out = folder.parent / "runs"
    (folder / "s9.json").write_text("{")
    argv = ["batch", str(folder), "-o", str(out), "--duration", "1", "--scheduler", cluster]
    assert main(argv) == 3
    check_runs(out, ["s0", "s1", "s2"])


@from_cluster
@pytest.mark.slow
def test_a_cluster_that_is_not_there(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["batch", str(folder), "-o", str(folder.parent / "runs"), "--scheduler", "tcp://127.0.0.1:1"]
    assert main(argv) == 2
    assert "no scheduler answers at tcp://127.0.0.1:1" in capsys.readouterr().err
