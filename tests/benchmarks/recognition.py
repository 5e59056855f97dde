"""How right and how fast drawings are read: on made-up ink of many writers, and on a corpus of real ink.

`sketchsim bench recognition` prints it all: whole sketches with 95 % intervals (Wilson's), what was taken for
what, what must not change a reading, ink without a meaning, whether scores mean what they say, time and memory.
"""

from __future__ import annotations

import itertools
import math
import time
import zlib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cli.arguments import Parser, whole_number
from cli.progress import Progress
from sim.scene import Body, Circle, Polygon
from sketch import Recognition, Sketch, Stroke, load_sketch, recognize
from tests.benchmarks import corpus, pictured
from tests.benchmarks.drawings import Drawing, Meant, differences, is_as_drawn, matched, writer
from tests.benchmarks.effort import effort, resampled
from tests.benchmarks.mechanisms import KINDS, NONSENSE, draw, nonsense
from tests.benchmarks.shapes import CARELESS, SHAPES, draw_shape

__all__ = ["main"]

Array = NDArray[np.float64]
T = TypeVar("T")

WRITERS = 20
CHANGED = 120  # sketches that are drawn in other orders, sizes, ...
PAPER = 4  # kinds of paper that a sketch is drawn on
COMPOSED = 270  # sketches of real ink
CARELESSLY = 12  # shapes of a kind in each way of being careless
TAP = 0.08  # of a shape's extent: in less the pen only rested
BINS = (0.0, 0.6, 0.8, 0.9, 0.95, 0.98, 0.99, 1.0)


