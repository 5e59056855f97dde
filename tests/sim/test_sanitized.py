"""The core under AddressSanitizer and UndefinedBehaviorSanitizer, on scenes made of random bytes."""

import subprocess

import pytest
from core_build import ROOT, build_backend, find_compiler

FUZZ = ROOT / "tests" / "sim" / "fuzz.c"


def build(folder, flags, sources):
    program = folder / "fuzz"
    command = [*find_compiler(build_backend()), "-std=c11", "-ffp-contract=off", *flags]
    command += [str(FUZZ), *map(str, sources), "-o", str(program), "-lm"]
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


def test_random_bytes_run_to_numbers(core, tmp_path):
    """The core as it is delivered."""
    run(build(tmp_path, ["-O1"], core), 100, 5, timeout=60)


@pytest.mark.slow
def test_sanitized(tmp_path):
    sources = sorted((ROOT / "sim" / "core").glob("*.c"))
    run(
        build(tmp_path, ["-Wall", "-Wextra", "-Werror", *build_backend().SANITIZE], sources),
        250,
        3,
        timeout=600,
    )
