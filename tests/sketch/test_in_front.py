"""Several bodies at one place: which of them a pivot joins, and which an X holds."""

from __future__ import annotations

import numpy as np
import pytest
from pages import box, read

from sketch.synthetic import HANDS, circle, cross, outline

HAND = HANDS["neat"]


def bodies_at(joint: object, scene: object) -> set[int]:
    """The numbers of the bodies that a joint joins, in the order of drawing."""
    names = [b.id for b in scene.bodies]  # type: ignore[attr-defined]
    return {names.index(name) for name in joint.bodies}  # type: ignore[attr-defined]


@pytest.mark.parametrize("case_first", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_a_pivot_before_a_case_joins_what_moves_in_front_of_it(case_first: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    case = outline(box(640, 360, 360, 600), HAND, rng)
    rod = outline(box(640, 320, 26, 290), HAND, rng)
    bob = circle((640, 450), 46, HAND, rng)
    parts = [case, rod, bob] if case_first else [rod, bob, case]
    pins = [circle((640, 190), 8, HAND, rng), circle((640, 450), 8, HAND, rng)]
    scene = read(*parts, *pins).scene
    big = 0 if case_first else 2
    rest = {0, 1, 2} - {big}
    assert len(scene.bodies) == 3
    upper, lower = sorted(scene.joints, key=lambda j: -j.position[1])
    assert bodies_at(upper, scene) == {big, min(rest)}
    assert bodies_at(lower, scene) == rest


@pytest.mark.parametrize("seed", range(4))
def test_an_x_holds_the_body_that_it_was_drawn_in(seed: int) -> None:
    """A narrow rod hangs over the middle of the X in a beam."""
    rng = np.random.default_rng(seed)
    beam = outline(box(640, 180, 700, 70), HAND, rng)
    hold = cross((640, 178), 44, HAND, rng)
    rod = outline(box(640, 330, 18, 340), HAND, rng)
    scene = read(beam, hold, rod).scene
    assert [b.anchored for b in scene.bodies] == [True, False]


@pytest.mark.parametrize("seed", range(4))
def test_a_pivot_where_two_bars_end_does_not_make_them_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boom = outline(box(500, 300, 420, 40, -0.8), HANDS["pieces"], rng)
    x, y = 500 + 195 * np.cos(0.8), 300 - 195 * np.sin(0.8)
    rope = outline(box(x + 4, y + 100, 24, 220), HANDS["pieces"], rng)
    scene = read(boom, rope, circle((x, y), 8, HAND, rng)).scene
    assert len(scene.bodies) == 2
    assert len(scene.joints) == 1
