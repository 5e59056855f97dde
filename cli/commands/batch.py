"""`sketchsim batch`: many drawings or scenes at once, on all cores or on a cluster."""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import sys
from collections.abc import Callable, Generator, Iterator
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from cli.arguments import UsageError, matching, number, whole_number
from cli.commands.simulate import RUN_OPTIONS, add_run_options, check_samples
from cli.results import DATA

__all__ = ["Done", "Task", "configure", "tasks_of", "work"]

EPILOG = """\
INPUT is a drawing, a picture, a scene, a folder of them, or a file with a drawing or scene on each line.
For each, two files are written in the folder: NAME.scene.json and NAME with the ending of --data.
What cannot be read is reported and left out; the exit status is then 3.

examples:
  sketchsim batch sketches/ -o runs
  sketchsim batch sketches.jsonl -o runs --data csv --duration 5
  sketchsim batch sketches/ -o runs --scheduler tcp://192.168.1.5:8786     workers of dask.distributed
"""


class Task(NamedTuple):
    """One input: the name of its files, where it stands, and its line where it is one of many in a file."""

    name: str
    source: str
    line: bytes | None = None


class Done(NamedTuple):
    """What became of a task: files by their endings, or the error as its line and hint."""

    task: str
    files: dict[str, bytes]
    notes: list[str]
    error: str = ""
    kind: str = ""
    hint: str = ""


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Read and run many drawings or scenes, on all cores or on a cluster."
    p.epilog = EPILOG
    p.add_argument("inputs", metavar="INPUT", nargs="+", help="files and folders")
    p.add_argument(
        "-o", dest="folder", metavar="FOLDER", required=True, help="where to write; made if need be"
    )
    p.add_argument("--data", choices=[kind[1:] for kind in DATA], default="npz", help="form of the motions")
    add_run_options(p)
    p.add_argument(
        "--scale", type=number(0, 1e9), metavar="PX_PER_M", help="pixels of the drawings in a metre"
    )
    p.add_argument("--workers", type=whole_number(1, 1024), metavar="N", help="processes (one a core)")
    p.add_argument("--scheduler", metavar="ADDRESS", help="run on this cluster of dask.distributed instead")
    p.add_argument("-q", "--quiet", action="store_true", help="no notes and no progress")
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    check_samples(options)
    tasks = tasks_of(matching(options.inputs))
    folder = Path(options.folder)
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"-o {folder}: this is not a folder")
    folder.mkdir(parents=True, exist_ok=True)
    from cli.outputs import Outputs
    from cli.progress import Progress, error, note

    settings = {name: getattr(options, name) for name in (*RUN_OPTIONS, "scale", "data")}
    if options.scheduler:
        results = _on_cluster(options.scheduler, tasks, settings)
    else:
        results = _here(options.workers, tasks, settings)
    kinds: set[str] = set()
    with Progress(not options.quiet) as progress, contextlib.closing(results):
        for k, done in enumerate(results):
            if done.error:
                kinds.add(done.kind)
                progress.clear()
                error(done.error, done.kind, done.hint)
                continue
            with Outputs() as files:
                for ending, content in done.files.items():
                    files.write(str(folder / (done.task + ending)), content)
            if not options.quiet:
                progress.clear()
                for text in done.notes:
                    note(f"{done.task}: {text}")
            progress.say(f"{k + 1} of {len(tasks)}", (k + 1) / len(tasks))
    return 1 if "inside" in kinds else 3 if kinds else 0


def tasks_of(inputs: list[str]) -> list[Task]:
    """The inputs one by one, each under a name of its own."""
    tasks = [task for source in inputs for task in _tasks_in(Path(source))]
    if not tasks:
        raise UsageError("nothing to run: there are no drawings, pictures or scenes")
    namings: tuple[Callable[[Task], str], ...] = (
        lambda task: task.name,
        lambda task: Path(task.source).name,
        lambda task: task.source,
    )
    for name_of in namings:
        named = [task._replace(name=re.sub(r"[/\\:]", "-", name_of(task))) for task in tasks]
        if len({task.name for task in named}) == len(tasks):
            return named
    raise UsageError("an input is given twice")


