"""The same drawing on many papers: it gives the same four strokes on all of them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from sheets import HEIGHT, WIDTH, assert_all, assert_ring_and_box, drawn, encoded, ink, lit

from sim.scene import InputError
from sketch.scan import read_picture, tracing
from sketch.scan.binding import ends
from sketch.scan.looking import look

ACROSS, DOWN = np.meshgrid(np.linspace(0, 1, WIDTH), np.linspace(0, 1, HEIGHT))


def shadow_with_an_edge() -> np.ndarray:
    return np.where(ACROSS + 0.3 * DOWN < 0.55, 0.62, 1.0)


def ruled(step: int, squares: bool) -> np.ndarray:
    page = np.full((HEIGHT, WIDTH, 3), 240.0)
    page[step::step] = (225, 200, 190)
    if squares:
        page[:, step::step] = (225, 200, 190)
    return page


def coffee() -> np.ndarray:
    page = np.full((HEIGHT, WIDTH, 3), 240, np.uint8)
    cv2.circle(page, (400, 420), 110, (190, 212, 225), 14, cv2.LINE_AA)
    return page.astype(float)


def folded() -> np.ndarray:
    return 1 - 0.12 * np.exp(-(((ACROSS - 0.42) / 0.01) ** 2)) + 0.08 * (DOWN > 0.4)


def show_through(page: np.ndarray) -> np.ndarray:
    return page - 25 * cv2.GaussianBlur(ink()[:, ::-1], (0, 0), 2.5)[..., None]


PAPERS = {
    "flat colours": lambda: drawn(ink()),
    "noise": lambda: drawn(ink(), noise=9),
    "uneven light": lambda: lit(drawn(ink(), noise=4), 0.45 + 0.5 * ACROSS * DOWN),
    "shadow with an edge": lambda: lit(drawn(ink(), noise=3), shadow_with_an_edge()),
    "lamp light": lambda: drawn(ink(), paper=(95, 175, 225), pen=(40, 35, 30), noise=3),
    "ruled": lambda: drawn(ink(), paper=ruled(34, False), noise=3),
    "squared": lambda: drawn(ink(), paper=ruled(28, True), pen=(140, 60, 30), noise=3),
    "coffee": lambda: drawn(ink(), paper=coffee(), noise=3),
    "folded": lambda: lit(drawn(ink(), noise=3), folded()),
    "show-through": lambda: drawn(ink(), paper=show_through(np.full((HEIGHT, WIDTH, 3), 240.0)), noise=2),
    "pencil": lambda: drawn(ink(pen=3), paper=(235, 235, 235), pen=(165, 165, 165), noise=3),
    "ballpoint": lambda: drawn(ink(pen=2.2), pen=(150, 70, 40), noise=3),
    "marker": lambda: drawn(ink(pen=10), pen=(40, 40, 200), noise=3),
    "red": lambda: drawn(ink(), pen=(60, 50, 220), noise=3),
    "green": lambda: drawn(ink(), pen=(80, 170, 60), noise=3),
    "orange": lambda: drawn(ink(), pen=(40, 140, 250), noise=3),
    "blackboard": lambda: drawn(ink(), paper=(52, 60, 45), pen=(225, 230, 228), noise=5),
    "whiteboard with glare": lambda: drawn(
        ink(pen=6),
        paper=np.minimum(190 + 120 * np.exp(-(((ACROSS - 0.7) / 0.1) ** 2 + ((DOWN - 0.3) / 0.2) ** 2)), 255)[
            ..., None
        ],
        pen=(150, 60, 30),
        noise=3,
    ),
    "blurred": lambda: cv2.GaussianBlur(drawn(ink(), noise=4), (0, 0), 1.6),
}


@pytest.mark.parametrize("name", PAPERS)
def test_the_drawing_is_the_same_on_every_paper(name: str) -> None:
    # a wide pen rounds the corners that it draws
    assert_all(
        read_picture(encoded(PAPERS[name]())), 2.2 if name in ("marker", "whiteboard with glare") else 1.5
    )


def grain_of(size: float, seed: int) -> np.ndarray:
    rough = cv2.GaussianBlur(np.random.default_rng(seed).standard_normal((HEIGHT, WIDTH)), (0, 0), size)
    return np.asarray(rough / rough.std())


def test_lines_that_the_grain_breaks_are_whole() -> None:
    for seed in range(4):
        worn = ink(pen=5) * (grain_of(0.8, seed) < 0.3)  # a pencil touches what stands out of the sheet
        sketch = read_picture(encoded(drawn(worn, pen=(110, 110, 110), noise=3)))
        assert 4 <= len(sketch.strokes) <= 8  # and not about a hundred


@pytest.mark.parametrize("scale", [0.6, 2, 3.5])
def test_a_larger_picture_gives_a_larger_drawing(scale: float) -> None:
    large = cv2.resize(PAPERS["noise"](), None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
    sketch = read_picture(encoded(large, ".jpg"))
    assert sketch.width == large.shape[1]
    for stroke in sketch.strokes:
        stroke.points[:] = (stroke.points + 0.5) / scale - 0.5
    assert_all(sketch, 2.0)


def test_filled_shapes_are_their_outlines() -> None:
    sketch = read_picture(encoded(drawn(ink(filled=True), noise=3)))
    assert assert_ring_and_box(sketch, 5.0) == []


@pytest.mark.parametrize(("slope", "step"), [(1, 10), (2, 16), (0, 8)])
def test_hatched_shapes_are_their_outlines(slope: int, step: int) -> None:
    lines = np.zeros((HEIGHT, WIDTH), np.float32)
    for c in range(-2 * WIDTH, 2 * WIDTH, step):
        cv2.line(lines, (0, c), (WIDTH, c + slope * WIDTH), 1.0, 3, cv2.LINE_AA)
    hatched = np.maximum(np.where(ink(filled=True) > 0.5, lines, 0), ink())
    assert len(assert_ring_and_box(read_picture(encoded(drawn(hatched, noise=3))), 5.0)) == 0


def test_what_stands_side_by_side_is_not_hatched() -> None:
    some = ink()
    for x in range(60, 660, 22):
        cv2.rectangle(some, (x, 430), (x + 16, 520), 1.0, 4)
    strokes = [s.points for s in read_picture(encoded(drawn(some, noise=3))).strokes]
    assert sum(s[:, 1].min() > 415 for s in strokes) == 28


def test_filled_shapes_among_lines_are_their_outlines() -> None:
    """The pen is as wide as its lines are, however much of the ink is filled."""
    some = ink()
    for x in range(60, 660, 60):
        corners = np.array([(x, 430), (x + 34, 430), (x + 34, 520), (x, 520)])
        cv2.fillPoly(some, [corners], 1.0)
    strokes = [s.points for s in read_picture(encoded(drawn(some, noise=3))).strokes]
    boxes = [s for s in strokes if s[:, 1].min() > 415]
    assert len(boxes) == 10
    for k, box in enumerate(sorted(boxes, key=lambda s: float(s[:, 0].min()))):
        # the pen's middle went half its width within the edge of what it filled
        assert np.abs(box.min(axis=0) - (60 + 60 * k + 1.5, 431.5)).max() < 1.5
        assert np.abs(box.max(axis=0) - (60 + 60 * k + 32.5, 518.5)).max() < 1.5


def other_side(strength: float) -> np.ndarray:
    behind = cv2.GaussianBlur(ink()[:, ::-1], (0, 0), 2.0)[..., None]
    return np.asarray(235 * (1 - strength * behind))


def stained() -> np.ndarray:
    """The ring that a cup left, darker where more of the coffee dried."""
    off = np.hypot(ACROSS * WIDTH - 330, DOWN * HEIGHT - 330)
    ring = np.exp(-(((off - 170) / 4) ** 2)) * (0.7 + 0.3 * ACROSS)
    return np.asarray(240 * (1 - ring[..., None] * np.array([0.45, 0.3, 0.2])))


def creased() -> np.ndarray:
    off = ACROSS * WIDTH - 280 - 20 * DOWN
    return np.asarray(240 * (1 - 0.25 * np.exp(-((off / 2.5) ** 2)) - 0.1 * (off > 0))[..., None])


FAINT_MARKS = {
    "the other side under pencil": (other_side(0.3), (110, 108, 106)),
    "the other side": (other_side(0.35), (50, 45, 45)),
    "a cup": (stained(), (50, 45, 45)),
    "a crease": (creased(), (50, 45, 45)),
}


@pytest.mark.parametrize("name", FAINT_MARKS)
def test_what_is_far_fainter_and_softer_was_not_drawn(name: str) -> None:
    page, pen = FAINT_MARKS[name]
    sketch = read_picture(encoded(drawn(ink(), paper=page, pen=pen, noise=3)))
    assert_all(sketch)
    assert any("far fainter than the pen's" in note for note in sketch.notes)


def test_a_paler_pen_draws_too() -> None:
    some = drawn(ink(), noise=3)
    cv2.line(some, (400, 470), (660, 450), (150, 150, 150), 4, cv2.LINE_AA)
    sketch = read_picture(encoded(some))
    assert len(sketch.strokes) == 5
    assert sketch.notes == []


@pytest.mark.parametrize("upright", [True, False])
def test_a_margin_is_printed_though_ink_crosses_it(upright: bool) -> None:
    page = np.full((HEIGHT, WIDTH, 3), 240, np.uint8)
    ends = ((150, 0), (156, HEIGHT)) if upright else ((0, 348), (WIDTH, 341))
    cv2.line(page, *ends, (80, 80, 215), 2, cv2.LINE_AA)
    sketch = read_picture(encoded(drawn(ink(), paper=page, noise=3)))
    assert_all(sketch)
    assert any("from edge to edge" in note for note in sketch.notes)


def punched(floor: bool) -> np.ndarray:
    """Two dark discs near the lower edge, a floor drawn under them or not."""
    picture = drawn(ink(), noise=3)
    for x in (200, 520):
        cv2.circle(picture, (x, HEIGHT - 24), 10, (60, 75, 95), cv2.FILLED, cv2.LINE_AA)
    if floor:
        cv2.line(picture, (100, HEIGHT - 10), (620, HEIGHT - 11), (40, 40, 40), 4, cv2.LINE_AA)
    return picture


@pytest.mark.parametrize("inward", [6, 9])
def test_a_hole_that_the_pictures_edge_cuts_is_not_drawn(inward: int) -> None:
    picture = drawn(ink(), noise=3)
    cv2.circle(picture, (inward, 300), 10, (60, 75, 95), cv2.FILLED, cv2.LINE_AA)
    assert_all(read_picture(encoded(picture)))


def board(trembling: float) -> np.ndarray:
    """The drawing within a frame, a pen in the tray below, and what is on the wall beside it."""
    picture = np.full((HEIGHT + 100, WIDTH + 100, 3), 240, np.float64)
    picture[50:-50, 50:-50] = drawn(ink())
    corners = np.array([(40, 40), (WIDTH + 60, 46), (WIDTH + 56, HEIGHT + 60), (44, HEIGHT + 54)], float)
    sides = [np.linspace(a, b, 60) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    way = np.concatenate(sides)
    swing = trembling * np.sin(np.arange(len(way)) / 3)
    way += swing[:, None] * np.where(np.abs(np.gradient(way[:, :1], axis=0)) > 1, (0, 1), (1, 0))
    cv2.polylines(picture, [np.round(16 * way).astype(np.int32)], True, (120, 120, 120), 9, cv2.LINE_AA, 4)
    cv2.rectangle(picture, (200, HEIGHT + 36), (330, HEIGHT + 50), (40, 40, 180), cv2.FILLED)
    cv2.circle(picture, (20, 300), 12, (60, 60, 60), 3)
    return picture + np.random.default_rng(2).normal(0, 3, picture.shape)


def test_a_boards_frame_is_not_drawn_and_nothing_on_it_or_beyond() -> None:
    sketch = read_picture(encoded(np.clip(board(0.0), 0, 255).astype(np.uint8)))
    assert "left out a frame all around, and what is beyond it" in sketch.notes
    for stroke in sketch.strokes:
        stroke.points[:] -= 50
    assert_all(sketch)


def test_a_box_that_a_hand_drew_around_everything_is_drawn() -> None:
    sketch = read_picture(encoded(np.clip(board(5.0), 0, 255).astype(np.uint8)))
    assert max(float(np.ptp(s.points[:, 0])) for s in sketch.strokes) > WIDTH


@pytest.mark.parametrize("ruling", [0, 25])
def test_a_shade_along_the_edges_is_no_row_of_holes(ruling: int) -> None:
    image = drawn(ink(), noise=3.0).astype(float)
    height, width = image.shape[:2]
    for x in range(20, width, 34):
        image[:, x : x + 2] -= ruling
    across, down = np.arange(width)[None], np.arange(height)[:, None]
    to_edge = np.minimum(np.minimum(down, height - 1 - down), np.minimum(across, width - 1 - across))
    sketch = read_picture(encoded(lit(image, 1 - 0.1 * np.exp(-to_edge / 14)), ".jpg"))
    assert (len(sketch.strokes), sketch.notes) == (4, [])


def test_holes_along_an_edge_are_not_drawn_but_balls_on_a_floor_are() -> None:
    sketch = read_picture(encoded(punched(floor=False)))
    assert_all(sketch)
    assert sketch.notes == ["left out 2 holes along an edge of the sheet"]
    assert len(read_picture(encoded(punched(floor=True))).strokes) == 7


def on_planks(sheet: np.ndarray, color: tuple[int, int, int]) -> np.ndarray:
    """A sheet on a desk whose seams end at it."""
    desk = np.full((HEIGHT + 240, WIDTH + 240, 3), color, float)
    desk += np.random.default_rng(3).normal(0, 3, desk.shape)
    for y in range(35, len(desk), 130):
        cv2.line(desk, (0, y), (desk.shape[1], y + 6), (20, 25, 30), 3, cv2.LINE_AA)
    desk = np.clip(desk, 0, 255).astype(np.uint8)
    desk[120:-120, 120:-120] = sheet
    return desk


def test_a_line_near_the_edge_of_the_sheet_is_drawn() -> None:
    sheet = drawn(ink())
    cv2.line(sheet, (60, HEIGHT - 5), (640, HEIGHT - 9), (40, 40, 40), 4, cv2.LINE_AA)
    desk = np.full((HEIGHT + 140, WIDTH + 180, 3), 70.0)
    desk[70:-70, 90:-90] = sheet
    seen = desk[100:, 120:]  # the sheet goes on beyond the picture, above and at its left
    large = cv2.resize(seen, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
    large += np.random.default_rng(1).normal(0, 3, large.shape)
    strokes = [s.points for s in read_picture(encoded(np.clip(large, 0, 255).astype(np.uint8))).strokes]
    assert len(strokes) == 5
    assert max(np.ptp(s[:, 0]) for s in strokes) == pytest.approx(1160, abs=12)


def assert_all_at(picture: np.ndarray, left: int, top: int) -> None:
    sketch = read_picture(encoded(picture))
    for stroke in sketch.strokes:
        stroke.points[:] -= (left, top)
    assert_all(sketch)


@pytest.mark.parametrize(
    ("paper", "desk"),
    [((235, 238, 240), (70, 75, 80)), ((235, 238, 240), (185, 190, 195)), ((120, 235, 250), (150, 150, 150))],
    ids=["dark desk", "pale desk", "yellow note"],
)
def test_a_sheet_on_a_desk_is_all_that_is_read(
    paper: tuple[int, int, int], desk: tuple[int, int, int]
) -> None:
    """A desk may be as white as the paper, and its seams as dark as ink."""
    assert_all_at(on_planks(drawn(ink(), paper=paper, noise=3), desk), 120, 120)


def test_a_deep_shadow_on_a_sheet_that_is_seen_whole_is_paper() -> None:
    """No line leads into it, so that only the sheet's edges tell."""
    light = np.where(ACROSS + 0.1 * DOWN < 0.93, 1.0, 0.35)
    sheet = lit(drawn(ink(), noise=3), light)
    cv2.line(sheet, (690, 100), (690, 400), (10, 10, 10), 4, cv2.LINE_AA)
    sketch = read_picture(encoded(on_planks(sheet, (50, 75, 105))))
    ends = [s.points[[0, -1], 0] for s in sketch.strokes]
    assert len(sketch.strokes) == 5
    assert sum(abs(x - 810).max() < 4 for x in ends) == 1


