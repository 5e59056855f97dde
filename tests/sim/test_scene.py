"""Scenes: what is refused and where, what is kept, and mass properties."""

import copy
import json
import math
import os
import random
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import Body, Circle, InputError, Polygon, Rectangle, Scene
from sim.scene import area_properties, parse_json

BALL = {"id": "ball", "shape": {"type": "circle", "radius": 0.5}, "position": [0, 1]}


def scene(**changes):
    return {"gravity": [0, -9.81], "bodies": [copy.deepcopy(BALL)], **changes}


def with_body(**changes):
    return scene(bodies=[{**BALL, **changes}])


def polygon(*vertices):
    return with_body(shape={"type": "polygon", "vertices": [list(v) for v in vertices]})


@pytest.mark.parametrize(
    ("bad", "path", "says"),
    [
        ({}, "bodies", "missing"),
        (scene(bodies=[{**BALL, "id": 3}]), "bodies[0].id", "expected str"),
        (scene(bodies=[{"id": "a", "position": [0, 0]}]), "bodies[0].shape", "missing"),
        (
            scene(bodies=[{"id": "a", "shape": {"type": "circle", "radius": 1}}]),
            "bodies[0].position",
            "missing",
        ),
        (scene(bodies=[BALL, BALL]), "bodies[1].id", "bodies[0]"),
        (scene(gravity=[0, math.nan]), "gravity[1]", "not a finite"),
        (scene(gravity=[0]), "gravity", "length 2"),
        (with_body(position=[math.inf, 0]), "bodies[0].position[0]", "not a finite"),
        (with_body(position=["x", 0]), "bodies[0].position[0]", "expected float"),
        (with_body(velocity=[0, math.nan]), "bodies[0].velocity[1]", "not a finite"),
        (with_body(angle=math.nan), "bodies[0].angle", "not a finite"),
        (with_body(mass=0), "bodies[0].mass", "not greater than 0"),
        (with_body(moment=-1), "bodies[0].moment", "not greater than 0"),
        (with_body(density=0), "bodies[0].density", "not greater than 0"),
        (with_body(friction=-0.1), "bodies[0].friction", "less than 0"),
        (with_body(elasticity=1.5), "bodies[0].elasticity", "between 0 and 1"),
        (with_body(color="red"), "bodies[0].color", "not a color"),
        (with_body(shape={"type": "circle", "radius": 0}), "bodies[0].shape.radius", "not greater than 0"),
        (
            with_body(shape={"type": "rectangle", "size": [1, -1]}),
            "bodies[0].shape.size[1]",
            "not greater than 0",
        ),
        (with_body(shape={"type": "star"}), "bodies[0].shape.type", "star"),
        (polygon((0, 0), (1, 0)), "bodies[0].shape.vertices", "at least 3"),
        (polygon((0, 0), (1, 0), (1, 0), (0, 1)), "bodies[0].shape.vertices[2]", "same point"),
        (polygon((0, 0), (1, 1), (1, 0), (0, 1)), "bodies[0].shape.vertices", "crosses"),
        (polygon((0, 0), (1, 0), (2, 0)), "bodies[0].shape.vertices", "crosses"),
        (polygon((0, 0), (4, 0), (4, 3), (2, 0), (0, 3)), "bodies[0].shape.vertices", "crosses"),
        (polygon((0, 0), (1, math.nan), (1, 1)), "bodies[0].shape.vertices[1][1]", "not a finite"),
        (
            scene(joints=[{"type": "pivot", "bodies": ["ball", "rod"], "position": [0, 0]}]),
            "joints[0].bodies[1]",
            "rod",
        ),
        (
            scene(joints=[{"type": "weld", "bodies": ["ball", None], "position": [0, 0]}]),
            "joints[0].type",
            "weld",
        ),
        (
            scene(joints=[{"type": "pivot", "bodies": ["ball", "ball"], "position": [0, 0]}]),
            "joints[0].bodies",
            "both",
        ),
        (
            scene(joints=[{"type": "pivot", "bodies": [None, None], "position": [0, 0]}]),
            "joints[0].bodies",
            "both",
        ),
        (scene(view={"pixels_per_metre": 0}), "view.pixels_per_metre", "not greater than 0"),
        (scene(format="other"), "format", "other"),
        (scene(version=2), "version", "2"),
        ([1], "", "a scene is a JSON object"),
    ],
)
def test_refused_with_the_place(bad, path, says):
    with pytest.raises(InputError) as e:
        Scene.from_dict(bad)
    assert e.value.path == path
    assert says in e.value.problem + " " + e.value.hint
    assert "\n" not in str(e.value)


