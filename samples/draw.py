"""Draws the samples: machines laid out in pixels, put on the page by a seeded, trembling pen.

    python samples/draw.py [FOLDER]     # writes every sketch, picture and scene, beside this file by default

Each page keeps what it means, so that the tests know what the program has to read in it.
"""

from __future__ import annotations

import itertools
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from page import HEIGHT, WIDTH, Page, Point

SCALE = WIDTH / 10  # pixels a metre

MACHINES: dict[str, Callable[[Page], None]] = {}


def machine(draw: Callable[[Page], None]) -> Callable[[Page], None]:
    MACHINES[draw.__name__.replace("_", "-")] = draw
    return draw


def page_of(name: str) -> Page:
    page = Page(name)
    MACHINES[name](page)
    return page


def along(a: Point, b: Point, s: float, out: float = 0.0) -> Point:
    """s pixels from a towards b, then `out` pixels to the left of that way on the page (up, going right)."""
    length = math.dist(a, b)
    dx, dy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    return a[0] + s * dx + out * dy, a[1] + s * dy - out * dx


def turn_of(a: Point, b: Point) -> float:
    return math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))


# ---------------------------------------------------------------- machines


@machine
def ramp(page: Page) -> None:
    """A ball rolls down and pushes a box."""
    page.rectangle((640, 665), (1160, 50), anchored=True)
    top, foot = (110, 250), (740, 639)
    page.polygon([top, (110, 639), foot], anchor=(250, 540))
    page.circle(along(top, foot, 80, 43), 42)
    page.rectangle((1000, 594), (90, 90))
    page.arrow((1150, 120), (1150, 250))


@machine
def stack(page: Page) -> None:
    """Boxes on boxes: they stand."""
    page.rectangle((640, 660), (760, 50), anchored=True)
    page.rectangle((640, 595), (190, 80))
    page.rectangle((633, 518), (160, 74))
    page.rectangle((645, 446), (120, 70))
    page.rectangle((638, 381), (90, 60))
    page.polygon([(600, 350), (676, 350), (638, 290)])
    page.arrow()


@machine
def arch(page: Page) -> None:
    """Two posts, a lintel and what stands on it."""
    page.rectangle((640, 660), (900, 50), anchored=True)
    page.rectangle((480, 555), (80, 160))
    page.rectangle((800, 555), (80, 160))
    page.rectangle((640, 450), (460, 50))
    page.polygon([(560, 424), (720, 424), (680, 340), (600, 340)])
    page.arrow((150, 120), (150, 240))


@machine
def pendulum(page: Page) -> None:
    beam = page.rectangle((640, 100), (320, 64))
    page.anchor(beam, (545, 100))
    top, bob = (650, 108), (397, 320)
    rod = page.beam(along(top, bob, -16), along(bob, top, -16), 30)
    page.pivot(beam, rod, top)
    ball = page.circle(bob, 56)
    page.pivot(rod, ball, bob)
    page.arrow()


@machine
def double_pendulum(page: Page) -> None:
    block = page.rectangle((640, 130), (150, 90))
    page.anchor(block, (600, 130))
    a, b, c = (670, 140), (880, 240), (1060, 120)
    upper = page.beam(along(a, b, -18), along(b, a, -18), 36)
    lower = page.beam(along(b, c, -18), along(c, b, -18), 32)
    page.pivot(block, upper, a)
    page.pivot(upper, lower, b)
    page.arrow()


@machine
def cart(page: Page) -> None:
    """A cart rolls down a hill into a tower."""
    page.rectangle((640, 665), (1180, 50), anchored=True)
    top, foot = (60, 300), (700, 639)
    page.polygon([top, (60, 639), foot], anchor=(190, 540))
    rear, front = along(top, foot, 70, 41), along(top, foot, 220, 41)
    frame = page.beam(along(rear, front, -40, 12), along(rear, front, 190, 12), 56)
    for hub in (rear, front):
        wheel = page.circle(hub, 40)
        page.pivot(frame, wheel, hub)
    for k in range(4):
        page.rectangle((980 + (-1) ** k * 3, 604 - 71 * k), (72, 71))
    page.rectangle((1205, 570), (36, 140), anchored=True)
    page.arrow((640, 100), (640, 230))


