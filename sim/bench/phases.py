"""Motion in stretches, each the solution of an ODE until something happens."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim.bench.parts import Array

__all__ = ["Phases"]

Event = Callable[[float, Array], float]


class Phases:
    """Stretches of motion, each an ODE until its event, and the states between at the sample times."""

    def __init__(self, times: Array) -> None:
        self.times = times
        self.now = 0.0
        self.done = False
        self._parts: list[tuple[NDArray[np.bool_], Array]] = []

    def run(self, slope: Callable[[float, Array], Array], start: Array, *events: Event) -> Array:
        """Solve until the first of the events that goes from above to below 0, or the last sample; the state there."""
        from scipy.integrate import solve_ivp

        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        end = float(self.times[-1])
        if self.now >= end:
            self.done = True
            return start
        run = solve_ivp(
            slope,
            (self.now, end),
            start,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=events or None,
            dense_output=True,
        )
        stop = float(run.t[-1])
        here = (self.times >= self.now) & (self.times <= stop)
        part = run.sol(self.times[here]).T if here.any() else np.empty((0, len(start)))  # it wants some
        self._parts.append((here, part))
        self.now, self.done = stop, run.status == 0
        return np.asarray(run.y[:, -1])

    def states(self) -> list[tuple[NDArray[np.bool_], Array]]:
        return self._parts