@pytest.mark.parametrize("dark", [False, True])
def test_the_tools_of_an_app_are_not_drawn(dark: bool) -> None:
    canvas = drawn(ink(), paper=(255, 255, 255), pen=(0, 0, 0))
    bar = np.full((90, WIDTH, 3), 238, np.uint8)
    for x in range(40, 400, 70):
        cv2.rectangle(bar, (x, 30), (x + 36, 66), (60, 60, 60), 3, cv2.LINE_AA)
        cv2.circle(bar, (WIDTH - x, 48), 16, (40, 40, 220), cv2.FILLED, cv2.LINE_AA)
    picture = np.vstack([bar, canvas])
    if dark:
        picture = (255 - 0.88 * picture).astype(np.uint8)
    assert_all_at(picture, 0, 90)


@pytest.mark.parametrize("dark", [False, True])
def test_panels_around_a_canvas_are_not_drawn(dark: bool) -> None:
    """They are hardly darker than it, or as bright behind a thin line."""
    canvas = drawn(ink(), paper=(255, 255, 255), pen=(0, 0, 0))
    side = np.full((HEIGHT, 70, 3), 248, np.uint8)
    foot = np.full((60, WIDTH + 70, 3), 255, np.uint8)
    side[:, -1] = foot[0] = 210
    for k in range(5):
        cv2.circle(side, (34, 40 + 60 * k), 16, (40 * k, 200 - 40 * k, 220), cv2.FILLED, cv2.LINE_AA)
        cv2.rectangle(foot, (60 + 100 * k, 16), (90 + 100 * k, 46), (60, 60, 60), 2, cv2.LINE_AA)
    picture = np.vstack([np.hstack([side, canvas]), foot])
    if dark:
        picture = (255 - 0.88 * picture).astype(np.uint8)
    assert_all_at(picture, 70, 0)


