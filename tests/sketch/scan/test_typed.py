"""What is printed on a sheet is left out, whatever is drawn below it; what stands in a row by itself is not."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sketch import load_sketch, recognize
from tests.benchmarks.drawings import Drawing, cross, differences, writer
from tests.benchmarks.mechanisms import draw
from tests.sketch.scan.paper import PAPERS, photographed
from tests.sketch.scan.sheets import encoded


def on(name: str, number: int) -> tuple[bytes, Drawing]:
    return photographed(draw(number, 7504, 20), PAPERS[name], np.random.default_rng([7500, number]))


@pytest.mark.parametrize("name", ["worksheet", "scanned worksheet", "letterhead"])
@pytest.mark.parametrize("number", [2, 3, 6])
def test_print_is_left_out_and_named(name: str, number: int) -> None:
    """Else its lines are rods, its letters balls, and the pen is as wide as the print is bold."""
    data, seen = on(name, number)
    scene = recognize(load_sketch(data)).scene
    assert differences(seen, scene) == []
    assert any("rows of print" in note for note in scene.notes)


def test_a_worksheet_may_lie_on_its_side() -> None:
    data, seen = on("scanned worksheet", 3)
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    scene = recognize(load_sketch(encoded(np.ascontiguousarray(np.rot90(picture))))).scene
    assert len(scene.bodies) == len(seen.bodies)


@pytest.mark.parametrize("what", ["balls", "boxes", "crosses"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_is_alike_in_a_row_is_no_print(what: str, seed: int) -> None:
    """Letters differ: ten small balls do not."""
    rng = np.random.default_rng([seed, 75])
    drawing = Drawing(writer(seed), rng)
    for x in range(330, 930, 60):
        if what == "balls":
            drawing.ball(x, 400, 18)
        elif what == "boxes":
            drawing.box(x, 400, 36, 36)
        else:
            drawing.strokes += cross((x, 400), 34, drawing.hand, rng)
    drawing.box(640, 600, 500, 60)
    data, _ = photographed(drawing, PAPERS["photo"], rng)
    scene = recognize(load_sketch(data)).scene
    assert not any("print" in note for note in scene.notes)
    assert len(scene.bodies) == (1 if what == "crosses" else 11)


@pytest.mark.parametrize("tremor", [0.0, 2.5])
def test_a_straight_line_below_print_is_printed_and_a_drawn_one_is_a_rod(tremor: float) -> None:
    page = np.full((700, 1000, 3), 240, np.uint8)
    for row in range(3):
        place = (80, 80 + 40 * row)
        cv2.putText(
            page, "Draw what happens next, and explain", place, cv2.FONT_HERSHEY_COMPLEX, 0.9, (40, 40, 40), 2
        )
    x = np.arange(80.0, 900.0, 2.0)
    y = 210 + tremor * np.sin(x / 23)
    line = np.round(np.stack([x, y], axis=1) * 16).astype(np.int32)
    cv2.polylines(page, [line], False, (40, 40, 40), 3, cv2.LINE_AA, 4)
    cv2.circle(page, (500, 500), 80, (40, 40, 40), 3, cv2.LINE_AA)
    scene = recognize(load_sketch(encoded(page))).scene
    assert len(scene.bodies) == (2 if tremor else 1)
