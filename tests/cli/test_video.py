"""The video that comes out, decoded again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest
from numpy.typing import NDArray

from cli.main import main
from cli.render.camera import fit
from cli.render.figure import Figure
from cli.render.style import CLEAN
from cli.render.video import write_video
from sim.scene import Scene
from sim.trajectory import Trajectory

Straight = Callable[..., Trajectory]

PAPER, BLUE, RED = CLEAN.paper, (0, 0, 255), (255, 0, 0)


def decode(path: Path) -> tuple[av.container.InputContainer, list[NDArray[np.uint8]], list[float]]:
    container = av.open(str(path))
    frames = list(container.decode(video=0))
    return container, [f.to_ndarray(format="rgb24") for f in frames], [float(f.time) for f in frames]


def test_size_duration_rate_and_tags(scene_file: Path) -> None:
    out = scene_file.parent / "run.mp4"
    argv = [
        "simulate",
        str(scene_file),
        "-o",
        str(out),
        "--duration",
        "1.5",
        "--fps",
        "24",
        "--size",
        "320x180",
    ]
    assert main(argv) == 0
    container, pictures, times = decode(out)
    stream = container.streams.video[0]
    assert stream.codec_context.name == "h264"
    assert stream.codec_context.pix_fmt == "yuv420p"
    assert (stream.codec_context.colorspace, stream.codec_context.color_range) == (6, 1)
    assert float(stream.duration * stream.time_base) == pytest.approx(1.5)
    assert pictures[0].shape == (180, 320, 3)
    assert times[0] == 0
    assert times == pytest.approx([k / 24 for k in range(len(times))])


def test_index_comes_first(scene_file: Path) -> None:
    """Players over a network start at once only when the index (moov) stands before the pictures (mdat)."""
    out = scene_file.parent / "run.mp4"
    assert main(["simulate", str(scene_file), "-o", str(out), "--duration", "0.2", "--size", "64x64"]) == 0
    data = out.read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_bodies_are_where_and_what_colour_they_should_be(
    scene: Scene, tmp_path: Path, straight: Straight
) -> None:
    """Page of 128x96 shown at five times the size: 160 pixels a metre."""
    out = tmp_path / "run.mp4"
    motion = straight(scene, duration=1.0, fps=20)
    write_video(str(out), Figure(scene, fit(scene, (640, 480)), CLEAN), motion, 20)
    _, pictures, times = decode(out)
    for picture, time in zip(pictures, times, strict=True):
        x, y = (0.75 + 2.0 * time) * 160, 1.5 * 160
        ball = picture[round(y) + 25, round(x) - 30].astype(int)
        assert np.abs(ball - BLUE).max() < 45, f"ball at {time} s: {ball}"
        if x - 90 > 0:
            assert np.abs(picture[round(y), round(x - 90)].astype(int) - PAPER).max() < 12
        box = picture[round(0.8 * 160), 3 * 160].astype(int)
        assert np.abs(box - RED).max() < 45, f"box at {time} s: {box}"
        left = int(np.flatnonzero(np.abs(picture[round(y)].astype(int) - PAPER).max(axis=1) > 100)[0])
        assert left == pytest.approx(max(x - 80, 0), abs=1.5)


def test_the_last_frame_shows_the_time_it_stands_for(
    scene: Scene, tmp_path: Path, straight: Straight
) -> None:
    out = tmp_path / "run.mp4"
    motion = straight(scene, duration=1.0, fps=20)
    write_video(str(out), Figure(scene, fit(scene, (640, 480)), CLEAN), motion, 20)
    _, _, times = decode(out)
    assert times[-1] == pytest.approx(0.95)


def test_bodies_that_leave_are_noted(scene_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = scene_file.parent / "run.mp4"
    assert main(["simulate", str(scene_file), "-o", str(out), "--duration", "4", "--size", "64x64"]) == 0
    # The ball's left side passes the page's right side (4 m) at (4 - 0.75 + 0.5) / 2 s.
    assert capsys.readouterr().err.splitlines() == ["note: ball leaves the picture at 1.9 s"]
