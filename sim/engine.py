"""simulate(): the impulse engine of core/ through ctypes, one call for a whole run."""

from __future__ import annotations

import ctypes
import functools
import math
import struct
import sys
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any, overload

import numpy as np

from sim.scene import Circle, InputError, Scene
from sim.trajectory import Event, Trajectory

__all__ = ["simulate"]

ABI = 3
MAX_SAMPLES = 10_000_000
MAX_VALUES = 500_000_000  # 4 GB of samples
DEFAULT_TOLERANCE = 1e-4

_EVENT_KINDS = ("impact", "contact begun", "contact ended", "rest")
_PROFILE = (
    "total_time",
    "separate_time",
    "search_time",
    "impact_time",
    "smooth_time",
    "crowd_time",
    "flights",
    "events",
    "impacts",
    "smooth_steps",
    "smooth_evals",
    "crowd_steps",
    "crowd_contacts",
    "pairs",
    "rows",
    "rests",
    "separated",
    "separation",
    "let_overlap",
    "budget_spent",
)

_BODY_DOUBLES = 11  # of SimBody
_EVENT = struct.Struct("=d4i4d")  # SimEvent


class _Input(ctypes.Structure):
    _fields_ = [
        ("body_count", ctypes.c_int32),
        ("joint_count", ctypes.c_int32),
        ("bodies", ctypes.c_void_p),
        ("vertex_start", ctypes.c_void_p),
        ("anchored", ctypes.c_void_p),
        ("vertices", ctypes.c_void_p),
        ("joint_bodies", ctypes.c_void_p),
        ("joint_points", ctypes.c_void_p),
        ("gravity", ctypes.c_double * 2),
    ]


class _Options(ctypes.Structure):
    _fields_ = [("fps", ctypes.c_double), ("sample_count", ctypes.c_int64), ("tolerance", ctypes.c_double)]


class _Profile(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in _PROFILE]


@functools.cache
def load_core() -> ctypes.CDLL:
    """The engine's library, loaded once; raises ImportError where there is none, or one of another version."""
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    path = Path(__file__).with_name("_core" + suffix)
    try:
        core = ctypes.CDLL(str(path))
    except OSError as e:
        raise ImportError(f"the engine's library does not load ({e}); install the project again") from None
    core.sim_struct_size.restype = ctypes.c_size_t
    core.sim_create.restype = ctypes.c_void_p
    core.sim_error.restype = ctypes.c_char_p
    core.sim_event_count.restype = ctypes.c_int64
    core.sim_create.argtypes = [ctypes.c_void_p]
    core.sim_run.argtypes = [ctypes.c_void_p] * 4
    core.sim_events.argtypes = core.sim_profile.argtypes = [ctypes.c_void_p] * 2
    core.sim_error.argtypes = core.sim_event_count.argtypes = core.sim_destroy.argtypes = [ctypes.c_void_p]
    size = ctypes.sizeof
    sizes = (8 * _BODY_DOUBLES, size(_Input), size(_Options), _EVENT.size, size(_Profile))
    found = tuple(core.sim_struct_size(k) for k in range(len(sizes)))
    if core.sim_abi() != ABI or found != sizes:
        raise ImportError(f"{path.name} does not belong to this version; install the project again")
    return core


def simulate(
    scene: Scene,
    duration: float = 10.0,
    fps: float = 60.0,
    tolerance: float | None = None,
    engine: str = "impulse",
) -> Trajectory:
    """Run a scene and sample it at 0, 1/fps, 2/fps, ... up to duration.

    Args:
        scene: what to run; it is not changed.
        duration: [s], >= 0.
        fps: samples a second, > 0.
        tolerance: the error in position to keep to [m]; 1e-4 without it.
        engine: "impulse" for this project's own, "pymunk" for the reference.

    Raises:
        InputError: for a scene that fails its checks, or an argument out of range.
        RuntimeError: when the run fails (numbers beyond the range of doubles, no memory).
    """
    if not isinstance(scene, Scene):
        raise TypeError(
            f"a Scene is run, not a {type(scene).__name__}; Scene.load and Scene.from_dict make one"
        )
    scene.check()
    samples = _sample_count(duration, fps, len(scene.bodies))
    if tolerance is None:
        tolerance = DEFAULT_TOLERANCE
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise InputError("tolerance", f"{tolerance} is not a length greater than 0")
    if engine == "pymunk":
        from sim.reference import run_pymunk

        return run_pymunk(scene, duration, fps)
    if engine != "impulse":
        raise InputError("engine", f"{engine!r} is neither 'impulse' nor 'pymunk'")
    return _run(load_core(), scene, samples, fps, tolerance)


