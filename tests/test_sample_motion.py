"""The samples run: each does what a person expects of it at first sight."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim import Scene, simulate
from sim.trajectory import Trajectory
from sketch import load_sketch, recognize
from sketch.formats import kind_of

SAMPLES = Path(__file__).resolve().parent.parent / "samples"
NAMES = sorted(path.stem for path in SAMPLES.glob("*.json"))
AT_REST = ["arch", "billiard", "stack"]
PIXEL = 10 / 1280  # [m]

Array = NDArray[np.float64]


@functools.cache
def ran(name: str) -> tuple[Scene, Trajectory]:
    data = (SAMPLES / f"{name}.json").read_bytes()
    scene = Scene.from_json(data) if kind_of(data) == "scene" else recognize(load_sketch(data)).scene
    return scene, simulate(scene, duration=10.0, fps=60)


def body_at(name: str, x: float, y: float) -> int:
    """Index of the body whose centre was drawn nearest to a point of the page [px]."""
    scene, _ = ran(name)
    return min(
        range(len(scene.bodies)),
        key=lambda k: math.dist(scene.bodies[k].position, (x * PIXEL, -y * PIXEL)),
    )


def path(name: str, x: float, y: float) -> Array:
    """Where that body goes, on the page [px], y down, shape (samples, 2)."""
    _, run = ran(name)
    out: Array = run.positions[:, body_at(name, x, y)] / (PIXEL, -PIXEL)
    return out


@pytest.mark.parametrize("name", NAMES)
def test_what_holds_for_every_machine(name: str) -> None:
    scene, run = ran(name)
    assert run.positions.shape == (601, len(scene.bodies), 2)
    assert all(np.isfinite(getattr(run, f)).all() for f in ("positions", "angles", "velocities", "energy"))
    for k, body in enumerate(scene.bodies):
        if body.anchored:
            assert np.all(run.positions[:, k] == run.positions[0, k])
            assert np.all(run.angles[:, k] == run.angles[0, k])
        else:  # the drawing is where it starts, but for overlaps: up to 3 px a storey, in towers of five
            assert math.dist(run.positions[0, k], body.position) < 15 * PIXEL
    scale = max(1.0, float(np.ptp(run.energy[:, 1])))
    assert np.max(run.energy[:, 2]) - run.energy[0, 2] < 0.01 * scale, "energy came from nowhere"


@pytest.mark.parametrize("name", NAMES)
def test_pivots_hold(name: str) -> None:
    scene, run = ran(name)
    index = {body.id: k for k, body in enumerate(scene.bodies)}
    for joint in scene.joints:
        ends = []
        for body in joint.bodies:
            if body is None:
                ends.append(np.broadcast_to(joint.position, (601, 2)))
                continue
            k = index[body]
            arm = np.subtract(joint.position, scene.bodies[k].position)
            turned = run.angles[:, k] - scene.bodies[k].angle
            c, s = np.cos(turned), np.sin(turned)
            arms = np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)
            ends.append(run.positions[:, k] + arms)
        assert np.max(np.hypot(*(ends[0] - ends[1]).T)) < 1e-4, "pivots hold to the tolerance"


@pytest.mark.parametrize("name", AT_REST)
def test_what_should_rest_rests(name: str) -> None:
    _, run = ran(name)
    moved = np.hypot(*np.moveaxis(run.positions - run.positions[0], 2, 0))
    assert np.max(moved) < 6 * PIXEL
    settled = run.times >= 1.0
    assert np.max(np.ptp(run.positions[settled], axis=0)) < 1e-3
    assert np.max(np.ptp(run.angles[settled], axis=0)) < 1e-3
    assert np.max(np.abs(run.velocities[-1])) < 1e-4


def test_ramp_the_ball_rolls_down_and_pushes_the_box() -> None:
    ball, box = path("ramp", 200, 255), path("ramp", 1000, 594)
    assert ball[-1, 0] > 800
    assert ball[-1, 1] == pytest.approx(640 - 42, abs=8)
    assert 5 < box[-1, 0] - box[0, 0] < 200
    assert np.max(np.abs(box[:, 1] - box[0, 1])) < 12, "it slides and stays upright"


def test_cart_the_tower_falls() -> None:
    frame, top = path("cart", 215, 320), path("cart", 977, 391)
    assert np.max(frame[:, 0]) > 800
    assert top[-1, 1] > top[0, 1] + 60
    assert frame[-1, 1] < 640


def test_pendulum_swings_to_the_other_side_and_back() -> None:
    bob = path("pendulum", 397, 320) - (650, 108)
    length = np.hypot(*bob.T)
    assert np.ptp(length) < 1.0
    assert np.max(bob[:, 0]) == pytest.approx(-bob[0, 0], abs=12)
    assert np.sum(np.diff(np.sign(bob[:, 0])) != 0) >= 5


@pytest.mark.parametrize("name", ["pendulum", "double-pendulum", "linkage"])
def test_what_only_swings_keeps_its_energy(name: str) -> None:
    _, run = ran(name)
    assert np.ptp(run.energy[:, 2]) < 2e-3 * np.ptp(run.energy[:, 0])


def test_seesaw_the_ball_throws_the_box() -> None:
    box, ball = path("seesaw", 912, 574), path("seesaw", 375, 130)
    assert np.min(box[:, 1]) < box[0, 1] - 100
    assert ball[-1, 1] > 500
    assert 60 < ball[-1, 0] < 1220


def test_dominoes_all_fall() -> None:
    _, run = ran("dominoes")
    pieces = [body_at("dominoes", 430 + 66 * k, 566) for k in range(11)]
    assert len(set(pieces)) == 11
    turned = np.abs(run.angles[:, pieces] - run.angles[0, pieces])
    assert np.all(turned[-1] > math.radians(45))
    first = [int(np.argmax(turned[:, k] > math.radians(20))) for k in range(11)]
    assert first == sorted(first), "one after the other"


def test_funnel_all_bodies_end_in_the_bin() -> None:
    scene, run = ran("funnel")
    moving = [k for k, body in enumerate(scene.bodies) if not body.anchored]
    assert len(moving) == 18
    end = run.positions[-1, moving] / (PIXEL, -PIXEL)
    assert np.all((end[:, 0] > 270) & (end[:, 0] < 1010) & (end[:, 1] < 680) & (end[:, 1] > 500))
    assert np.max(np.abs(run.velocities[-1])) < 0.05, "at most a ball still rolls slowly"


def test_marbles_end_in_the_cup() -> None:
    scene, run = ran("marbles")
    moving = [k for k, body in enumerate(scene.bodies) if not body.anchored]
    end = run.positions[-1, moving] / (PIXEL, -PIXEL)
    assert np.all((end[:, 0] > 110) & (end[:, 0] < 240) & (end[:, 1] > 560) & (end[:, 1] < 690))


def test_bridge_carries_its_load() -> None:
    ball, box = path("bridge", 560, 130), path("bridge", 730, 150)
    for load in (ball, box):
        assert 250 < load[-1, 1] < 420
        assert 300 < load[-1, 0] < 980


def test_sign_two_pivots_hold_and_one_swings() -> None:
    _, run = ran("sign")
    small = body_at("sign", 672, 378)
    for x, y in ((520, 160), (600, 260)):
        k = body_at("sign", x, y)
        assert np.max(np.abs(run.positions[:, k] - run.positions[0, k])) < 1e-3
    assert np.ptp(run.angles[:, small]) > 1.0


def test_wrecker_the_wall_breaks() -> None:
    weight, top = path("wrecker", 262, 300), path("wrecker", 790, 384)
    assert np.max(weight[:, 0]) > 670
    assert top[-1, 1] > top[0, 1] + 60


def test_cradle_the_last_ball_swings_out() -> None:
    """As far as the first was held up: elastic balls hand the whole of their motion on."""
    first, last = path("cradle-of-steel", 241, 376), path("cradle-of-steel", 820, 456)
    rise = first[:, 1].max() - first[0, 1]
    assert last[0, 1] - last[:, 1].min() == pytest.approx(rise, rel=0.05)
    middle = path("cradle-of-steel", 640, 456)
    first_swing = middle[: 2 * 60]
    assert np.max(np.abs(first_swing - middle[0])) < 0.1 * rise, "the middle ball stays where it hangs"


def test_billiard_the_break_scatters_the_balls_and_none_leaves_the_table() -> None:
    _, run = ran("billiard-break")
    balls = run.positions[:, 4:] / (PIXEL, -PIXEL)
    assert np.all((balls[..., 0] > 125) & (balls[..., 0] < 1155))
    assert np.all((balls[..., 1] > 105) & (balls[..., 1] < 615))
    assert np.all(np.hypot(*np.moveaxis(balls[-1] - balls[0], 1, 0)) > 10)
