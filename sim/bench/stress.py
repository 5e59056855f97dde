"""The stress suite: hard scenes through this engine and through pymunk, side by side.

>>> from sim.bench.stress import main
>>> main(["--only", "stack of 10"])  # doctest: +SKIP
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.bench.stress_scenes import Case, cases, random_cases
from sim.engine import simulate
from sim.reference import convex_pieces, run_pymunk
from sim.scene import Body, Circle, Scene
from sim.trajectory import Trajectory

__all__ = ["Measured", "main", "measure", "table"]

Array: TypeAlias = NDArray[np.float64]
FPS = 30.0
LOOKS = 25  # samples in which depths are looked for


@dataclass(frozen=True)
class Measured:
    """What a run of a case came to.

    Attributes:
        growth: the most by which energy exceeded its start, as a share of the largest change or motion in it.
        momentum: the drift of the momentum of a free system, as a share of the sum of m |v|; nan for others.
        depth: the deepest overlap that was not there at the start [m].
        drift: the farthest that a joint came apart [m].
        speed: the fastest body at the end [m/s].
        finite: no NaN, no infinity.
        seconds: CPU of the whole call.
    """

    growth: float
    momentum: float
    depth: float
    drift: float
    speed: float
    finite: bool
    seconds: float


def measure(case: Case, run: Callable[[Scene, float, float], Trajectory]) -> Measured:
    """Run a case, sampled at FPS (an hour at one sample a second), and measure it."""
    fps = FPS if case.duration <= 60 else 1.0
    began = time.process_time()
    try:
        result = run(case.scene, case.duration, fps)
    except RuntimeError:
        return _failed(time.process_time() - began)
    seconds = time.process_time() - began
    if not (np.isfinite(result.positions).all() and np.isfinite(result.velocities).all()):
        return _failed(seconds)
    return Measured(
        growth=_growth(result),
        momentum=_momentum_drift(case.scene, result) if case.free else math.nan,
        depth=_new_depth(case.scene, result),
        drift=_joint_drift(case.scene, result),
        speed=float(np.hypot(*result.velocities[-1].T).max(initial=0.0)),
        finite=True,
        seconds=seconds,
    )


def _failed(seconds: float) -> Measured:
    nan = math.nan
    return Measured(nan, nan, nan, nan, nan, finite=False, seconds=seconds)


def _growth(run: Trajectory) -> float:
    kinetic, potential, total = run.energy.T
    scale = max(kinetic.max(), float(np.ptp(potential)), 1e-12)
    return float(max(0.0, (total - total[0]).max()) / scale)


def _momentum_drift(scene: Scene, run: Trajectory) -> float:
    mass = np.array([b.mass_properties()[0] for b in scene.bodies])
    p = np.einsum("b,tbk->tk", mass, run.velocities)
    scale = float((mass * np.hypot(*run.velocities[0].T)).sum())
    return float(np.abs(p - p[0]).max()) / max(scale, 1e-12)


def _joint_drift(scene: Scene, run: Trajectory) -> float:
    """How far the two points of a joint are from each other at worst; they start together."""
    index = {b.id: i for i, b in enumerate(scene.bodies)}
    worst = 0.0
    for joint in scene.joints:
        ends = []
        for name in joint.bodies:
            if name is None:
                ends.append(np.broadcast_to(np.array(joint.position), run.positions[:, 0].shape))
                continue
            i = index[name]
            b = scene.bodies[i]
            local = _turn(np.array(joint.position) - np.array(b.position), -b.angle)
            ends.append(run.positions[:, i] + _turn(local, run.angles[:, i]))
        worst = max(worst, float(np.hypot(*(ends[0] - ends[1]).T).max()))
    return worst


def _turn(v: Array, angle: float | Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * v[..., 0] - s * v[..., 1], s * v[..., 0] + c * v[..., 1]], axis=-1)


# ---------------------------------------------------------------- depth


Placed = tuple[Array, float]  # vertices and radius of a convex piece


def _new_depth(scene: Scene, run: Trajectory) -> float:
    """The deepest overlap of two bodies that collide and did not overlap at the start."""
    pieces = [_pieces(b) for b in scene.bodies]
    still = np.array([b.anchored for b in scene.bodies])
    index = {b.id: i for i, b in enumerate(scene.bodies)}
    joined = {frozenset(index[n] for n in j.bodies if n is not None) for j in scene.joints}
    skip: set[tuple[int, int]] = set()
    worst = 0.0
    for f in np.unique(np.linspace(0, len(run) - 1, min(LOOKS, len(run))).astype(int)):
        p, a = run.positions[f], run.angles[f]
        lies = [[(_turn(v, a[i]) + p[i], r) for v, r in its] for i, its in enumerate(pieces)]
        low = np.array([np.min([v.min(axis=0) - r for v, r in its], axis=0) for its in lies])
        high = np.array([np.max([v.max(axis=0) + r for v, r in its], axis=0) for its in lies])
        under = (low[:, None] < high).all(axis=2)
        near = under & under.T & ~(still[:, None] & still)  # others are apart
        for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True):
            if (i, j) in skip or frozenset((int(i), int(j))) in joined:
                continue
            depth = max(overlap(one, other) for one in lies[i] for other in lies[j])
            if f == 0 and depth > 1e-6:
                skip.add((int(i), int(j)))
            else:
                worst = max(worst, depth)
    return worst


def _pieces(body: Body) -> list[Placed]:
    shape = body.shape
    if isinstance(shape, Circle):
        return [(np.zeros((1, 2)), shape.radius)]
    return [(np.array(v), 0.0) for v in convex_pieces(shape.vertices)]


def overlap(a: Placed, b: Placed) -> float:
    """How far two convex pieces must be moved to part them [m]; negative when they are apart (separating axes)."""
    (u, r), (v, s) = a, b
    axes = [_normals(w) for w in (u, v) if len(w) > 1]
    for p, q in ((u, v), (v, u)):
        if len(p) == 1:
            d = q[np.argmin(((q - p[0]) ** 2).sum(1))] - p[0]
            length = np.hypot(*d)
            axes.append((d / length if length > 0 else np.array([1.0, 0.0]))[None])
    n = np.concatenate(axes)
    n = np.concatenate([n, -n])
    return float(((u @ n.T).max(0) + r - ((v @ n.T).min(0) - s)).min())


def _normals(v: Array) -> Array:
    e = np.roll(v, -1, 0) - v
    normals: Array = np.stack([e[:, 1], -e[:, 0]], 1) / np.hypot(*e.T)[:, None]
    return normals


# ---------------------------------------------------------------- the table


COLUMNS = ("energy growth", "momentum", "depth mm", "joints mm", "end m/s", "ms")


def table(rows: Iterable[tuple[str, Measured, Measured | None]]) -> Iterable[str]:
    """Lines of text: each case by this engine and, where it was run, by pymunk below it."""
    yield f"{'case':<38}{'engine':<9}" + "".join(f"{c:>14}" for c in COLUMNS)
    for name, ours, theirs in rows:
        yield _line(name, "impulse", ours)
        if theirs is not None:
            yield _line("", "pymunk", theirs)


def _line(name: str, engine: str, m: Measured) -> str:
    if not m.finite:
        return f"{name:<38}{engine:<9}{'failed':>14}"
    momentum = "" if math.isnan(m.momentum) else f"{m.momentum:.1e}"
    numbers = f"{m.growth:>14.1e}{momentum:>14}{1e3 * m.depth:>14.3g}{1e3 * m.drift:>14.2g}"
    return f"{name:<38}{engine:<9}{numbers}{m.speed:>14.3g}{1e3 * m.seconds:>14.1f}"


def _impulse(scene: Scene, duration: float, fps: float) -> Trajectory:
    return simulate(scene, duration, fps)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="sketchsim bench stress", description=__doc__.splitlines()[0] if __doc__ else ""
    )
    parser.add_argument("--only", default="", help="cases whose name holds this")
    parser.add_argument(
        "--random", type=int, default=0, metavar="N", help="so many random sketches' scenes too"
    )
    parser.add_argument("--alone", action="store_true", help="without pymunk")
    options = parser.parse_args(arguments)
    chosen = [c for c in cases() if options.only in c.name]
    rows = ((c.name, measure(c, _impulse), None if options.alone else measure(c, run_pymunk)) for c in chosen)
    for line in table(rows):
        print(line, flush=True)
    if options.random:
        _print_random(options.random, options.alone)
    return 0


def _print_random(count: int, alone: bool) -> None:
    """What the worst of many random scenes came to."""
    engines: list[tuple[str, Callable[[Scene, float, float], Trajectory]]] = [("impulse", _impulse)]
    if not alone:
        engines.append(("pymunk", run_pymunk))
    for name, run in engines:
        results = [(c.name, measure(c, run)) for c in random_cases(count)]
        whole = [(n, m) for n, m in results if m.finite]
        print(f"{count} random sketches by {name}: {count - len(whole)} failed", end="")
        for quantity in ("growth", "depth", "drift", "seconds"):
            worst_name, worst = max(whole, key=lambda r: getattr(r[1], quantity))
            print(f"; largest {quantity} {getattr(worst, quantity):.2g} ({worst_name})", end="")
        print(flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