def _sample_count(duration: float, fps: float, bodies: int) -> int:
    if not (math.isfinite(duration) and duration >= 0):
        raise InputError("duration", f"{duration} is not a time of 0 or more")
    if not (math.isfinite(fps) and fps > 0):
        raise InputError("fps", f"{fps} is not a number greater than 0")
    count = duration * fps
    if count > MAX_SAMPLES or count * max(bodies, 1) * 6 > MAX_VALUES:
        raise InputError(
            "duration", f"{count:.0f} samples of {bodies} bodies are too many", "take fewer fps", kind="size"
        )
    return math.floor(count * (1 + 1e-12) + 1e-9) + 1


def _pack(scene: Scene) -> tuple[_Input, list[array[Any]]]:
    """The scene as the core's flat arrays, and what must stay alive while they are used."""
    index_of: dict[str | None, int] = {body.id: i for i, body in enumerate(scene.bodies)}
    index_of[None] = -1
    bodies, vertices, points = array("d"), array("d"), array("d")
    start, anchored, pairs = array("i", [0]), array("i"), array("i")
    for b in scene.bodies:
        shape = b.shape
        if isinstance(shape, Circle):
            radius = shape.radius
        else:
            radius = 0.0
            for v in shape.vertices:
                vertices.extend(v)
        velocity, spin = ((0.0, 0.0), 0.0) if b.anchored else (b.velocity, b.angular_velocity)
        bodies.extend(
            (*b.position, b.angle, *velocity, spin, *b.mass_properties(), b.friction, b.elasticity, radius)
        )
        start.append(len(vertices) // 2)
        anchored.append(b.anchored)
    for j in scene.joints:
        pairs.extend((index_of[j.bodies[0]], index_of[j.bodies[1]]))
        points.extend(j.position)
    parts: list[array[Any]] = [bodies, start, anchored, vertices, pairs, points]
    addresses = [part.buffer_info()[0] for part in parts]
    packed = _Input(len(scene.bodies), len(scene.joints), *addresses, (ctypes.c_double * 2)(*scene.gravity))
    return packed, parts


def _run(core: ctypes.CDLL, scene: Scene, samples: int, fps: float, tolerance: float) -> Trajectory:
    packed, parts = _pack(scene)
    n = len(scene.bodies)
    frames = np.empty((samples, n, 6))
    energy = np.empty((samples, 3))
    sim = core.sim_create(ctypes.byref(packed))
    del parts
    if not sim:
        raise RuntimeError("out of memory")
    try:
        options = _Options(fps, samples, tolerance)
        if core.sim_run(sim, ctypes.byref(options), frames.ctypes.data, energy.ctypes.data) != 0:
            raise RuntimeError(core.sim_error(sim).decode())
        ids = [body.id for body in scene.bodies]
        events = _events(core, sim, ids)
        profile = _Profile()
        core.sim_profile(sim, ctypes.byref(profile))
    finally:
        core.sim_destroy(sim)
    return Trajectory(
        times=np.arange(samples) / fps,
        positions=frames[:, :, 0:2],
        angles=frames[:, :, 2],
        velocities=frames[:, :, 3:5],
        angular_velocities=frames[:, :, 5],
        body_ids=ids,
        energy=energy,
        events=events,
        profile={name: getattr(profile, name) for name in _PROFILE},
    )


class _Events(Sequence[Event]):
    """A run's events, made from the core's records when they are first looked at: a pile has thousands."""

    def __init__(self, raw: bytes, ids: list[str]) -> None:
        self._raw, self._ids = raw, ids
        self._made: list[Event] | None = None

    def _all(self) -> list[Event]:
        if self._made is None:
            name: list[str | None] = [*self._ids, None]  # index -1: none
            self._made = [
                Event(time, _EVENT_KINDS[kind], (self._ids[a], name[b]), (x, y), (jx, jy))
                for time, kind, a, b, _, x, y, jx, jy in _EVENT.iter_unpack(self._raw)
            ]
        return self._made

    def __len__(self) -> int:
        return len(self._raw) // _EVENT.size

    @overload
    def __getitem__(self, index: int) -> Event: ...
    @overload
    def __getitem__(self, index: slice) -> list[Event]: ...
    def __getitem__(self, index: int | slice) -> Event | list[Event]:
        return self._all()[index]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self._all() == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self._all())


def _events(core: ctypes.CDLL, sim: int, ids: list[str]) -> _Events:
    raw = ctypes.create_string_buffer(_EVENT.size * core.sim_event_count(sim))
    core.sim_events(sim, raw)
    return _Events(raw.raw, ids)
