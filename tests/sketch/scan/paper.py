"""Drawings on made-up paper before a made-up camera, with their truth carried along.

A `Paper` says what the sheet, the pen, the light and the camera are like; `photographed` gives the file of the
picture and the drawing as it lies in the picture's own pixels::

    data, seen = photographed(drawing, PAPERS["hard shadow"], np.random.default_rng(1))
    differences(seen, recognize(load_sketch(data)).scene)

`python -m tests.sketch.scan.paper SHEET.png` draws a cart on all of them.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.drawings import Drawing
from tests.benchmarks.mechanisms import draw
from tests.sketch.scan.typed import Print, typed
from tests.sketch.scan.worn import fold, grain, punch, stain

__all__ = ["PAPERS", "Paper", "photographed"]

Array = NDArray[Any]
Color = tuple[float, float, float]  # BGR

FINE = 2  # ink is drawn with this many pixels for one, each way, then reduced
MARGIN = 60  # of paper around the page [pixels of the drawing]
FOCAL = 1.3  # focal length, as a share of the picture's width
PRINT: Color = (45, 42, 42)
TABLE: Color = (52, 76, 104)
SKIN: Color = (115, 145, 200)
NAIL: Color = (128, 150, 205)
WHITE: Color = (1.0, 1.0, 1.0)  # of a lamp


@dataclass(frozen=True)
class Paper:
    """How a drawing lies before the camera. Lengths are in pixels of the drawing unless it says otherwise.

    Attributes:
        scale: pixels of the picture for one of the drawing.
        pen, color, cover: the pen's width, its colour, and how much of the paper it hides, 0 to 1.
        grain: how much of a pencil's graphite the paper's grain leaves out, 0 to 1.
        skips: how much of a stroke a ballpoint that runs dry leaves out, 0 to 1.
        second: colour of the pen that every other stroke is drawn with, or None.
        hatched: distance of the lines that free bodies are hatched with, or 0.
        filled: whether bodies are filled in.  tint: how much of the paper the fill hides, as a share of the ink.
        sheet: colour of the paper.  texture: its unevenness [grey levels].
        ruled, squared: distance of printed lines, or 0; ruling: their colour; ruling_width [pixels of the picture].
        behind: how dark the other side of the sheet shows through, 0 to 1.
        folds, coffee, specks, smudges: how many; a smudge is what an eraser leaves of a line.
        punched: how many holes are along the left edge.
        printed: what is printed on the sheet, or None.
        shade: light at the darkest corner, as a share of the brightest.
        shadow: light within a shadow with an edge, likewise; shadow_edge: how soft that is [pixels of the picture].
        lamp: colour of the light.  glare: [grey levels] of a lamp's reflection.
        tilt: of the camera [degrees]; turn: of the sheet [degrees].
        table: how much of the table is seen on each side, as a share of the sheet.  fingers: how many hold the sheet.
        blur, noise: of the camera [pixels of the picture, grey levels].  quality: of the JPEG file; 0 is a PNG file.
    """

    scale: float = 1.25
    pen: float = 2.8
    color: Color = (60, 45, 40)
    cover: float = 0.92
    grain: float = 0.0
    skips: float = 0.0
    second: Color | None = None
    hatched: float = 0.0
    filled: bool = False
    tint: float = 1.0
    sheet: Color = (238, 240, 241)
    texture: float = 2.0
    ruled: float = 0.0
    squared: float = 0.0
    ruling: Color = (215, 190, 175)
    ruling_width: float = 1.2
    behind: float = 0.0
    folds: int = 0
    coffee: int = 0
    specks: int = 0
    smudges: int = 0
    punched: int = 0
    printed: Print | None = None
    shade: float = 1.0
    shadow: float = 1.0
    shadow_edge: float = 3.0
    lamp: Color = WHITE
    glare: float = 0.0
    tilt: float = 0.0
    turn: float = 0.0
    table: float = 0.0
    fingers: int = 0
    blur: float = 0.6
    noise: float = 2.0
    quality: int = 85

    def shows(self, drawing: Drawing) -> bool:
        """Whether all of a drawing is seen on it: a fill as dark as the ink hides marks."""
        if self.hatched and not _free(drawing):
            return False
        hides = self.filled and self.tint == 1.0
        return not hides or not (drawing.joints or any(body.anchored for body in drawing.bodies))


PHOTO = Paper(shade=0.7, tilt=4, turn=2, noise=3)
PENCIL = replace(PHOTO, color=(95, 92, 90), cover=0.8, grain=0.28, pen=2.4)
BALLPOINT = replace(PHOTO, color=(140, 60, 35), pen=1.8, cover=0.88)

PAPERS: dict[str, Paper] = {
    "screenshot": Paper(
        texture=0, blur=0, noise=0, quality=0, cover=1.0, sheet=(255, 255, 255), color=(0, 0, 0)
    ),
    "scan": Paper(),
    "photo": PHOTO,
    "pencil": PENCIL,
    "faint pencil": replace(PENCIL, color=(150, 148, 146), shade=0.6),
    "ballpoint": BALLPOINT,
    "marker": replace(PHOTO, pen=7.0, color=(45, 40, 190)),
    "yellow-green pen": replace(PHOTO, color=(70, 190, 150)),
    "filled": replace(PHOTO, filled=True, color=(150, 80, 40)),
    "tinted": replace(PHOTO, filled=True, tint=0.4, color=(150, 80, 40)),
    "red pencil on yellow": replace(PENCIL, sheet=(150, 225, 240), color=(80, 80, 190)),
    "tilted 12 degrees": replace(PHOTO, tilt=12, table=0.04),
    "tilted 20 degrees": replace(PHOTO, tilt=20, table=0.06),
    "hard shadow": replace(PHOTO, shadow=0.5),
    "deep hard shadow": replace(PHOTO, shadow=0.32, shadow_edge=2),
    "yellow lamp": replace(PHOTO, lamp=(0.45, 0.78, 1.0), shade=0.5),
    "dim room": replace(PHOTO, lamp=(0.22, 0.24, 0.25), noise=4, table=0.1),
    "ruled": replace(BALLPOINT, ruled=30),
    "squared": replace(BALLPOINT, squared=26),
    "ruled darkly": replace(PHOTO, ruled=34, ruling=(150, 120, 100)),
    "squared darkly": replace(PHOTO, squared=30, ruling=(165, 130, 110)),
    "show-through": replace(PHOTO, behind=0.2),
    "folded twice": replace(PHOTO, folds=2),
    "coffee": replace(BALLPOINT, coffee=1),
    "on a table, with fingers": replace(PHOTO, table=0.12, fingers=3, turn=5),
    "pencil in a shadow on a table": replace(PENCIL, shadow=0.55, table=0.1, fingers=2),
    "blackboard": replace(
        PHOTO, sheet=(56, 62, 50), color=(225, 232, 230), pen=4.5, cover=0.8, grain=0.3, texture=5, tilt=6
    ),
    "whiteboard with glare": replace(
        PHOTO, sheet=(205, 205, 205), color=(150, 60, 30), pen=5, glare=120, tilt=8
    ),
    "out of focus": replace(PHOTO, blur=2.0),
    "noisy": replace(PHOTO, noise=11),
    "JPEG of quality 30": replace(BALLPOINT, quality=30),
    "large photo": replace(PHOTO, scale=2.2, blur=1.2, table=0.05),
    "everything at once": replace(
        BALLPOINT,
        ruled=32,
        shadow=0.55,
        lamp=(0.7, 0.9, 1.0),
        folds=1,
        tilt=9,
        table=0.08,
        fingers=2,
        noise=4,
    ),
    "ballpoint that skips": replace(BALLPOINT, skips=0.06),
    "two pens": replace(PHOTO, second=(40, 40, 200)),
    "pencil and pen": replace(PENCIL, second=(110, 50, 30)),
    "hatched": replace(PHOTO, hatched=9.0),
    "punched": replace(PHOTO, punched=4),
    "smudges": replace(PENCIL, smudges=4),
    "worksheet": replace(
        PENCIL, printed=Print(fields=True, title=True, problem=3), tilt=6, turn=3, table=0.04
    ),
    "scanned worksheet": Paper(
        printed=Print(tall=15, face=cv2.FONT_HERSHEY_DUPLEX, problem=5, answer=2), turn=1
    ),
    "letterhead": replace(
        BALLPOINT, printed=Print(tall=20, face=cv2.FONT_HERSHEY_TRIPLEX, title=True), scale=1.6
    ),
    "wide marker": replace(PHOTO, pen=10.0, color=(60, 120, 40), scale=0.8),
}


def photographed(drawing: Drawing, paper: Paper, rng: np.random.Generator) -> tuple[bytes, Drawing]:
    """The picture file of a drawing on some paper, and the drawing in that picture's pixels."""
    if paper.printed is not None:
        drawing = _lowered(drawing, paper.printed)
    view, size = _view(drawing, paper, rng)
    sheet = _sheet(drawing, paper, rng)
    border = cv2.BORDER_CONSTANT if paper.table else cv2.BORDER_REPLICATE
    picture = cv2.warpPerspective(
        sheet, view, size, flags=cv2.INTER_LINEAR, borderMode=border, borderValue=TABLE
    )
    if paper.table:
        inside = cv2.warpPerspective(np.ones(sheet.shape[:2], np.float32), view, size)
        wood = _coloured(TABLE, 9 * grain((size[1], size[0]), 6, rng))
        picture *= _bgr(inside)
        picture += wood * _bgr(1 - inside)
    picture = _lit(picture, paper, rng)
    if paper.fingers:
        _hold(picture, paper, view, sheet.shape[1::-1], rng)
    if paper.lamp != WHITE:
        picture *= np.array(paper.lamp, np.float32)
    if paper.blur:
        cv2.GaussianBlur(picture, (0, 0), paper.blur, picture)
    if paper.noise:
        noise = rng.standard_normal(picture.shape, np.float32)
        noise *= paper.noise
        picture += noise
    picture += 0.5
    pixels = np.clip(picture, 0, 255, out=picture).astype(np.uint8)
    if paper.quality:
        data = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, paper.quality])[1]
    else:
        data = cv2.imencode(".png", pixels)[1]
    lie = np.array(
        [[paper.scale, 0, MARGIN * paper.scale], [0, paper.scale, MARGIN * paper.scale], [0, 0, 1]]
    )
    return data.tobytes(), _carried(drawing, view @ lie, size)


