"""What a crowd tells of itself: impacts, contacts that begin and end, rest."""

import itertools
import math
from collections import defaultdict

import numpy as np
import pytest

from sim import Scene, Trajectory, simulate
from sim.bench.stress_scenes import cases

G = 9.81
RADIUS, ELASTICITY = 0.2, 0.4


def balls(rows: int, columns: int, friction: float) -> Scene:
    """Balls in a tray, those of a row one beside the other, each row shifted against the one below."""
    bodies: list[dict[str, object]] = [
        {"id": name, "shape": {"type": "rectangle", "size": size}, "position": at, "anchored": True}
        for name, size, at in (
            ("floor", [8, 1], [0, -0.5]),
            ("left", [1, 9], [-2.1, 4.5]),
            ("right", [1, 9], [2.1, 4.5]),
        )
    ]
    for i in range(rows * columns):
        x = -1.2 + 0.45 * (i % columns) + 0.03 * (i // columns % 2)
        position = [x, 0.7 + 0.01 * (i % columns) + 0.5 * (i // columns)]
        bodies.append({"id": f"b{i}", "shape": {"type": "circle", "radius": RADIUS}, "position": position})
    common = {"friction": friction, "elasticity": ELASTICITY}
    return Scene.from_dict({"bodies": [{**common, **b} for b in bodies], "gravity": [0, -G]})


@pytest.fixture(scope="module")
def pile() -> tuple[Scene, Trajectory]:
    scene = balls(5, 6, 0.5)
    run = simulate(scene, duration=8)
    assert run.profile["crowd_steps"] > 100
    return scene, run


def test_events_are_in_order_and_contacts_alternate(pile: tuple[Scene, Trajectory]) -> None:
    _, run = pile
    times = [e.time for e in run.events]
    assert times == sorted(times)
    assert times[0] > 0
    assert times[-1] <= run.times[-1]
    touching: dict[frozenset[str | None], bool] = defaultdict(bool)
    for e in run.events:
        if e.kind in ("contact begun", "contact ended"):
            assert touching[frozenset(e.bodies)] == (e.kind == "contact ended")
            touching[frozenset(e.bodies)] = e.kind == "contact begun"


def test_contacts_at_the_end_are_those_that_can_be_measured(pile: tuple[Scene, Trajectory]) -> None:
    scene, run = pile
    touching = set()
    for e in run.events:
        if e.kind == "contact begun":
            touching.add(frozenset(e.bodies))
        if e.kind == "contact ended":
            touching.discard(frozenset(e.bodies))
    assert not np.any(run.velocities[-1])
    p = run.positions[-1]
    for i, a in enumerate(scene.bodies):
        if a.anchored:
            continue
        assert (frozenset((a.id, "floor")) in touching) == (p[i, 1] < RADIUS * 1.006)
        for j in range(i):
            if not scene.bodies[j].anchored and frozenset((a.id, scene.bodies[j].id)) in touching:
                assert math.dist(p[i], p[j]) < 2 * RADIUS * 1.006


STILL = 7e-3 * RADIUS  # what counts as still: a body that was only stirred so far is not told to rest again


def away(run: Trajectory, i: int, k: int) -> np.ndarray:
    """How far any point of a body is, at each sample, from where it was at sample k."""
    turned = np.abs(run.angles[:, i] - run.angles[k, i])
    return np.hypot(*(run.positions[:, i] - run.positions[k, i]).T) + RADIUS * turned


def test_every_body_is_told_to_rest_where_it_stays(pile: tuple[Scene, Trajectory]) -> None:
    scene, run = pile
    last = {e.bodies[0]: e for e in run.events if e.kind == "rest"}
    for i, body in enumerate(scene.bodies):
        if not body.anchored:
            since = int(np.searchsorted(run.times, last[body.id].time - 1e-9))
            assert away(run, i, since)[since:].max() < 2 * STILL


def test_a_body_is_told_to_rest_again_only_if_it_left(pile: tuple[Scene, Trajectory]) -> None:
    scene, run = pile
    rests: dict[str | None, list[int]] = defaultdict(list)
    for e in run.events:
        if e.kind == "rest":
            rests[e.bodies[0]].append(round(60 * e.time))
    for i, body in enumerate(scene.bodies):
        for before, after in itertools.pairwise(rests[body.id]):
            assert away(run, i, before)[before : after + 1].max() > 0.9 * STILL


def test_rest_is_told_once_until_a_body_moves_or_is_struck() -> None:
    """Rough bodies that lie in a pile are woken by what lands on it, and mostly stay where they are."""
    case = next(c for c in cases() if c.name == "pile, friction 10, elasticity 0.3")
    run = simulate(case.scene, duration=case.duration)
    rested: dict[str, float] = {}
    for e in run.events:
        if e.kind == "impact":
            for name in e.bodies:
                rested.pop(str(name), None)
        elif e.kind == "rest":
            body = run.body_ids.index(e.bodies[0])
            if e.bodies[0] in rested:
                between = (run.times >= rested[e.bodies[0]]) & (run.times <= e.time)
                assert np.any(run.velocities[between, body]) or np.any(run.angular_velocities[between, body])
            rested[e.bodies[0]] = e.time
    assert len(rested) > 40


def test_a_first_blow_has_the_impulse_that_turns_the_fall_around() -> None:
    scene = balls(3, 6, 0.0)
    run = simulate(scene, duration=1)
    seen: set[str | None] = set()
    blows = 0
    for e in run.events:
        if e.kind == "impact" and not seen & set(e.bodies) - {"floor"} and "floor" in e.bodies:
            ball = next(b for b in scene.bodies if b.id in e.bodies and b.id != "floor")
            speed = math.sqrt(2 * G * (ball.position[1] - RADIUS))
            up = e.impulse[1] if e.bodies[1] == ball.id else -e.impulse[1]
            expected = ball.mass_properties()[0] * (1 + ELASTICITY) * speed
            assert up == pytest.approx(expected, rel=0.03)
            assert e.point == pytest.approx((ball.position[0], 0), abs=0.02)
            blows += 1
        if e.kind == "impact":
            seen |= set(e.bodies) - {"floor"}
    assert blows == 6
    assert run.profile["crowd_steps"] > 0
