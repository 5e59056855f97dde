"""PEP 517 build backend: setuptools, plus a C compiler from the package registry where there is none.

The project's two native libraries are plain C11 without Python.h, so one wheel (``py3-none-<platform>``)
serves every Python.  `ziglang` carries clang and joins the build requirements only where no working C
compiler is found.  If nothing compiles, the build fails and says why: there is no slower fallback.

Run as a script it compiles the libraries in place, for development::

    python .packaging/native_backend.py [--sanitize]
"""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import build_meta as _setuptools
from setuptools.build_meta import (  # noqa: F401  (hooks that need no change)
    build_editable,
    build_sdist,
    build_wheel,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = {"sim._core": "sim/core", "sketch._ink": "sketch/core"}
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")

# No fused multiply-add and no fast-math: the same scene gives the same bits on every build. Nobody asks for errno or
# for the processor's exception flags; without them square roots and choices are taken several at a time.
FLAGS = ["-O3", "-std=c11", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
FLAGS += ["-Wall", "-Wextra", "-fvisibility=hidden", "-shared"]
SANITIZE = (
    "-O1",
    "-g",
    "-fno-omit-frame-pointer",
    "-fsanitize=address,undefined",
    "-fno-sanitize-recover=undefined",
)


# What a compiler must be able to do: macOS has a `cc` that only offers to install one, a clang of Windows may know no
# -lm, and an old gcc there may build for another width of pointers than this Python has.
PROBE = f"""
#include <math.h>
_Static_assert(sizeof(void *) == {struct.calcsize("P")}, "the width of this Python's pointers");
int probe(double x) {{ return isfinite(fmod(x, 2)); }}
"""


def find_compiler() -> list[str] | None:
    """The first C compiler that compiles and links: $CC, cc, gcc, clang; None where there is none."""
    wanted = [shlex.split(os.environ["CC"])] if os.environ.get("CC") else [["cc"], ["gcc"], ["clang"]]
    for command in wanted:
        if shutil.which(command[0]) is None:
            continue
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "probe.c")
            source.write_text(PROBE)
            run = subprocess.run(
                compilation(command, [str(source)], Path(folder, "probe" + SUFFIX)), capture_output=True
            )
            if run.returncode == 0:
                return command
    return None


def compilation(
    compiler: list[str], sources: list[str], built: Path, extra: tuple[str, ...] = ()
) -> list[str]:
    """The command that compiles the sources into the shared library `built`."""
    position_independent = [] if sys.platform == "win32" else ["-fPIC"]
    return [*compiler, *FLAGS, *extra, *position_independent, *sources, "-o", str(built), "-lm"]


def compile_library(name: str, built: Path, sanitize: bool = False) -> None:
    """Compile every .c file of the library's folder into the shared library `built`."""
    compiler = find_compiler() or [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]
    sources = sorted(str(path) for path in (ROOT / FOLDERS[name]).glob("*.c"))
    print("compiling", name, "with", shlex.join(compiler), file=sys.stderr)
    built.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=built.parent) as folder:  # some compilers put more beside it
        whole = Path(folder, built.name)
        command = compilation(compiler, sources, whole, SANITIZE if sanitize else ())
        if subprocess.run(command).returncode != 0:
            raise SystemExit(
                f"error: the C library {name} did not compile; the command was: {shlex.join(command)}"
            )
        os.replace(whole, built)  # a process may be running the old one


def in_place(name: str) -> Path:
    """The library beside the package that loads it, in the source folder."""
    return ROOT / (name.replace(".", "/") + SUFFIX)


class BuildLibraries(build_ext):
    """Compiles the shared libraries, named without a Python version."""

    def get_ext_filename(self, fullname: str) -> str:
        return fullname.replace(".", os.sep) + SUFFIX

    def build_extension(self, ext) -> None:
        built, here = Path(self.get_ext_fullpath(ext.name)), in_place(ext.name)
        compile_library(ext.name, built)
        if built.resolve() == here:
            return
        # A Python that is started in the source folder finds the packages there before those that are installed.
        with contextlib.suppress(OSError), tempfile.TemporaryDirectory(dir=here.parent) as folder:
            os.replace(shutil.copy2(built, folder), here)  # unless the source folder is read-only


class AnyPythonWheel(bdist_wheel):
    """One wheel for every Python of a platform: nothing in it depends on Python's C interface."""

    def get_tag(self) -> tuple[str, str, str]:
        return "py3", "none", super().get_tag()[2]


class WholeSource(sdist):
    """A source archive with all that builds and tests it."""

    def add_defaults(self) -> None:
        super().add_defaults()
        for pattern in (".packaging/*.py", "*/core/*.[ch]", "tests/**/*", "samples/*"):
            self.filelist.extend(str(p.relative_to(ROOT)) for p in ROOT.glob(pattern) if p.is_file())


def get_requires_for_build_wheel(config_settings=None) -> list[str]:
    compiler = [] if find_compiler() else ["ziglang"]
    return [*_setuptools.get_requires_for_build_wheel(config_settings), *compiler]


get_requires_for_build_editable = get_requires_for_build_wheel


if __name__ == "__main__":
    for library in FOLDERS:
        compile_library(library, in_place(library), sanitize="--sanitize" in sys.argv[1:])
