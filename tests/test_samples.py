"""The samples: drawn anew they are the same, read they mean what was drawn, run they do what one expects."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim import Scene
from sim.scene import Circle, Polygon, Rectangle
from sketch import load_sketch, recognize

SAMPLES = Path(__file__).resolve().parent.parent / "samples"
sys.path.insert(0, str(SAMPLES))

import draw  # noqa: E402

TEXTS = draw.files()


def numbers(data: Any) -> list[float]:
    if isinstance(data, dict):
        return [n for value in data.values() for n in numbers(value)]
    if isinstance(data, list):
        return [n for value in data for n in numbers(value)]
    return [data] if isinstance(data, int | float) else []


@pytest.mark.parametrize("name", TEXTS)
def test_the_committed_sample_is_what_the_script_draws(name: str) -> None:
    committed, drawn = (SAMPLES / name).read_text(), TEXTS[name]
    if committed != drawn:  # another C library may round a sine the other way
        a, b = json.loads(committed), json.loads(drawn)
        assert len(numbers(a)) == len(numbers(b))
        assert np.max(np.abs(np.subtract(numbers(a), numbers(b)))) <= 0.1001, "run python samples/draw.py"


def test_the_committed_pictures_are_what_the_script_draws() -> None:
    import cv2

    for name, data in draw.pictures().items():
        committed = cv2.imread(str(SAMPLES / name)).astype(float)
        drawn = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        assert np.mean(np.abs(committed - drawn)) < 2, "run python samples/draw.py"


def test_every_sample_file_has_a_source() -> None:
    assert {path.name for path in SAMPLES.glob("*.json")} == set(TEXTS)
    assert {path.name for path in SAMPLES.glob("*-on-paper.*")} == set(draw.PICTURES)


def centre(outline: list[tuple[float, float]]) -> np.ndarray[Any, Any]:
    points = np.array(outline)
    return (points.min(0) + points.max(0)) / 2


def misread(page: draw.Page, scene: Scene) -> list[str]:
    """How the scene differs from what the page means: one line a difference."""
    wrong: list[str] = []
    pixels = np.array([1, -1]) * draw.SCALE
    outlines = [np.array(body.outline()) * pixels for body in scene.bodies]
    ids: dict[int | None, str | None] = {None: None}
    for k, meant in enumerate(page.bodies):
        at = centre(meant["outline"])
        near = min(range(len(outlines)), key=lambda i: math.dist(centre(outlines[i]), at), default=None)
        body = None if near is None else scene.bodies[near]
        span = np.ptp(np.array(meant["outline"]), axis=0)
        if body is None or math.dist(centre(outlines[near]), at) > 8 or body.id in ids.values():
            wrong.append(f"no body for the {meant['kind']} at {at}")
            continue
        ids[k] = body.id
        kinds = {"circle": Circle, "rectangle": Rectangle, "polygon": Polygon}
        if not isinstance(body.shape, kinds.get(meant["kind"], Circle | Rectangle | Polygon)):
            wrong.append(f"the {meant['kind']} at {at} is {type(body.shape).__name__} {body.id}")
        elif isinstance(body.shape, Polygon) and len(body.shape.vertices) != len(meant["outline"]):
            wrong.append(f"{body.id} at {at} has {len(body.shape.vertices)} vertices")
        if body.anchored != meant["anchored"]:
            wrong.append(f"{body.id} at {at}: anchored {body.anchored}")
        if np.any(np.abs(np.ptp(outlines[near], axis=0) - span) > 16):
            wrong.append(f"{body.id} at {at} spans {np.ptp(outlines[near], axis=0)}, not {span}")
    wrong += [f"{body.id} was invented" for body in scene.bodies if body.id not in ids.values()]

    left = list(scene.joints)
    for joint in page.joints:
        pair = {ids.get(k, "?") for k in joint["bodies"]}
        hits = [
            j
            for j in left
            if set(j.bodies) == pair and math.dist(np.array(j.position) * pixels, joint["position"]) < 8
        ]
        if hits:
            left.remove(hits[0])
        else:
            wrong.append(f"no pivot of {pair} at {joint['position']}")
    wrong += [f"pivot of {joint.bodies} was invented" for joint in left]

    gravity = np.array(page.gravity or (0, 0)) * [9.81, -9.81]
    if math.dist(scene.gravity, gravity) > 0.5:
        wrong.append(f"gravity is {scene.gravity}")
    return wrong


@pytest.mark.parametrize("name", ["cart", "seesaw", "ramp", "stack"])
def test_what_shares_lines_is_read_from_paper_too(name: str) -> None:
    import cv2
    from on_paper import picture

    page = draw.page_of(name)
    scene = recognize(load_sketch(cv2.imencode(".png", picture(page, "scan"))[1].tobytes())).scene
    assert misread(page, scene) == []


@pytest.mark.parametrize("name", draw.MACHINES)
def test_the_drawing_is_read_as_it_was_meant(name: str) -> None:
    scene = recognize(load_sketch(SAMPLES / f"{name}.json")).scene
    assert "\n".join(misread(draw.page_of(name), scene)) == ""


@pytest.mark.parametrize("name", draw.PICTURES)
def test_the_picture_is_read_as_its_strokes_are(name: str) -> None:
    """A photo shifts and tilts the page, so places are not compared."""
    scene = recognize(load_sketch(SAMPLES / name)).scene
    page = draw.page_of(draw.PICTURES[name][0])

    def meaning(shape: str, vertices: int, anchored: bool) -> tuple[str, int, bool]:
        return shape, vertices if shape == "polygon" else 0, anchored

    read = [
        meaning(type(b.shape).__name__.lower(), len(getattr(b.shape, "vertices", [])), b.anchored)
        for b in scene.bodies
    ]
    solid = {"bar": "rectangle"}  # a straight line is a thin one
    meant = [meaning(solid.get(b["kind"], b["kind"]), len(b["outline"]), b["anchored"]) for b in page.bodies]
    assert sorted(read) == sorted(meant)
    assert len(scene.joints) == len(page.joints)
    g = np.array(page.gravity or (0, 0)) * [9.81, -9.81]
    assert math.dist(scene.gravity, g) < 9.81 * math.radians(8)


def test_a_page_without_an_arrow_says_so() -> None:
    scene = recognize(load_sketch(SAMPLES / "billiard.json")).scene
    assert any("no gravity" in note for note in scene.notes)


@pytest.mark.parametrize("name", draw.SCENES)
def test_the_edited_scene_keeps_its_edits(name: str) -> None:
    scene = Scene.load(SAMPLES / f"{name}.json")
    assert Scene.from_json(scene.to_json()) == scene
    assert any(body.elasticity >= 0.95 and body.color for body in scene.bodies)
