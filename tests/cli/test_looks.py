"""Every kind of output and every look, by what can be seen or read in it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import av
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cli.commands.simulate import until_rest
from cli.main import main
from cli.outputs import Outputs
from cli.render.animation import PLAIN, Extras, drawn
from cli.render.camera import along, fit
from cli.render.figure import Figure
from cli.render.gif import choose_palette, nearest_of, quantized
from cli.render.ink import world_strokes
from cli.render.style import BLUEPRINT, CLEAN, INK
from cli.render.text import LETTERS, lettering
from cli.render.video import sheet, write_video
from cli.results import Look, Run
from sim.scene import Joint, Scene
from sim.trajectory import Trajectory
from sketch.ink import Sketch, Stroke
from sketch.recognize import Reading, Recognition

Straight = Callable[..., Trajectory]
Picture = NDArray[np.uint8]


def frames(figure: Figure, motion: Trajectory, extras: Extras = PLAIN) -> list[Picture]:
    """Every frame of a motion at 20 fps, in BGR."""
    page = sheet(figure.pen.size)
    found = []
    for _, done in drawn(figure, motion, 20, lambda: page, extras):
        found.append(np.array(cv2.cvtColorTwoPlane(*done.canvas.planes, cv2.COLOR_YUV2BGR_NV12)))
    return found


def test_webm_is_the_same_film(scene: Scene, straight: Straight, tmp_path: Path) -> None:
    out = tmp_path / "run.webm"
    motion = straight(scene, duration=1.0, fps=20)
    write_video(str(out), Figure(scene, fit(scene, (320, 240)), CLEAN), motion, 20, ".webm")
    with av.open(str(out)) as container:
        stream = container.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
        assert stream.codec_context.name in ("vp9", "libvpx-vp9")
        assert float(container.duration or 0) / av.time_base == pytest.approx(1, abs=0.06)
    assert len(pictures) == 20
    r, g, b = pictures[10][120 + 20, round((0.75 + 1) * 80) - 15].astype(int)
    assert b > 180
    assert max(r, g) < 110


def test_gif_loops_lasts_and_keeps_its_colours(scene: Scene, straight: Straight, tmp_path: Path) -> None:
    out = tmp_path / "run.gif"
    run = Run("run", scene, straight(scene, duration=1.0, fps=50), 50, Look((320, 240)))
    with Outputs() as files:
        run.write(files, str(out), lambda _: None)
    data = out.read_bytes()
    assert data.startswith(b"GIF89a")
    assert b"NETSCAPE2.0\x03\x01\x00\x00" in data  # for ever
    with av.open(str(out)) as container:
        pictures = list(container.decode(video=0))
    assert float(pictures[-1].time) == pytest.approx(0.98, abs=0.011)
    assert 24 <= len(pictures) <= 27
    first = pictures[0].to_ndarray(format="rgb24")
    assert np.abs(first[120 + 20, 60 - 15].astype(int) - (30, 30, 254)).max() < 12
    assert np.abs(first[40, 160].astype(int) - CLEAN.paper).max() <= 8


def test_palette_keeps_the_large_areas_exactly() -> None:
    picture = np.zeros((64, 64, 3), np.uint8)
    picture[:32] = (10, 200, 33)
    rng = np.random.default_rng(5)
    picture[50:] = rng.integers(0, 255, (14, 64, 3))
    palette = choose_palette([picture]).tolist()
    assert [10, 200, 33] in palette
    assert [0, 0, 0] in palette
    assert len(palette) == 256


def test_large_areas_of_nearly_one_colour_stay_apart() -> None:
    """The middle of the first one's coarse colour is nearer to the second one."""
    picture = np.full((64, 64, 3), (208, 237, 241), np.uint8)
    picture[:20] = 211, 234, 242
    picture[:, 60:] = np.random.default_rng(5).integers(0, 256, (64, 4, 3))
    palette = choose_palette([picture])
    shown = palette[quantized(picture, nearest_of(palette))]
    assert np.array_equal(shown[:, :60], picture[:, :60])


