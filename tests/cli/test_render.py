"""Camera, outlines, canvas: the geometry of a picture."""

from __future__ import annotations

import math
from collections.abc import Callable

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cli.render.annotations import round_length
from cli.render.camera import fit, outside
from cli.render.canvas import BLOOM, ONE, Canvas, fixed
from cli.render.figure import Figure
from cli.render.outline import inset, is_convex, segment, signed_area
from cli.render.still import strobe
from cli.render.style import CLEAN, mix
from sim.scene import Scene
from sim.trajectory import Trajectory

Straight = Callable[..., Trajectory]


def test_a_page_fills_the_picture(scene: Scene) -> None:
    camera = fit(scene, (256, 192))
    assert camera.scale == 64
    assert camera.pixels(np.array([[0, 0], [4, -3]])).tolist() == [[0, 0], [256, 192]]
    assert camera.page(np.array([[128, 96]]), 32).tolist() == [[256, 192]]


def test_a_page_of_another_form_is_centred(scene: Scene) -> None:
    camera = fit(scene, (512, 192))
    assert camera.scale == 64
    assert camera.pixels(np.array([2, -1.5])).tolist() == [256, 96]


def test_without_a_page_bodies_and_their_motion_are_fitted(scene: Scene, straight: Straight) -> None:
    scene.view = None
    motion = straight(scene, duration=4.0)
    camera = fit(scene, (640, 360), motion)
    for k in (0, -1):
        for at in motion.positions[k, 1:]:
            column, row = camera.pixels(at)
            assert 0 < column < 640
            assert 0 < row < 360
    assert not outside(scene, motion, camera)


def test_a_body_that_flies_away_does_not_shrink_the_rest_to_nothing(scene: Scene, straight: Straight) -> None:
    scene.view = None
    scene.bodies[1].velocity = (1e4, 0)
    motion = straight(scene, duration=4.0)
    camera = fit(scene, (640, 360), motion)
    assert 0.5 * camera.scale > 3  # the ball's radius in pixels
    assert [name for name, _ in outside(scene, motion, camera)] == ["ball"]


@given(
    sides=st.integers(3, 12),
    turn=st.floats(0, 6.3),
    radius=st.floats(5, 100),
    distance=st.floats(0.1, 1.0),
    clockwise=st.booleans(),
)
@settings(derandomize=True, max_examples=60)
def test_inset_moves_the_sides_of_a_regular_polygon(
    sides: int, turn: float, radius: float, distance: float, clockwise: bool
) -> None:
    angles = turn + 2 * math.pi * np.arange(sides) / sides
    v = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if clockwise:
        v = v[::-1]
    moved = inset(v, distance)
    apothem = radius * math.cos(math.pi / sides)
    expected = v * (apothem - distance) / apothem
    assert moved == pytest.approx(expected, abs=1e-9)


def test_inset_of_a_concave_polygon_loses_about_its_outline() -> None:
    v = np.array([[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6.0]])
    assert signed_area(inset(v, 0.1)) == pytest.approx(20 - 24 * 0.1 + 4 * 0.01, abs=1e-9)


def test_inset_of_something_thinner_than_the_line_stays_inside() -> None:
    v = np.array([[0, 0], [10, 0], [10, 0.5], [0, 0.5]])
    moved = inset(v, 1.0)
    assert moved.min() >= 0
    assert moved[:, 1].max() <= 0.5


def test_convexity_is_told_both_ways_round() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    dart = np.array([[0, 0], [1, 0], [0.2, 0.2], [0, 1.0]])
    for v in (square, square[::-1]):
        assert is_convex(v)
    for v in (dart, dart[::-1]):
        assert not is_convex(v)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785])
def test_fills_cover_the_area_that_they_should(angle: float) -> None:
    """The area of a fill in pixels, to within a tenth of a pixel along its outline."""
    c, s = math.cos(angle), math.sin(angle)
    v = np.array([[-30, -20], [30, -20], [30, 20], [-30, 20]]) @ np.array([[c, s], [-s, c]]) + 50.3
    canvas = Canvas.plain((100, 100), (0, 0, 0))
    canvas.polygon(fixed(inset(v, BLOOM)), (255, 255, 255))
    assert canvas.planes[0][..., 0].sum() / 255 == pytest.approx(2400, abs=0.12 * 200)


def test_lines_have_their_true_width() -> None:
    canvas = Canvas.plain((100, 60), (0, 0, 0))
    canvas.polygon(
        fixed(segment(np.array([-50.0, 30]), np.array([150.0, 30]), 4 - 2 * BLOOM)), (255, 255, 255)
    )
    assert canvas.planes[0][:, 50, 0].sum() / 255 == pytest.approx(4, abs=0.25)


