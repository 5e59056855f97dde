"""The package as a whole: what lies where, who imports whom, what an import costs, how it is built."""

from __future__ import annotations

import ast
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("sim", "sketch", "cli")
HEAVY = {
    "av",
    "cv2",
    "distributed",
    "matplotlib",
    "pillow_heif",
    "pymunk",
    "pypdfium2",
    "scipy",
    "svgelements",
}


def modules() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def imported(path: Path, nodes: list[ast.AST]) -> set[str]:
    """Full names of the modules that these statements import."""
    package = path.relative_to(ROOT).parent.parts
    names: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join([*above, *([node.module] if node.module else [])])
            names |= {base} | {f"{base}.{alias.name}" for alias in node.names}
    return names


def at_module_level(tree: ast.Module) -> list[ast.AST]:
    """Statements that run when the module is imported: all but bodies of functions and type checking."""
    found: list[ast.AST] = []
    todo: list[ast.AST] = [tree]
    while todo:
        for child in ast.iter_child_nodes(todo.pop()):
            if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
                continue
            if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
                continue
            found.append(child)
            todo.append(child)
    return found


def test_top_level_holds_only_what_was_agreed() -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    top = {line.split("/")[0] for line in listed.splitlines()}
    agreed = {"pyproject.toml", "README.md", "LICENSE", "samples", "tests", *PACKAGES}
    assert {name for name in top if not name.startswith(".")} <= agreed


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_go_one_way(path: Path) -> None:
    package = path.relative_to(ROOT).parts[0]
    tree = ast.parse(path.read_text())
    ours = {
        n for n in imported(path, list(ast.walk(tree))) if n.split(".")[0] in {*PACKAGES, "tests", "samples"}
    }
    allowed = {
        "sim": lambda n: n.startswith("sim"),
        "sketch": lambda n: n.startswith("sketch") or n == "sim" or n.startswith("sim.scene"),
        "cli": lambda n: n.split(".")[0] in PACKAGES,
    }[package]
    assert {n for n in ours if not allowed(n)} == set()
    if package == "sketch":  # `from sim import scene` is fine, `from sim import simulate` is not
        assert "import sim" not in {ast.unparse(n) for n in ast.walk(tree) if isinstance(n, ast.Import)}
    heavy = {n.split(".")[0] for n in imported(path, at_module_level(tree))} & HEAVY
    assert heavy == set(), "imported by the function that needs it, not with the module"


def modules_after(code: str) -> set[str]:
    """Top-level names in sys.modules after the code has run in a fresh Python."""
    report = "\nimport sys; print('\\n'.join({name.split('.')[0] for name in sys.modules}))"
    run = subprocess.run(
        [sys.executable, "-c", code + report], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return set(run.stdout.split())


def test_scene_to_trajectory_imports_nothing_heavy() -> None:
    loaded = modules_after(
        "from sim import Scene, simulate\n"
        "scene = Scene.load('samples/billiard-break.json')\n"
        "assert simulate(scene, duration=0.1).to_json()"
    )
    assert "numpy" in loaded
    assert loaded & HEAVY == set()


def test_strokes_to_scene_imports_nothing_heavy() -> None:
    loaded = modules_after(
        "from sketch import load_sketch, recognize\n"
        "assert recognize(load_sketch('samples/ramp.json')).scene.to_json()"
    )
    assert "numpy" in loaded
    assert loaded & HEAVY == set()


# ---------------------------------------------------------------- building


@pytest.fixture
def backend(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    spec = importlib.util.spec_from_file_location("native_backend", ROOT / ".packaging/native_backend.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module._setuptools, "get_requires_for_build_wheel", lambda settings: ["setuptools"])
    return module


def program(folder: Path, name: str, script: str) -> None:
    path = folder / name
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)


@pytest.fixture
def bare_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A PATH of one empty folder, and no CC."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    return tmp_path


def test_a_machine_without_a_compiler_builds_with_ziglang(backend: ModuleType, bare_path: Path) -> None:
    assert backend.find_compiler() is None
    assert "ziglang" in backend.get_requires_for_build_wheel()
    assert "ziglang" in backend.get_requires_for_build_editable()


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
def test_a_compiler_that_does_not_work_is_no_compiler(backend: ModuleType, bare_path: Path) -> None:
    program(bare_path, "cc", "exit 1")
    assert backend.find_compiler() is None
    program(bare_path, "gcc", "exit 0")
    assert backend.find_compiler() == ["gcc"]
    assert "ziglang" not in backend.get_requires_for_build_wheel()


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
def test_CC_is_the_compiler_where_it_is_set(
    backend: ModuleType, bare_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program(bare_path, "cc", "exit 0")
    program(bare_path, "mine", 'test "$1" = --fast')
    monkeypatch.setenv("CC", "mine --fast")
    assert backend.find_compiler() == ["mine", "--fast"]


def test_one_wheel_serves_every_python(backend: ModuleType) -> None:
    from setuptools import Distribution, Extension

    wheel = backend.AnyPythonWheel(Distribution({"name": "x", "ext_modules": [Extension("x._core", [])]}))
    wheel.ensure_finalized()
    python, abi, platform = wheel.get_tag()
    assert (python, abi) == ("py3", "none")
    assert platform != "any"
    build = backend.BuildLibraries(Distribution())
    assert build.get_ext_filename("sim._core") == os.path.join("sim", "_core") + backend.SUFFIX


def test_what_is_built_for_the_wheel_also_serves_a_python_started_in_the_source_folder(
    backend: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There `import sketch` finds the source folder's package, not the one that was installed."""
    from setuptools import Distribution, Extension

    source, wheel = tmp_path / "source", tmp_path / "wheel"
    (source / "sketch").mkdir(parents=True)
    (wheel / "sketch").mkdir(parents=True)
    monkeypatch.setattr(backend, "ROOT", source)
    monkeypatch.setattr(backend, "compile_library", lambda name, built: built.write_bytes(b"built"))
    build = backend.BuildLibraries(Distribution({"name": "x"}))
    build.build_lib = str(wheel)
    build.build_extension(Extension("sketch._ink", []))
    found = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert sorted(found) == [folder / "sketch" / f"_ink{backend.SUFFIX}" for folder in (source, wheel)]
    assert {path.read_bytes() for path in found} == {b"built"}


@pytest.mark.slow
def test_the_wheel_holds_all_that_runs_and_no_sources(tmp_path: Path) -> None:
    import zipfile

    tree = tmp_path / "tree"
    skip = shutil.ignore_patterns("*.so", "*.dylib", "*.dll", ".git", "build", "*.egg-info", "__pycache__")
    shutil.copytree(ROOT, tree, ignore=skip)
    build = f"import native_backend; native_backend.build_wheel({str(tmp_path)!r})"
    path = {**os.environ, "PYTHONPATH": str(tree / ".packaging")}
    subprocess.run([sys.executable, "-c", build], cwd=tree, env=path, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {n.split(".")[0] for n in names if n.endswith((".so", ".dylib", ".dll"))} == {
        "sim/_core",
        "sketch/_ink",
    }
    runs = {
        p
        for package in PACKAGES
        for p in (ROOT / package).rglob("*")
        if p.suffix in (".py", ".js", ".css", ".html")
    }
    assert {str(p.relative_to(ROOT)) for p in runs} <= names
    assert {n for n in names if n.endswith((".c", ".h")) or n.startswith(("tests", "samples"))} == set()
