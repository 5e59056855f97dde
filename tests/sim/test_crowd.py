"""The crowd alone: many contacts at once by substeps.

Its errors are those of a method of first order with 240 substeps a second: millimetres for bodies of a metre. What must
hold exactly: determinism, momentum without friction of the background, and that nothing gets through anything.
"""

import hashlib
import math

import numpy as np
import pytest
from core_build import FIXED, REST

from sim import Scene, simulate

G = 9.81


def box(name, x, y, w=1.0, h=1.0, **more):
    return {"id": name, "shape": {"type": "rectangle", "size": [w, h]}, "position": [x, y], **more}


def ball(name, x, y, r=0.5, **more):
    return {"id": name, "shape": {"type": "circle", "radius": r}, "position": [x, y], **more}


def polygon(name, vertices, x=0.0, y=0.0, **more):
    return {"id": name, "shape": {"type": "polygon", "vertices": vertices}, "position": [x, y], **more}


GROUND = box("ground", 0, -1, 60, 2, anchored=True)


def scene(*bodies, joints=(), gravity=(0, -G), **common):
    bodies = [{**common, **b} for b in bodies]
    return Scene.from_dict({"bodies": bodies, "joints": list(joints), "gravity": list(gravity)})


def energy(s, run):
    """Kinetic and potential energy by sample."""
    total = np.zeros(len(run.times))
    for k, b in enumerate(s.bodies):
        if b.anchored:
            continue
        m, i = b.mass_properties()
        total += 0.5 * m * (run.velocities[:, k] ** 2).sum(1) + 0.5 * i * run.spins[:, k] ** 2
        total -= m * run.positions[:, k] @ np.array(s.gravity)
    return total


def at_rest(run):
    return bool(np.isin(run.modes[-1], (FIXED, REST)).all()) and not run.velocities[-1].any()


# ---------------------------------------------------------------- rest


@pytest.mark.parametrize("count", [1, 10, 30])
def test_a_stack_stays(crowd, count):
    s = scene(GROUND, *(box(f"b{i}", 0, 0.5 + i) for i in range(count)))
    run = crowd(s, 5)
    assert at_rest(run)
    assert np.abs(run.positions[-1] - run.positions[0]).max() < 0.004 * count
    assert np.abs(run.angles[-1]).max() < 1e-3


def test_a_pyramid_stays(crowd):
    rows = 12
    bodies = [
        box(f"b{r}-{k}", 1.1 * (k - r / 2), 0.5 + (rows - 1 - r)) for r in range(rows) for k in range(r + 1)
    ]
    run = crowd(scene(GROUND, *bodies), 5)
    assert at_rest(run)
    assert np.abs(run.positions[-1] - run.positions[0]).max() < 0.02


