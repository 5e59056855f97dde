"""What a scene does not need is not imported."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

PROGRAM = """
import sys
from cli.main import main
status = main(sys.argv[1:])
print(*sorted({name.partition(".")[0] for name in sys.modules} | {"numpy.ma"} & set(sys.modules)), file=sys.stderr)
sys.exit(status)
"""


def modules_after(*argv: str) -> set[str]:
    run = subprocess.run([sys.executable, "-c", PROGRAM, *argv], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return set(run.stderr.splitlines()[-1].split())


@pytest.mark.parametrize("output", ["-", "run.npz", "run.csv"])
def test_scene_to_data_needs_no_heavy_library(scene_file: Path, output: str) -> None:
    target = output if output == "-" else str(scene_file.parent / output)
    loaded = modules_after("simulate", str(scene_file), "-o", target)
    assert "numpy" in loaded
    assert not loaded & {"cv2", "scipy", "av", "pymunk", "matplotlib", "asyncio", "sketch"}


def test_strokes_to_a_scene_needs_no_heavy_library() -> None:
    """numpy.ma is what np.median loads; tempfile, zipfile and shutil bring every compressor."""
    loaded = modules_after("recognize", "samples/pendulum.json", "-o", "-")
    assert "sketch" in loaded
    assert not loaded & {"cv2", "scipy", "av", "numpy.ma", "tempfile", "zipfile", "shutil", "csv", "asyncio"}


def test_help_needs_no_numpy() -> None:
    loaded = modules_after("simulate", "--help")
    assert not loaded & {"numpy", "msgspec", "cv2", "scipy", "av", "pymunk"}
