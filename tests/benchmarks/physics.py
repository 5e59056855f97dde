"""Work and precision: how long each case takes for how small an error, beside pymunk at finer steps.

`sketchsim bench physics` prints it all, in one run; `--plot FILE` draws it.  Errors are metres, the largest
over bodies and samples of position error + reach x orientation error.  Times are CPU of a whole call from
Scene to Trajectory, the median of runs that take turns, as multiples of pymunk's at its defaults (60 Hz, 10
iterations).
"""

from __future__ import annotations

import math
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from statistics import median
from typing import Any

from cli.arguments import Parser, UsageError, whole_number
from sim import Scene, simulate
from sim.bench.cases import CASES, Case, case_error
from sim.reference import run_pymunk
from sim.scene import Body, Circle, Rectangle
from sim.trajectory import Trajectory

__all__ = ["main"]

TOLERANCES = tuple(10.0**-k for k in range(2, 9))
RATES = tuple(60.0 * 2**k for k in range(8))  # 60 to 7680 Hz
LEAST = 1e-16  # an error of 0 in a logarithmic plot
_LABELS = ("sketchsim, asked for 1e-2 to 1e-8 m", "pymunk at 60 to 7680 Hz")


@dataclass(frozen=True)
class Point:
    """One way of running a case. error: [m], NaN where no truth is known.  cpu: [s]."""

    label: str
    error: float
    cpu: float


def measure(scene: Scene, duration: float, case: Case | None, repeat: int) -> tuple[list[Point], list[Point]]:
    """The engine at each tolerance, pymunk at each rate; at 60 Hz only where no case tells the truth."""
    ways: dict[str, Callable[[], Trajectory]] = {}
    for tolerance in TOLERANCES:
        ways[f"{tolerance:.0e}"] = lambda tol=tolerance: simulate(scene, duration, tolerance=tol)
    for rate in RATES if case else RATES[:1]:
        ways[f"{rate:.0f} Hz"] = lambda hz=rate: run_pymunk(scene, duration, rate=hz)
    for run in (ways["1e-02"], ways["60 Hz"]):
        run()  # untimed: imports and first pages of memory are not in question
    times: dict[str, list[float]] = {label: [] for label in ways}
    errors = dict.fromkeys(ways, math.nan)
    for turn in range(repeat):
        for label, run in ways.items():
            if turn and times[label][0] > 1.0:
                continue  # a slow one is measured well enough by one run
            start = time.process_time()
            motion = run()
            times[label].append(time.process_time() - start)
            if case is not None:
                errors[label] = case_error(case, motion.times, motion.positions, motion.angles)
    points = [Point(label, errors[label], median(times[label])) for label in ways]
    return points[: len(TOLERANCES)], points[len(TOLERANCES) :]