def _view(drawing: Drawing, paper: Paper, rng: np.random.Generator) -> tuple[Array, tuple[int, int]]:
    """From the sheet's pixels to the picture's, and the picture's width and height.

    A plane before a pinhole camera, turned in itself, then tilted about an axis of any direction.
    """
    width = (drawing.width + 2 * MARGIN) * paper.scale
    height = (drawing.height + 2 * MARGIN) * paper.scale
    size = (round(width * (1 + 2 * paper.table)), round(height * (1 + 2 * paper.table)))
    if not paper.tilt and not paper.turn:
        return np.array([[1, 0, size[0] / 2 - width / 2], [0, 1, size[1] / 2 - height / 2], [0, 0, 1]]), size
    focal = FOCAL * width
    axis = rng.uniform(0, 2 * math.pi)
    tilt = math.radians(paper.tilt) * np.array([math.cos(axis), math.sin(axis), 0])
    turn = math.radians(paper.turn) * rng.choice([-1, 1]) * np.array([0, 0, 1.0])
    pose = cv2.Rodrigues(tilt)[0] @ cv2.Rodrigues(turn)[0]
    camera = np.array([[focal, 0, size[0] / 2], [0, focal, size[1] / 2], [0, 0, 1]])
    centred = np.array([[1, 0, -width / 2], [0, 1, -height / 2], [0, 0, 1]])
    # nearer, the tilted sheet would not fit the picture; farther, the table would be seen beside it
    distance = focal * (1.06 if paper.table else 1.0)
    view = camera @ np.column_stack([pose[:, 0], pose[:, 1], [0, 0, distance]]) @ centred
    return view / view[2, 2], size


