"""Strobe pictures, the scale bar's place and cameras of still outputs; edges and letters that do not go astray."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cli.main import main
from cli.render.animation import Extras
from cli.render.annotations import scale_bar
from cli.render.camera import Camera, about, fit
from cli.render.canvas import Canvas
from cli.render.figure import Figure
from cli.render.page import page
from cli.render.pen import Pen
from cli.render.still import strobe
from cli.render.style import CLEAN
from sim.scene import Scene
from sim.trajectory import Trajectory

Straight = Callable[..., Trajectory]


def blue(picture: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Where a picture shows the blue ball or its ghosts: (n, 2) rows and columns."""
    b, _, r = (picture[..., k].astype(int) for k in range(3))
    return np.argwhere(b - r > 60)


def test_a_body_that_comes_the_same_way_again_leaves_no_second_ghosts(
    scene: Scene, straight: Straight
) -> None:
    """There and back, and there again, at the same places: the same picture as there once."""
    there = straight(scene, duration=1.0, fps=100)
    again = straight(scene, duration=3.0, fps=100)
    again.positions[101:201] = there.positions[99::-1]
    again.positions[201:] = there.positions[1:]
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    once, thrice = (strobe(figure, motion).planes[0] for motion in (there, again))
    below = slice(120, None)  # the caption differs
    assert len(blue(once[below])) == pytest.approx(len(blue(thrice[below])), rel=0.05)


def test_ghosts_of_a_machine_are_whole() -> None:
    """A hub that turns on its spot belongs to the ghosts of the arm that it carries."""
    scene = Scene.from_dict(
        {
            "bodies": [
                {
                    "id": "hub",
                    "shape": {"type": "circle", "radius": 0.2},
                    "position": [0, 0],
                    "color": "#ff0000",
                },
                {"id": "arm", "shape": {"type": "rectangle", "size": [3, 0.1]}, "position": [1.5, 0]},
                {"id": "other", "shape": {"type": "circle", "radius": 0.2}, "position": [3, -3]},
            ],
            "joints": [{"type": "pivot", "bodies": ["hub", "arm"], "position": [0, 0]}] * 1,
        }
    )
    from cli.render.still import _machines

    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    owners = [{figure.parts[i].body for i in parts} for parts in _machines(figure)]
    assert owners == [{0, 1}, {2}]


def test_the_scale_bar_stands_in_the_corner_where_it_hides_the_least(scene: Scene) -> None:
    """The floor fills both lower corners, the box the upper right one."""
    camera = fit(scene, (640, 480))
    pen = Pen(CLEAN, (640, 480))
    scene.bodies[0].shape = type(scene.bodies[0].shape)((4.0, 1.2))
    bar = scale_bar(scene, camera, pen)
    assert bar.left < 100
    assert bar.bottom < 120
    assert scale_bar(Scene(), camera, pen).bottom > 400
    ink = [np.array([[0.1, -0.2], [1.0, -0.2], [0.1, -0.5], [1.0, -0.5]])]
    assert scale_bar(scene, camera, pen, ink) != bar


def test_with_every_corner_taken_the_scale_bar_stands_between_two() -> None:
    camera = Camera((1280, 720), 100.0, (0.0, 0.0))
    corners = [(x, y) for x in (1.5, 11.3) for y in (-0.7, -6.5)]
    shape = {"type": "rectangle", "size": [3.0, 1.4]}
    bodies = [{"id": f"{c}", "shape": shape, "position": c} for c in corners]
    bar = scale_bar(Scene.from_dict({"bodies": bodies}), camera, Pen(CLEAN, camera.size))
    assert 300 < bar.left < bar.left + bar.long < 980


@pytest.mark.parametrize("size", [(640, 360), (64, 64), (1280, 720)])
def test_letters_stay_in_the_picture(size: tuple[int, int]) -> None:
    figure = Figure(Scene(), fit(Scene(), size), CLEAN)
    dark = np.argwhere(figure.background.planes[0].min(axis=2) < 120)
    if size[0] > 64:
        assert dark[:, 1].max() < size[0] - 4
        assert dark[:, 0].max() < size[1] - 4
    assert len(dark) > 20