def test_a_pile_settles_without_going_through_anything(crowd):
    rng = np.random.default_rng(8)
    walls = [box("l", -3.5, 4, 1, 14, anchored=True), box("r", 3.5, 4, 1, 14, anchored=True)]
    kinds = [
        lambda n, x, y: ball(n, x, y, rng.uniform(0.15, 0.3)),
        lambda n, x, y: box(n, x, y, *rng.uniform(0.25, 0.5, 2), angle=rng.uniform(0, 3)),
        lambda n, x, y: polygon(n, [[0, 0], [0.5, 0], [0.5, 0.2], [0.2, 0.2], [0.2, 0.5], [0, 0.5]], x, y),
    ]
    bodies = [kinds[i % 3](f"b{i}", -2.5 + 0.8 * (i % 7), 0.6 + 0.8 * (i // 7)) for i in range(70)]
    s = scene(GROUND, *walls, *bodies, elasticity=0.2)
    run = crowd(s, 6)
    assert np.abs(run.velocities[-1]).max() < 0.3
    inside = run.positions[:, 3:]
    assert np.abs(inside[:, :, 0]).max() < 3
    assert inside[:, :, 1].min() > 0.1
    e = energy(s, run)
    assert np.diff(e).max() <= 2e-3 * (e[0] - e[-1])  # nothing feeds it


def test_a_pile_of_disks_and_boxes_comes_to_rest(crowd):
    rng = np.random.default_rng(3)
    walls = [box("l", -3.5, 4, 1, 14, anchored=True), box("r", 3.5, 4, 1, 14, anchored=True)]
    bodies = []
    for i in range(70):
        x, y = -2.5 + 0.8 * (i % 7), 0.6 + 0.8 * (i // 7)
        w, h = rng.uniform(0.25, 0.5, 2)
        bodies.append(
            ball(f"b{i}", x, y, w / 2) if i % 2 else box(f"b{i}", x, y, w, h, angle=rng.uniform(0, 3))
        )
    s = scene(GROUND, *walls, *bodies, elasticity=0.1)
    run = crowd(s, 10)
    assert at_rest(run)
    worst = max(depth(s, run, f) for f in range(60, 601, 60))
    assert worst < 0.008


def depth(s, run, f):
    """How deep the deepest overlap of two boxes or disks is [m]."""
    from test_manifold import depth as overlap
    from test_manifold import disk, polygon

    from tests.sim.test_random_scenes import close_by

    placed = []
    for k, b in enumerate(s.bodies):
        p, angle = run.positions[f, k], run.angles[f, k]
        placed.append(
            disk(*p, b.shape.radius) if hasattr(b.shape, "radius") else polygon(b.shape.vertices, *p, angle)
        )
    worst = 0.0
    for i, j in close_by(placed):
        if not (s.bodies[i].anchored and s.bodies[j].anchored):
            worst = max(worst, overlap(placed[i], placed[j]))
    return worst


@pytest.mark.parametrize("pull", [G, 1000.0])
def test_a_pile_is_no_deeper_where_it_is_pulled_harder(crowd, pull):
    """The same scene in other units of time: what falls faster is stepped more often."""
    rng = np.random.default_rng(5)
    walls = [box("l", -1.9, 4, 1, 14, anchored=True), box("r", 1.9, 4, 1, 14, anchored=True)]
    bodies = []
    for i in range(24):
        x, y, w = -0.9 + 0.6 * (i % 4), 0.4 + 0.6 * (i // 4), rng.uniform(0.25, 0.45)
        bodies.append(
            ball(f"b{i}", x, y, w / 2) if i % 2 else box(f"b{i}", x, y, w, 0.3, angle=rng.uniform(0, 3))
        )
    s = scene(GROUND, *walls, *bodies, elasticity=0.1, gravity=(0, -pull))
    run = crowd(s, 3)
    assert max(depth(s, run, f) for f in (60, 90, 120, 180)) < 0.004


@pytest.mark.parametrize(("count", "deepest"), [(10, 0.006), (20, 0.009)])
def test_a_blow_goes_through_a_falling_column(crowd, count, deepest):
    """From a metre high: the lowest box stops, and with it, in the same few substeps, all that are above it."""
    s = scene(GROUND, *(box(f"b{i}", 0, 1.5 + 1.0001 * i) for i in range(count)), elasticity=0)
    run = crowd(s, 2, fps=240)
    tops = run.positions[:, :, 1] + (1.0, *[0.5] * count)
    assert (tops[:, :-1] - (run.positions[:, 1:, 1] - 0.5)).max() < deepest


@pytest.mark.parametrize("elasticity", [0.0, 1.0])
@pytest.mark.parametrize("ratio", [10.0, 100.0, 1e4, 1e6])
def test_a_light_body_gives_a_heavy_one_no_more_than_it_has(crowd, ratio, elasticity):
    s = scene(ball("heavy", 0, 0, 0.5, mass=ratio), ball("light", -2, 0.1, 0.2, mass=1, velocity=[20, 0]),
              gravity=(0, 0), elasticity=elasticity)  # fmt: skip
    run = crowd(s, 0.5)
    e, own = energy(s, run), 0.5 * ratio * (run.velocities[-1, 0] ** 2).sum()
    assert 0 < own <= e[0]
    if elasticity == 0:
        assert e.max() <= e[0] * (1 + 1e-9)


def test_a_box_rocking_on_a_ball_comes_to_rest(crowd):
    sides = [box("l", -0.7, 0.3, 0.4, 0.6, anchored=True), box("r", 0.7, 0.3, 0.4, 0.6, anchored=True)]
    top = box("t", 0.02, 1.1, 0.5, 0.2, angle=-0.05, angular_velocity=0.4)
    s = scene(GROUND, *sides, ball("b", 0, 0.5, 0.5), top, friction=1.0)
    assert at_rest(crowd(s, 15))


def test_what_is_at_rest_wakes_when_it_is_hit(crowd):
    s = scene(GROUND, box("b", 0, 0.5), ball("a", -8, 0.5, 0.3, velocity=[6, 0]), friction=0.3)
    run = crowd(s, 4)
    assert (run.modes[:, 1] == REST).any()
    assert run.positions[-1, 1, 0] > 0.05


def test_what_loses_its_support_falls(crowd):
    """A wedge-shaped prop is shot out from under a plank that had come to rest on it."""
    s = scene(
        GROUND, box("prop", 0, 0.25, 0.3, 0.5, mass=0.2), box("plank", 0, 0.55, 0.6, 0.1, mass=0.2),
        ball("shot", -12, 0.25, 0.2, velocity=[14, 0], mass=5), friction=0.2)  # fmt: skip
    run = crowd(s, 4)
    assert run.positions[30, 2, 1] == pytest.approx(0.55, abs=2e-3)
    assert run.positions[-1, 2, 1] < 0.4


# ---------------------------------------------------------------- friction, bounces, momentum


@pytest.mark.parametrize(("mu", "slides"), [(0.5, True), (0.56, True), (0.6, False), (0.8, False)])
def test_the_friction_threshold(crowd, mu, slides):
    """A block on a slope of 30 degrees: tan 30 = 0.577."""
    tilt = math.radians(30)
    up = np.array([math.sin(tilt), math.cos(tilt)])
    slope = box("s", 0, 0, 60, 1, angle=-tilt, anchored=True)
    run = crowd(scene(slope, box("b", *(0.8 * up), 1, 0.6, angle=-tilt), friction=mu, elasticity=0), 3)
    way = np.linalg.norm(run.positions[:, 1] - run.positions[0, 1], axis=1)
    if slides:
        acceleration = G * (math.sin(tilt) - mu * math.cos(tilt))
        assert way[-1] == pytest.approx(acceleration / 2 * 9, abs=0.03)
    else:
        assert way[-1] < 2e-3


@pytest.mark.parametrize("elasticity", [0.3, 0.7, 1.0])
def test_bounce_heights(crowd, elasticity):
    s = scene(GROUND, ball("a", 0, 2.5, elasticity=elasticity), elasticity=0)
    run = crowd(s, 3, fps=240)
    first = math.sqrt(2 * 2 / G)
    after = (run.times > first + 0.02) & (run.times < first * (1 + 2 * elasticity))
    assert run.positions[after, 1, 1].max() - 0.5 == pytest.approx(2 * elasticity**2, abs=0.06)


def test_momentum_is_kept_without_walls(crowd):
    rng = np.random.default_rng(2)
    bodies = []
    for i in range(25):
        x, y = 1.2 * (i % 5 - 2), 1.2 * (i // 5 - 2)
        body = box if i % 2 else ball
        bodies.append(
            body(
                f"b{i}",
                x,
                y,
                0.5,
                velocity=[-x, -y],
                angular_velocity=rng.uniform(-3, 3),
                density=rng.uniform(1, 20),
            )
        )
    s = scene(*bodies, gravity=(0, 0), elasticity=0.5)
    run = crowd(s, 3)
    mass, moment = np.array([b.mass_properties() for b in s.bodies]).T
    p = (mass[None, :, None] * run.velocities).sum(1)
    (x, y), (vx, vy) = np.moveaxis(run.positions, 2, 0), np.moveaxis(run.velocities, 2, 0)
    spin = (moment * run.spins + mass * (x * vy - y * vx)).sum(1)
    scale = mass.sum()
    assert np.abs(p - p[0]).max() < 1e-10 * scale
    assert np.abs(spin - spin[0]).max() < 2e-2 * scale  # positions of contacts are of first order
    e = energy(s, run)
    assert np.diff(e).max() <= 1e-9 * e[0]


def test_weightless_drift_goes_on(crowd):
    run = crowd(
        scene(
            box("w", 0, -1, 10, 2, anchored=True),
            box("b", 0, 0.5, velocity=[1e-3, 0]),
            friction=0,
            gravity=(0, 0),
        ),
        5,
    )
    assert run.positions[-1, 1, 0] == pytest.approx(5e-3, rel=1e-6)


# ---------------------------------------------------------------- hard cases


def test_a_wedge_in_a_gap_stays_sane(crowd):
    wedge = polygon("w", [[-0.5, 1], [0, -1], [0.5, 1]], 0, 3.3, density=50)
    s = scene(
        GROUND,
        box("l", -1.2, 1, 2, 2, anchored=True),
        box("r", 1.2, 1, 2, 2, anchored=True),
        wedge,
        friction=0.2,
    )
    run = crowd(s, 5)
    e = energy(s, run)
    assert e.max() == e[0]
    assert np.abs(run.velocities[-1]).max() < 0.05
    assert run.positions[-1, 3, 1] > 1.5


@pytest.mark.parametrize("ratio", [1e2, 1e4, 1e6])
@pytest.mark.parametrize("every", [5, 40])
def test_heavy_bodies_in_a_pile_of_light_ones_make_no_energy(crowd, ratio, every):
    rng = np.random.default_rng(4)
    walls = [box("l", -2, 9, 1, 20, anchored=True), box("r", 2, 9, 1, 20, anchored=True)]
    bodies = []
    for i in range(40):
        x, y, r = -0.97 + 0.65 * (i % 4), 0.4 + 0.6 * (i // 4), rng.uniform(0.13, 0.25)
        mass = ratio if i % every == every - 1 else 1.0
        bodies.append(
            ball(f"b{i}", x, y, r, mass=mass) if i % 2 else box(f"b{i}", x, y, 2 * r, 1.8 * r, mass=mass)
        )
    s = scene(GROUND, *walls, *bodies, elasticity=0.1, friction=0.5)
    e = energy(s, crowd(s, 6))
    grown = (e - np.minimum.accumulate(e)).max() / e[0]
    assert grown < 0.05


@pytest.mark.parametrize("ratio", [1e2, 1e4, 1e6])
def test_the_heavy_on_the_light(crowd, ratio):
    s = scene(GROUND, box("light", 0, 0.5, mass=1), box("heavy", 0, 1.5, mass=ratio))
    run = crowd(s, 3)
    assert np.abs(run.positions[-1] - run.positions[0]).max() < 0.05
    assert np.abs(run.velocities[-1]).max() < 1e-3


def test_a_chain_with_a_heavy_end_hangs_together(crowd):
    n = 30
    links = [box(f"l{i}", 0.5 * (i + 0.5), 0, 0.5, 0.1) for i in range(n)]
    joints = [{"bodies": [f"l{i - 1}" if i else None, f"l{i}"], "position": [0.5 * i, 0]} for i in range(n)]
    end = ball("end", 0.5 * n + 0.3, 0, 0.3, density=20)
    joints.append({"bodies": [f"l{n - 1}", "end"], "position": [0.5 * n, 0]})
    s = scene(*links, end, joints=joints)
    run = crowd(s, 5)
    c, si = np.cos(run.angles[:, :n]), np.sin(run.angles[:, :n])
    arm = 0.25 * np.stack([c, si], 2)
    gaps = np.linalg.norm(
        run.positions[:, 1:n] - arm[:, 1:] - run.positions[:, : n - 1] - arm[:, :-1], axis=2
    )
    assert gaps.max() < 0.05
    e = energy(s, run)
    assert e.max() - e[0] < 0.02 * (e[0] - s.bodies[-1].mass_properties()[0] * -G * 15)


@pytest.mark.parametrize("seed", range(4))
def test_a_taut_bridge_bears_a_heap(seed):
    """Planks in one line between two fixed points can't sag: their pivots' places say more than there is room for."""
    rng = np.random.default_rng(seed)
    planks = [box(f"p{i}", 0.225 + 0.45 * i, 3, 0.5, 0.1) for i in range(12)]
    ends = [None, *(p["id"] for p in planks), None]
    pivots = [
        {"type": "pivot", "bodies": [ends[i], ends[i + 1]], "position": [0.45 * i, 3]} for i in range(13)
    ]
    heap = [
        box(f"b{k}", 0.3 + 0.4 * (k % 12), 3.4 + 0.4 * (k // 12), 0.3, 0.3, angle=rng.uniform(-1, 1))
        for k in range(25)
    ]
    s = scene(GROUND, *planks, *heap, joints=pivots, friction=0.4)
    run = simulate(s, 6.0, 60)
    total = run.energy[:, 2]
    assert run.profile["crowd_steps"] > 0
    assert (total - np.minimum.accumulate(total)).max() < 5e-3 * total[0]
    assert np.abs(run.positions[-1, 1:13, 1] - 3).max() < 0.05
    assert np.hypot(*run.velocities[-1].T).max() < 0.05


@pytest.mark.parametrize("speed", [10.0, 100.0, 1000.0, 20000.0])
@pytest.mark.parametrize("shape", [ball, box])
@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_nothing_goes_through_a_thin_wall(crowd, speed, shape, angle):
    wall = box("wall", 3, 0, 0.001, 20, anchored=True)
    shot = shape(
        "shot", 0, 0, 0.1, velocity=[speed * math.cos(angle), speed * math.sin(angle)], angular_velocity=30
    )
    run = crowd(scene(wall, shot, gravity=(0, 0)), 1)
    assert run.positions[:, 1, 0].max() < 3


def test_a_stray_does_not_go_through_its_neighbours(crowd):
    """What is at rest, and is shot off in the middle of a step, is stopped by what it meets in that same step."""
    s = scene(
        ball("shot", -3, 0, 0.3, velocity=[400, 0], density=100), ball("hit", 0, 0, 0.2),
        box("wall", 2, 0, 0.002, 4, anchored=True), box("far", -6, 0, 0.002, 4, anchored=True),
        gravity=(0, 0), elasticity=1.0)  # fmt: skip
    run = crowd(s, 0.5)
    assert run.positions[:, :2, 0].max() < 2
    assert run.positions[:, :2, 0].min() > -6


@pytest.mark.parametrize("elasticity", [0.0, 0.5, 1.0])
def test_nothing_is_squeezed_out_of_a_thin_box(crowd, elasticity):
    """A ball up to 800 times as heavy as the other drives that into walls of 2 mm, at up to 2000 m/s."""
    rng = np.random.default_rng(6)
    walls = [
        box("left", -6, 0, 0.002, 4, anchored=True), box("right", 2, 0, 0.002, 4, anchored=True),
        box("top", -2, 2, 8, 0.002, anchored=True), box("bottom", -2, -2, 8, 0.002, anchored=True),
    ]  # fmt: skip
    for _ in range(80):
        at, speed, density = (
            rng.uniform([-5, -0.1], [-2, 0.1]),
            10 ** rng.uniform(1.5, 3.3),
            10 ** rng.uniform(0, 2.5),
        )
        shot = ball("shot", *at, 0.3, velocity=[speed, 0], density=density)
        hit = ball("hit", 0, 0, rng.uniform(0.1, 0.3))
        run = crowd(scene(*walls, shot, hit, gravity=(0, 0), elasticity=elasticity), 0.3)
        assert (np.abs(run.positions[:, 4:] - (-2, 0)) < (4, 2)).all()


def test_a_near_miss_is_not_a_hit(crowd):
    """A fast ball that passes a corner with a hair between keeps its way."""
    s = scene(box("b", 3, -1, 2, 2, anchored=True), ball("a", 0, 0.11, 0.1, velocity=[40, 0]), gravity=(0, 0))
    run = crowd(s, 0.5)
    assert np.abs(run.positions[:, 1, 1] - 0.11).max() < 1e-9
    assert run.positions[-1, 1, 0] == pytest.approx(20)


def test_nothing_catches_on_the_seams_of_a_concave_body(crowd):
    """A frictionless box slides over a long hill that is cut into many pieces, and keeps its speed."""
    top = [[x, 0.0] for x in np.linspace(20, -20, 41)]
    hill = [[-20.0, -1.0], [-10.0, -2.0], [0.0, -1.0], [10.0, -2.0], [20.0, -1.0], *top]
    ground = polygon("g", hill, 0, 0, anchored=True)
    placed = Scene.from_dict({"bodies": [ground]}).bodies[0]
    level = max(v[1] for v in placed.outline())
    s = scene(ground, box("b", -15, level + 0.25, 0.5, 0.5, velocity=[5, 0]), friction=0, elasticity=0)
    run = crowd(s, 5)
    assert np.abs(run.velocities[:, 1, 0] - 5).max() < 1e-6
    assert np.abs(run.positions[:, 1, 1] - level - 0.25).max() < 2e-3


def test_all_sizes_in_one_scene(crowd):
    sizes = [10.0**k for k in (-3, -2, -1, 0, 1, 2, 3)]
    x, bodies = 0.0, []
    for k, r in enumerate(sizes):
        x += 2.5 * r
        bodies.append(box(f"b{k}", x, 1.05 * r, 2 * r, 2 * r))
        x += 2.5 * r
    run = crowd(scene(box("ground", 0, -1000, 40000, 2000, anchored=True), *bodies), 20)
    assert at_rest(run)
    rise = run.positions[-1, 1:, 1] / sizes
    assert rise == pytest.approx(np.ones(7), abs=0.02)


# ---------------------------------------------------------------- determinism


def digest(run):
    h = hashlib.sha256()
    for a in (run.positions, run.angles, run.velocities, run.spins):
        h.update(np.ascontiguousarray(a).tobytes())
    return h.hexdigest()


def tumble():
    rng = np.random.default_rng(1)
    bodies = [
        (ball if i % 2 else box)(f"b{i}", float(rng.uniform(-2, 2)), 1.0 + i * 0.8, 0.4) for i in range(20)
    ]
    chain = [ball(f"c{i}", 3 + 0.3 * i, 2, 0.1) for i in range(4)]
    joints = [{"bodies": [f"c{i}", f"c{i + 1}"], "position": [3.15 + 0.3 * i, 2]} for i in range(3)]
    return scene(GROUND, *bodies, *chain, joints=joints)


def test_the_same_scene_gives_the_same_bits(crowd):
    assert digest(crowd(tumble(), 3)) == digest(crowd(tumble(), 3))