def test_svg_shows_every_body_where_it_is(scene: Scene, straight: Straight, tmp_path: Path) -> None:
    out = tmp_path / "scene.svg"
    scene.bodies[1].id = 'a <b> & "c"'
    with Outputs() as files:
        Run("run", scene, straight(scene), 20, Look((640, 480))).write(files, str(out), lambda _: None)
    root = ET.parse(out).getroot()
    space = "{http://www.w3.org/2000/svg}"
    assert root.get("viewBox") == "0 0 640 480"
    ball = root.find(f"{space}g/{space}circle")
    assert ball is not None
    assert [float(ball.get(name, "")) for name in ("cx", "cy", "r")] == [120, 240, 80]
    titles = [title.text for title in root.iter(f"{space}title")]
    assert titles == ["floor", 'a <b> & "c"', "box"]
    floor = next(p for p in root.iter(f"{space}polygon"))
    assert floor.get("fill", "").startswith("url(#hatch")
    assert [text.text for text in root.iter(f"{space}text")] == ["50 cm", "no gravity"]
    scene.gravity = (0, -9.81)
    with Outputs() as files:
        Run("run", scene, straight(scene), 20, Look((640, 480))).write(files, str(out), lambda _: None)
    assert [text.text for text in ET.parse(out).iter(f"{space}text")] == ["50 cm", "g"]


def test_blueprint_is_light_on_blue(scene: Scene, straight: Straight) -> None:
    picture = frames(Figure(scene, fit(scene, (640, 480)), BLUEPRINT), straight(scene, duration=0.1))[0]
    b, g, r = np.median(picture.reshape(-1, 3), axis=0)
    assert b > 100
    assert max(g, r) < 80
    assert picture.max() > 220


def scribbled(scene: Scene) -> Recognition:
    """The ball as two strokes, and one that nobody could read."""
    ring = np.array([[24 + 16 * np.cos(a), 48 + 16 * np.sin(a)] for a in np.linspace(0, 6.3, 40)])
    pin, noise = ring * 0.2 + (19.2, 38.4), np.array([[100.0, 40], [120, 60]])
    scene.bodies[1].strokes = [0]
    scene.joints = [Joint(bodies=("ball", None), position=(0.75, -1.5))]
    ink = Sketch([Stroke(ring), Stroke(pin), Stroke(noise)], 128, 96)
    readings = [
        Reading("circle", (0,), 1, ring),
        Reading("pivot", (1,), 1, pin),
        Reading("unread", (2,), 0, noise),
    ]
    return Recognition(ink, scene, readings)


def test_strokes_belong_to_their_bodies_and_pivots_to_what_carries_them(scene: Scene) -> None:
    ink = world_strokes(scribbled(scene))
    assert [body for body, _ in ink] == [1, 1, None]
    assert ink[2][1].tolist() == [[100 / 32, -40 / 32], [120 / 32, -60 / 32]]


def test_ink_moves_with_its_body(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), INK, world_strokes(scribbled(scene)))
    pictures = frames(figure, straight(scene, duration=0.5))
    dark = [picture.max(axis=2) < 120 for picture in (pictures[0], pictures[-1])]
    row = 240 - 60  # the ring's upper half, above the mark
    moved = round(2.0 * 0.45 * 160)
    first, last = (np.flatnonzero(picture[row, :520]) for picture in dark)
    assert len(first) >= 2
    assert last.min() - first.min() == pytest.approx(moved, abs=2)
    assert dark[0][200:300, 500:600].any()  # what was not read stays
    assert np.array_equal(dark[0][200:300, 540:600], dark[1][200:300, 540:600])