def main(argv: list[str]) -> int:
    p = Parser(prog="sketchsim bench recognition", description=__doc__)
    p.add_argument(
        "--corpus", type=Path, metavar="DIR", help="real ink: a folder with dev/*.jsonl.gz and compose.py"
    )
    p.add_argument(
        "--failures", type=Path, metavar="DIR", help="for a picture of each sketch that is read wrong"
    )
    p.add_argument(
        "--count", type=whole_number(1, 1_000_000), default=504, metavar="N", help="made-up sketches (504)"
    )
    p.add_argument(
        "--seed",
        type=whole_number(0, 999_999_999),
        default=0,
        metavar="S",
        help="another seed draws others (0)",
    )
    p.add_argument(
        "--paper", action="store_true", help="draw the made-up sketches on paper instead, before a camera"
    )
    options = p.parse_args(argv)
    if options.corpus is not None and not (options.corpus / "dev").is_dir():
        p.error(f"--corpus {options.corpus}: there is no folder dev in it")
    with Progress() as progress:
        bench = Bench(progress, options.failures)
        if options.paper:
            bench.paper(options.count, options.seed)
            return 0
        bench.mechanisms(options.count, options.seed)
        bench.changes(min(CHANGED, options.count), options.seed)
        bench.nonsense(options.count // 4, options.seed)
        bench.careless(max(options.count * CARELESSLY // 504, 1), options.seed)
        if options.corpus is not None:
            bench.isolated(options.corpus)
            bench.composed(options.corpus, options.seed)
        effort(bench.each, options.seed)
    return 0


def interval(right: int, count: int) -> tuple[float, float]:
    """95 % confidence interval of a share (Wilson 1927)."""
    if count == 0:
        return 0.0, 1.0
    z, p = 1.96, right / count
    middle = p + z * z / (2 * count)
    half = z * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count))
    return max(middle - half, 0.0) / (1 + z * z / count), (middle + half) / (1 + z * z / count)


def rate(right: int, count: int) -> str:
    low, high = interval(right, count)
    return (
        f"{right:5} of {count:4} = {100 * right / max(count, 1):5.1f} % ({100 * low:.1f} to {100 * high:.1f})"
    )


@dataclass(eq=False)
class Judged:
    """A drawing, how it was read, and what is wrong with that."""

    drawing: Drawing
    recognition: Recognition
    hits: dict[int, tuple[int, float]]
    wrong: list[str]
    seconds: float


def judge(drawing: Drawing, picture: bytes | None = None) -> Judged:
    """Read a drawing, by its strokes or by a picture of it."""
    sketch = drawing.sketch
    begin = time.process_time()
    recognition = recognize(sketch if picture is None else load_sketch(picture))
    seconds = time.process_time() - begin
    hits = matched(drawing, recognition.scene)
    return Judged(drawing, recognition, hits, differences(drawing, recognition.scene, hits), seconds)


class Bench:
    """The tables, one a method; failures are drawn as they come."""

    def __init__(self, progress: Progress, failures: Path | None) -> None:
        self.progress = progress
        self.failures = failures
        if failures is not None:
            failures.mkdir(parents=True, exist_ok=True)

    def each(self, items: Sequence[T], what: str) -> Iterator[T]:
        for k, item in enumerate(items):
            self.progress.say(what, k / len(items))
            yield item
        self.progress.clear()

    def show(
        self, name: str, recognition: Recognition, wrong: list[str], meant: Iterable[Meant] = ()
    ) -> None:
        if self.failures is not None:
            path = self.failures / f"{name.replace('/', '-')}.png"
            path.write_bytes(pictured.failure(recognition, wrong, [m.outline for m in meant]))

    # ------------------------------------------------------------ made-up ink

    def mechanisms(self, count: int, seed: int) -> None:
        judged = []
        for k in self.each(range(count), "mechanisms"):
            j = judge(draw(k, seed, WRITERS))
            judged.append(j)
            if j.wrong:
                self.show(f"{j.drawing.name}-{k}", j.recognition, j.wrong, j.drawing.bodies)
        print(f"made-up mechanisms of {len(KINDS)} kinds by {WRITERS} writers, seed {seed}")
        _whole(judged)
        _kinds(judged)
        _confusion(judged)
        _reliability(_scores(judged))

    def changes(self, count: int, seed: int) -> None:
        right = []
        for k in self.each(range(count), "mechanisms to be changed"):
            drawing = draw(k, seed + 1, WRITERS)
            if not judge(drawing).wrong:
                right.append(drawing)
        print(f"\nthe same sketch drawn otherwise: right as before, of {len(right)} that were right")
        for name, change in CHANGES.items():
            kept = 0
            for k, drawing in enumerate(self.each(right, name)):
                j = judge(change(drawing, np.random.default_rng([seed, k])))
                kept += not j.wrong
                if j.wrong:
                    self.show(
                        f"{name}-{drawing.name}-{k}".replace(" ", "-"),
                        j.recognition,
                        j.wrong,
                        j.drawing.bodies,
                    )
            print(f"  {name:<28}{rate(kept, len(right))}")

    def nonsense(self, count: int, seed: int) -> None:
        """Ink without a meaning, on a good sketch: it must change nothing else, be no body, and be named."""
        tally: dict[str, Counter[str]] = defaultdict(Counter)
        for k in self.each(range(count), "ink without a meaning"):
            drawing = draw(k, seed + 2, WRITERS)
            if judge(drawing).wrong:
                continue
            name = NONSENSE[k % len(NONSENSE)]
            first = len(drawing.strokes)
            at = _free_place(drawing)
            nonsense(name, at, float(drawing.rng.uniform(60, 120)), drawing)
            _count_strays(self, tally[name], drawing, range(first, len(drawing.strokes)), f"{name}-{k}")
        _print_strays("made-up ink without a meaning, on a good sketch", tally)

    def paper(self, count: int, seed: int) -> None:
        """Sketches that are right as strokes, on each kind of paper."""
        from tests.sketch.scan.paper import PAPERS, photographed

        print(f"made-up mechanisms that are right as strokes, on paper, seed {seed}")
        papers = list(PAPERS)
        tally: dict[str, list[Judged]] = {name: [] for name in papers}
        for k in self.each(range(count // PAPER), "drawings on paper"):
            for i in range(PAPER):
                name = papers[(PAPER * k + i) % len(papers)]
                drawn = (draw(number, seed + 4, WRITERS) for number in itertools.count(k))
                drawing = next(filter(PAPERS[name].shows, drawn))
                if judge(drawing).wrong:
                    continue
                data, seen = photographed(drawing, PAPERS[name], np.random.default_rng([seed, k, i]))
                j = judge(seen, data)
                tally[name].append(j)
                if j.wrong:
                    self.show(
                        f"{name} {seen.name} {k}".replace(" ", "-"), j.recognition, j.wrong, seen.bodies
                    )
        for name, judged in tally.items():
            right = sum(not j.wrong for j in judged)
            cpu = 1e3 * float(np.mean([j.seconds for j in judged] or [0.0]))
            reasons = Counter(_reason(w) for j in judged for w in j.wrong[:1])
            said = "; ".join(f"{text} ({n})" for text, n in reasons.most_common(2))
            print(f"  {name:<30}{rate(right, len(judged))}{cpu:7.0f} ms  {said}")
        every = [j for judged in tally.values() for j in judged]
        print(f"  {'all':<30}{rate(sum(not j.wrong for j in every), len(every))}")

    def careless(self, count: int, seed: int) -> None:
        """Made-up shapes one by one, drawn carelessly: by what was drawn, and by how."""
        tables: dict[str, Counter[str]] = defaultdict(Counter)
        ways: dict[str, Counter[bool]] = defaultdict(Counter)
        every = [(name, way, k) for name in SHAPES for way in CARELESS for k in range(count)]
        for name, way, k in self.each(every, "careless shapes"):
            rng = np.random.default_rng([seed, k, zlib.crc32(f"{name}{way}".encode())])
            page = Drawing(writer(0), np.random.default_rng(1))
            if name == "X":
                page.box(640, 360, 520, 420)
            first = len(page.strokes)
            page.strokes += draw_shape(name, way, k % WRITERS, rng)
            got, recognition = _read(page.sketch.strokes, first)
            tables[name][got] += 1
            ways[way][got == SHAPES[name]] += 1
            if got != SHAPES[name]:
                self.show(f"careless-{name}-{way}-{k}", recognition, [f"{way}: it was read as {got}"])
        print(f"\nmade-up shapes one by one, drawn carelessly by {WRITERS} writers, seed {seed}")
        for name, table in tables.items():
            others = ", ".join(f"{k} {v}" for k, v in table.most_common() if k != SHAPES[name])
            print(f"  {name:<28}{rate(table[SHAPES[name]], sum(table.values()))}  {others}")
        for way, t in ways.items():
            print(f"    {way:<26}{rate(t[True], sum(t.values()))}")
        right = sum(t[True] for t in ways.values())
        print(f"  {'all':<28}{rate(right, len(every))}")

    # ------------------------------------------------------------ real ink

    def isolated(self, folder: Path) -> None:
        tables: dict[tuple[str, str, str], Counter[str]] = defaultdict(Counter)
        strays: dict[str, Counter[str]] = defaultdict(Counter)
        pairs: list[tuple[float, bool]] = []
        base = draw(3, 5, WRITERS)  # a stack of boxes
        while judge(base).wrong:
            base = draw(int(base.rng.integers(10_000)) * len(KINDS) + 3, 5, WRITERS)
        for sample in self.each(list(corpus.samples(folder)), "shapes of the corpus"):
            name = f"{sample.source}-{sample.label}-{sample.name}"
            if sample.meant is None:
                place = _placed(sample.strokes, _free_place(base), 110.0)
                drawing = replace(base, strokes=[*base.strokes, *place])
                strokes = range(len(base.strokes), len(drawing.strokes))
                _count_strays(self, strays[f"{sample.source} {sample.label}"], drawing, strokes, name)
                continue
            if sample.source.startswith("fca") and sample.meant == "gravity":
                continue  # routed, with bends
            got, recognition = _alone(sample)
            tables[sample.source, sample.label, sample.meant][got] += 1
            if (
                zlib.crc32(f"{sample.source}{sample.writer}".encode()) % 2
            ):  # the scores were fitted on the others
                pairs.append((max(recognition.readings, key=lambda r: r.gain).score, got == sample.meant))
            if got != sample.meant:
                self.show(name, recognition, [f"{sample.meant} was read as {got}"])
        print("\nshapes of the corpus, one by one")
        right = total = 0
        for (source, label, meant), table in sorted(tables.items()):
            n = sum(table.values())
            right, total = right + table[meant], total + n
            others = ", ".join(f"{k} {v}" for k, v in table.most_common() if k != meant)
            print(f"  {source:<14}{label:<14}{rate(table[meant], n)}  {others}")
        print(f"  {'all':<28}{rate(right, total)}")
        _reliability(pairs)
        _print_strays("ink of the corpus outside the vocabulary, on a good sketch", strays)

    def composed(self, folder: Path, seed: int) -> None:
        drawings = corpus.composed(folder, COMPOSED, seed)
        judged = []
        for k, drawing in enumerate(self.each(drawings, "composed sketches")):
            j = judge(drawing)
            judged.append(j)
            if j.wrong:
                self.show(f"composed-{drawing.name}-{k}", j.recognition, j.wrong, drawing.bodies)
        print(f"\nsketches composed of the corpus' ink, seed {seed}")
        _whole(judged)
        _kinds(judged)
        _confusion(judged)
        _reliability(_scores(judged))


# ---------------------------------------------------------------- tables


def _whole(judged: list[Judged]) -> None:
    right = sum(not j.wrong for j in judged)
    shares = [share for j in judged for _, share in j.hits.values()]
    times = [1e3 * j.seconds for j in judged]
    print(f"  {'wholly right':<28}{rate(right, len(judged))}")
    print(f"  {'mean overlap of bodies':<28}{np.mean(shares):14.3f}")
    strokes = np.mean([len(j.drawing.strokes) for j in judged])
    print(f"  {'CPU of a sketch':<28}{np.mean(times):11.1f} ms, of {strokes:.1f} strokes")


def _kinds(judged: list[Judged]) -> None:
    by_kind: dict[str, list[Judged]] = defaultdict(list)
    for j in judged:
        by_kind[j.drawing.name].append(j)
    for name, group in sorted(by_kind.items()):
        reasons = Counter(_reason(w) for j in group for w in j.wrong[:1])
        said = "; ".join(f"{text} ({n})" for text, n in reasons.most_common(2))
        print(f"    {name.replace('_', ' '):<26}{rate(sum(not j.wrong for j in group), len(group))}  {said}")


def _reason(text: str) -> str:
    return " ".join(
        "n" if any(c.isdigit() for c in word) and "side" not in text else word for word in text.split()
    )


def _class(body: Body) -> str:
    if isinstance(body.shape, Circle):
        return "circle"
    sides = len(body.shape.vertices) if isinstance(body.shape, Polygon) else 4
    return str(sides) if sides <= 6 else "more"


def _confusion(judged: list[Judged]) -> None:
    columns = ("circle", "3", "4", "5", "6", "more", "missing")
    table: dict[str, Counter[str]] = defaultdict(Counter)
    for j in judged:
        for i, meant in enumerate(j.drawing.bodies):
            row = meant.kind if meant.kind in ("circle", "round", "bar") else f"{meant.sides} sides"
            hit = j.hits.get(i)
            table[row]["missing" if hit is None else _class(j.recognition.scene.bodies[hit[0]])] += 1
        table["nothing"]["invented"] += len(j.recognition.scene.bodies) - len(j.hits)
    print(f"    {'drawn, read as':<16}" + "".join(f"{c:>9}" for c in columns))
    for row, counts in sorted(table.items()):
        if row != "nothing":
            print(f"    {row:<16}" + "".join(f"{counts[c] or '.':>9}" for c in columns))
    print(f"    bodies invented: {table['nothing']['invented']}")


def _scores(judged: list[Judged]) -> list[tuple[float, bool]]:
    """Of each body that was read its score, and whether it is right."""
    pairs = []
    for j in judged:
        back = {found: i for i, (found, _) in j.hits.items()}
        for k, body in enumerate(j.recognition.scene.bodies):
            good = k in back and j.drawing.bodies[back[k]].is_read_as(body)
            pairs.append((body.score or 0.0, good))
    return pairs


def _reliability(pairs: list[tuple[float, bool]]) -> None:
    """Of the readings with a score in some range, how many are right."""
    scores, good = np.array([s for s, _ in pairs]), np.array([g for _, g in pairs])
    print(f"    {'score':<16}{'readings':>9}{'mean':>9}{'right':>9}")
    for low, high in itertools.pairwise(BINS):
        within = (scores >= low) & ((scores < high) | (high == 1.0))
        if within.any():
            share = f"{100 * good[within].mean():8.1f}%"
            print(
                f"    {f'{low:g} to {high:g}':<16}{within.sum():9}{100 * scores[within].mean():8.1f}%{share}"
            )
    brier = float(np.mean((scores - good) ** 2))
    print(f"    Brier score {brier:.4f}; {np.mean(good) * (1 - np.mean(good)):.4f} if each said the mean")


def _count_strays(bench: Bench, tally: Counter[str], drawing: Drawing, strokes: range, name: str) -> None:
    j = judge(drawing)
    scene, stray = j.recognition.scene, set(strokes)
    invented = [b for b in scene.bodies if stray & set(b.strokes or [])]
    others = [w for w in j.wrong if not any(w.startswith(b.id + " ") for b in invented)]
    read = {s for r in j.recognition.readings if r.kind != "unread" for s in r.strokes}
    named = set().union(*(r.strokes for r in j.recognition.readings if r.kind == "unread"))
    tally["count"] += 1
    tally["body"] += bool(invented)
    wrong = [b for b in invented if not is_as_drawn(drawing, scene, b)]
    tally["wrong"] += bool(wrong)
    tally["unsaid"] += not all(any(note.startswith(f"{b.id} ") for note in scene.notes) for b in wrong)
    tally["changed"] += bool(others)
    tally["silent"] += not stray <= read | named
    if invented or others:
        bench.show(f"stray-{name}", j.recognition, j.wrong, drawing.bodies)


def _print_strays(title: str, tally: dict[str, Counter[str]]) -> None:
    print(f"\n{title}: a body, of these not as it was drawn, and anything else changed")
    every: Counter[str] = Counter()
    for name, t in sorted(tally.items()):
        every.update(t)
        print(f"  {name:<28}{t['body']:5} {t['wrong']:5} {t['changed']:5} of {t['count']:4}")
    print(f"  {'a body':<28}{rate(every['body'], every['count'])}")
    print(f"  {'a body, and not as drawn':<28}{rate(every['wrong'], every['count'])}")
    print(f"  {'likewise, and unsaid':<28}{rate(every['unsaid'], every['count'])}")
    print(f"  {'anything else changed':<28}{rate(every['changed'], every['count'])}")
    print(f"  {'neither read nor named':<28}{rate(every['silent'], every['count'])}")


# ---------------------------------------------------------------- what must not change a reading


def _turned(drawing: Drawing, rng: np.random.Generator) -> Drawing:
    angle = float(rng.uniform(0, 2 * math.pi))
    c, s = math.cos(angle), math.sin(angle)
    return drawing.moved(lambda p: p @ np.array([[c, s], [-s, c]]), angle)


def _shuffled(drawing: Drawing, rng: np.random.Generator) -> Drawing:
    return replace(drawing, strokes=[drawing.strokes[i] for i in rng.permutation(len(drawing.strokes))])


def _points(count: int) -> Callable[[Drawing, np.random.Generator], Drawing]:
    return lambda drawing, _: replace(drawing, strokes=[resampled(s, count) for s in drawing.strokes])


CHANGES: dict[str, Callable[[Drawing, np.random.Generator], Drawing]] = {
    "strokes in another order": _shuffled,
    "strokes reversed": lambda d, _: replace(d, strokes=[s[::-1] for s in d.strokes]),
    "0.3 times as large": lambda d, _: d.moved(lambda p: 0.3 * p),
    "4 times as large": lambda d, _: d.moved(lambda p: 4 * p),
    "turned by any angle": _turned,
    "10 points a stroke": _points(10),
    "400 points a stroke": _points(400),
}


# ---------------------------------------------------------------- pages


def _free_place(drawing: Drawing) -> tuple[float, float]:
    """The place of the page that is farthest from all ink [pixels]."""
    ink = np.concatenate(drawing.strokes)
    places = [(float(x), float(y)) for x in range(90, 1240, 46) for y in range(90, 660, 38)]
    return max(places, key=lambda at: float(np.hypot(*(ink - at).T).min()))


def _placed(strokes: list[Array], at: tuple[float, float], size: float) -> list[Array]:
    ink = np.concatenate(strokes)
    low, span = ink.min(axis=0), np.ptp(ink, axis=0)
    return [(s - low - span / 2) * (size / span.max()) + at for s in strokes]


def _alone(sample: corpus.Sample) -> tuple[str, Recognition]:
    """What a sample is read as on a page of its own; an X within a box, as it means nothing elsewhere."""
    drawing = Drawing(writer(0), np.random.default_rng(1))
    anchor = sample.meant == "anchor"
    if anchor:
        drawing.box(640, 360, 520, 420)
    first = len(drawing.strokes)
    strokes = [
        Stroke(s) for s in [*drawing.strokes, *_placed(sample.strokes, (640, 360), 150 if anchor else 300)]
    ]
    return _read(strokes, first)


def _read(strokes: list[Stroke], first: int) -> tuple[str, Recognition]:
    """What strokes from the first on are read as, on a page of 1280 by 720 pixels: named and joined by +.

    A tap of the pen that is left out, and named, is no miss.
    """
    recognition = recognize(Sketch(strokes, 1280.0, 720.0))
    tap = TAP * _extent([s.points for s in strokes[first:]])
    found = [
        _kind(r.kind, len(r.outline))
        for r in recognition.readings
        if max(r.strokes) >= first
        and not (r.kind == "unread" and _extent([strokes[k].points for k in r.strokes]) < tap)
    ]
    return " + ".join(sorted(found)), recognition


def _extent(strokes: list[Array]) -> float:
    return float(np.hypot(*np.ptp(np.concatenate(strokes), axis=0)))


def _kind(kind: str, sides: int) -> str:
    if kind in ("rectangle", "polygon"):
        return str(sides) if sides < 8 else "round"
    return kind