def pile() -> Scene:
    """200 disks and boxes fall into a bin."""
    bodies = [
        _box("floor", (7, 0.5), (0, -0.25), anchored=True),
        _box("left", (0.5, 6), (-3.25, 3), anchored=True),
        _box("right", (0.5, 6), (3.25, 3), anchored=True),
    ]
    for k in range(200):
        at = (-2.6 + 0.4 * (k % 14) + 0.03 * (k // 14 % 3), 0.4 + 0.4 * (k // 14))
        bodies.append(
            Body(id=f"p{k}", shape=Circle(0.17), position=at)
            if k % 2
            else _box(f"p{k}", (0.3, 0.3), at, angle=0.1 * (k % 7))
        )
    return Scene(bodies=bodies, gravity=(0, -9.81))


def dominoes() -> Scene:
    """Forty of them, the first one pushed."""
    bodies = [_box("floor", (40, 1), (10, -0.5), anchored=True)]
    bodies += [_box(f"d{k}", (0.1, 1.0), (0.45 * k, 0.5)) for k in range(40)]
    bodies[1].angular_velocity = -2.0
    return Scene(bodies=bodies, gravity=(0, -9.81))


def _box(name: str, size: tuple[float, float], at: tuple[float, float], **more: Any) -> Body:
    return Body(id=name, shape=Rectangle(size), position=at, **more)


def table(name: str, ours: list[Point], theirs: list[Point]) -> str:
    unit = theirs[0].cpu
    lines = [f"{name} (pymunk at 60 Hz: {1e3 * unit:.2f} ms)"]
    for title, points in (("tolerance", ours), ("pymunk", theirs)):
        lines.append(f"  {title:<12}" + "".join(f"{p.label:>10}" for p in points))
        if not math.isnan(points[0].error):
            lines.append(f"  {'error m':<12}" + "".join(f"{p.error:>10.1e}" for p in points))
        lines.append(f"  {'x pymunk':<12}" + "".join(f"{p.cpu / unit:>10.3f}" for p in points))
    return "\n".join(lines)


def plot(results: dict[str, tuple[list[Point], list[Point]]], path: str) -> None:
    """Error against time, a panel a case."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    shown = {name: r for name, r in results.items() if not math.isnan(r[0][0].error)}
    columns = min(range(6, 9), key=lambda c: (-len(shown)) % c) if len(shown) > 8 else len(shown)
    rows = math.ceil(len(shown) / columns)
    figure, axes = plt.subplots(
        rows,
        columns,
        figsize=(1.75 * columns + 0.5, 1.65 * rows + 0.4),
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    panels = list(axes.flat)
    for ax, (name, lines) in zip(panels, shown.items(), strict=False):
        for points, color, label in zip(lines, ("#aa3377", "#4477aa"), _LABELS, strict=True):
            x, y = [1e3 * p.cpu for p in points], [min(max(p.error, LEAST), 1e2) for p in points]
            ax.loglog(x, y, "o-", color=color, label=label, markersize=2.5, linewidth=1.1)
        ax.set_title(name, fontsize=8.5)
        ax.set_ylim(1e-17, 1e2)
        ax.set_yticks([1e-15, 1e-10, 1e-5, 1])
        ax.grid(alpha=0.3, linewidth=0.5)
        ax.tick_params(labelsize=7)
    for ax in panels[len(shown) :]:
        ax.axis("off")
    for ax in axes[:, 0]:
        ax.set_ylabel("error [m]", fontsize=8)
    for ax in panels[max(len(shown) - columns, 0) : len(shown)]:  # the lowest of each column
        ax.set_xlabel("CPU [ms]", fontsize=8)
        ax.tick_params(labelbottom=True)
    figure.legend(
        *panels[0].get_legend_handles_labels(), fontsize=9, loc="lower center", ncol=2, frameon=False
    )
    figure.tight_layout(rect=(0, 0.2 / rows, 1, 1))
    figure.savefig(path, dpi=100)


def main(argv: list[str]) -> int:
    parser = Parser(prog="sketchsim bench physics", description=__doc__)
    parser.add_argument(
        "--plot", metavar="FILE", help="a .png or .svg of error against time (needs matplotlib)"
    )
    parser.add_argument("--only", metavar="NAME", default="", help="cases whose name has this in it")
    parser.add_argument(
        "--repeat", type=whole_number(1, 1000), default=5, help="runs of each, of which the median counts"
    )
    options = parser.parse_args(argv)
    if options.plot and find_spec("matplotlib") is None:
        raise UsageError("--plot: matplotlib is not installed", "pip install matplotlib")
    results: dict[str, tuple[list[Point], list[Point]]] = {}
    known: dict[str, tuple[Scene, float, Case | None]] = {c.name: (c.scene, c.duration, c) for c in CASES}
    crowds: dict[str, tuple[Scene, float, Case | None]] = {
        "pile of 200": (pile(), 10.0, None),
        "40 dominoes": (dominoes(), 10.0, None),
    }
    chosen = {name: what for name, what in (known | crowds).items() if options.only in name}
    if not chosen:
        names = ", ".join(known | crowds)
        raise UsageError(f"--only: no case has {options.only!r} in its name", f"the cases are {names}")
    print(f"Python {platform.python_version()}, pymunk {version('pymunk')}, {_processor()}")
    for name, what in chosen.items():
        results[name] = measure(*what, options.repeat)
        print(table(name, *results[name]), flush=True)
    if options.plot:
        plot(results, options.plot)
    return 0


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as f:
            return next(line.split(":", 1)[1].strip() for line in f if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