@pytest.mark.parametrize("text", ["", "   ", "{", "[1,", "\x00", '{"bodies": [}', "[" * 100_000])
def test_not_json(text):
    with pytest.raises(InputError):
        Scene.from_json(text)
    with pytest.raises(InputError):
        Scene.from_json(text.encode())


def test_where_the_json_breaks():
    with pytest.raises(InputError) as e:
        parse_json('{"a": 1,\n "b": oops}')
    assert e.value.path == "line 2 column 7"


def test_too_much_json():
    with pytest.raises(InputError, match="at most"):
        parse_json(b" " * 2000, max_bytes=1000)


def test_unknown_keys_survive():
    d = scene(author="me", tags=[1, {"x": None}])
    d["bodies"][0]["note"] = {"deep": [1, 2]}
    d["joints"] = [{"type": "pivot", "bodies": ["ball", None], "position": [0, 1], "why": "hinge"}]
    d["view"] = {"pixels_per_metre": 50, "theme": "dark"}
    back = json.loads(Scene.from_dict(d).to_json())
    assert back["author"] == "me"
    assert back["tags"] == [1, {"x": None}]
    assert back["bodies"][0]["note"] == {"deep": [1, 2]}
    assert back["joints"][0]["why"] == "hinge"
    assert back["view"]["theme"] == "dark"
    assert json.loads(Scene.from_dict(back).to_json()) == back


def test_save_and_load(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text("old")
    original = Scene.from_dict(scene(notes=["seen"]))
    original.save(path)
    assert Scene.load(path) == original
    assert [p.name for p in tmp_path.iterdir()] == ["scene.json"]  # nothing left beside it


@pytest.mark.skipif(os.name != "posix", reason="the permissions of POSIX")
def test_a_saved_scene_is_as_readable_as_any_file(tmp_path):
    other, path = tmp_path / "other", tmp_path / "scene.json"
    other.write_text("")
    Scene().save(path)
    assert path.stat().st_mode == other.stat().st_mode
    path.chmod(0o640)
    Scene().save(path)
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_scene_that_cannot_be_saved_names_the_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere.scene\.json'$"):
        Scene().save(tmp_path / "nowhere" / "scene.json")


numbers = st.floats(-100, 100)
bodies = st.builds(
    lambda shape, position, angle, velocity, anchored, mass: {
        "shape": shape,
        "position": position,
        "angle": angle,
        "velocity": velocity,
        "anchored": anchored,
        **({} if mass is None else {"mass": mass}),
    },
    st.one_of(
        st.builds(lambda r: {"type": "circle", "radius": r}, st.floats(1e-3, 1e3)),
        st.builds(
            lambda w, h: {"type": "rectangle", "size": [w, h]}, st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)
        ),
    ),
    st.tuples(numbers, numbers).map(list),
    numbers,
    st.tuples(numbers, numbers).map(list),
    st.booleans(),
    st.none() | st.floats(1e-3, 1e6),
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(bodies, max_size=5))
def test_round_trip(made):
    d = {"bodies": [{"id": f"b{i}", **b} for i, b in enumerate(made)], "gravity": [0, -1.5]}
    loaded = Scene.from_dict(d)
    assert Scene.from_json(loaded.to_json()) == loaded
    for body, given_ in zip(loaded.to_dict()["bodies"], d["bodies"], strict=True):
        assert {k: body[k] for k in given_} == given_


# ---------------------------------------------------------------- mass properties


def test_mass_and_moment_of_simple_shapes():
    assert Body(id="a", shape=Circle(2.0), position=(0, 0), density=3.0).mass_properties() == pytest.approx(
        (12 * math.pi, 24 * math.pi)
    )
    assert Body(id="a", shape=Rectangle((2.0, 3.0)), position=(0, 0)).mass_properties() == pytest.approx(
        (6, 6.5)
    )
    right = Body(id="a", shape=Polygon([(0, 0), (3, 0), (0, 3)]), position=(0, 0))  # I = m (a^2 + b^2) / 18
    assert right.mass_properties() == pytest.approx((4.5, 4.5))


