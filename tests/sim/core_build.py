"""What the tests of the core share: where it is, how it is compiled, what its numbers mean."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIXED, REST, FLIGHT = 0, 1, 2  # of the core's modes


def build_backend():
    spec = importlib.util.spec_from_file_location("native_backend", ROOT / ".packaging" / "native_backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