def _carried(drawing: Drawing, view: Array, size: tuple[float, float]) -> Drawing:
    def go(points: Any) -> Array:
        points = np.asarray(points, np.float64).reshape(-1, 1, 2)
        return np.asarray(cv2.perspectiveTransform(points, view)).reshape(-1, 2)

    gravity = drawing.gravity
    if gravity is not None:
        middle = np.array([drawing.width / 2, drawing.height / 2])
        a, b = go([middle, middle + 50 * np.array([math.cos(gravity), math.sin(gravity)])])
        gravity = math.atan2(b[1] - a[1], b[0] - a[0])
    return replace(
        drawing,
        strokes=[go(s) for s in drawing.strokes],
        bodies=[replace(b, outline=go(b.outline)) for b in drawing.bodies],
        joints=[replace(j, position=tuple(go([j.position])[0].tolist())) for j in drawing.joints],
        gravity=gravity,
        width=float(size[0]),
        height=float(size[1]),
    )


def _lowered(drawing: Drawing, printed: Print) -> Drawing:
    """A drawing on a larger page, below what is printed above it."""
    down = np.array([[1, 0, 0], [0, 1, printed.above], [0, 0, 1]])
    return _carried(drawing, down, (drawing.width, drawing.height + printed.above + printed.below))


def _bgr(grey: Array) -> Array:
    """The same in every channel: a row of three at a time, numpy takes many times as long."""
    return cv2.merge([np.asarray(grey, np.float32)] * 3)


