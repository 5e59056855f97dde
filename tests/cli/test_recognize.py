"""From ink to a scene, a picture of what was seen, an explanation, a video."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cli.main import main
from cli.render.overlay import overlay
from cli.render.style import CLEAN
from cli.render.text import lettering
from sim.scene import Scene
from sketch import load_sketch, recognize
from sketch.ink import Sketch, Stroke
from sketch.recognize import Reading, Recognition


def circle(x: float, y: float, r: float) -> list[list[float]]:
    return [[x + r * math.cos(k / 10), y + r * math.sin(k / 10)] for k in range(63)]


def line(*corners: tuple[float, float]) -> list[list[float]]:
    """A stroke through the corners with a point every few pixels, as a pen gives."""
    points: list[list[float]] = []
    for (ax, ay), (bx, by) in pairwise(corners):
        n = max(2, round(math.hypot(bx - ax, by - ay) / 6))
        points += [[ax + (bx - ax) * k / n, ay + (by - ay) * k / n] for k in range(n)]
    return [*points, list(corners[-1])]


# A ball over a floor with an X in it, and an arrow.
STROKES = [
    line((100, 400), (540, 400), (540, 450), (100, 450), (100, 400)),
    line((300, 410), (340, 442)),
    line((340, 410), (300, 442)),
    circle(320, 200, 50),
    line((560, 60), (560, 180), (545, 155), (560, 180), (575, 155)),
]


@pytest.fixture
def sketch_file(tmp_path: Path) -> Path:
    path = tmp_path / "ball.json"
    strokes = [{"points": stroke} for stroke in STROKES]
    path.write_text(json.dumps({"width": 640, "height": 480, "pixels_per_metre": 100, "strokes": strokes}))
    return path


def test_a_drawing_becomes_a_scene(sketch_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = sketch_file.parent / "scene.json"
    assert main(["recognize", str(sketch_file), "-o", str(out)]) == 0
    assert capsys.readouterr().out == ""
    scene = Scene.load(out)
    assert sorted(type(body.shape).__name__ for body in scene.bodies) == ["Circle", "Rectangle"]
    assert [type(body.shape).__name__ for body in scene.bodies if body.anchored] == ["Rectangle"]
    assert scene.gravity == pytest.approx((0, -9.81), abs=0.2)


def test_the_scene_goes_to_standard_output(
    sketch_file: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    assert main(["recognize", str(sketch_file)]) == 0
    assert len(Scene.from_json(capfdbinary.readouterr().out).bodies) == 2


def test_scale_is_that_of_the_drawing(sketch_file: Path) -> None:
    out = sketch_file.parent / "scene.json"
    assert main(["recognize", str(sketch_file), "-o", str(out), "--scale", "50"]) == 0
    ball = next(b for b in Scene.load(out).bodies if not b.anchored)
    assert ball.shape.radius == pytest.approx(1.0, rel=0.05)  # type: ignore[union-attr]


def test_explanation_names_every_reading(sketch_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["recognize", str(sketch_file), "--explain"]) == 0
    text = capsys.readouterr().out
    for word in ("circle", "rectangle", "anchor", "gravity", "anchored", "strokes 1, 2"):
        assert word in text


def test_quiet_leaves_the_notes_out(sketch_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    drawing = json.loads(sketch_file.read_text())
    drawing["strokes"].append(line((100, 100), (300, 105)))
    sketch_file.write_text(json.dumps(drawing))
    assert main(["recognize", str(sketch_file)]) == 0
    assert "open line" in capsys.readouterr().err
    assert main(["recognize", str(sketch_file), "--quiet"]) == 0
    assert capsys.readouterr().err == ""


def test_explanation_leaves_standard_output_to_the_scene(
    sketch_file: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    assert main(["recognize", str(sketch_file), "--explain", "-o", "-"]) == 0
    captured = capfdbinary.readouterr()
    assert len(Scene.from_json(captured.out).bodies) == 2
    assert b"rectangle" in captured.err


def test_strokes_are_what_the_caller_says(sketch_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = sketch_file.parent / "scene.json"
    before = recognize(load_sketch(sketch_file))
    ball = next(r for r in before.readings if r.kind == "circle")
    said = ",".join(map(str, ball.strokes)) + "=ignore"
    assert main(["recognize", str(sketch_file), "-o", str(out), "--read", said]) == 0
    assert len(Scene.load(out).bodies) == len(before.scene.bodies) - 1
    assert main(["simulate", str(sketch_file), "-o", str(out), "--read", said, "--duration", "0.1"]) == 0
    for wrong, message in [
        ("3", "'3' is not STROKES=KIND"),
        ("0=wheel", "--read 0: 'wheel' is not a reading"),
        ("2,999=ball", "--read 2,999: there is no stroke 999"),
    ]:
        capsys.readouterr()
        assert main(["recognize", str(sketch_file), "-o", str(out), "--read", wrong]) == 2
        assert message in capsys.readouterr().err


def test_drawing_to_video_falls_and_rests(sketch_file: Path) -> None:
    out = sketch_file.parent / "run"
    argv = ["simulate", str(sketch_file), "-o", f"{out}.mp4", "-o", f"{out}.json", "--duration", "3"]
    assert main([*argv, "--size", "320x240"]) == 0
    run = json.loads(Path(f"{out}.json").read_bytes())
    ball = next(k for k in range(2) if run["positions"][0][k] != run["positions"][-1][k])
    # The floor's top is at y = -4 m, the ball's radius 0.5 m.
    assert run["positions"][-1][ball][1] == pytest.approx(-3.5, abs=0.05)
    assert Path(f"{out}.mp4").stat().st_size > 1000


def test_gravity_of_the_command_line_comes_before_the_drawn(
    sketch_file: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    argv = ["simulate", str(sketch_file), "-o", "-", "--duration", "0.1", "--gravity"]
    assert main([*argv, "none"]) == 0
    run = json.loads(capfdbinary.readouterr().out)
    assert run["velocities"][0] == run["velocities"][-1]
    assert main([*argv, "-2,0"]) == 0
    run = json.loads(capfdbinary.readouterr().out)
    moving = max(run["velocities"][-1], key=lambda v: abs(v[0]))
    assert moving == pytest.approx([-0.2, 0], abs=1e-9)


def test_a_gravity_that_is_asked_for_makes_its_note_void_and_no_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawing = tmp_path / "drawing.json"
    drawing.write_text(json.dumps({"strokes": [STROKES[0], line((100, 100), (300, 105))]}))
    argv = ["simulate", str(drawing), "-o", str(tmp_path / "run.csv"), "--duration", "0.1"]
    assert main(argv) == 0
    missing, bar = capsys.readouterr().err.splitlines()
    assert missing == "note: no gravity arrow: nothing will fall"
    assert "open line" in bar
    assert main([*argv, "--gravity", "down"]) == 0
    assert capsys.readouterr().err.splitlines() == [bar]


def test_bad_strokes_name_the_place(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text('{"strokes": [{"points": [[1, 2], [3, 4]]}, {"points": [[0, 0], [NaN, 1]]}]}')
    for command in ("recognize", "simulate"):
        assert main([command, str(bad)]) == 3
        captured = capsys.readouterr()
        assert captured.err.splitlines()[0].startswith("error: strokes[1].points[1]: x is")


def test_overlay_file(sketch_file: Path) -> None:
    out = sketch_file.parent / "seen.png"
    assert main(["recognize", str(sketch_file), "--overlay", str(out)]) == 0
    picture = cv2.imread(str(out))
    assert picture.shape == (480, 640, 3)
    assert sorted(path.name for path in sketch_file.parent.iterdir()) == ["ball.json", "seen.png"]


def test_overlay_names_bodies_by_their_ids_and_all_else_by_its_strokes(
    sketch_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []

    def told(text: str, size: int) -> NDArray[np.uint8]:
        written.append(text)
        return lettering(text, size)

    monkeypatch.setattr("cli.render.overlay.lettering", told)
    overlay(recognize(load_sketch(sketch_file)))
    assert sorted(written) == ["anchor 1,2", "b1 rectangle", "b2 circle", "gravity 4"]


def test_overlay_shows_unread_ink_in_the_signal_colour() -> None:
    ink = Sketch([Stroke(np.array(line((20, 100), (180, 100))))], 200, 200)
    reading = Reading("unread", (0,), 0.4, np.zeros((0, 2)))
    picture = overlay(Recognition(ink, Scene(), [reading])).planes[0]
    near = np.abs(picture[97:104, 100].astype(int) - CLEAN.signal[::-1]).max(axis=1)
    assert near.min() < 30


def test_overlay_leaves_a_bent_bar_open() -> None:
    corners = np.array([(40.0, 160.0), (40.0, 40.0), (160.0, 40.0)])
    ink = Sketch([Stroke(corners)], 200, 200)
    picture = overlay(Recognition(ink, Scene(), [Reading("bar", (0,), 1.0, corners)])).planes[0]
    paper = picture[190, 190]
    assert np.all(picture[95:105, 95:105] == paper)  # on the way from end to end
    assert np.any(picture[100, 35:46] != paper)


def test_overlay_reduces_large_pictures_and_keeps_their_form() -> None:
    ink = Sketch([], 4000, 1000, picture=np.full((1000, 4000, 3), 200, np.uint8))
    assert overlay(Recognition(ink, Scene(), [])).planes[0].shape == (400, 1600, 3)


def test_overlay_of_a_page_without_size_shows_all_ink() -> None:
    ink = Sketch([Stroke(np.array(line((20, 30), (300, 100))))])
    assert overlay(Recognition(ink, Scene(), [])).planes[0].shape == (120, 320, 3)


def test_stages_show_what_was_seen_on_a_picture(tmp_path: Path) -> None:
    paper = Path(__file__).resolve().parents[2] / "samples" / "pendulum-on-paper.jpg"
    out = tmp_path / "scene.json"
    assert main(["recognize", str(paper), "-o", str(out), "--stages", str(tmp_path / "seen")]) == 0
    seen = sorted(path.name for path in (tmp_path / "seen").iterdir())
    assert seen == ["1-page.png", "2-mask.png", "3-skeleton.png", "4-strokes.png"]
    assert all(cv2.imread(str(tmp_path / "seen" / name)) is not None for name in seen)


def test_elasticity_and_friction_are_those_of_every_body(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    """A ball is dropped from 1 m, and another slides at 1 m/s: v = e √(2 g h), and μ g t is lost."""
    ball = {"shape": {"type": "circle", "radius": 0.1}}
    block = {"shape": {"type": "rectangle", "size": [0.4, 0.4]}}
    floor = {"shape": {"type": "rectangle", "size": [20, 1]}, "anchored": True}
    bodies = [
        {"id": "floor", "position": [0, -0.5], **floor},
        {"id": "ball", "position": [3, 1.1], **ball},
        {"id": "block", "position": [-3, 0.2], "velocity": [1, 0], **block},
    ]
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps({"bodies": bodies, "gravity": [0, -10]}))
    argv = ["simulate", str(scene), "-o", "-", "--fps", "100", "--duration", "0.46"]
    assert main([*argv, "--elasticity", "0.5", "--friction", "0.1"]) == 0
    run = json.loads(capfdbinary.readouterr().out)
    fall = (2 * 1 / 10) ** 0.5
    up = 0.5 * 10 * fall - 10 * (0.46 - fall)
    assert run["velocities"][-1][1] == pytest.approx([0, up], abs=1e-3)
    assert run["velocities"][-1][2] == pytest.approx([1 - 0.1 * 10 * 0.46, 0], abs=1e-3)
    assert main([*argv, "--elasticity", "1.5"]) == 2
    assert b"--elasticity: 1.5 is more than 1" in capfdbinary.readouterr().err
    assert main([*argv, "--friction", "-1"]) == 2
    assert b"--friction: -1 is less than 0" in capfdbinary.readouterr().err


def test_bodies_too_far_in_one_another_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shape = {"shape": {"type": "circle", "radius": 1.0}}
    scene = tmp_path / "scene.json"
    told = []
    for apart in (0.2, 1.98):
        bodies = [{"id": "a", "position": [0, 0], **shape}, {"id": "b", "position": [apart, 0], **shape}]
        scene.write_text(json.dumps({"bodies": bodies}))
        assert main(["simulate", str(scene), "-o", str(tmp_path / "a.csv"), "--duration", "0.1"]) == 0
        told.append("pass through each other" in capsys.readouterr().err)
    assert told == [True, False]