def test_trails_show_the_way_and_stay(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    motion = straight(scene, duration=1.5)
    plain, trailed = (
        frames(figure, motion, extras)[-1].astype(int) for extras in (Extras(), Extras(trails=True))
    )
    difference = np.abs(plain - trailed).max(axis=2)[240 - 2 : 240 + 2].max(axis=0)
    assert difference[125:300].min() > 60  # from where the ball started to where it covers its trail
    assert np.abs(figure.background.planes[0].astype(int)[236:244, 130:300] - CLEAN.paper[::-1]).max() == 0


def test_vectors_point_where_bodies_go(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    motion = straight(scene, duration=0.2)
    plain, drawn_ = (
        frames(figure, motion, extras)[0].astype(int) for extras in (Extras(), Extras(vectors=True))
    )
    rows, columns = np.nonzero(np.abs(plain - drawn_).max(axis=2) > 40)
    assert np.abs(rows - 240).max() < 12  # level
    assert columns.min() >= 118  # from the ball's centre, and none at the box, which stands still
    assert 150 < columns.max() < 250


def test_following_keeps_the_body_in_the_middle(scene: Scene, straight: Straight) -> None:
    motion = straight(scene, duration=2.0)
    camera = fit(scene, (320, 240))
    wide = along(camera, motion.positions[:, 1])
    assert wide.scale == camera.scale
    figure = Figure(scene, wide, CLEAN, size=(320, 240))
    for picture in frames(figure, motion, Extras(follow=1)):
        assert picture.shape == (240, 320, 3)
        b, _, r = picture[120 + 20, 160 - 15].astype(int)
        assert b > 200
        assert r < 80


def test_follow_needs_a_body_that_is_there(scene_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(scene_file.parent / "run.mp4")
    assert main(["simulate", str(scene_file), "-o", out, "--camera", "follow:bell"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        "error: --camera: there is no body 'bell' [usage]",
        "hint: the bodies are: floor ball box",
    ]
    assert main(["simulate", str(scene_file), "-o", out, "--camera", "orbit"]) == 2
    argv = ["simulate", str(scene_file), "-o", out, "--camera", "follow:ball", "--size", "64x64"]
    assert main([*argv, "--duration", "0.5"]) == 0


def test_until_rest_ends_a_second_after_the_last_movement(scene: Scene, straight: Straight) -> None:
    motion = straight(scene, duration=5.0, fps=20)
    assert until_rest(motion, 20) == (motion, False)
    motion.velocities[21:] = 0
    cut, rested = until_rest(motion, 20)
    assert rested
    assert cut.times[-1] == 2.0
    assert len(cut.energy) == len(cut.angles) == 41


def test_still_moving_is_said(scene_file: Path, capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    argv = ["simulate", str(scene_file), "-o", "-", "--until-rest", "--duration", "1"]
    assert main(argv) == 0
    assert capfdbinary.readouterr().err == b"note: still moving after 1 s\n"
    assert main([*argv, "--quiet"]) == 0
    assert capfdbinary.readouterr().err == b""


def test_several_inputs_give_each_file_its_inputs_name(
    scene_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = scene_file.parent
    monkeypatch.chdir(folder)
    (folder / "other.json").write_bytes(scene_file.read_bytes())
    (folder / "films").mkdir()
    argv = ["simulate", "scene.json", "other.json", "--duration", "0.1"]
    assert main([*argv, "-o", ".csv", "-o", "films/.npz"]) == 0
    assert sorted(path.name for path in folder.iterdir()) == [
        "films", "other.csv", "other.json", "scene.csv", "scene.json",
    ]  # fmt: skip
    assert sorted(path.name for path in (folder / "films").iterdir()) == ["other.npz", "scene.npz"]
    assert main([*argv, "-o", "run.csv"]) == 2
    assert "error: -o run.csv: one file cannot hold 2 runs" in capsys.readouterr().err
    assert main([*argv, "-o", ".json"]) == 2  # this would write over the inputs
    (folder / "other.json").write_text('{"bodies": 3}')
    assert main([*argv, "-o", ".csv"]) == 3
    assert capsys.readouterr().err.splitlines()[-1].startswith("error: other.json: bodies: expected")


def test_verbose_tells_the_profile(scene_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", str(scene_file), "-o", str(scene_file.parent / "a.csv"), "-v"]) == 0
    first, *rest = capsys.readouterr().err.splitlines()
    assert first.startswith("note: 3 bodies, 0 joints, 601 samples")
    assert rest[-1].startswith("note: wrote ")


def test_the_page_carries_the_motion(scene_file: Path) -> None:
    out = scene_file.parent / "run.html"
    scene = json.loads(scene_file.read_text())
    scene["bodies"][1]["id"] = "</script><b>"
    scene_file.write_text(json.dumps(scene))
    assert main(["simulate", str(scene_file), "-o", str(out), "--duration", "0.5", "--fps", "10"]) == 0
    html = out.read_text("utf-8")
    start = html.index('<script id="data" type="application/json">') + len(
        '<script id="data" type="application/json">'
    )
    data = json.loads(html[start : html.index("</script>", start)])
    assert [body["id"] for body in data["bodies"]] == ["floor", "</script><b>", "box"]
    assert (data["count"], data["fps"]) == (6, 10)
    assert "{{" not in html.partition("<script>")[0]


def test_every_letter_is_drawn_within_its_mask() -> None:
    for letter in LETTERS:
        mask = lettering(letter, 40)
        assert mask.max() > 200, letter
        edges = (mask[0], mask[-1], mask[:, 0], mask[:, -1])
        assert max(int(edge.max()) for edge in edges) == 0, letter
    assert lettering("0", 12).shape[0] < lettering("0", 24).shape[0]
    assert np.array_equal(lettering("€", 20), lettering("?", 20))


@pytest.mark.parametrize(
    "options",
    [
        ["--size", "64x64"],
        ["--duration", "0.001"],
        ["--fps", "0.1"],
        ["--fps", "29.97", "--duration", "0.2"],
        ["--size", "64x512", "--style", "blueprint", "--vectors"],
    ],
    ids=" ".join,
)
def test_unusual_sizes_and_rates_are_drawn_too(options: list[str], scene_file: Path) -> None:
    scene = json.loads(scene_file.read_text())
    scene["joints"] = [{"type": "pivot", "bodies": ["ball", None], "position": [0.75, -1.5]}]
    scene_file.write_text(json.dumps(scene))
    outputs = [f"-o.{kind}" for kind in ("mp4", "gif", "png", "svg", "html")]
    argv = ["simulate", str(scene_file), "--duration", "1", "--size", "320x240"]
    assert (
        main([*argv, *(out.replace("-o.", f"-o{scene_file.parent}/run.") for out in outputs), *options]) == 0
    )
    assert all((scene_file.parent / f"run.{kind[3:]}").stat().st_size > 300 for kind in outputs)


def test_a_scene_without_bodies_is_drawn(tmp_path: Path) -> None:
    empty = tmp_path / "empty.json"
    empty.write_text('{"bodies": []}')
    targets = [str(tmp_path / f"run.{kind}") for kind in ("mp4", "webm", "gif", "png", "svg", "html", "csv")]
    argv = [word for target in targets for word in ("-o", target)]
    assert main(["simulate", str(empty), "--duration", "1", "--size", "64x64", *argv]) == 0
    assert all(Path(target).exists() for target in targets)


@pytest.mark.parametrize("kind", ["mp4", "webm", "gif", "png", "html", "svg", "npz"])
def test_the_same_scene_gives_the_same_file(kind: str, scene_file: Path) -> None:
    contents = []
    for k in range(2):
        out = scene_file.parent / f"run{k}.{kind}"
        argv = ["simulate", str(scene_file), "-o", str(out), "--duration", "0.5", "--size", "160x120"]
        assert main(argv) == 0
        contents.append(out.read_bytes())
    assert contents[0] == contents[1]
