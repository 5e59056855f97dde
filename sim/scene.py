"""The scene: bodies, joints and gravity in SI units, y up; its checks, its JSON, its mass properties."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any, TypeAlias

import msgspec

from sim.json_input import InputError, check_format, convert, kind_of_value, parse_json

__all__ = [
    "Body",
    "Circle",
    "InputError",
    "Joint",
    "Polygon",
    "Rectangle",
    "Scene",
    "View",
    "check_format",
    "parse_json",
]

Vector: TypeAlias = tuple[float, float]

_KEPT = "(kept)"  # the encoded name of `extra`: no key of a file is meant by it
LARGEST = 1e9  # of coordinates, lengths, speeds: beyond it doubles have no micrometres left
SMALLEST = 1e-9  # of lengths [m]
MOST_MASS = 1e30  # of masses, moments and densities, and 1 over it the least
MAX_VERTICES = 10_000  # of one polygon: the check for crossing sides is quadratic at worst


class Circle(msgspec.Struct, tag="circle", frozen=True):
    """A disk about the body's position. radius: [m], > 0."""

    radius: float


class Rectangle(msgspec.Struct, tag="rectangle", frozen=True):
    """A rectangle about the body's position. size: width and height before turning [m], each > 0."""

    size: Vector

    @property
    def vertices(self) -> list[Vector]:
        w, h = self.size[0] / 2, self.size[1] / 2
        return [(-w, -h), (w, -h), (w, h), (-w, h)]


class Polygon(msgspec.Struct, tag="polygon", frozen=True):
    """A simple polygon, convex or concave.

    vertices: about the body's position [m], either way round. The position is the centre of mass: what is
    loaded is moved to its centroid, what is made in Python has its mass where the position is.
    """

    vertices: list[Vector]


Shape: TypeAlias = Circle | Rectangle | Polygon


class Body(msgspec.Struct, kw_only=True):
    """A rigid body.

    Attributes:
        id: name, unique in its scene.
        shape: outline about the centre of mass.
        position: centre of mass [m].
        angle: counter-clockwise [rad].
        velocity: [m/s].  angular_velocity: [rad/s].
        anchored: fixed to the background; its velocity is ignored.
        density: [kg/m²]; used for what `mass` and `moment` leave open.
        mass: [kg] or None.  moment: about the centre of mass [kg m²] or None.
        friction: Coulomb's coefficient; a touching pair has √(μa μb).
        elasticity: coefficient of restitution, 0 to 1; a touching pair has max(ea, eb).
        color: "#rrggbb", or None for one from the palette.
        strokes: strokes of the sketch that drew it.  score: the reading's probability, 0 to 1.
        extra: keys that are not this program's; kept through load and save.
    """

    id: str
    shape: Shape
    position: Vector
    angle: float = 0.0
    velocity: Vector = (0.0, 0.0)
    angular_velocity: float = 0.0
    anchored: bool = False
    density: float = 1.0
    mass: float | None = None
    moment: float | None = None
    friction: float = 0.5
    elasticity: float = 0.3
    color: str | None = None
    strokes: list[int] | None = None
    score: float | None = None
    extra: dict[str, Any] = msgspec.field(default_factory=dict, name=_KEPT)

    def mass_properties(self) -> tuple[float, float]:
        """Mass [kg] and moment about the centre of mass [kg m²], as if the body were not anchored.

        An outline of uniform density unless `mass` or `moment` say otherwise; a given mass alone
        scales the moment with it.
        """
        if self.mass is not None and self.moment is not None:
            return self.mass, self.moment
        area, _, second = area_properties(self.shape)
        mass = self.density * area if self.mass is None else self.mass
        moment = mass * second / area if self.moment is None else self.moment
        return mass, moment

    def outline(self) -> list[Vector]:
        """The vertices in the scene's frame [m]; a circle as a polygon of 64 sides."""
        if isinstance(self.shape, Circle):
            r = self.shape.radius
            local = [(r * math.cos(k * math.pi / 32), r * math.sin(k * math.pi / 32)) for k in range(64)]
        else:
            local = list(self.shape.vertices)
        c, s = math.cos(self.angle), math.sin(self.angle)
        return [(self.position[0] + c * x - s * y, self.position[1] + s * x + c * y) for x, y in local]


class Joint(msgspec.Struct, kw_only=True):
    """A pivot: the point `position` [m] of the two bodies stays together and they turn about it.

    bodies: two ids; None is the background.  Two pivots on one pair hold it rigidly (a pin).
    """

    bodies: tuple[str | None, str | None]
    position: Vector
    type: str = "pivot"
    extra: dict[str, Any] = msgspec.field(default_factory=dict, name=_KEPT)


