"""What was drawn overlapping is moved apart before the start: by little, once, and to touching."""

import math
import time

import numpy as np
import pytest

from sim import Scene, simulate


def box(name, x, y, w=1.0, h=1.0, **more):
    return {"id": name, "shape": {"type": "rectangle", "size": [w, h]}, "position": [x, y], **more}


def ball(name, x, y, r=0.25, **more):
    return {"id": name, "shape": {"type": "circle", "radius": r}, "position": [x, y], **more}


GROUND = box("ground", 0, -1, 40, 2, anchored=True)


def start(*bodies, joints=()):
    """Positions and angles at the start, and what the engine says it did."""
    scene = Scene.from_dict({"bodies": list(bodies), "joints": list(joints), "gravity": [0, -9.81]})
    run = simulate(scene, duration=0, fps=60)
    return run.positions[0], run.angles[0], run.profile


@pytest.mark.parametrize("count", [1, 3, 12, 50])
def test_a_stack_drawn_into_itself(count):
    p, a, profile = start(GROUND, *(box(f"b{i}", 0.01 * i, 0.46 + 0.95 * i) for i in range(count)))
    assert p[1:, 1] == pytest.approx(0.5 + np.arange(count), abs=1e-9)
    assert p[1:, 0] == pytest.approx(0.01 * np.arange(count), abs=1e-9)  # moved up alone
    assert np.all(a == 0)
    assert profile["separated"] == count
    assert profile["separation"] == pytest.approx(0.04 + 0.05 * (count - 1))
    assert profile["let_overlap"] == 0


def test_what_touches_already_is_left_alone_to_the_last_bit():
    bodies = [box(f"b{i}", 0.1 * i, 0.5 + i) for i in range(5)] + [ball("c", 3 * 0.1 + 2, 0.25)]
    p, _, profile = start(GROUND, *bodies)
    assert p[1:].tolist() == [list(b["position"]) for b in bodies]
    assert profile["separated"] == 0
    rounded = [box("a", 0, 0.5 - 1e-13), box("b", 0, 1.5 - 3e-13)]
    p, _, _ = start(GROUND, *rounded)
    assert p[1:].tolist() == [list(b["position"]) for b in rounded]


def test_an_overlap_does_not_move_what_is_elsewhere():
    far = [box("f1", 8, 0.5), box("f2", 8.1, 1.5)]
    p, _, profile = start(GROUND, box("a", 0, 0.45), *far)
    assert p[2:].tolist() == [list(b["position"]) for b in far]
    assert profile["separated"] == 1


def test_the_heavier_moves_less_and_the_anchored_not_at_all():
    p, _, _ = start(ball("a", 0, 0, 0.5, mass=1), ball("b", 0.9, 0, 0.5, mass=16))
    assert p[1, 0] - p[0, 0] == pytest.approx(1, abs=1e-9)
    assert -p[0, 0] > 3 * (p[1, 0] - 0.9) > 0
    p, _, _ = start(ball("a", 0, 0, 0.5, anchored=True), ball("b", 0.9, 0, 0.5))
    assert p.tolist() == [[0, 0], [pytest.approx(1, abs=1e-9), pytest.approx(0, abs=1e-12)]]


def test_a_ball_drawn_into_a_ramp_leaves_it_straight_out():
    tilt = math.radians(30)
    ramp = box("ramp", 0, 0, 10, 1, angle=-tilt, anchored=True)
    normal = np.array([math.sin(tilt), math.cos(tilt)])
    p, _, _ = start(ramp, ball("a", *(normal * (0.5 + 0.25 - 0.05))))
    assert p[1] == pytest.approx(normal * 0.75, abs=1e-9)


def test_deeper_than_touching_is_let_overlap():
    inside = [box("big", 0, 2, 4, 4), ball("in", 0.5, 2.5), box("half", 2.0, 2, 0.5, 0.5)]
    p, _, profile = start(GROUND, *inside)
    assert p[1:].tolist() == [list(b["position"]) for b in inside]
    assert profile["let_overlap"] == 2
    assert profile["separated"] == 0


