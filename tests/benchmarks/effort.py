"""What reading drawings takes: CPU time against the number of strokes, a stroke at a time, and memory."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sketch import Recognizer, Sketch, Stroke, recognize
from tests.benchmarks.mechanisms import draw

__all__ = ["effort", "resampled"]

Array = NDArray[np.float64]

SIZES = (20, 50, 100, 200, 400)  # strokes
WRITERS = 20


def effort(each: Callable[[Sequence[Any], str], Iterator[Any]], seed: int) -> None:
    """Print the table. each: iterates, and shows how far."""
    print("\nCPU time [ms]")
    print(f"  {'strokes':<28}" + "".join(f"{n:>9}" for n in SIZES))
    for name, page in (("machines side by side", machines), ("lines across each other", crossing)):
        times = []
        for n in each(SIZES, name):
            sketch = page(n, seed)
            times.append(min(_seconds(recognize, sketch) for _ in range(3 if n <= 200 else 1)))
        print(f"  {name:<28}" + "".join(f"{1e3 * t:9.1f}" for t in times))
    times = [_one_more(machines(n, seed)) for n in each(SIZES, "one stroke more")]
    print(f"  {'one stroke more, or less':<28}" + "".join(f"{1e3 * t:9.1f}" for t in times))
    path = os.pathsep.join(p for p in sys.path if p)
    used = subprocess.run(
        [sys.executable, "-c", _MEMORY],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
    ).stdout.split()
    print(f"memory beyond the ink: {used[0]} MB for 200 strokes of 500 points", end="")
    print(f", {used[1]} MB for a stroke of a million, which takes {used[2]} s CPU")


def resampled(stroke: Array, count: int) -> Array:
    """So many points along a stroke, at equal distances."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(stroke, axis=0).T))])
    t = np.linspace(0, along[-1], count)
    return np.stack([np.interp(t, along, stroke[:, k]) for k in (0, 1)], axis=1)


def machines(count: int, seed: int) -> Sketch:
    """Mechanisms side by side, with so many strokes in all."""
    strokes: list[Stroke] = []
    k = 0
    while len(strokes) < count:
        place = np.array([1300.0 * (k % 4), 740.0 * (k // 4)])
        strokes += [Stroke(s + place) for s in draw(k, seed + 3, WRITERS).strokes]
        k += 1
    return Sketch(strokes[:count])


def crossing(count: int, seed: int) -> Sketch:
    """Long lines at random, each across half of the others."""
    rng = np.random.default_rng([seed, count])
    return Sketch([Stroke(resampled(rng.uniform(0, 1000, (2, 2)), 20)) for _ in range(count)])


def _seconds(call: Callable[[Sketch], object], sketch: Sketch) -> float:
    begin = time.process_time()
    call(sketch)
    return time.process_time() - begin


def _one_more(sketch: Sketch) -> float:
    """CPU to read a page after one of its last strokes came or went, the median of twenty [s]."""
    width, height = (np.concatenate([s.points for s in sketch.strokes]).max(axis=0) + 10).tolist()
    page = Recognizer(replace(sketch, width=width, height=height))
    page.recognition()
    times = []
    for key in range(len(sketch.strokes) - 10, len(sketch.strokes)):
        times.append(_seconds(lambda _, k=key: (page.remove(k), page.recognition()), sketch))
        times.append(_seconds(lambda s, k=key: (page.add(s.strokes[k]), page.recognition()), sketch))
    return float(np.median(times))


_MEMORY = """
import time, tracemalloc, numpy as np
from sketch import Sketch
from sketch import Stroke
from sketch import recognize
from tests.benchmarks.effort import machines, resampled
recognize(machines(20, 0))
sketch = Sketch([Stroke(resampled(s.points, 500)) for s in machines(200, 0).strokes])
t = np.linspace(0, 6.28, 1_000_000)
circle = Sketch([Stroke(np.stack([100 * np.cos(t), 100 * np.sin(t)], axis=1))])
begin = time.process_time()
recognize(circle)
seconds = time.process_time() - begin
tracemalloc.start()
for page in (sketch, circle):
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    recognize(page)
    print(round((tracemalloc.get_traced_memory()[1] - before) / 1e6))
print(round(seconds, 2))
"""