class View(msgspec.Struct, kw_only=True):
    """How the scene lies on the page [pixels]: (px, py), y down, is (px, -py) / pixels_per_metre."""

    pixels_per_metre: float = 100.0
    width: float | None = None
    height: float | None = None
    extra: dict[str, Any] = msgspec.field(default_factory=dict, name=_KEPT)


class Scene(msgspec.Struct, kw_only=True):
    """What `sim` runs. See the README's scene JSON for the format that load and save speak.

    gravity: [m/s²], y up.
    """

    bodies: list[Body] = []
    joints: list[Joint] = []
    gravity: Vector = (0.0, 0.0)
    view: View | None = None
    notes: list[str] = []
    extra: dict[str, Any] = msgspec.field(default_factory=dict, name=_KEPT)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Read scene JSON. Raises InputError for what is not a scene, OSError for what cannot be read."""
        return cls.from_json(Path(path).read_bytes())

    @classmethod
    def from_json(cls, data: bytes | str) -> Scene:
        return cls.from_dict(parse_json(data))

    @classmethod
    def from_dict(cls, d: Any) -> Scene:
        """Build and check a scene from scene JSON's objects. Raises InputError that names the bad element."""
        if not isinstance(d, dict):
            raise InputError("", f"a scene is a JSON object, not {kind_of_value(d)}")
        check_format(d, "sketchsim-scene")
        if "bodies" not in d:
            raise InputError(
                "bodies", "missing", "a scene has a list of bodies, each with id, shape and position"
            )
        scene = convert(d, cls)
        _keep_unknown_keys(scene, d)
        scene.check()
        for body in scene.bodies:
            _centre(body)
        return scene

    def to_dict(self) -> dict[str, Any]:
        """Scene JSON's objects: plain dicts, lists, numbers and strings."""
        out: dict[str, Any] = {"format": "sketchsim-scene", "version": 1, "gravity": list(self.gravity)}
        out["bodies"] = [_plain(b) for b in self.bodies]
        out["joints"] = [_plain(j) for j in self.joints]
        if self.view is not None:
            out["view"] = _plain(self.view)
        out["notes"] = list(self.notes)
        return out | self.extra

    def to_json(self) -> bytes:
        return msgspec.json.format(msgspec.json.encode(self.to_dict()), indent=1) + b"\n"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write scene JSON; an existing file is replaced only once the new one is whole."""
        target = Path(path).resolve()
        beside = target.with_name(f".{target.name}.{os.urandom(6).hex()}")
        try:
            beside.write_bytes(self.to_json())
            if target.exists():
                beside.chmod(target.stat().st_mode & 0o777)
            os.replace(beside, target)
        except BaseException as e:
            if isinstance(e, OSError):
                e.filename = os.fspath(path)  # what was asked for, not what is written beside it
            beside.unlink(missing_ok=True)
            raise

    def check(self) -> None:
        """Raise InputError at the first value that no physical scene can have."""
        _vector(self.gravity, "gravity")
        seen: dict[str, int] = {}
        for i, body in enumerate(self.bodies):
            if body.id in seen:
                raise InputError(
                    f"bodies[{i}].id",
                    f"{body.id!r} is the id of bodies[{seen[body.id]}] too",
                    "ids are unique",
                )
            seen[body.id] = i
            _check_body(body, i)
        for i, joint in enumerate(self.joints):
            _check_joint(joint, seen, f"joints[{i}]")
        if self.view is not None:
            _positive(self.view.pixels_per_metre, "view.pixels_per_metre")


# ---------------------------------------------------------------- mass properties


def area_properties(shape: Shape) -> tuple[float, Vector, float]:
    """Area [m²], centroid [m] and second moment of area about the centroid [m⁴].

    Polygon: Green's theorem on the fan of triangles about the first vertex, which keeps the digits of a
    polygon far from its origin (see any text on the shoelace formula).
    """
    if isinstance(shape, Circle):
        area = math.pi * shape.radius**2
        return area, (0.0, 0.0), area * shape.radius**2 / 2
    if isinstance(shape, Rectangle):
        w, h = shape.size
        return w * h, (0.0, 0.0), w * h * (w * w + h * h) / 12
    x0, y0 = shape.vertices[0]
    twice = mx = my = polar = 0.0
    for (ax, ay), (bx, by) in zip(shape.vertices, [*shape.vertices[1:], shape.vertices[0]], strict=True):
        ax, ay, bx, by = ax - x0, ay - y0, bx - x0, by - y0
        cross = ax * by - ay * bx
        twice += cross
        mx += cross * (ax + bx)
        my += cross * (ay + by)
        polar += cross * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by)
    if twice == 0.0:
        return 0.0, (x0, y0), 0.0
    area, cx, cy = twice / 2, mx / (3 * twice), my / (3 * twice)
    second = polar / 12 - area * (cx * cx + cy * cy)
    return abs(area), (x0 + cx, y0 + cy), abs(second)


def _centre(body: Body) -> None:
    """Move a polygon's origin to its centroid where the file has it elsewhere; the outline stays where it is.

    An offset within a thousandth of the size is the rounding of printed vertices and is left alone.
    """
    if not isinstance(body.shape, Polygon):
        return
    _, (cx, cy), _ = area_properties(body.shape)
    size = max(math.hypot(x - cx, y - cy) for x, y in body.shape.vertices)
    if math.hypot(cx, cy) <= 1e-3 * size:
        return
    c, s = math.cos(body.angle), math.sin(body.angle)
    body.shape = Polygon([(x - cx, y - cy) for x, y in body.shape.vertices])
    body.position = (body.position[0] + c * cx - s * cy, body.position[1] + s * cx + c * cy)


# ---------------------------------------------------------------- checks


# Paths are templates, filled in only for an error: a scene is checked on every run.


def _number(value: float, path: str, index: int = 0, most: float = LARGEST) -> None:
    try:
        if -most <= value <= most:
            return
    except TypeError:
        raise InputError(_fill(path, index), f"{value!r} is not a number") from None
    path = _fill(path, index)
    if not math.isfinite(value):
        raise InputError(path, f"{value} is not a finite number")
    raise InputError(path, f"{value:g} is beyond {most:g}", "units are metres, seconds and kilograms")


def _vector(values: Vector, path: str, index: int = 0) -> None:
    try:
        x, y = values
        if -LARGEST <= x <= LARGEST and -LARGEST <= y <= LARGEST:
            return
    except (TypeError, ValueError):
        raise InputError(_fill(path, index), f"{values!r} is not two numbers") from None
    for k, v in enumerate(values):
        _number(v, f"{_fill(path, index)}[{k}]")


def _positive(value: float, path: str, index: int = 0, least: float = 0.0, most: float = LARGEST) -> None:
    _number(value, path, index, most)
    if value <= 0:
        raise InputError(_fill(path, index), f"{value:g} is not greater than 0")
    if value < least:
        raise InputError(
            _fill(path, index), f"{value:g} is below {least:g}", "units are metres, seconds and kilograms"
        )


def _fill(path: str, index: int) -> str:
    return path % index if "%" in path else path


def _check_body(body: Body, i: int) -> None:
    _vector(body.position, "bodies[%d].position", i)
    _vector(body.velocity, "bodies[%d].velocity", i)
    _number(body.angle, "bodies[%d].angle", i)
    _number(body.angular_velocity, "bodies[%d].angular_velocity", i)
    _positive(body.density, "bodies[%d].density", i, 1 / MOST_MASS, MOST_MASS)
    try:
        if body.mass is not None:
            _positive(body.mass, "bodies[%d].mass", i, 1 / MOST_MASS, MOST_MASS)
        if body.moment is not None:
            _positive(body.moment, "bodies[%d].moment", i, 1 / MOST_MASS, MOST_MASS)
    except InputError as e:
        e.hint = 'a body that must not move has "anchored": true'
        raise
    _number(body.friction, "bodies[%d].friction", i)
    if body.friction < 0:
        raise InputError(f"bodies[{i}].friction", f"{body.friction:g} is less than 0")
    _number(body.elasticity, "bodies[%d].elasticity", i)
    if not 0 <= body.elasticity <= 1:
        raise InputError(f"bodies[{i}].elasticity", f"{body.elasticity:g} is not between 0 and 1")
    if body.color is not None and not _is_color(body.color):
        raise InputError(f"bodies[{i}].color", f"{body.color!r} is not a color", 'write it as "#4477aa"')
    if isinstance(body.shape, Circle):
        _positive(body.shape.radius, "bodies[%d].shape.radius", i, SMALLEST)
    elif isinstance(body.shape, Rectangle):
        _vector(body.shape.size, "bodies[%d].shape.size", i)
        _positive(body.shape.size[0], "bodies[%d].shape.size[0]", i, SMALLEST)
        _positive(body.shape.size[1], "bodies[%d].shape.size[1]", i, SMALLEST)
    elif isinstance(body.shape, Polygon):
        _check_vertices(body.shape, f"bodies[{i}].shape.vertices")
    else:
        raise InputError(f"bodies[{i}].shape", f"{body.shape!r} is not a Circle, a Rectangle or a Polygon")


def _is_color(text: str) -> bool:
    return len(text) == 7 and text[0] == "#" and all(c in "0123456789abcdefABCDEF" for c in text[1:])


def _check_vertices(shape: Polygon, path: str) -> None:
    v = shape.vertices
    if len(v) < 3:
        raise InputError(path, f"a polygon has at least 3 vertices, not {len(v)}")
    if len(v) > MAX_VERTICES:
        raise InputError(path, f"{len(v)} vertices; at most {MAX_VERTICES} are taken", kind="size")
    for k, p in enumerate(v):
        _vector(p, f"{path}[{k}]")
        if p == v[k - 1]:
            raise InputError(f"{path}[{k}]", "the same point as the vertex before it")
    crossing = _first_crossing(v)
    if crossing is not None:
        i, j = crossing
        raise InputError(
            path,
            f"the side from vertex {i} crosses the side from vertex {j}",
            "the sides of a polygon meet only at its vertices",
        )
    area, _, _ = area_properties(shape)
    reach = max(abs(c) for p in v for c in (p[0] - v[0][0], p[1] - v[0][1]))
    if area <= 1e-12 * reach * reach or reach < SMALLEST:
        raise InputError(path, "the polygon has no area")


def _first_crossing(v: list[Vector]) -> tuple[int, int] | None:
    """The first two sides that meet elsewhere than at a shared vertex, or None for a simple polygon.

    Sides are swept in the order of their least x, so that only sides whose spans in x overlap are compared.
    """
    n = len(v)
    order = sorted(range(n), key=lambda i: min(v[i][0], v[(i + 1) % n][0]))
    active: list[int] = []
    for i in order:
        a, b = v[i], v[(i + 1) % n]
        left = min(a[0], b[0])
        active = [j for j in active if max(v[j][0], v[(j + 1) % n][0]) >= left]
        for j in active:
            c, d = v[j], v[(j + 1) % n]
            if (i + 1) % n == j or (j + 1) % n == i:
                # neighbours share one vertex: they may only not fold back over each other
                shared, p, q = (b, a, d) if (i + 1) % n == j else (a, b, c)
                if _turn(p, shared, q) == 0 and _ahead(p, shared, q):
                    return min(i, j), max(i, j)
            elif _meet(a, b, c, d):
                return min(i, j), max(i, j)
        active.append(i)
    return None


def _turn(a: Vector, b: Vector, c: Vector) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _ahead(p: Vector, shared: Vector, q: Vector) -> bool:
    """Whether p and q, on one line with `shared`, lie on the same side of it."""
    return (p[0] - shared[0]) * (q[0] - shared[0]) + (p[1] - shared[1]) * (q[1] - shared[1]) > 0


def _meet(a: Vector, b: Vector, c: Vector, d: Vector) -> bool:
    """Whether the closed segments ab and cd have a point in common."""
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    u, v, w, x = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if ((u > 0) != (v > 0) or u == 0 or v == 0) and ((w > 0) != (x > 0) or w == 0 or x == 0):
        if u == v == w == x == 0:  # on one line: do the spans overlap?
            return max(min(a[0], b[0]), min(c[0], d[0])) <= min(max(a[0], b[0]), max(c[0], d[0]))
        return u * v <= 0 and w * x <= 0
    return False


def _check_joint(joint: Joint, ids: dict[str, int], path: str) -> None:
    if joint.type != "pivot":
        raise InputError(f"{path}.type", f"{joint.type!r} is not a kind of joint", 'the only kind is "pivot"')
    _vector(joint.position, f"{path}.position")
    a, b = joint.bodies
    for k, name in enumerate((a, b)):
        if name is not None and name not in ids:
            raise InputError(
                f"{path}.bodies[{k}]",
                f"there is no body {name!r}",
                "a joint names two bodies; null is the background",
            )
    if a == b:
        raise InputError(
            f"{path}.bodies",
            f"both are {json.dumps(a)}",
            "a joint names two different bodies; null is the background",
        )


# ---------------------------------------------------------------- JSON


_HEADER = {"format", "version"}


def _keep_unknown_keys(scene: Scene, d: dict[str, Any]) -> None:
    scene.extra = _unknown(Scene, d)
    for body, raw in zip(scene.bodies, d["bodies"], strict=True):
        body.extra = _unknown(Body, raw)
    for joint, raw in zip(scene.joints, d.get("joints", []), strict=True):
        joint.extra = _unknown(Joint, raw)
    if scene.view is not None:
        scene.view.extra = _unknown(View, d["view"])


def _unknown(cls: type[msgspec.Struct], raw: dict[str, Any]) -> dict[str, Any]:
    known = set(cls.__struct_encode_fields__) | _HEADER
    return {k: v for k, v in raw.items() if k not in known}


def _plain(part: msgspec.Struct) -> dict[str, Any]:
    """A struct as JSON's objects, without what was left open, with the keys that were not ours at the end."""
    # through JSON: tuples become lists, and numpy's numbers plain ones
    out: dict[str, Any] = msgspec.json.decode(msgspec.json.encode(part, enc_hook=lambda v: v.tolist()))
    extra: dict[str, Any] = out.pop(_KEPT)
    return {k: v for k, v in out.items() if v is not None} | extra
