"""How a crowd ends: bodies come to rest in it, fly off, or are given back to the exact way."""

import math

import numpy as np
import pytest
from core_build import FLIGHT, REST

from sim import Scene, Trajectory, simulate

G = 9.81
SUBSTEPS = 240  # a second, of the crowd


def box(name, x, y, w, h, **more):
    return {"id": name, "shape": {"type": "rectangle", "size": [w, h]}, "position": [x, y], **more}


def ball(name, x, y, r, **more):
    return {"id": name, "shape": {"type": "circle", "radius": r}, "position": [x, y], **more}


def scene(*bodies, joints=(), gravity=(0, -G), **common):
    bodies = [{**common, **b} for b in bodies]
    return Scene.from_dict({"bodies": bodies, "joints": list(joints), "gravity": list(gravity)})


GROUND = box("ground", 0, -1, 400, 2, anchored=True)
WALLS = [box("left", -1.5, 1, 1, 4, anchored=True), box("right", 1.5, 1, 1, 4, anchored=True)]


def heap(count):
    return [
        ball(f"b{i}", -0.72 + 0.45 * (i % 4) + 0.03 * (i // 4), 0.3 + 0.45 * (i // 4), 0.2)
        for i in range(count)
    ]


def last_event(run: Trajectory) -> float:
    return max(e.time for e in run.events)


def assert_straight(run: Trajectory, since: float, to: float) -> None:
    """Every body goes on as it did at that time, to so many metres."""
    first = int(np.searchsorted(run.times, since))
    assert first < len(run.times) - 30
    assert np.array_equal(
        run.velocities[first:], np.broadcast_to(run.velocities[-1], run.velocities[first:].shape)
    )
    way = (run.times[first:] - run.times[first])[:, None, None] * run.velocities[-1]
    assert np.abs(run.positions[first:] - run.positions[first] - way).max() < to


# ---------------------------------------------------------------- the way back


R = 0.1
RACK = [ball(f"{i}-{k}", i * R * math.sqrt(3), (2 * k - i) * R, R) for i in range(5) for k in range(i + 1)]
CUE = ball("cue", -2, 0.01, R, velocity=[5, 0])
BREAK = scene(*RACK, CUE, gravity=(0, 0), friction=0, elasticity=0.9)


def test_what_flies_apart_flies_straight():
    """The break of fifteen balls that touch: too many contacts for the exact way, for as long as they last."""
    run = simulate(BREAK, duration=2)
    assert 0 < run.profile["crowd_steps"] < 0.2 * SUBSTEPS
    assert_straight(run, last_event(run), 1e-12)
    momentum = np.einsum("tbk,b->tk", run.velocities, [b.mass_properties()[0] for b in BREAK.bodies])
    assert np.abs(momentum - momentum[0]).max() < 1e-12


def test_a_heap_that_runs_apart_is_given_back():
    """On ice the balls slide on for ever, without error once the crowd is over, each as high as it is to be."""
    rows = [
        ball(f"{row}-{k}", 0.402 * (k - (3 - row) / 2), 0.2 + 0.35 * row, 0.2)
        for row in range(4)
        for k in range(4 - row)
    ]
    run = simulate(scene(GROUND, *rows, friction=0, elasticity=0), duration=6)
    assert 0 < run.profile["crowd_steps"] < 2 * SUBSTEPS
    assert_straight(run, last_event(run), 1e-9)
    assert np.abs(run.velocities[-1, 1:, 0]).min() > 0.2
    assert np.abs(run.positions[-1, 1:, 1] - 0.2).max() < 0.002  # slop of the crowd's contacts


def test_what_has_nothing_near_leaves_the_crowd(crowd):
    """The same break, stepped by the crowd alone: what was knocked out of the rack flies on by itself."""
    run = crowd(BREAK, 2)
    away = (run.positions[-1][:, None] - run.positions[-1]) ** 2
    nearest = np.sqrt(away.sum(2) + np.diag(np.full(len(away), np.inf))).min(1)
    assert (nearest > 0.3).sum() > 4
    assert (run.modes[-1, nearest > 0.3] == FLIGHT).all()


@pytest.mark.parametrize(("row", "strays"), [(8, 1e-5), (9, 0.02)])
def test_a_rod_swings_on_when_its_load_has_slid_off(row, strays):
    """Two rows of balls lie on a rod that falls about its end.  What hangs on joints is not put to rest in the crowd:
    with few balls the rod is given back and swings without error, with many it stays and nearly keeps its energy."""
    rod = box("rod", 1, 4, 2, 0.1)
    pivot = {"type": "pivot", "bodies": ["rod", None], "position": [0, 4]}
    load = [ball(f"b{k}", 0.2 + 0.2 * (k % row) + 0.1 * (k // row), 4.15 + 0.1733 * (k // row), 0.1)
            for k in range(2 * row - 1)]  # fmt: skip
    s = scene(GROUND, rod, *load, joints=[pivot], friction=0.5)
    run = simulate(s, duration=10)
    mass, moment = s.bodies[1].mass_properties()
    swing = 0.5 * moment * run.angular_velocities[:, 1] ** 2 + 0.5 * mass * (run.velocities[:, 1] ** 2).sum(1)
    energy = swing + mass * G * run.positions[:, 1, 1]
    assert run.profile["crowd_steps"] > 0
    assert np.abs(energy[300:] - energy[-1]).max() < strays * swing.max()
    assert swing[480:].max() > 0.97 * swing[120:].max()


@pytest.mark.parametrize(
    ("count", "friction", "elasticity"),
    [(12, 0.5, 0.2), (24, 0.5, 0.2), (7, 0.8, 0.4), (7, 0.8, 0.5), (7, 1.0, 0.6), (6, 1.5, 0.6)],
)
def test_balls_that_hardly_roll_come_to_rest_in_the_crowd(count, friction, elasticity):
    """The exact way would let them roll between the walls for ever; few of them are asked for by it, many are not."""
    balls = heap(count)
    run = simulate(scene(GROUND, *WALLS, *balls, friction=friction, elasticity=elasticity), duration=8)
    assert run.profile["crowd_steps"] > 0
    assert not run.velocities[-1].any()
    assert not run.angular_velocities[-1].any()
    assert run.energy[:, 2].max() <= run.energy[0, 2] * (1 + 1e-9)


# ---------------------------------------------------------------- rest


def test_what_lies_under_what_moves_rests_but_for_what_it_touches(crowd):
    """A ball rolls along a stack of planks and falls off its end: only the top one waits for that."""
    planks = [box(f"p{i}", 0, 0.25 + 0.5 * i, 8, 0.5) for i in range(5)]
    roll = ball("roll", 1, 2.9, 0.4, velocity=[0.5, 0], angular_velocity=-1.25)
    run = crowd(scene(GROUND, *planks, roll, friction=0.5), 9)
    on = run.positions[:, 6, 0] < 3.9
    on[:60] = False  # it takes a while
    off = run.positions[:, 6, 1] < 0.5
    assert on.sum() > 200
    assert (run.modes[on, 1:5] == REST).all()
    assert (run.modes[on, 5:] != REST).all()
    assert (run.positions[on, 1:5] == run.positions[on, 1:5][0]).all()
    assert np.allclose(run.velocities[on, 6, 0], 0.5, atol=0.002)  # no rest, no resistance
    assert off.any()
    assert (run.modes[-1, 1:6] == REST).all()


@pytest.mark.parametrize("beyond", [-2e-3, 5e-4, 2e-3])
def test_what_slides_ever_so_slowly_is_not_put_to_rest(crowd, beyond):
    """Just steeper than the angle of friction a block gains 5 or 22 mm/s in a second; just less steep it stays."""
    mu = 0.5
    angle = math.atan(mu) + beyond
    normal = np.array([-math.sin(angle), math.cos(angle)])
    slope = box("slope", *(-0.5 * normal), 60, 1, angle=angle, anchored=True)
    run = crowd(scene(slope, box("block", *(0.25 * normal), 0.5, 0.5, angle=angle), friction=mu), 4)
    speed = np.hypot(*run.velocities[:, 1].T)
    gain = G * (math.sin(angle) - mu * math.cos(angle))
    if beyond < 0:
        assert run.modes[-1, 1] == REST
    else:
        assert (run.modes[:, 1] != REST).all()
        assert (speed[240] - speed[60]) / 3 == pytest.approx(gain, rel=0.02)


def test_an_impulse_goes_through_what_rests(crowd):
    """A row of balls that rest and touch: a blow at one end sends the other end off; momentum along the row is kept."""
    row = [ball(f"b{i}", 0.4 * i, 0.2, 0.2) for i in range(5)]
    s = scene(GROUND, *row, ball("cue", -4, 0.2, 0.2, velocity=[3, 0]), friction=0, elasticity=0)
    run = crowd(s, 4)
    hit = int(np.nonzero(run.velocities[:, 1, 0] > 0)[0][0])
    assert (run.modes[hit - 2, 1:6] == REST).all()
    momentum = run.velocities[:, :, 0].sum(1)
    assert np.abs(momentum - 3).max() < 1e-9
    assert (run.velocities[-1, 1:, 0] > 0).all()