def _tasks_in(path: Path) -> Iterator[Task]:
    from cli.inputs import read
    from sketch.formats import kind_of

    if path.is_dir():
        for inside in sorted(path.iterdir()):
            if inside.is_file() and not inside.name.startswith("."):
                with inside.open("rb") as f:
                    known = kind_of(f.read(4096)) != "unknown"
                if known:
                    yield from _tasks_in(inside)
        return
    with (
        contextlib.suppress(OSError),
        path.open("rb") as f,
    ):  # what cannot be read is told in its turn
        if _is_one_a_line(f.read(1 << 22)):
            for number, line in enumerate(read(str(path)).split(b"\n"), 1):
                if line.strip():
                    yield Task(f"{path.stem}-{number}", f"{path} line {number}", line)
            return
    yield Task(path.stem, str(path))


def _is_one_a_line(data: bytes) -> bool:
    """Whether the first line is a JSON object by itself, and more stands below it."""
    import json

    first, _, rest = data.lstrip().partition(b"\n")
    if first[:1] != b"{" or not rest.strip():
        return False
    try:
        json.loads(first)
    except ValueError:  # a document over several lines
        return False
    return True


def work(task: Task, settings: dict[str, Any]) -> Done:
    """Read and run one task. Errors of the input are part of the result; it runs in any process."""
    from cli.commands.simulate import motion_of
    from cli.inputs import Way, is_scene, load_bytes, naming, read
    from sim.scene import InputError

    options = argparse.Namespace(**settings)
    notes: list[str] = []
    try:
        with naming(task.source, True):
            data = read(task.source) if task.line is None else task.line
            loaded = load_bytes(data, task.source, Way(None if is_scene(data) else options.scale))
            motion = motion_of(loaded, options, notes.append)
    except InputError as e:
        problem = str(e) if task.line is None else str(e).replace(": line 1 column ", " column ", 1)
        return Done(task.name, {}, notes, problem, e.kind, e.hint)
    except Exception as e:  # whatever is wrong with one, the others are run
        problem = f"{task.source}: something inside failed: {type(e).__name__}: {e}"
        return Done(task.name, {}, notes, problem, "inside")
    content = getattr(motion, DATA[f".{options.data}"])()
    return Done(task.name, {".scene.json": loaded.scene.to_json(), f".{options.data}": content}, notes)


def _here(workers: int | None, tasks: list[Task], settings: dict[str, Any]) -> Generator[Done, None, None]:
    """The results in the order of the tasks, from processes on this machine."""
    import multiprocessing
    from functools import partial

    workers = min(workers or _cores(), len(tasks))
    step = partial(work, settings=settings)
    if workers == 1:
        yield from map(step, tasks)
        return
    import sketch.recognize  # noqa: F401  (before the fork: every process has them at once)

    method = "fork" if sys.platform == "linux" else "spawn"  # macOS forks, but its own libraries break
    with multiprocessing.get_context(method).Pool(workers, _leave_signals) as pool:
        yield from pool.imap(step, tasks, chunksize=max(1, min(8, len(tasks) // (4 * workers))))


def _leave_signals() -> None:
    """In a worker: the parent alone deals with Ctrl-C, and ends its workers by SIGTERM."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _on_cluster(address: str, tasks: list[Task], settings: dict[str, Any]) -> Generator[Done, None, None]:
    """The results as they come, from the workers of a cluster that have this program installed.

    The workers need not see this machine's files: inputs are read here, a few ahead of the workers.
    """
    try:
        from distributed import Client, as_completed
    except ModuleNotFoundError:
        hint = "pip install distributed"
        raise UsageError("--scheduler: dask.distributed is not installed", hint) from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError) as e:
        raise UsageError(f"--scheduler: no scheduler answers at {address}: {e}") from None
    with client:
        ahead = 4 * max(1, sum(client.nthreads().values()))
        waiting = iter(tasks)
        first = [_submit(client, task, settings) for task in islice(waiting, ahead)]
        running = as_completed(first, with_results=True)
        for _, done in running:
            yield Done(*done)
            for task in islice(waiting, 1):
                running.add(_submit(client, task, settings))


def _submit(client: Any, task: Task, settings: dict[str, Any]) -> Any:
    """The future of a task that carries its input along; one that cannot be read fails over there alike."""
    from cli.inputs import read
    from sim.scene import InputError

    with contextlib.suppress(InputError):
        if task.line is None:
            task = task._replace(line=read(task.source))
    return client.submit(work, task, settings, pure=False)


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