def _coloured(color: Color, more: Array) -> Array:
    """A colour, with so much more in every channel."""
    return cv2.merge([np.float32(channel) + more for channel in color])


# ---------------------------------------------------------------- the sheet and its ink


def _sheet(drawing: Drawing, paper: Paper, rng: np.random.Generator) -> Array:
    """The sheet seen straight from above in even light, BGR, float."""
    ink, second = _ink(drawing, paper, rng), None
    if paper.second is not None:
        ink = _ink(replace(drawing, strokes=drawing.strokes[::2]), paper, rng)
        second = _ink(
            replace(drawing, strokes=drawing.strokes[1::2]), replace(paper, pen=1.2 * paper.pen), rng
        )
    shape = ink.shape
    sheet = _coloured(paper.sheet, paper.texture * grain(shape, 1.5, rng))
    _rule(sheet, paper, rng)
    if paper.printed is not None:
        _put(typed(paper.printed, shape, paper.scale, rng), PRINT, sheet, paper)
    if paper.behind:
        sheet *= _bgr(1 - paper.behind * cv2.GaussianBlur(ink[:, ::-1], (0, 0), 2.0))
    for _ in range(paper.coffee):
        stain(sheet, rng)
    for _ in range(paper.smudges):
        _smudge(sheet, paper, rng)
    for _ in range(paper.folds):
        fold(sheet, rng)
    for _ in range(paper.specks):
        at = (rng.uniform(0.05, 0.95, 2) * shape[::-1]).astype(int).tolist()
        cv2.circle(sheet, at, round(rng.uniform(1, 2.5)), (70, 70, 70), cv2.FILLED, cv2.LINE_AA)
    if paper.grain:
        ink = ink * np.clip(1 - paper.grain * (0.5 + grain(shape, 0.8, rng)), 0, 1)
    _put(ink, paper.color, sheet, paper)
    if second is not None and paper.second is not None:
        _put(second, paper.second, sheet, paper)
    punch(sheet, paper.punched)
    return sheet


def _put(ink: Array, color: Color, sheet: Array, paper: Paper) -> None:
    there = ink > 0  # on little of it: the rest is as it was
    cover = paper.cover * ink[there][:, None]
    sheet[there] = sheet[there] * (1 - cover) + np.array(color, np.float32) * cover


def _ink(drawing: Drawing, paper: Paper, rng: np.random.Generator) -> Array:
    """How much of each pixel is under ink; the pen's width changes slowly along a stroke."""
    up = FINE * paper.scale
    size = [round((side + 2 * MARGIN) * paper.scale) for side in (drawing.height, drawing.width)]
    image = np.zeros([FINE * side for side in size], np.uint8)

    def fixed(points: Array) -> Array:
        return np.round(((points + MARGIN) * up + 0.5 * (FINE - 1)) * 16).astype(np.int32)

    for stroke in drawing.strokes:
        pieces = max(1, len(stroke) // 12)
        for k in range(pieces):
            piece = stroke[k * len(stroke) // pieces : (k + 1) * len(stroke) // pieces + 1]
            wide = max(1, round(paper.pen * up * rng.uniform(0.88, 1.12)))
            for part in _written(piece, paper, rng):
                cv2.polylines(image, [fixed(part)], False, 255, wide, cv2.LINE_AA, 4)
    for line in _hatching(drawing, paper, rng) if paper.hatched else ():
        wide = max(1, round(paper.pen * up * rng.uniform(0.7, 1.0)))
        cv2.polylines(image, [fixed(line)], False, 255, wide, cv2.LINE_AA, 4)
    if paper.filled:
        fill = np.zeros_like(image)
        for body in drawing.bodies:
            if body.kind != "bar":
                cv2.fillPoly(fill, [fixed(body.outline)], round(255 * paper.tint), cv2.LINE_AA, 4)
        image = np.maximum(image, fill)
    return cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA).astype(np.float32) / 255


def _written(stroke: Array, paper: Paper, rng: np.random.Generator) -> list[Array]:
    """The parts of a stroke that a pen leaves ink of: one that runs dry skips for about a pen's width or two."""
    if not paper.skips:
        return [stroke]
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(stroke, axis=0).T))])
    parts, at = [], 0.0
    while at < along[-1]:
        skip = paper.pen * rng.exponential(1.5)
        end = at + rng.exponential(skip / paper.skips) + paper.pen
        places = np.concatenate([[at], along[(along > at) & (along < end)], [min(end, along[-1])]])
        parts.append(np.stack([np.interp(places, along, axis) for axis in stroke.T], axis=1))
        at = end + skip
    return parts


