"""Whole sketches: machines drawn by several hands, in any order, direction, size and turn; and what is said of them."""

from __future__ import annotations

import math
import time
from functools import cache

import numpy as np
import pytest
from pages import box, cart, kinds, machines, ngon, page, pendulum, read, stack

from sim.scene import InputError, Scene
from sketch import Recognition, Sketch, Stroke, recognize
from sketch.synthetic import HANDS, arrow, circle, cross, line, outline, scribble

MACHINES = machines()
NEAT = HANDS["neat"]


def meaning(recognition: Recognition) -> object:
    """What a scene is, whatever its place, size and turn."""
    scene = recognition.scene
    bodies = sorted((len(b.outline()), b.anchored) for b in scene.bodies)
    return bodies, len(scene.joints), math.hypot(*scene.gravity) > 1


@pytest.mark.parametrize(("name", "sketch", "bodies", "joints"), MACHINES, ids=[m[0] for m in MACHINES])
def test_a_machine_is_read_whole(name: str, sketch: Sketch, bodies: int, joints: int) -> None:
    scene = recognize(sketch).scene
    assert len(scene.bodies) == bodies
    assert len(scene.joints) == joints
    assert [b.id for b in scene.bodies if b.anchored] == ["b1"]
    gx, gy = scene.gravity
    assert gy == pytest.approx(-9.81, abs=0.4)
    assert abs(gx) < 2
    assert not any("left out" in note or "arrow" in note for note in scene.notes)
    scene.check()
    assert Scene.from_json(scene.to_json()).to_dict() == scene.to_dict()
    drawn = [s for b in scene.bodies for s in b.strokes or []]
    assert len(drawn) == len(set(drawn)), "no stroke draws two bodies"


@cache
def as_drawn(name: str) -> object:
    """What one of the machines means."""
    return next(meaning(recognize(sketch)) for machine, sketch, _, _ in MACHINES if machine == name)


def changed(sketch: Sketch, how: str) -> Sketch:
    rng = np.random.default_rng(5)
    strokes = [s.points for s in sketch.strokes]
    if how == "shuffled":
        strokes = [strokes[i] for i in rng.permutation(len(strokes))]
    elif how == "reversed":
        strokes = [s[::-1].copy() for s in strokes]
    elif how == "dense":
        strokes = [_resampled(s, 400) for s in strokes]
    elif how == "turned":
        c, s = math.cos(1.1), math.sin(1.1)
        strokes = [p @ np.array([[c, s], [-s, c]]) for p in strokes]
    else:
        strokes = [s * float(how) for s in strokes]
    return Sketch([Stroke(s) for s in strokes])


def _resampled(points: np.ndarray, n: int) -> np.ndarray:
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    t = np.linspace(0, along[-1], n)
    return np.stack([np.interp(t, along, points[:, k]) for k in (0, 1)], axis=1)


@pytest.mark.parametrize("how", ["shuffled", "reversed", "dense", "turned", "0.3", "4"])
def test_the_reading_does_not_depend_on(how: str) -> None:
    for name, sketch, _, _ in MACHINES:
        if "quick" in name:
            continue  # a careless long side may be read with four corners or five
        assert meaning(recognize(changed(sketch, how))) == as_drawn(name)


def test_times_are_not_looked_at() -> None:
    sketch = pendulum(NEAT, np.random.default_rng(1))
    wrong = [Stroke(s.points, np.arange(len(s.points), 0, -1.0)) for s in sketch.strokes]
    timed = recognize(Sketch(wrong, sketch.width, sketch.height))
    assert timed.scene.to_dict() == recognize(sketch).scene.to_dict()


def test_geometry_of_the_scene() -> None:
    """x = px / ppm, y = -py / ppm, the longer side of the canvas 10 m; a body reaches to the edge of its ink."""
    rng = np.random.default_rng(3)
    shapes = [outline(box(640, 360, 320, 160, 0.2), NEAT, rng), circle((1000, 200), 64, NEAT, rng)]
    bodies = read(*shapes, outline(ngon(3, 300, 300, 90), NEAT, rng)).scene.bodies
    rectangle, ball, triangle = bodies
    assert rectangle.position == pytest.approx((5.0, -360 / 128), abs=0.03)
    turn = np.array([[math.cos(0.2), -math.sin(0.2)], [math.sin(0.2), math.cos(0.2)]])
    ink = np.ptp(np.concatenate(shapes[0]) @ turn, axis=0) / 128
    for meant, found, reached in zip((2.5, 1.25), rectangle.shape.size, ink, strict=True):
        assert meant < 1.005 * found < 1.01 * reached
        assert reached < 1.05 * meant  # so that the bounds say something
    assert rectangle.angle == pytest.approx(-0.2, abs=0.02)
    assert ball.position == pytest.approx((1000 / 128, -200 / 128), abs=0.03)
    assert ball.shape.radius == pytest.approx(0.5, rel=0.03)
    assert np.mean(triangle.shape.vertices, axis=0) == pytest.approx((0, 0), abs=1e-9)
    given = recognize(page(*shapes), scale=64).scene
    assert given.view is not None
    assert given.view.pixels_per_metre == 64
    assert given.bodies[0].position == pytest.approx((10.0, -360 / 64), abs=0.06)