def test_a_floor_across_a_whole_canvas_is_drawn() -> None:
    canvas = drawn(ink(), paper=(255, 255, 255), pen=(0, 0, 0))
    cv2.line(canvas, (4, 440), (WIDTH - 4, 446), (0, 0, 0), 4, cv2.LINE_AA)
    cv2.circle(canvas, (360, 500), 30, (0, 0, 0), 4, cv2.LINE_AA)
    assert len(read_picture(encoded(canvas)).strokes) == 6


def error_diffused(grey: np.ndarray) -> np.ndarray:
    """Floyd and Steinberg's dots: what a pixel is off is shared out to the next ones."""
    left = np.pad(grey.astype(float), ((0, 1), (1, 1)))
    for y in range(len(grey)):
        row, below = left[y].tolist(), left[y + 1]
        off = np.zeros(len(row))
        for x in range(1, len(row) - 1):
            value = 255.0 if row[x] > 127 else 0.0
            off[x] = row[x] - value
            row[x] = value
            row[x + 1] += off[x] * 7 / 16
        below += (3 * np.roll(off, -1) + 5 * off + np.roll(off, 1)) / 16
        left[y] = row
    return left[:-1, 1:-1].astype(np.uint8)


@pytest.mark.parametrize("paper", [120, 150, 170, 185, 200, 220, 240])
def test_dithered_grey_is_paper(paper: int) -> None:
    """Its dots are no ink, though they touch the lines, and what was drawn on it is still there."""
    matrix = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]]) * 16 + 8
    grey = drawn(ink(pen=6), paper=(paper,) * 3, pen=(20, 20, 20))[..., 1]
    dots = np.where(grey > np.tile(matrix, (HEIGHT // 4, WIDTH // 4)), 255, 0).astype(np.uint8)
    assert_all(read_picture(encoded(dots)), 2.0)


@pytest.mark.parametrize("paper", [150, 200])
def test_error_diffused_grey_is_paper(paper: int) -> None:
    grey = drawn(ink(pen=6), paper=(paper,) * 3, pen=(20, 20, 20))[..., 1]
    assert_all(read_picture(encoded(error_diffused(grey))), 2.2)


def test_too_many_lines_are_said_to_be_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tracing, "MOST_LINES", 5)
    with pytest.raises(InputError, match=r"nothing was read: [0-9]+ lines are too many"):
        read_picture(encoded(PAPERS["noise"]()))


def test_fingers_that_hold_the_sheet_and_specks_are_no_ink() -> None:
    picture = cv2.copyMakeBorder(PAPERS["noise"](), 40, 40, 40, 40, cv2.BORDER_CONSTANT, value=(40, 45, 50))
    for x in (420, 480):
        cv2.ellipse(picture, (x, 30), (22, 50), 0, 0, 360, (70, 95, 150), cv2.FILLED, cv2.LINE_AA)
    for x, y in ((650, 500), (90, 480), (400, 200)):
        cv2.circle(picture, (x, y), 3, (60, 60, 60), cv2.FILLED, cv2.LINE_AA)
    sketch = read_picture(encoded(picture))
    for stroke in sketch.strokes:
        stroke.points[:] -= 40
    assert_all(sketch)
    assert sketch.notes == ["left out 3 specks on the paper"]


def turned(sheet: np.ndarray, degrees: float, shrunk: float = 0.8) -> tuple[np.ndarray, np.ndarray]:
    """A sheet that lies turned on a dark desk, and the way back from the picture to it."""
    way = cv2.getRotationMatrix2D((WIDTH / 2, HEIGHT / 2), degrees, 2 * shrunk)
    way[:, 2] += (WIDTH / 2, HEIGHT / 2)
    desk = cv2.warpAffine(sheet, way, (2 * WIDTH, 2 * HEIGHT), flags=cv2.INTER_AREA, borderValue=(45, 50, 55))
    noise = np.random.default_rng(4).normal(0, 3, desk.shape)
    return np.clip(desk + noise, 0, 255).astype(np.uint8), cv2.invertAffineTransform(way)


@pytest.mark.parametrize("degrees", [-9, 6])
def test_squares_on_a_turned_sheet_are_printed(degrees: float) -> None:
    page = ruled(28, True) - np.array([40, 60, 70]) * (ruled(28, True) < 240)
    picture, back = turned(drawn(ink(), paper=page), degrees)
    sketch = read_picture(encoded(picture))
    for stroke in sketch.strokes:
        stroke.points[:] = stroke.points @ back[:, :2].T + back[:, 2]
    assert_all(sketch, 2.0)


@pytest.mark.parametrize("step", [28, 32])
@pytest.mark.parametrize("degrees", [2.0, 5.0])
def test_what_crosses_squares_keeps_little_of_them(step: int, degrees: float) -> None:
    """A bit of a printed line at each crossing would be a junction and an end: hundreds of them on a page."""
    page = np.where(ruled(step, True) < 240, 150.0, 240.0)
    picture = drawn(ink(pen=3.0), paper=page, pen=(40, 40, 40), noise=3)
    way = cv2.getRotationMatrix2D((WIDTH / 2, HEIGHT / 2), degrees, 1.0)
    seen = look(cv2.warpAffine(picture, way, (WIDTH, HEIGHT), borderMode=cv2.BORDER_REFLECT))
    assert seen is not None
    assert ends(seen.skeleton) <= 10  # the cross has four


@pytest.mark.parametrize("shining", [False, True])
def test_a_pen_that_lies_across_the_edge_of_the_sheet_is_not_drawn(shining: bool) -> None:
    picture, back = turned(drawn(ink()), 4)
    cv2.line(picture, (1150, 250), (1420, 180), (60, 60, 60), 16, cv2.LINE_AA)
    if shining:
        cv2.line(picture, (1150, 250), (1420, 180), (250, 250, 250), 4, cv2.LINE_AA)
    sketch = read_picture(encoded(picture))
    for stroke in sketch.strokes:
        stroke.points[:] = stroke.points @ back[:, :2].T + back[:, 2]
    assert_all(sketch, 2.0)
    assert "left out 1 things that lie across the edge of the sheet" in sketch.notes


def test_a_floor_to_the_edge_of_the_sheet_is_drawn() -> None:
    sheet = drawn(ink())
    cv2.line(sheet, (0, 470), (680, 474), (35, 35, 35), 5, cv2.LINE_AA)
    picture, _ = turned(sheet, 4)
    assert len(read_picture(encoded(picture)).strokes) == 5


@pytest.mark.parametrize("beyond", [1, 4, 9])
def test_ink_at_the_edge_of_the_sheet_is_read_or_named(beyond: int) -> None:
    """A box whose lower side is so near to the edge that it may not be told from it."""
    sheet = drawn(ink())
    cv2.rectangle(sheet, (440, 430), (600, HEIGHT - beyond), (35, 35, 35), 4, cv2.LINE_AA)
    sketch = read_picture(encoded(turned(sheet, 4)[0]))
    whole = any(np.hypot(*(s.points[0] - s.points[-1])) < 4 for s in sketch.strokes[4:])
    assert whole or any("to the edge of the sheet" in note for note in sketch.notes)


def test_marks_left_out_at_the_edge_of_the_sheet_are_named() -> None:
    sheet = drawn(ink())
    cv2.circle(sheet, (500, HEIGHT - 12), 9, (35, 35, 35), 3, cv2.LINE_AA)
    sketch = read_picture(encoded(turned(sheet, 4)[0]))
    assert len(sketch.strokes) == 5 or any("at the edge of the sheet" in note for note in sketch.notes)


def floored(beyond: int) -> np.ndarray:
    """The drawing, and a floor whose middle is so far within the sheet's lower edge [pixels]."""
    sheet = drawn(ink())
    cv2.line(sheet, (60, HEIGHT - beyond), (660, HEIGHT - beyond), (40, 40, 40), 4, cv2.LINE_AA)
    return sheet


@pytest.mark.parametrize("desk", [None, 50, 110, 185, 225])
@pytest.mark.parametrize("beyond", [5, 6, 8, 12])
def test_a_floor_along_the_edge_is_read_or_named(desk: int | None, beyond: int) -> None:
    picture = floored(beyond)
    if desk is not None:
        picture = np.full((HEIGHT + 160, WIDTH + 200, 3), desk, np.uint8)
        picture[80:-80, 100:-100] = floored(beyond)
    noise = np.random.default_rng(5).normal(0, 3, picture.shape)
    sketch = read_picture(encoded(np.clip(picture + noise, 0, 255).astype(np.uint8)))
    read = sum(np.ptp(s.points[:, 0]) > 590 for s in sketch.strokes) == 1
    assert read or any("to the edge of the sheet" in note for note in sketch.notes)


@pytest.mark.parametrize("desk", [50, 110])
def test_a_floor_that_bare_paper_parts_from_a_dark_desk_is_read(desk: int) -> None:
    picture = np.full((2 * HEIGHT + 160, 2 * WIDTH + 200, 3), desk, np.uint8)
    picture[80:-80, 100:-100] = cv2.resize(floored(6), None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
    noise = np.random.default_rng(6).normal(0, 3, picture.shape)
    sketch = read_picture(encoded(np.clip(picture + noise, 0, 255).astype(np.uint8)))
    assert sorted(np.ptp(s.points[:, 0]) for s in sketch.strokes)[-1] == pytest.approx(1200, abs=12)
    assert len(sketch.strokes) == 5


@pytest.mark.parametrize("wide", range(2, 20, 2))
def test_a_strip_of_the_desk_along_the_pictures_edge_is_not_drawn(wide: int) -> None:
    picture = np.full((2 * HEIGHT, 2 * WIDTH, 3), 45, np.uint8)
    sheet = cv2.resize(drawn(ink()), None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
    picture[wide:] = sheet[: 2 * HEIGHT - wide]
    noise = np.random.default_rng(7).normal(0, 3, picture.shape)
    assert len(read_picture(encoded(np.clip(picture + noise, 0, 255).astype(np.uint8))).strokes) == 4