@pytest.mark.parametrize("turn", np.linspace(0, 1.5, 4).tolist())
def test_edges_of_concave_bodies_are_smooth(turn: float) -> None:
    """A star's outline, against the same drawn eight times as large."""
    star = [
        [0.9 * r * math.cos(k * math.pi / 5), 0.9 * r * math.sin(k * math.pi / 5)]
        for k, r in enumerate([1, 0.45] * 5)
    ]
    body = {
        "id": "star", "shape": {"type": "polygon", "vertices": star}, "position": [1, -1], "angle": turn,
        "color": "#000000",
    }  # fmt: skip
    view = {"pixels_per_metre": 360, "width": 720, "height": 720}
    scene = Scene.from_dict({"bodies": [body], "view": view})
    figure = Figure(scene, fit(scene, (720, 720)), replace(CLEAN, edge=(0, 0, 0), pale=0.0))
    canvas = Canvas.plain((720, 720), (255, 255, 255))
    figure.fill(canvas, figure.place(np.array([[1, -1]]), np.array([turn])))
    big = np.full((5760, 5760), 255, np.uint8)
    outline = np.array(scene.bodies[0].outline()) * (360, -360) * 8 - 0.5
    cv2.fillPoly(big, [np.rint(outline).astype(np.int32)], 0)
    true = cv2.resize(big, (720, 720), interpolation=cv2.INTER_AREA).astype(float)
    edge = (true > 0) & (true < 255)
    error = (canvas.planes[0].mean(axis=2) - true)[edge] / 255
    assert math.sqrt(np.mean(error**2)) < 0.1
    assert abs(error.mean()) < 0.08


def test_stills_follow_a_body(scene_file: Path, straight: Straight, scene: Scene) -> None:
    """The strobe picture shows the body's way as large as may be; the .svg has the body in its middle."""
    folder = scene_file.parent
    argv = ["simulate", str(scene_file), "--duration", "0.5", "--size", "640x480", "--camera", "follow:ball"]
    assert main([*argv, "-o", str(folder / "a.png"), "-o", str(folder / "a.svg")]) == 0
    found = re.search(r'<circle cx="([\d.]+)" cy="([\d.]+)"', (folder / "a.svg").read_text())
    assert found is not None
    assert [float(x) for x in found.groups()] == pytest.approx([320, 240])
    ball = blue(cv2.imread(str(folder / "a.png")))
    assert ball.min(axis=0).min() > 20
    assert np.ptp(ball[:, 1]) > 200
    camera = about(fit(scene, (640, 480)), straight(scene).positions[:, 1], 0.5)
    ends = camera.pixels(straight(scene).positions[[0, -1], 1])
    assert ends.mean(axis=0) == pytest.approx([320, 240])


def test_the_page_shows_the_body_that_goes_farthest(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    for follow, expected in ((None, (-1, 1)), (2, (2, 2))):
        html = page(figure, straight(scene), "a", extras=Extras(follow=follow, vectors=True)).decode()
        found = re.search(r'type="application/json">(.*?)</script>', html, re.S)
        assert found is not None
        data = json.loads(found[1])
        assert (data["follow"], data["body"]) == expected
        assert (data["vectors"], data["trails"]) == (True, False)


def test_strobe_pictures_show_trails(scene: Scene, straight: Straight) -> None:
    """A body that swings down and back up leaves a path between its ghosts."""
    motion = straight(scene, duration=1.0, fps=20)
    motion.positions[:, 2, 1] += np.linspace(0, -2, len(motion)) ** 2 * np.linspace(1, 0, len(motion))
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    without, with_ = (strobe(figure, motion, trails).planes[0].astype(int) for trails in (False, True))
    assert (np.abs(with_ - without).max(axis=2) > 40).sum() > 20
