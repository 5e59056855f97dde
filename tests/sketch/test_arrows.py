"""Arrows beside the one that is gravity: of a coordinate cross, at a moving body, of a dimension line."""

from __future__ import annotations

import numpy as np
import pytest
from pages import box, page, read

from sketch.recognize import Recognition, recognize
from sketch.synthetic import HANDS, Hand, arrow, circle, line, outline

Array = np.ndarray
HAND = HANDS["neat"]
SEEDS = range(4)


def scenery(rng: np.random.Generator) -> list[Array]:
    """A floor, a ball and a box: bodies b1, b2 and b3."""
    floor, load = (outline(v, HAND, rng) for v in (box(640, 600, 900, 60), box(840, 510, 200, 110)))
    return [*floor, *circle((450, 520), 45, HAND, rng), *load]


def is_down(recognition: Recognition) -> bool:
    return recognition.scene.gravity[1] < -9.5


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("size", [60, 140])
def test_a_coordinate_cross_is_no_gravity(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    bodies, gravity = scenery(rng), arrow((1180, 120), (1183, 230), HAND, rng)
    axes = [
        *arrow((150, 300), (150 + size, 302), HAND, rng),
        *arrow((152, 300), (150, 300 - size), HAND, rng),
    ]
    seen = read(bodies, axes, gravity)
    assert len(seen.scene.bodies) == 3
    assert is_down(seen)
    alone = read(bodies, axes).scene
    assert (len(alone.bodies), tuple(alone.gravity)) == (3, (0.0, 0.0))
    notes = " ".join(alone.notes)
    first = len(bodies)
    assert all(str(k) in notes for k in range(first, first + len(axes)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("gap", [0, 10])
def test_an_arrow_that_begins_at_a_body_is_no_gravity(seed: int, gap: float) -> None:
    rng = np.random.default_rng(seed)
    bodies, gravity = scenery(rng), arrow((1180, 120), (1183, 230), HAND, rng)
    moving = arrow((450 - 45 - gap, 520), (320 - gap, 518), HAND, rng)
    seen = read(bodies, gravity, moving)
    assert len(seen.scene.bodies) == 3
    assert is_down(seen)
    alone = read(bodies, moving).scene
    assert tuple(alone.gravity) == (0.0, 0.0)
    assert any("an arrow at a body" in note for note in alone.notes)
    sketch = page(bodies, moving)
    said = {tuple(range(len(bodies), len(sketch.strokes))): "gravity"}
    assert recognize(sketch, overrides=said).scene.gravity[0] < -9.5  # unless it is said to be


@pytest.mark.parametrize("seed", SEEDS)
def test_of_two_arrows_the_one_on_free_paper_is_gravity(seed: int) -> None:
    """However many strokes either is drawn in, and whichever came first; and the other is named."""
    rng = np.random.default_rng(seed)
    bodies, gravity = scenery(rng), arrow((1180, 120), (1183, 230), HAND, rng)
    pushing = arrow((560, 430), (705, 480), HAND, rng)  # at the box, from the left
    for strokes in ((gravity, pushing), (pushing, gravity)):
        seen = read(bodies, *strokes)
        assert is_down(seen)
        assert any("2 arrows" in note for note in seen.scene.notes)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_line_with_two_heads_is_no_gravity(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = scenery(rng)
    (shaft,) = line([(740, 440), (940, 440)], HAND, rng)
    heads = [
        line([(x + inward, 440 + up), (x, 440)], HAND, rng)
        for x, inward in ((740, 14), (940, -14))
        for up in (-8, 8)
    ]
    scene = read(bodies, [shaft], *heads).scene
    assert (len(scene.bodies), tuple(scene.gravity)) == (3, (0.0, 0.0))
    seen = read(bodies, [shaft], *heads, arrow((1180, 120), (1183, 230), HAND, rng))
    assert len(seen.scene.bodies) == 3
    assert is_down(seen)


@pytest.mark.parametrize("seed", SEEDS)
def test_an_arrow_beside_a_wall_is_gravity(seed: int) -> None:
    """It runs along the wall and does not begin at it: alone on its page it means what arrows mean."""
    rng = np.random.default_rng(seed)
    wall = outline(box(400, 360, 50, 500), HAND, rng)
    seen = read(wall, arrow((450, 200), (452, 320), HAND, rng))
    assert is_down(seen)
    assert len(seen.scene.bodies) == 1


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("tip", [1165, 1166])
def test_an_arrow_whose_barb_crosses_its_shaft_is_gravity(seed: int, tip: float) -> None:
    """By its ink alone it is rather an X, and there is no body that it would fix."""
    rng = np.random.default_rng(seed)
    shaft = line([(1180, 100), (1182, 250)], HAND, rng)
    head = line([(1140, 194), (tip, 250), (1224, 194)], HAND, rng)
    assert is_down(read(scenery(rng), shaft, head))


@pytest.mark.parametrize("seed", [0, 2, 3, 4, 5, 7])
def test_a_velocity_along_a_slope_is_no_gravity_beside_a_careless_arrow(seed: int) -> None:
    """A crate on a wedge; what leads away from it aslant is gravity where there is no other arrow alone."""
    rng, t = np.random.default_rng(seed), 0.5
    along, up = np.array([np.cos(t), np.sin(t)]), np.array([np.sin(t), -np.cos(t)])
    wedge = outline([(300, 300), (862, 607), (300, 607)], HAND, rng)
    x, y = (300, 300) + 260 * along + 46 * up
    crate = outline(box(float(x), float(y), 120, 84, t), HAND, rng)
    tail = (x, y) + 50 * up + 10 * along
    wall = outline(box(1190, 185, 60, 300), HAND, rng)
    careless = Hand(tremor=0.02, drift=0.05, rounding=0.2, overshoot=0.08, hook=0.08)
    moving = arrow((float(tail[0]), float(tail[1])), tuple((tail + 130 * along).tolist()), HAND, rng)
    seen = read(wedge, crate, wall, moving, arrow((1100, 150), (1100, 220), careless, rng)).scene
    assert len(seen.bodies) == 3
    assert seen.gravity[1] < -8.5