def test_a_given_mass_scales_the_moment_and_a_given_moment_stands():
    box = Body(id="a", shape=Rectangle((2.0, 3.0)), position=(0, 0), mass=60.0)
    assert box.mass_properties() == pytest.approx((60, 65))
    assert Body(id="a", shape=Rectangle((2.0, 3.0)), position=(0, 0), moment=2.0).mass_properties() == (6, 2)


def star(rng):
    n = rng.randrange(3, 15)
    radii = [rng.uniform(0.3, 1) for _ in range(n)]
    return [
        (r * math.cos(2 * math.pi * k / n), r * math.sin(2 * math.pi * k / n)) for k, r in enumerate(radii)
    ]


@pytest.mark.parametrize("seed", range(5))
def test_polygon_properties_add_up(seed):
    """Area and moments of a polygon are those of its convex pieces, by the parallel-axis theorem."""
    from sim.reference import convex_pieces

    v = star(random.Random(seed))
    area, (cx, cy), second = area_properties(Polygon(v))
    parts = [area_properties(Polygon(piece)) for piece in convex_pieces(v)]
    assert sum(p[0] for p in parts) == pytest.approx(area)
    assert sum(p[0] * p[1][0] for p in parts) == pytest.approx(area * cx, abs=1e-12)
    assert sum(p[0] * p[1][1] for p in parts) == pytest.approx(area * cy, abs=1e-12)
    about = sum(p[2] + p[0] * ((p[1][0] - cx) ** 2 + (p[1][1] - cy) ** 2) for p in parts)
    assert about == pytest.approx(second)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(0, 6.28), st.booleans())
def test_properties_do_not_depend_on_the_frame(seed, x, y, angle, backwards):
    v = star(random.Random(seed))
    area, (cx, cy), second = area_properties(Polygon(v))
    c, s = math.cos(angle), math.sin(angle)
    moved = [(x + c * p[0] - s * p[1], y + s * p[0] + c * p[1]) for p in v]
    area2, (cx2, cy2), second2 = area_properties(Polygon(moved[::-1] if backwards else moved))
    assert area2 == pytest.approx(area, rel=1e-9)
    assert (cx2, cy2) == pytest.approx((x + c * cx - s * cy, y + s * cx + c * cy), abs=1e-8)
    assert second2 == pytest.approx(second, rel=1e-8)


def test_a_polygon_off_its_centroid_is_centred_and_stays_where_it_is():
    d = polygon((1, 1), (3, 1), (3, 2), (1, 2))
    d["bodies"][0] |= {"position": [10, 0], "angle": math.pi / 2}
    body = Scene.from_dict(d).bodies[0]
    assert body.position == pytest.approx((8.5, 2))
    assert body.outline() == [pytest.approx(p) for p in [(9, 1), (9, 3), (8, 3), (8, 1)]]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"position": (0.0, 1.0, 2.0)}, r"bodies\[0\].position: .* is not two numbers"),
        ({"velocity": 3.0}, r"bodies\[0\].velocity: 3.0 is not two numbers"),
        ({"angle": "0"}, r"bodies\[0\].angle: '0' is not a number"),
        ({"shape": Circle("1")}, r"bodies\[0\].shape.radius: '1' is not a number"),  # type: ignore[arg-type]
        ({"shape": Rectangle(1.0)}, r"bodies\[0\].shape.size: 1.0 is not two numbers"),  # type: ignore[arg-type]
        ({"shape": None}, r"bodies\[0\].shape: None is not a Circle, a Rectangle or a Polygon"),
    ],
)
def test_values_of_another_kind_are_refused_with_the_place(wrong, says):
    body = Body(**{"id": "a", "shape": Circle(1.0), "position": (0.0, 0.0)} | wrong)
    with pytest.raises(InputError, match=says):
        Scene(bodies=[body]).check()


def test_a_large_polygon_is_checked_in_time():
    n = 10_000
    round_ = [[math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)] for k in range(n)]
    began = time.process_time()
    Scene.from_dict(polygon(*round_))
    assert time.process_time() - began < 5
    with pytest.raises(InputError, match="at most"):
        Scene.from_dict(polygon(*round_, [2.0, -0.1]))