def test_a_page_without_a_canvas_is_as_wide_as_its_ink() -> None:
    sketch = Sketch([Stroke(s) for s in outline(box(500, 300, 1000, 100), NEAT, np.random.default_rng(2))])
    view = recognize(sketch).scene.view
    assert view is not None
    assert view.pixels_per_metre == pytest.approx(110, rel=0.03)


def test_a_wheel_on_a_pivot_is_no_pivot_and_a_pivot_of_two_rings_is_one() -> None:
    """Over two bodies that overlap: nobody pins a pin, but some draw a pin as two rings."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        under = [outline(box(500, 480, 320, 100), NEAT, rng), outline(box(500, 540, 600, 60), NEAT, rng)]
        wheel = read(*under, circle((500, 520), 42, NEAT, rng), circle((500, 520), 10, NEAT, rng)).scene
        assert len(wheel.bodies) == 3
        assert {b for joint in wheel.joints for b in joint.bodies} == {
            "b1",
            "b2",
            "b3",
        }  # the pin goes through all
        rings = read(*under, circle((500, 520), 15, NEAT, rng), circle((500, 520), 5, NEAT, rng)).scene
        assert (len(rings.bodies), len(rings.joints)) == (2, 1)


def test_gravity_can_be_given() -> None:
    scene = recognize(pendulum(NEAT, np.random.default_rng(1)), gravity=(1.0, 2.0)).scene
    assert scene.gravity == (1.0, 2.0)


# ---------------------------------------------------------------- what is left out, and what is said


def test_a_scribble_changes_nothing_else_and_is_named() -> None:
    for seed in range(10):
        rng = np.random.default_rng(seed)
        sketch = cart(NEAT, rng)
        ink = [*(s.points for s in sketch.strokes), *scribble((1100, 180), 120, rng)]
        scene = recognize(Sketch([Stroke(p) for p in ink], sketch.width, sketch.height)).scene
        assert meaning(recognize(sketch)) == meaning(Recognition(sketch, scene, []))
        assert any(f"stroke {len(ink) - 1}" in note for note in scene.notes)


@pytest.mark.parametrize("letter", ["T", "H", "*"])
def test_letters_on_a_page_are_no_bodies(letter: str) -> None:
    at = {"T": ["00 40", "20 25"], "H": ["00 05", "40 45", "02 42"], "*": ["00 45", "40 05", "20 25"]}[letter]
    for seed in range(4):
        rng = np.random.default_rng(seed)
        sketch = stack(NEAT, rng)
        for stroke in at:
            ends = [(1000 + 20 * int(p[0]), 120 + 20 * int(p[1])) for p in stroke.split()]
            sketch.strokes.extend(Stroke(s) for s in line(ends, NEAT, rng))
        scene = recognize(sketch).scene
        assert len(scene.bodies) == 5
        assert any(str(len(sketch.strokes) - 1) in note for note in scene.notes)


def test_a_dot_is_left_out() -> None:
    sketch = cart(NEAT, np.random.default_rng(0))
    strokes = [*sketch.strokes, Stroke(np.array([[200.0, 100.0]])), Stroke(np.empty((0, 2)))]
    scene = recognize(Sketch(strokes, sketch.width, sketch.height)).scene
    assert len(scene.bodies) == 4
    assert any(f"{len(strokes) - 2}, {len(strokes) - 1}" in note for note in scene.notes)


def test_notes() -> None:
    rng = np.random.default_rng(4)
    body = outline(box(400, 400, 200, 120), NEAT, rng)
    assert "no gravity arrow" in "".join(read(body).scene.notes)
    arrows = [arrow((100, 100), (100, 230), NEAT, rng), arrow((1000, 100), (1150, 100), NEAT, rng)]
    scene = read(body, *arrows).scene
    assert any("2 arrows" in note for note in scene.notes)
    assert math.hypot(*scene.gravity) == pytest.approx(9.81)
    assert any("over no body" in note for note in read(body, cross((900, 500), 50, NEAT, rng)).scene.notes)
    bars = [line([(100, y), (700, y + 20)], NEAT, rng) for y in (400, 600)]
    assert "b1 (stroke 0) is an open line: a bar as thick as the pen" in read(bars[0]).scene.notes
    assert "b1 and b2 (strokes 0, 1) are open lines: bars as thick as the pen" in read(*bars).scene.notes


def test_scores_and_alternatives() -> None:
    recognition = recognize(stack(NEAT, np.random.default_rng(2)))
    for reading in recognition.readings:
        assert 0 < reading.score <= 1
        others = [score for _, score in reading.alternatives]
        assert others == sorted(others, reverse=True)
        assert reading.kind not in [kind for kind, _ in reading.alternatives]
        assert reading.gain > 0


def test_an_account_names_every_stroke() -> None:
    sketch = pendulum(NEAT, np.random.default_rng(2))
    text = recognize(sketch).explain()
    for word in ("b1: ", "b2: ", "anchored", "a pivot of b1 and b2", "gravity", "rectangle"):
        assert word in text
    numbers = {
        int(n) for part in text.split("from stroke")[1:] for n in part.split("\n")[0].strip("s ").split(",")
    }
    assert numbers == set(range(len(sketch.strokes)))


# ---------------------------------------------------------------- overrides


def test_a_reading_can_be_said() -> None:
    rng = np.random.default_rng(1)
    shapes = [outline(box(400, 400, 300, 120), NEAT, rng), circle((400, 400), 12, NEAT, rng)]
    sketch = page(*shapes)
    small = len(sketch.strokes) - 1
    assert len(recognize(sketch).scene.joints) == 1
    ball = recognize(sketch, overrides={small: "ball"}).scene
    assert (len(ball.bodies), ball.joints) == (2, [])
    gone = recognize(sketch, overrides={(small,): "ignore"}).scene
    assert (len(gone.bodies), gone.joints) == (1, [])
    assert not any("left out" in note for note in gone.notes), "what was said to be nothing needs no note"
    body = tuple(range(small))
    assert kinds(recognize(sketch, overrides={body: "circle"}))[-1] in ("circle", "pivot")


def test_any_ink_can_be_said_to_be_anything() -> None:
    sketch = cart(HANDS["quick"], np.random.default_rng(1))
    sketch.strokes.append(Stroke(scribble((1100, 180), 90, np.random.default_rng(0))[0]))
    last = len(sketch.strokes) - 1
    for kind in ("circle", "rectangle", "polygon", "bar", "anchor", "gravity", "pivot", "ball", "ignore"):
        for strokes in ((last,), (0, 1), (3,)):
            recognition = recognize(sketch, overrides={strokes: kind})
            recognition.scene.check()
            assert any(r.forced == kind for r in recognition.readings)


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [({99: "ball"}, "no stroke 99"), ({0: "wheel"}, "is not a reading"), ({0: "ball", (0, 1): "bar"}, "already")],
)  # fmt: skip
def test_a_wrong_override_is_named(overrides: dict[object, str], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        recognize(cart(NEAT, np.random.default_rng(1)), overrides=overrides)


# ---------------------------------------------------------------- robustness and time


@pytest.mark.parametrize("seed", range(25))
def test_any_ink_gives_a_scene(seed: int) -> None:
    rng = np.random.default_rng(seed)
    strokes = []
    for _ in range(rng.integers(1, 14)):
        n = int(rng.choice([1, 2, 3, 5, 40]))
        walk = np.cumsum(rng.normal(0, rng.choice([0.01, 3, 60]), (n, 2)), axis=0)
        strokes.append(Stroke(np.round(walk + rng.uniform(0, 700, 2), int(rng.integers(0, 3)))))
    scene = recognize(Sketch(strokes)).scene
    scene.check()
    read_strokes = {s for b in scene.bodies for s in b.strokes or []}
    assert read_strokes <= set(range(len(strokes)))


def hatching(count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [np.array([[8.0 * i, 0], [8.0 * i + 60, 200]]) + rng.normal(0, 1, (2, 2)) for i in range(count)]


def squares(count: int) -> list[np.ndarray]:
    long = 20.0 * count
    rows = [np.array([[0, 20.0 * k], [long, 20.0 * k]]) for k in range(count + 1)]
    return rows + [row[:, ::-1].copy() for row in rows]


def net(count: int) -> list[np.ndarray]:
    """Long lines near one another, each across half of all."""
    at = np.linspace(0, 1000, count // 2)
    rows = [np.array([[0, y], [1000, y + 3 * math.sin(k)]]) for k, y in enumerate(at)]
    return rows + [row[:, ::-1].copy() for row in rows]


def machine_parts() -> list[np.ndarray]:
    """The strokes of a cart and a pendulum."""
    rng = np.random.default_rng(0)
    return [s.points for m in (cart, pendulum) for s in m(HANDS["pieces"], rng).strokes]


def seconds(ink: list[np.ndarray], times: int) -> float:
    """CPU that it takes to read strokes, the least of some times [s]."""
    sketch, best = Sketch([Stroke(s) for s in ink]), math.inf
    for _ in range(times):
        start = time.process_time()
        recognize(sketch).scene.check()
        best = min(best, time.process_time() - start)
    return best


@pytest.mark.parametrize(
    "ink",
    [hatching(60), squares(12), hatching(450), net(140)],
    ids=["hatching", "squares", "much", "net"],
)
def test_shading_takes_no_time(ink: list[np.ndarray]) -> None:
    """Ink in which everything is near everything: the number of groups is bounded, and no stroke of it takes much
    longer than one of a machine."""
    machines = machine_parts()
    seconds(machines, 1)
    assert seconds(ink, 1) / len(ink) < 15 * seconds(machines, 3) / len(machines)


def test_time_grows_with_the_page_and_no_faster() -> None:
    """Machines side by side: eight times as many take at most about eight times as long."""
    tile = machine_parts()

    def of(count: int) -> float:
        places = [np.array([1400 * (k % 4), 800 * (k // 4)]) for k in range(count)]
        return seconds([p + place for place in places for p in tile], 3)

    of(1)
    assert of(8) < 14 * of(1)
