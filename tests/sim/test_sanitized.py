"""The core under AddressSanitizer and UndefinedBehaviorSanitizer, on scenes made of random bytes."""

import subprocess
import sys

import pytest
from core_build import ROOT, build_backend

SOURCES = [ROOT / "tests" / "sim" / "fuzz.c", *sorted((ROOT / "sim" / "core").glob("*.c"))]


def build(folder, flags):
    compiler = build_backend().find_compiler() or [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]
    program = folder / "fuzz"
    command = [
        *compiler,
        "-std=c11",
        "-ffp-contract=off",
        *flags,
        *map(str, SOURCES),
        "-o",
        str(program),
        "-lm",
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0 and "sanitize" in done.stderr:
        pytest.skip("this compiler has no sanitizers")
    assert done.returncode == 0, done.stderr
    return program


def run(program, count, seed, timeout):
    done = subprocess.run(
        [str(program), "--random", str(count), str(seed)], capture_output=True, text=True, timeout=timeout
    )
    assert done.returncode == 0, done.stderr[-3000:]


def test_random_bytes_run_to_numbers(tmp_path):
    run(build(tmp_path, ["-O1"]), 100, 5, timeout=60)


@pytest.mark.slow
def test_sanitized(tmp_path):
    run(build(tmp_path, ["-Wall", "-Wextra", "-Werror", *build_backend().SANITIZE]), 250, 3, timeout=600)
