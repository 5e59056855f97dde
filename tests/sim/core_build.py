"""What the tests of the core share: where it is, how it is compiled, what its numbers mean."""

import importlib.util
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIXED, REST, FLIGHT = 0, 1, 2  # of the core's modes
SECONDS = 300  # that a compilation takes at most


def build_backend():
    spec = importlib.util.spec_from_file_location("native_backend", ROOT / ".packaging" / "native_backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def find_compiler(backend):
    return backend.find_compiler() or [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]


def objects(backend, compiler, folder):
    """The core's objects, compiled as the backend does, each by the first that asks for it in a folder: processes that
    ask for them at once share the work."""
    flags = [flag for flag in backend.FLAGS if flag != "-shared"]
    flags += ["-Werror", *([] if sys.platform == "win32" else ["-fPIC"])]
    built = [folder / f"{path.stem}.o" for path in sorted((ROOT / "sim" / "core").glob("*.c"))]
    for one in built:
        try:
            one.with_suffix(".begun").touch(exist_ok=False)
        except FileExistsError:
            continue
        whole = one.with_suffix(".part")
        source = ROOT / "sim" / "core" / f"{one.stem}.c"
        subprocess.run([*compiler, *flags, "-c", str(source), "-o", str(whole)], check=True)
        whole.rename(one)
    end = time.monotonic() + SECONDS
    while not all(one.exists() for one in built):
        assert time.monotonic() < end, "another process did not compile what it began"
        time.sleep(0.05)
    return list(map(str, built))