def test_a_line_is_thin_but_carries_what_was_drawn_into_it():
    """A line's bar is thinner than the overlap: what counts is the size of the body that stands on it."""
    p, _, profile = start(box("line", 0, 0, 10, 0.03, anchored=True), box("a", 0, 0.47))
    assert p[1] == pytest.approx([0, 0.515], abs=1e-9)
    assert profile["let_overlap"] == 0


def test_what_cannot_be_parted_shares_the_overlap():
    walls = [box("l", -0.99, 1, 1, 2, anchored=True), box("r", 0.99, 1, 1, 2, anchored=True)]
    p, _, profile = start(*walls, ball("a", 0.005, 1, 0.5))
    assert p[2] == pytest.approx([0, 1], abs=5e-4)
    assert profile["separation"] < 0.01


def test_joints_hold_while_bodies_part():
    cart = [box("body", 0, 1, 4, 0.5), ball("w1", -1.2, 0.48, 0.5), ball("w2", 1.2, 0.46, 0.5)]
    joints = [
        {"bodies": ["body", w], "position": [x, y]} for w, x, y in (("w1", -1.2, 0.48), ("w2", 1.2, 0.46))
    ]
    p, a, _ = start(GROUND, *cart, joints=joints)
    assert p[2:, 1] == pytest.approx([0.5, 0.5], abs=1e-9)
    for k, (x, y) in ((2, (-1.2, -0.52)), (3, (1.2, -0.54))):
        c, s = math.cos(a[1]), math.sin(a[1])
        assert p[k] == pytest.approx(p[1] + np.array([c * x - s * y, s * x + c * y]), abs=1e-8)


def test_a_lever_on_the_background_turns_out_of_a_block():
    lever, block = box("lever", 0, 1, 4, 0.2), box("block", 1.5, 0.5, 0.5, 0.84, anchored=True)
    p, a, _ = start(lever, block, joints=[{"bodies": ["lever", None], "position": [0, 1]}])
    assert p[0] == pytest.approx([0, 1], abs=1e-9)
    assert 0 < a[0] < 0.03


def test_a_feather_under_an_anvil():
    p, _, _ = start(GROUND, box("feather", 0, 0.48, density=1), box("anvil", 0, 1.45, density=1e6))
    assert p[1:, 1] == pytest.approx([0.5, 1.5], abs=1e-8)


def test_a_concave_body_is_moved_as_one():
    u = {
        "id": "u",
        "shape": {
            "type": "polygon",
            "vertices": [[-1, 0], [1, 0], [1, 1], [0.6, 1], [0.6, 0.4], [-0.6, 0.4], [-0.6, 1], [-1, 1]],
        },
    }
    placed = Scene.from_dict({"bodies": [{**u, "position": [0, 0]}]}).bodies[0]
    low = min(v[1] for v in placed.shape.vertices)
    p, a, _ = start(GROUND, {**u, "position": [0, -0.03]})
    assert p[1, 1] == pytest.approx(-low, abs=1e-9)
    assert a[1] == 0


def test_a_crowd_of_overlaps_takes_a_moment():
    rng = np.random.default_rng(4)
    bodies = [
        ball(f"b{k}", 0.47 * (k % 20) + rng.uniform(0, 0.02), 0.24 + 0.48 * (k // 20)) for k in range(300)
    ]
    began = time.process_time()
    p, _, profile = start(GROUND, *bodies)
    assert time.process_time() - began < 2
    d = np.linalg.norm(p[1:, None] - p[None, 1:], axis=2) + np.eye(300)
    assert d.min() > 0.5 - 1e-6
    assert p[1:, 1].min() > 0.25 - 1e-6
    assert profile["let_overlap"] == 0
