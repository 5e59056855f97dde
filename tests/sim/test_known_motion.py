"""Scenes whose motion is known, run at every tolerance: the error stays within what was asked for."""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest

from sim import Body, Circle, Joint, Polygon, Rectangle, Scene, simulate
from sim.bench.cases import CASES, Case, case_error

BY_NAME = {case.name: case for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_error_keeps_to_the_tolerance(case: Case) -> None:
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8):
        run = simulate(case.scene, duration=case.duration, fps=60, tolerance=tolerance)
        error = case_error(case, run.times, run.positions, run.angles)
        assert error <= 3 * tolerance, f"at a tolerance of {tolerance:g}"
        assert run.profile["crowd_steps"] == 0, f"at a tolerance of {tolerance:g}"


@pytest.mark.parametrize("name", ["projectile", "spinning bounce", "unequal disks", "corner impact"])
def test_flights_and_impacts_are_exact(name: str) -> None:
    case = BY_NAME[name]
    run = simulate(case.scene, duration=case.duration, fps=60)
    assert case_error(case, run.times, run.positions, run.angles) < 1e-12


@pytest.mark.parametrize("name", ["pendulum", "double pendulum", "triple pendulum"])
def test_coarse_is_cheaper_than_fine(name: str) -> None:
    case = BY_NAME[name]
    evaluations = [
        simulate(case.scene, duration=case.duration, tolerance=t).profile["smooth_evals"]
        for t in (1e-3, 1e-5, 1e-7)
    ]
    assert evaluations[0] < evaluations[1] < evaluations[2] < 4 * evaluations[0]


def test_a_break_is_the_same_at_every_tolerance() -> None:
    """Balls a tenth of a millimetre apart are not struck at once, however coarse the tolerance: flights are exact."""
    spots = [(0.17329 * row, 0.10005 * (2 * j - row)) for row in range(4) for j in range(row + 1)]
    rack = [
        Body(id=f"b{k}", shape=Circle(0.1), position=at, friction=0.2, elasticity=0.9)
        for k, at in enumerate(spots)
    ]
    cue = Body(
        id="cue", shape=Circle(0.1), position=(-1.0, 0.013), velocity=(5.0, 0.0), friction=0.2, elasticity=0.9
    )
    scene = Scene(bodies=[cue, *rack], gravity=(0, 0))
    coarse, fine = (simulate(scene, duration=0.7, tolerance=t) for t in (1e-3, 1e-8))
    assert np.abs(coarse.positions - fine.positions).max() < 1e-9


def test_energy_of_a_frictionless_machine_is_kept() -> None:
    case = BY_NAME["triple pendulum"]
    run = simulate(case.scene, duration=case.duration, tolerance=1e-7)
    assert np.ptp(run.energy[:, 2]) < 1e-6 * np.ptp(run.energy[:, 0])


# ---------------------------------------------------------------- what a scene does not need is not done


def test_a_flight_is_one_flight() -> None:
    profile = simulate(BY_NAME["projectile"].scene, duration=10).profile
    assert profile["flights"] == 1
    assert profile["smooth_steps"] == profile["crowd_steps"] == profile["impacts"] == profile["pairs"] == 0


def test_rest_costs_nothing_for_an_hour() -> None:
    profile = simulate(BY_NAME["tower of 10"].scene, duration=3600, fps=1).profile
    assert profile["rests"] == 1
    assert profile["smooth_steps"] == profile["crowd_steps"] == 0
    assert profile["events"] <= 10


def test_a_flight_beside_a_resting_tower_costs_nothing_more() -> None:
    tower = BY_NAME["tower of 10"].scene
    ball = Body(id="ball", shape=Circle(0.1), position=(20.0, 1.1), elasticity=0.8, friction=0.0)
    both = Scene(bodies=[*tower.bodies, ball], gravity=tower.gravity)
    profile = simulate(both, duration=3).profile
    assert profile["smooth_steps"] == 0
    assert profile["rests"] == 1