def _free(drawing: Drawing) -> list[Array]:
    """The outlines of bodies that have no mark on them, so that hatching hides none."""
    jointed = {k for joint in drawing.joints for k in joint.bodies}
    bodies = enumerate(drawing.bodies)
    return [b.outline for k, b in bodies if not b.anchored and k not in jointed and b.kind != "bar"]


def _hatching(drawing: Drawing, paper: Paper, rng: np.random.Generator) -> list[Array]:
    """Lines at a slant from side to side of the free bodies, each drawn a little short or long."""
    lines = []
    for outline in _free(drawing):
        a = rng.uniform(0.6, 1.0)
        along, across = np.array([math.cos(a), -math.sin(a)]), np.array([math.sin(a), math.cos(a)])
        u, v = outline @ along, outline @ across
        for at in np.arange(v.min() + 0.6 * paper.hatched, v.max(), paper.hatched):
            level = v - (at + rng.normal(0, 0.06) * paper.hatched)
            far = np.roll(level, -1)
            cut = np.flatnonzero(level * far < 0)
            if len(cut) != 2:
                continue
            share = level[cut] / (level[cut] - far[cut])
            ends = np.sort(u[cut] + share * (np.roll(u, -1)[cut] - u[cut])) + rng.normal(0, 1.5, 2)
            lines.append(np.array([end * along + at * across for end in ends]))
    return lines


def _smudge(sheet: Array, paper: Paper, rng: np.random.Generator) -> None:
    """What an eraser leaves of a line: its ghost, and graphite that it spread beside it."""
    height, width = sheet.shape[:2]
    at = np.array([width, height]) * rng.uniform(0.2, 0.8, 2)
    a, long = rng.uniform(0, math.pi), 0.08 * width
    ends = [
        at - long * np.array([math.cos(a), math.sin(a)]),
        at + long * np.array([math.cos(a), math.sin(a)]),
    ]
    ghost, spread = np.zeros((height, width), np.float32), np.zeros((height, width), np.float32)
    first, last = (np.round(end).astype(int).tolist() for end in ends)
    cv2.line(ghost, first, last, 1.0, max(1, round(paper.pen * paper.scale)), cv2.LINE_AA)
    for off in rng.normal(0, 0.012 * width, (6, 2)):
        from_, to = (np.round(end + off).astype(int).tolist() for end in ends)
        cv2.line(spread, from_, to, float(rng.uniform(0.3, 1)), round(0.012 * width))
    spread = cv2.GaussianBlur(spread, (0, 0), 0.006 * width)
    sheet *= 1 - (0.14 * cv2.GaussianBlur(ghost, (0, 0), 1.2) + 0.08 * spread)[..., None]