def test_planes_of_video_agree_with_the_picture_in_rgb(scene: Scene) -> None:
    """Drawing straight to Y, U and V gives what converting the RGB picture would."""
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    placed = figure.place(*(np.array([getattr(b, n) for b in scene.bodies]) for n in ("position", "angle")))
    picture = Canvas.plain((640, 480), (0, 0, 0))
    picture.copy_from(figure.background)
    figure.fill(picture, placed)
    direct = figure.background.to_yuv()
    figure.fill(direct, placed)
    for mine, its in zip(direct.planes, picture.to_yuv().planes, strict=True):
        difference = np.abs(mine.astype(int) - its)
        assert np.percentile(difference, 98) <= 3
    back = cv2.cvtColorTwoPlane(*direct.planes, cv2.COLOR_YUV2BGR_NV12)
    assert np.median(np.abs(back.astype(int) - picture.planes[0])) <= 1


def test_a_rolling_disc_shows_that_it_turns(scene: Scene) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    positions = np.array([body.position for body in scene.bodies])
    pictures = []
    for angle in (0.0, 1.0):
        canvas = Canvas.plain((640, 480), (0, 0, 0))
        canvas.copy_from(figure.background)
        figure.fill(canvas, figure.place(positions, np.array([0, angle, 0])))
        pictures.append(canvas.planes[0].astype(int))
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 60).sum() > 50


def test_anchored_bodies_are_hatched(scene: Scene) -> None:
    """Along a row through the floor light and dark alternate; through the box they do not."""
    figure = Figure(scene, fit(scene, (1280, 960)), CLEAN)
    row = figure.background.planes[0][round(2.75 * 320)].astype(int).sum(axis=1)[300:980]
    dark = row < (row.min() + row.max()) / 2
    assert np.count_nonzero(np.diff(dark.astype(int)) == 1) > 10


def test_strobe_shows_the_start_the_end_and_ghosts_between(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    picture = strobe(figure, straight(scene, duration=1.0)).planes[0]
    row = picture[round(1.5 * 160) + 40].astype(int)  # below the mark, through the ball
    at_end, at_start = row[round(2.75 * 160)], row[round(0.6 * 160)]
    blue = np.array([255, 0, 0])
    assert np.abs(at_end - blue).max() < 45
    assert np.abs(at_start - np.array(mix((0, 0, 255), CLEAN.paper, 0.62)[::-1])).max() < 45


def test_strobe_of_a_scene_that_hardly_settles_is_one_at_rest(scene: Scene, straight: Straight) -> None:
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    settling = straight(scene, duration=2.0)
    settling.positions[:, 1:] = settling.positions[0, 1:]
    settling.positions[1:, 1, 1] -= 3 / figure.camera.scale
    resting = straight(scene, duration=2.0)
    resting.positions[:] = settling.positions[-1]
    shown, still = (strobe(figure, motion).planes[0] for motion in (settling, resting))
    assert np.array_equal(shown, still)


def test_strobe_ends_where_the_motion_does(scene: Scene, straight: Straight) -> None:
    """Of ten seconds the ball moves for one: the end is where it stops, with the ghosts before it."""
    motion = straight(scene, duration=10.0)
    motion.positions[20:] = motion.positions[20]
    motion.positions[20:, 1, 0] += 0.2 / 160 * np.sin(np.arange(len(motion) - 20))  # a fifth of a pixel
    figure = Figure(scene, fit(scene, (640, 480)), CLEAN)
    short, long = (strobe(figure, m).planes[0] for m in (straight(scene, duration=1.0), motion))
    assert (np.abs(short.astype(int) - long).max(axis=2) > 40).mean() < 0.002


@pytest.mark.parametrize(
    ("metres", "bar"), [(1.0, 1), (1.99, 1), (2.0, 2), (7, 5), (0.034, 0.02), (1200, 1000)]
)
def test_scale_bars_have_round_lengths(metres: float, bar: float) -> None:
    assert round_length(metres) == pytest.approx(bar)


def test_blending_is_clipped_at_the_border() -> None:
    canvas = Canvas.plain((20, 10), (0, 0, 0))
    canvas.blend(np.full((8, 8), 255, np.uint8), (16, 6), (255, 255, 255))
    canvas.blend(np.full((8, 8), 255, np.uint8), (-4, -4), (255, 255, 255))
    canvas.blend(np.full((8, 8), 255, np.uint8), (40, 40), (255, 255, 255))
    assert canvas.planes[0][..., 0].sum() / 255 == 16 + 16
    assert ONE == 16
