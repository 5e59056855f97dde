"""What --tidy undoes of the hand, and what it leaves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import box, ngon, page, pendulum

from sim.scene import Scene
from sketch import recognize
from sketch.synthetic import HANDS, arrow, circle, cross, ellipse, line, outline

NEAT = HANDS["neat"]
PPM = 128.0


def scene_of(*shapes: list[np.ndarray]) -> Scene:
    return recognize(page(*shapes), tidy=True).scene


def tops(scene: Scene) -> list[tuple[float, float]]:
    """Of each body its least and greatest height on the page [pixels]."""
    ys = [-PPM * np.array(b.outline())[:, 1] for b in scene.bodies]
    return [(float(y.min()), float(y.max())) for y in ys]


@pytest.mark.parametrize("seed", range(6))
def test_near_level_sides_are_level_and_slopes_stay(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shapes = [
        outline(box(400, 500, 600, 60, 0.03), NEAT, rng),
        outline([(200, 300), (420, 306), (360, 200), (260, 196)], NEAT, rng),
        outline(box(900, 300, 300, 60, 0.25), NEAT, rng),
        line([(700, 600), (1100, 612)], NEAT, rng),
        arrow((80, 100), (85, 230), NEAT, rng),
    ]
    scene = scene_of(*shapes)
    floor, trapezoid, slope, bar = scene.bodies
    assert floor.angle == 0
    sides = np.diff(np.array([*trapezoid.outline(), trapezoid.outline()[0]]), axis=0)
    assert np.count_nonzero(np.abs(sides[:, 1]) < 1e-9) == 2
    assert slope.angle == pytest.approx(-0.25, abs=0.03)
    assert bar.angle == 0
    assert scene.gravity == pytest.approx((0, -9.81), abs=1e-9)
    assert sum(note.startswith("tidied: ") for note in scene.notes) == 4
    assert not any("tidied" in note for note in recognize(page(*shapes)).scene.notes), "never by default"


def test_near_equal_wheels_are_equal_and_others_are_not() -> None:
    rng = np.random.default_rng(1)
    scene = scene_of(*(circle((200 * (k + 1), 300), r, NEAT, rng) for k, r in enumerate((50, 52, 80, 51))))
    radii = [b.shape.radius for b in scene.bodies]
    assert radii[0] == pytest.approx(radii[1], rel=1e-9)
    assert radii[0] == pytest.approx(radii[3], rel=1e-9)
    assert radii[0] * PPM == pytest.approx(51, rel=0.03)
    assert radii[2] * PPM == pytest.approx(80, rel=0.03)


@pytest.mark.parametrize("seed", range(6))
def test_what_nearly_touches_touches_from_the_ground_up(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = scene_of(
        outline(box(500, 600, 700, 60), NEAT, rng),
        cross((500, 600), 40, NEAT, rng),
        outline(box(400, 520, 120, 90), NEAT, rng),
        outline(box(400, 425, 100, 88), NEAT, rng),
        circle((700, 525), 40, NEAT, rng),
        outline(ngon(3, 900, 300, 60), NEAT, rng),
        arrow((80, 100), (82, 230), NEAT, rng),
    )
    floor, low, high, ball, triangle = tops(scene)
    assert scene.bodies[0].anchored
    assert low[1] == pytest.approx(floor[0], abs=1e-6)
    assert high[1] == pytest.approx(low[0], abs=1e-6)
    assert -PPM * (scene.bodies[3].position[1] - scene.bodies[3].shape.radius) == pytest.approx(
        floor[0], abs=1e-6
    )
    assert triangle[1] < floor[0] - 100, "what is far from all stays"
    assert ball[1] == pytest.approx(floor[0], abs=2)


def test_bodies_on_pivots_stay_where_they_were_drawn() -> None:
    sketch = pendulum(NEAT, np.random.default_rng(3))
    plain, tidied = recognize(sketch).scene, recognize(sketch, tidy=True).scene
    assert tidied.joints == plain.joints
    for a, b in zip(plain.bodies, tidied.bodies, strict=True):
        assert math.dist(a.position, b.position) < 0.03


def test_the_error_of_a_fit_is_that_of_its_corners() -> None:
    """Over many drawings the corners are off by what the readings say, within a factor of two."""
    said, off = [], []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        (reading,) = recognize(page(circle((400, 300), 120, NEAT, rng))).readings
        said.append(reading.error)
        off.append(math.dist(reading.outline.mean(axis=0), (400, 300)))
    assert 0.5 < math.sqrt(np.mean(np.square(off))) / math.sqrt(np.mean(np.square(said))) < 2


def test_an_outline_without_sides_stays_as_it_was_drawn() -> None:
    """Of its many short sides some are near level wherever it goes."""
    rng = np.random.default_rng(3)
    shapes = [ellipse((500, 300), (170, 80), 0.0, NEAT, rng)]
    (drawn,), (tidied,) = (recognize(page(*shapes), tidy=tidy).scene.bodies for tidy in (False, True))
    assert len(drawn.outline()) > 8
    assert tidied == drawn