def _rule(sheet: Array, paper: Paper, rng: np.random.Generator) -> None:
    height, width = sheet.shape[:2]
    step = (paper.ruled or paper.squared) * paper.scale
    if not step:
        return
    lines = np.zeros((height, width), np.uint8)
    wide = max(1, round(FINE * paper.ruling_width))
    for y in np.arange(rng.uniform(0.3, 1) * step, height, step):
        cv2.line(lines, (0, round(y)), (width, round(y)), 255, max(1, wide // FINE), cv2.LINE_AA)
    for x in np.arange(rng.uniform(0.3, 1) * step, width, step) if paper.squared else ():
        cv2.line(lines, (round(x), 0), (round(x), height), 255, max(1, wide // FINE), cv2.LINE_AA)
    share = (lines.astype(np.float32) / 255)[..., None]
    sheet[...] = sheet * (1 - share) + np.array(paper.ruling, np.float32) * share


# ---------------------------------------------------------------- light and camera


def _lit(picture: Array, paper: Paper, rng: np.random.Generator) -> Array:
    height, width = picture.shape[:2]
    u = np.linspace(-0.5, 0.5, width, dtype=np.float32)[None]
    v = np.linspace(-0.5, 0.5, height, dtype=np.float32)[:, None]
    a = rng.uniform(0, 2 * math.pi)
    along = (u * math.cos(a) + v * math.sin(a)) / (0.5 * (abs(math.cos(a)) + abs(math.sin(a))))
    light = 1 - (1 - paper.shade) * (0.5 + 0.5 * along)
    if paper.shadow < 1:
        b = rng.uniform(0, 2 * math.pi)
        off = (u * math.cos(b) + v * math.sin(b) + rng.uniform(-0.15, 0.15)) * width
        light *= paper.shadow + (1 - paper.shadow) / (1 + np.exp(-np.clip(off / paper.shadow_edge, -40, 40)))
    picture *= _bgr(light)
    if paper.glare:
        at, wide = rng.uniform(-0.3, 0.3, 2), rng.uniform(0.06, 0.1)
        picture = (
            picture
            + paper.glare * np.exp(-(((u - at[0]) / wide) ** 2 + ((v - at[1]) / wide) ** 2))[..., None]
        )
    return np.asarray(picture, np.float32)


def _hold(
    picture: Array, paper: Paper, view: Array, sheet: tuple[int, int], rng: np.random.Generator
) -> None:
    """Fingertips on the sheet's right edge, with nails and a shadow."""
    edge = np.array([[[sheet[0], sheet[1] * 0.55]], [[sheet[0], sheet[1] * 0.9]]], np.float64)
    low, high = cv2.perspectiveTransform(edge, view).reshape(2, 2)
    thick = 0.03 * picture.shape[1]
    left = max(int(min(low[0], high[0]) - 3 * thick), 0)
    whole, picture = picture, np.ascontiguousarray(picture[:, left:])
    low, high = low - [left, 0], high - [left, 0]
    for k in range(paper.fingers):
        tip = low + (high - low) * k / max(paper.fingers, 1) - [rng.uniform(0, 0.6) * thick, 0]
        root = tip + np.array([20 * thick, rng.uniform(1.5, 4) * thick])
        ends = [tuple(np.round(p).astype(int).tolist()) for p in (tip, root)]
        mask = np.zeros(picture.shape[:2], np.float32)
        cv2.line(mask, *ends, 1.0, round(1.6 * thick))
        depth = cv2.GaussianBlur(mask, (0, 0), 0.25 * thick)[..., None]
        picture *= 1 - 0.4 * np.roll(depth, 5, axis=0)
        picture[mask > 0] = (np.array(SKIN, np.float32) * (0.7 + 0.3 * depth))[mask > 0]
        nail = tuple(np.round(tip + np.array([0.1 * thick, 0])).astype(int).tolist())
        cv2.ellipse(picture, nail, (round(0.4 * thick), round(0.28 * thick)), 0, 0, 360, NAIL, -1)
    whole[:, left:] = picture


def contact_sheet(drawing: Drawing, across: int = 6, width: int = 360, height: int = 220) -> Array:
    """A drawing on every paper, with the papers' names."""
    pictures = []
    for name, paper in PAPERS.items():
        data, _ = photographed(drawing, paper, np.random.default_rng(1))
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        picture = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
        cv2.putText(picture, name, (5, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (0, 0, 255), 1, cv2.LINE_AA)
        pictures.append(picture)
    pictures += [np.full_like(pictures[0], 255)] * (-len(pictures) % across)
    rows = [np.hstack(pictures[k : k + across]) for k in range(0, len(pictures), across)]
    return np.asarray(np.vstack(rows))


if __name__ == "__main__":
    cv2.imwrite(sys.argv[1], contact_sheet(draw(1, 7, 20)))