@machine
def seesaw(page: Page) -> None:
    """A heavy ball throws a box."""
    page.rectangle((640, 670), (1180, 44), anchored=True)
    page.rectangle((75, 590), (36, 116), anchored=True)
    page.rectangle((1205, 590), (36, 116), anchored=True)
    foot = page.polygon([(640, 525), (555, 647), (725, 647)], anchor=(640, 612))
    hinge = (640, 546)
    a, b = (321, 461), (959, 631)
    plank = page.beam(a, b, 32)
    page.pivot(foot, plank, hinge)
    page.rectangle(along(a, b, 590, 45), (58, 58), turn_of(a, b))
    page.circle((375, 130), 70)
    page.arrow((1120, 110), (1120, 240))


@machine
def dominoes(page: Page) -> None:
    page.rectangle((660, 655), (1160, 44), anchored=True)
    a, b = (100, 455), (355, 550)
    page.beam(a, b, 28, anchored=True)
    page.circle(along(a, b, 45, 51), 36)
    for k in range(11):
        page.rectangle((430 + 66 * k, 566), (28, 133))
    page.arrow((1150, 120), (1150, 250))


@machine
def funnel(page: Page) -> None:
    """Many bodies fall through a funnel into a bin."""
    page.beam((200, 235), (505, 395), 36, anchored=True)
    page.beam((1080, 235), (775, 395), 36, anchored=True)
    page.rectangle((640, 692), (800, 36), anchored=True)
    page.rectangle((258, 606), (32, 134), anchored=True)
    page.rectangle((1022, 606), (32, 134), anchored=True)
    sides = [0, 4, 3, 5, 6, 0, 4, 0, 6, 3, 4, 5, 0, 3, 4, 0, 5, 4]
    wobble = page.hand.random
    for k, n in enumerate(sides):
        centre = (410 + 92 * (k % 6) + wobble.uniform(-8, 8), 60 + 84 * (k // 6) + wobble.uniform(-6, 6))
        if n == 0:
            page.circle(centre, wobble.uniform(24, 30))
        elif n == 4:
            page.rectangle(centre, (wobble.uniform(48, 62), wobble.uniform(44, 54)), wobble.uniform(-15, 15))
        else:
            radius, start = wobble.uniform(31, 35), wobble.uniform(0, 2)
            corner = [start + 2 * math.pi * i / n for i in range(n)]
            page.polygon(
                [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in corner]
            )
    page.arrow((110, 100), (110, 230))


@machine
def billiard(page: Page) -> None:
    """A table seen from above: no arrow, so nothing moves until someone gives the white ball a speed."""
    page.rectangle((640, 60), (1160, 40), anchored=True)
    page.rectangle((640, 660), (1160, 40), anchored=True)
    page.rectangle((80, 360), (40, 540), anchored=True)
    page.rectangle((1200, 360), (40, 540), anchored=True)
    page.circle((340, 360), 30)
    for row in range(4):
        for k in range(row + 1):
            page.circle((800 + 57 * row, 360 + 66 * (k - row / 2)), 30)


@machine
def cradle(page: Page) -> None:
    """Newton's cradle, the first ball held up."""
    beam = page.rectangle((640, 110), (620, 56))
    page.anchor(beam, (375, 110))
    for k in range(5):
        top = (460 + 90 * k, 116)
        swing = math.radians(40 if k == 0 else 0)
        ball = (top[0] - 340 * math.sin(swing), top[1] + 340 * math.cos(swing))
        string = page.bar([along(top, ball, -6), along(ball, top, -6)])
        bob = page.circle(ball, 44)
        page.pivot(beam, string, top)
        page.pivot(string, bob, ball)
    page.arrow((1120, 140), (1120, 270))


@machine
def linkage(page: Page) -> None:
    """A four-bar linkage on two pivots in the background."""
    a, b, c, d = (420, 470), (480, 315), (838, 190), (780, 470)
    crank = page.beam(along(a, b, -20), along(b, a, -20), 36)
    coupler = page.beam(along(b, c, -20), along(c, b, -20), 34)
    rocker = page.beam(along(c, d, -20), along(d, c, -20), 36)
    page.pivot(crank, coupler, b)
    page.pivot(coupler, rocker, c)
    page.pivot(crank, None, a)
    page.pivot(rocker, None, d)
    page.arrow((1120, 140), (1120, 270))


@machine
def bridge(page: Page) -> None:
    """A hanging bridge of planks takes a ball and a box."""
    posts = [
        page.rectangle((130, 480), (170, 400), anchored=True),
        page.rectangle((1150, 480), (170, 400), anchored=True),
    ]
    n = 8
    joints = [(190 + 900 * k / n, 310 + 90 * (1 - (2 * k / n - 1) ** 2)) for k in range(n + 1)]
    planks = [page.beam(along(p, q, -14), along(q, p, -14), 28) for p, q in itertools.pairwise(joints)]
    chain = [posts[0], *planks, posts[1]]
    for left, right, joint in zip(chain[:-1], chain[1:], joints, strict=True):
        page.pivot(left, right, joint, 8)
    page.circle((560, 130), 50)
    page.rectangle((730, 150), (84, 84), 8)
    page.arrow((1150, 60), (1150, 190))


@machine
def marbles(page: Page) -> None:
    """A marble run, with a cup at its end."""
    page.rectangle((70, 360), (40, 640), anchored=True)
    page.rectangle((1210, 360), (40, 640), anchored=True)
    runs = [((94, 140), (990, 290)), ((1186, 390), (270, 550))]
    for a, b in runs:
        page.beam(a, b, 26, anchored=True)
    cup = [(96, 600), (126, 600), (126, 666), (226, 666), (226, 600), (256, 600), (256, 706), (96, 706)]
    page.anchor(page.polygon(cup), (176, 686), 26)
    a, b = runs[0]
    for k in range(3):
        page.circle(along(a, b, 60 + 62 * k, 36), 22)
    page.arrow((640, 40), (640, 140))


@machine
def sign(page: Page) -> None:
    """Two pivots hold a board still; one lets the small board swing."""
    post = page.rectangle((300, 400), (60, 560), anchored=True)
    arm = page.rectangle((520, 160), (560, 44))
    page.pivot(post, arm, (286, 160), 8)
    page.pivot(post, arm, (314, 160), 8)
    board = page.rectangle((600, 260), (300, 180))
    page.pivot(arm, board, (490, 176), 8)
    page.pivot(arm, board, (710, 176), 8)
    hinge = (600, 332)
    small = page.beam(along(hinge, (750, 430), -22), (750, 430), 80)
    page.pivot(board, small, hinge, 8)
    page.arrow((1080, 140), (1080, 270))


@machine
def wrecker(page: Page) -> None:
    """A wrecking ball and a wall of bricks."""
    page.rectangle((640, 670), (1180, 44), anchored=True)
    page.rectangle((130, 390), (56, 510), anchored=True)
    jib = page.beam((104, 104), (590, 104), 48, anchored=True)
    top, ball = (550, 108), (262, 300)
    length = math.dist(top, ball)
    joints = [along(top, ball, length * k / 3) for k in range(4)]
    links = [
        page.beam(along(p, q, -14), along(q, p, -14), thickness)
        for p, q, thickness in zip(joints[:-1], joints[1:], (26, 34, 26), strict=True)
    ]
    weight = page.circle(ball, 78)
    for left, right, joint in zip([jib, *links], [*links, weight], joints, strict=True):
        page.pivot(left, right, joint, 8)
    for row in range(6):
        bricks = [(-40, 78), (40, 78)] if row % 2 == 0 else [(-60, 38), (0, 78), (60, 38)]
        for x, width in bricks:
            page.rectangle((790 + x, 624 - 48 * row), (width, 47))
    page.rectangle((1205, 577), (36, 140), anchored=True)
    page.arrow((1150, 60), (1150, 190))


# ---------------------------------------------------------------- scenes


def scene_of(page: Page) -> dict[str, Any]:
    """The scene JSON that the page means, with the lines where the pen meant them."""
    bodies = []
    for k, body in enumerate(page.bodies):
        bodies.append({"id": f"b{k + 1}", **_placed(body["kind"], body["outline"])})
        if body["anchored"]:
            bodies[-1]["anchored"] = True
    gravity = (0, 0) if page.gravity is None else (9.81 * page.gravity[0], -9.81 * page.gravity[1])
    joints = [
        {
            "type": "pivot",
            "bodies": [None if k is None else f"b{k + 1}" for k in j["bodies"]],
            "position": _metres(j["position"]),
        }
        for j in page.joints
    ]
    view = {"pixels_per_metre": SCALE, "width": WIDTH, "height": HEIGHT}
    return {
        "format": "sketchsim-scene",
        "version": 1,
        "gravity": [round(g, 3) for g in gravity],
        "bodies": bodies,
        "joints": joints,
        "view": view,
    }


def _placed(kind: str, outline: list[Point]) -> dict[str, Any]:
    n = len(outline)
    x, y = sum(p[0] for p in outline) / n, sum(p[1] for p in outline) / n
    if kind == "circle":
        return {
            "shape": {"type": "circle", "radius": round(math.dist(outline[0], (x, y)) / SCALE, 4)},
            "position": _metres((x, y)),
        }
    if kind == "rectangle":
        a, b, c, _ = outline
        size = [round(math.dist(a, b) / SCALE, 4), round(math.dist(b, c) / SCALE, 4)]
        angle = round(-math.radians(turn_of(a, b)), 4) + 0.0
        return {"shape": {"type": "rectangle", "size": size}, "position": _metres((x, y)), "angle": angle}
    if kind == "bar":
        a, b = outline
        return _placed(
            "rectangle",
            [
                along(a, b, 0, 1.5),
                along(a, b, math.dist(a, b), 1.5),
                along(b, a, 0, 1.5),
                along(b, a, math.dist(a, b), 1.5),
            ],
        )
    vertices = [[round((p[0] - x) / SCALE, 4), round(-(p[1] - y) / SCALE, 4)] for p in outline]
    return {"shape": {"type": "polygon", "vertices": vertices}, "position": _metres((x, y))}


def _metres(p: Point) -> list[float]:
    return [round(p[0] / SCALE, 4), round(-p[1] / SCALE, 4)]


def billiard_break() -> dict[str, Any]:
    """The billiard with the white ball on its way: velocity, elasticity, friction and colours edited."""
    scene = scene_of(page_of("billiard"))
    colors = [
        "#f7f7f0",
        "#e8b923",
        "#2255aa",
        "#bb3333",
        "#663388",
        "#dd7722",
        "#227744",
        "#772222",
        "#222222",
    ]
    for k, body in enumerate(scene["bodies"]):
        body |= {"friction": 0.05, "elasticity": 0.95, "color": "#1f6b45"}
        if not body.get("anchored"):
            body["color"] = colors[(k - 4) % len(colors)]
    scene["bodies"][4] |= {"velocity": [9.0, 0.2]}
    return scene


def cradle_of_steel() -> dict[str, Any]:
    """The cradle with balls that lose nothing, on strings that weigh next to nothing."""
    scene = scene_of(page_of("cradle"))
    for body in scene["bodies"]:
        if body["shape"]["type"] == "circle":
            body |= {"elasticity": 1.0, "friction": 0.0, "density": 40.0, "color": "#8899aa"}
        elif not body.get("anchored"):
            body |= {"density": 0.1, "color": "#333333"}
    return scene


SCENES = {"billiard-break": billiard_break, "cradle-of-steel": cradle_of_steel}


def scene_json(scene: dict[str, Any]) -> str:
    """Scene JSON to be read and edited: a body a line."""

    def lines(rows: list[dict[str, Any]]) -> str:
        return "[\n  " + ",\n  ".join(json.dumps(row) for row in rows) + "\n ]" if rows else "[]"

    parts = [
        f"{json.dumps(key)}: {lines(value) if key in ('bodies', 'joints') else json.dumps(value)}"
        for key, value in scene.items()
    ]
    return "{" + ",\n ".join(parts) + "}\n"


PICTURES = {
    "pendulum-on-paper.jpg": ("pendulum", "photo"),
    "billiard-on-paper.jpg": ("billiard", "photo"),
    "double-pendulum-on-paper.jpg": ("double-pendulum", "photo"),
    "cradle-on-paper.png": ("cradle", "scan"),
}


def files() -> dict[str, str]:
    """The text samples by name."""
    out = {f"{name}.json": page_of(name).to_json() for name in MACHINES}
    return out | {f"{name}.json": scene_json(scene()) for name, scene in SCENES.items()}


def pictures() -> dict[str, bytes]:
    """The pictures of paper by name, encoded."""
    import cv2
    from on_paper import picture

    out = {}
    for name, (machine_name, kind) in PICTURES.items():
        image = picture(page_of(machine_name), kind)
        if name.endswith(".png"):  # few greys make a small file
            image = image // 12 * 12
        quality = (
            [cv2.IMWRITE_JPEG_QUALITY, 72] if name.endswith(".jpg") else [cv2.IMWRITE_PNG_COMPRESSION, 9]
        )
        out[name] = cv2.imencode(Path(name).suffix, image, quality)[1].tobytes()
    return out


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for name, text in files().items():
        (folder / name).write_text(text)
    for name, data in pictures().items():
        (folder / name).write_bytes(data)
