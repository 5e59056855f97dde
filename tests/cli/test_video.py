"""The video that comes out, decoded again."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest
from numpy.typing import NDArray

from cli.main import main
from cli.render.animation import changes, clock, drawn
from cli.render.camera import fit
from cli.render.figure import Figure
from cli.render.style import CLEAN
from cli.render.video import sheet as new_sheet
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
        box = picture[round(0.45 * 160), 3 * 160].astype(int)
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
    scene = json.loads(scene_file.read_text())
    scene["bodies"][2] = {**scene["bodies"][1], "id": "other", "position": [0.75, -0.45]}
    scene_file.write_text(json.dumps(scene))
    assert main(["simulate", str(scene_file), "-o", str(out), "--duration", "2.2", "--size", "64x64"]) == 0
    assert capsys.readouterr().err.splitlines() == ["note: ball and other leave the picture at 1.9 s"]


def spinning(scene: Scene) -> Scene:
    """Everything that moves turns as well, so that every part changes."""
    for body in scene.bodies[1:]:
        body.angular_velocity = 2.0
    return scene


def assert_as_drawn_afresh(figure: Figure, motion: Trajectory) -> None:
    """Every frame at 20 Hz has the pixels that it has on sheets nothing was drawn on before."""
    sheets = [new_sheet(figure.pen.size) for _ in range(2)]
    numbers = []
    for k, sheet in drawn(figure, motion, 20, lambda: sheets[len(numbers) % 2]):
        numbers.append(k)
        fresh = figure.background.to_yuv()
        figure.fill(fresh, figure.place(motion.positions[k], motion.angles[k]))
        figure.caption(fresh, f"{k // 2 / 10:.1f} s")
        for mine, its in zip(sheet.canvas.planes, fresh.planes, strict=True):
            assert np.array_equal(mine, its), f"frame {k}"
    assert numbers == list(range(len(motion) - 1))


def test_redrawing_only_what_changed_leaves_no_trace(scene: Scene, straight: Straight) -> None:
    figure = Figure(spinning(scene), fit(scene, (640, 480)), CLEAN)
    assert_as_drawn_afresh(figure, straight(scene, duration=1.5, fps=20))


def test_what_rests_for_a_while_lies_in_its_place_over_and_under_what_moves(
    scene: Scene, straight: Straight
) -> None:
    """The ball goes to and fro; the box circles, rests beside its way, circles, and rests over its way."""
    motion = straight(scene, duration=16.0, fps=20)
    t = motion.times
    motion.positions[:, 1] = np.stack([2.0 + 1.5 * np.sin(t), -0.9 + 0 * t], axis=1)
    turn = np.where((t > 2.5) & (t < 7), 2.5, np.minimum(t, 9.5))
    motion.positions[:, 2] = np.stack([2.0 - 1.5 * np.sin(turn), -1.9 - np.cos(turn)], axis=1)
    assert_as_drawn_afresh(Figure(scene, fit(scene, (320, 240)), CLEAN), motion)


def test_frames_at_rest_are_not_drawn_again(scene: Scene, straight: Straight, tmp_path: Path) -> None:
    """One second of motion, seven of rest: a frame for every full second, and the video lasts as long."""
    motion = straight(scene, duration=8.0, fps=20)
    motion.positions[20:] = motion.positions[20]
    out = tmp_path / "run.mp4"
    write_video(str(out), Figure(scene, fit(scene, (640, 480)), CLEAN), motion, 20)
    container, _, times = decode(out)
    stream = container.streams.video[0]
    assert times == pytest.approx([*(k / 20 for k in range(21)), 2, 3, 4, 5, 6, 7, 7.95])
    assert float(stream.duration * stream.time_base) == pytest.approx(8)


def test_bodies_out_of_the_picture_make_no_new_frames(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    motion = straight(scene, duration=8.0, fps=20)
    changed = changes(figure, motion, 160)
    last = int(np.flatnonzero(changed)[-1])
    assert last / 20 == pytest.approx((4 - 0.75 + 0.5) / 2, abs=0.1)
    assert changed[: last + 1].all()


def test_the_clock_counts_tenths_in_motion_and_seconds_at_rest() -> None:
    changed = np.ones(100, bool)
    assert clock(changed, 20)[::20] == ["0.0 s", "1.0 s", "2.0 s", "3.0 s", "4.0 s"]
    assert clock(changed, 20)[3] == "0.1 s"
    changed[31:91] = False
    texts = clock(changed, 20)
    assert texts[30:40] == ["1.5 s"] * 10
    assert texts[40:60] == ["2.0 s"] * 20
    assert texts[80:91] == ["4.0 s"] * 11
    assert texts[92] == "4.6 s"
    assert clock(np.array([True, False, False, True]), 20) == ["0.0 s", "0.0 s", "0.1 s", "0.1 s"]
