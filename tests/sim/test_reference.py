"""The reference engine: the scene's own pair rules, joints, concave bodies, sampling."""

import math

import numpy as np
import pytest

from sim import Scene, simulate
from sim.reference import run_pymunk

GROUND = {
    "id": "ground",
    "shape": {"type": "rectangle", "size": [40, 2]},
    "position": [0, -1],
    "anchored": True,
}


def scene(*bodies, joints=(), gravity=(0, -9.81)):
    return Scene.from_dict({"bodies": list(bodies), "joints": list(joints), "gravity": list(gravity)})


def ball(name, x, y, r=0.25, **more):
    return {"id": name, "shape": {"type": "circle", "radius": r}, "position": [x, y], **more}


def test_free_fall_converges_to_the_parabola():
    s = scene(ball("a", 0, 10, velocity=[1, 2], angular_velocity=3))
    errors = []
    for rate in (60, 240, 960):
        run = run_pymunk(s, 1.0, 20, rate=rate)
        assert len(run) == 21
        errors.append(np.abs(run.positions[:, 0, 1] - (10 + 2 * run.times - 9.81 / 2 * run.times**2)).max())
        assert run.positions[:, 0, 0] == pytest.approx(run.times, abs=1e-9)
        assert run.angles[:, 0] == pytest.approx(3 * run.times)
    assert errors[1] == pytest.approx(errors[0] / 4, rel=0.05)
    assert errors[2] == pytest.approx(errors[1] / 4, rel=0.05)


def test_the_greater_elasticity_counts():
    s = scene({**GROUND, "elasticity": 0.0}, ball("a", 0, 2.25, elasticity=0.8))
    run = run_pymunk(s, 1.2, 100, rate=2000)
    after = run.times > math.sqrt(2 * 2 / 9.81) + 0.02
    assert run.positions[after, 1, 1].max() - 0.25 == pytest.approx(2 * 0.64, abs=0.02)


@pytest.mark.parametrize(
    ("ground", "block", "slides"), [(0.2, 0.8, True), (0.3, 0.98, False), (0.0, 1.0, True)]
)
def test_friction_is_the_geometric_mean(ground, block, slides):
    """On a slope of 27 degrees: tan is 0.51 and the pair's friction 0.4, 0.54 and 0."""
    tilt = math.radians(27)
    slope = {"id": "s", "shape": {"type": "rectangle", "size": [20, 1]}, "position": [0, 0], "angle": -tilt}
    slope |= {"anchored": True, "friction": ground}
    up = np.array([math.sin(tilt), math.cos(tilt)]) * 0.75
    box = {
        "id": "b",
        "shape": {"type": "rectangle", "size": [1, 0.5]},
        "position": up.tolist(),
        "angle": -tilt,
    }
    run = run_pymunk(scene(slope, {**box, "friction": block, "elasticity": 0}), 1.0, 10, rate=600)
    way = np.linalg.norm(run.positions[-1, 1] - run.positions[0, 1])
    expected = 9.81 / 2 * (math.sin(tilt) - math.sqrt(ground * block) * math.cos(tilt))
    assert way == pytest.approx(expected, rel=0.05) if slides else way < 0.01


def test_joined_bodies_do_not_collide_and_hang_together():
    s = scene(
        ball("a", 0, 0, 0.5),
        ball("b", 0.3, 0, 0.5),
        joints=[{"bodies": ["a", "b"], "position": [0.15, 0]}, {"bodies": ["a", None], "position": [0, 0]}],
    )
    run = run_pymunk(s, 2.0, 60, rate=600)
    assert np.abs(run.positions[:, 0]).max() < 0.01
    arm = np.stack([np.cos(run.angles[:, 0]), np.sin(run.angles[:, 0])], 1) * 0.15
    back = np.stack([np.cos(run.angles[:, 1]), np.sin(run.angles[:, 1])], 1) * 0.15
    assert np.abs(run.positions[:, 0] + arm - run.positions[:, 1] + back).max() < 0.01


def test_a_ball_rests_in_a_concave_cup():
    cup = {
        "id": "cup",
        "shape": {
            "type": "polygon",
            "vertices": [[-2, 0], [2, 0], [2, 2], [1, 2], [1, 1], [-1, 1], [-1, 2], [-2, 2]],
        },
    }
    run = run_pymunk(scene({**cup, "position": [0, 0], "anchored": True}, ball("a", 0.3, 2.5)), 4.0, 10)
    centre = run.positions[0, 0]
    assert run.positions[-1, 1, 1] - centre[1] - 0.25 == pytest.approx(1 - 0.9, abs=0.6)
    assert abs(run.positions[-1, 1, 0]) < 0.8
    assert run.positions[-1, 1, 1] > 0


def test_everything_of_the_scene_is_in_the_trajectory():
    s = scene(GROUND, ball("a", 0, 0.25, density=2.0), ball("p", 5, 1, anchored=True, velocity=[1, 0]))
    run = simulate(s, 0.5, 30, engine="pymunk")
    assert run.body_ids == ["ground", "a", "p"]
    assert np.all(run.positions[:, 2] == (5, 1))
    assert np.all(run.velocities[:, 2] == 0)
    assert run.energy[0] == pytest.approx(
        [0, 2 * math.pi * 0.0625 * 9.81 * 0.25, 2 * math.pi * 0.0625 * 9.81 * 0.25]
    )
    assert simulate(scene(GROUND), 0.1, 30, engine="pymunk").positions.shape == (4, 1, 2)
    assert simulate(scene(), 0.1, 30, engine="pymunk").positions.shape == (4, 0, 2)


def test_a_joint_between_anchored_bodies_is_nothing():
    s = scene(
        GROUND, ball("p", 5, 1, anchored=True), joints=[{"bodies": ["ground", "p"], "position": [0, 0]}]
    )
    assert len(run_pymunk(s, 0.1, 10)) == 2