def test_a_pile_that_rests_costs_nothing_more_and_a_flight_beside_it_one_search() -> None:
    floor = Body(id="floor", shape=Rectangle((8.0, 1.0)), position=(0.0, -0.5), anchored=True)
    wall = [
        Body(id=f"w{k}", shape=Rectangle((1.0, 6.0)), position=(x, 2.0), anchored=True)
        for k, x in enumerate((-2, 2))
    ]
    pile = [
        Body(
            id=f"b{k}",
            shape=Circle(0.2),
            position=(-0.9 + 0.45 * (k % 5) + 0.05 * (k // 5 % 3), 0.3 + 0.5 * (k // 5)),
        )
        for k in range(25)
    ]
    scene = Scene(bodies=[floor, *wall, *pile], gravity=(0, -9.81))
    short, long = (simulate(scene, duration=d).profile for d in (8.0, 60.0))
    assert short["crowd_steps"] > 0
    for count in ("crowd_steps", "crowd_contacts", "smooth_steps", "events", "pairs"):
        assert long[count] == short[count], count
    ball = Body(id="ball", shape=Circle(0.1), position=(3.0, 200.0))
    both = simulate(Scene(bodies=[*scene.bodies, ball], gravity=scene.gravity), duration=8.0).profile
    assert both["crowd_steps"] == short["crowd_steps"]
    assert both["crowd_contacts"] == pytest.approx(short["crowd_contacts"], rel=0.01)  # sizes round otherwise
    assert both["events"] <= short["events"] + 5


# ---------------------------------------------------------------- events


def test_an_impact_tells_when_where_and_how_hard() -> None:
    run = simulate(BY_NAME["spinning bounce"].scene, duration=0.5)
    impact = next(e for e in run.events if e.kind == "impact")
    fall = np.sqrt(2 / 9.81)
    assert impact.time == pytest.approx(fall, abs=1e-12)
    assert impact.bodies == ("ground", "a")
    assert impact.point == pytest.approx((2 * fall, 0), abs=1e-12)
    mass = np.pi * 0.2**2
    assert impact.impulse[1] == pytest.approx(mass * 1.7 * 9.81 * fall, rel=1e-12)
    assert (
        abs(impact.impulse[0]) == pytest.approx(0.2 * impact.impulse[1], rel=1e-9)
        or abs(impact.impulse[0]) < 0.2 * impact.impulse[1]
    )


def test_contacts_begin_and_end_and_rest_is_told() -> None:
    run = simulate(BY_NAME["bounces to rest"].scene, duration=2.0)
    kinds = [e.kind for e in run.events]
    assert kinds[-2:] == ["contact begun", "rest"]
    e = 0.5
    fall = np.sqrt(2 / 9.81)
    assert run.events[-1].time == pytest.approx(fall * (1 + 2 * e / (1 - e)), abs=0.01)
    assert [t.time for t in run.events] == sorted(t.time for t in run.events)


def test_sliding_off_an_edge_ends_the_contact_there() -> None:
    table = Body(id="table", shape=Rectangle((2.0, 1.0)), position=(0.0, -0.5), anchored=True, friction=0.0)
    ball = Body(
        id="ball", shape=Circle(0.1), position=(0.0, 0.1), velocity=(2.0, 0.0), friction=0.0, elasticity=0.0
    )
    run = simulate(Scene(bodies=[table, ball], gravity=(0, -9.81)), duration=1.0)
    ended = [e for e in run.events if e.kind == "contact ended"]
    # at 2 m/s on a radius of 0.1 m gravity is too weak to turn the ball about the edge: v^2 / r > g
    assert ended[-1].time == pytest.approx(0.5, abs=1e-5)
    assert run.positions[-1, 1, 0] == pytest.approx(2.0, abs=1e-4)


# ---------------------------------------------------------------- the same bits

# What the engine makes of MACHINE, on every build and processor. It changes with the engine's arithmetic: when it does,
# see that the tests above hold, then put the new one here.
GOLDEN = "bacc97c3c172e7391723a454b6ba9ae58ccb7bd6e57c9737ea6e26219e4a9e54"


def machine() -> Scene:
    """A chain on pivots swings into a box that has landed on the floor: flight, impacts, friction, pivots, rest."""
    chain = [Body(id=f"c{k}", shape=Rectangle((0.5, 0.1)), position=(0.25 + 0.5 * k, 3.0)) for k in range(4)]
    joints = [Joint(bodies=(f"c{k - 1}" if k else None, f"c{k}"), position=(0.5 * k, 3.0)) for k in range(4)]
    box = Body(id="box", shape=Rectangle((0.6, 0.4)), position=(-1.0, 2.0), angle=0.3, angular_velocity=1.0)
    floor = Body(id="floor", shape=Rectangle((20.0, 1.0)), position=(0.0, -0.5), anchored=True)
    return Scene(bodies=[*chain, box, floor], joints=joints, gravity=(0, -9.81))


def test_every_run_gives_the_same_bits() -> None:
    digests = {
        hashlib.sha256(simulate(machine(), duration=3.0).positions.tobytes()).hexdigest() for _ in range(3)
    }
    assert digests == {GOLDEN}


def test_a_corner_beside_a_tip_is_not_in_it() -> None:
    """A corner that falls past a needle is behind the line of the far flank, but outside; the tip meets its side."""
    needle = Polygon(
        [(-1.0, -2 / 3), (0.5, -2 / 3), (0.5, 4 / 3)]
    )  # the tip at the origin, the right flank upright
    beside, height, left, right = (
        0.003,
        0.5,
        math.radians(110),
        math.radians(60),
    )  # the corner's sides go up so
    sides = [(0.0, 0.0), (math.cos(right), math.sin(right)), (math.cos(left), math.sin(left))]
    x, y = (sum(v[k] for v in sides) / 3 for k in range(2))
    spike = Polygon([(vx - x, vy - y) for vx, vy in sides])
    falls = Body(id="spike", shape=spike, position=(beside + x, height + y))
    ground = Body(id="needle", shape=needle, position=(-0.5, -4 / 3), anchored=True)
    run = simulate(Scene(bodies=[ground, falls], gravity=(0, -9.81)), duration=0.5, tolerance=1e-8)
    first = next(e for e in run.events if e.kind == "impact")
    fall = height - beside * math.tan(left)
    assert first.time == pytest.approx(math.sqrt(2 * fall / 9.81), abs=1e-8)
