import ctypes
import os
import subprocess
from dataclasses import dataclass

import numpy as np
import pytest
from core_build import ROOT, build_backend, find_compiler, objects


@pytest.fixture(scope="session")
def core(tmp_path_factory):
    """The core's objects, compiled once for all tests, by all processes that run them."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "core"
    folder.mkdir(exist_ok=True)
    backend = build_backend()
    return objects(backend, find_compiler(backend), folder)


@pytest.fixture(scope="session")
def probe(core, tmp_path_factory):
    """The core with doors into its parts."""
    backend = build_backend()
    built = tmp_path_factory.mktemp("probe") / ("probe" + backend.SUFFIX)
    sources = [str(ROOT / "tests" / "sim" / "probe.c"), *core]
    subprocess.run(backend.compilation(find_compiler(backend), sources, built, ("-Werror",)), check=True)
    return ctypes.CDLL(str(built))


@dataclass
class Run:
    """Samples of a run by the crowd alone."""

    times: np.ndarray
    positions: np.ndarray
    angles: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
    modes: np.ndarray


@pytest.fixture(scope="session")
def crowd(probe):
    """crowd(scene, duration, fps, tolerance) -> Run."""
    from sim.engine import _pack

    def run(scene, duration, fps=60.0, tolerance=1e-4):
        packed, _parts = _pack(scene)
        samples, n = round(duration * fps) + 1, len(scene.bodies)
        frames, modes = np.empty((samples, n, 6)), np.empty((samples, n), dtype=np.int32)
        status = probe.probe_crowd(
            ctypes.byref(packed),
            ctypes.c_double(1 / fps),
            samples,
            ctypes.c_double(tolerance),
            ctypes.c_void_p(frames.ctypes.data),
            ctypes.c_void_p(modes.ctypes.data),
        )
        assert status == 0
        assert np.isfinite(frames).all()
        return Run(
            np.arange(samples) / fps,
            frames[:, :, :2],
            frames[:, :, 2],
            frames[:, :, 3:5],
            frames[:, :, 5],
            modes,
        )

    return run
