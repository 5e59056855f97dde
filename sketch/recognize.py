"""Ink → scene: readings of groups of strokes, scored, and the set of them that explains all the ink best.

What is optimized: the length of a description of the page. Every reading of a group of ink says what the
ink is in fewer nats than saying the ink itself, point by point; that saving is its gain (`sketch.scoring`).
The answer is the set of readings, each piece of ink in at most one, with the greatest total gain, found
exactly (`sketch.search`): no other set of the readings at hand describes the page in fewer nats. It is
found twice: first from the ink alone, then with what the bodies of the first answer say about the marks on
and around them (`sketch.context`).

Readings depend on the ink around them alone (`sketch.proposals`). So a `Recognizer` that gets one stroke more
looks anew at its neighbourhood, and comes to the same scene as one that gets them all at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.scene import InputError, Scene
from sketch.arrows import pointing
from sketch.context import Context, Pick
from sketch.cutting import things_in
from sketch.explain import explain
from sketch.ink import Sketch, Stroke
from sketch.interpret import interpret
from sketch.kernel import depth
from sketch.marks import ASIDE, LIFT
from sketch.overrides import Overrides, forced_reading, normal_overrides
from sketch.pieces import Page
from sketch.placing import Placed, placed
from sketch.proposals import Proposals, Proposed, proposing
from sketch.reading import Reading, Rival, scored
from sketch.sampling import sampled
from sketch.scoring import Fitted
from sketch.search import Packing, Part, part
from sketch.writing import written

__all__ = ["Reading", "Recognition", "Recognizer", "recognize"]

Array = NDArray[np.float64]

SAME_PLACE = 0.2  # of a body's size: outlines nowhere further apart are one body, gone over
KINDS = {"ellipse": "polygon", "free": "polygon", "cross": "anchor", "arrow": "gravity"}
LENDING = 3  # times, at most, that readings are chosen anew without the sides that no body lent
NOT_LENT = 1e3  # nats that these lose
FORCED = 1e6  # nats that a reading gains by having been said by the caller
MANY = 8  # sides from which on nobody counts them


@dataclass(frozen=True, eq=False)
class Recognition:
    """A sketch as it was understood: the scene and the readings that it was made from."""

    sketch: Sketch
    scene: Scene
    readings: list[Reading]

    def explain(self) -> str:
        """A person's account: each reading, from which strokes, why this and not the next."""
        return explain(self)


def recognize(
    sketch: Sketch,
    *,
    scale: float | None = None,
    gravity: tuple[float, float] | None = None,
    overrides: Mapping[int | tuple[int, ...], str] | None = None,
    tidy: bool = False,
) -> Recognition:
    """Read a sketch.

    Args:
        sketch: the ink.
        scale: [pixels per metre], overriding the sketch's own.
        gravity: [m/s²], y up, overriding the arrow's.
        overrides: what some strokes are, as ``{(3, 4): "anchor", 7: "ball", 9: "ignore"}``: one of
            `sketch.overrides.KINDS`; the rest is read around them.
        tidy: whether to make near-level sides level, near-equal wheels equal, and what nearly touches touch.
    """
    return Recognizer(sketch).recognition(scale=scale, gravity=gravity, overrides=overrides, tidy=tidy)


class Recognizer:
    """A page that is read while it is drawn: strokes come and go, and the scene is the same as from scratch.

    ::

        page = Recognizer(Sketch([], width=1280, height=720))
        key = page.add(Stroke(points))      # at every pen-up
        page.recognition().scene
        page.remove(key)                    # undo
    """

    def __init__(self, sketch: Sketch) -> None:
        """sketch: the canvas, and the ink that is on it already."""
        if not isinstance(sketch, Sketch):
            raise TypeError(
                f"a Sketch is read, not a {type(sketch).__name__}; load_sketch makes one of a file"
            )
        self._canvas = sketch
        self._proposals = Proposals(math.hypot(sketch.width or 0.0, sketch.height or 0.0))
        self._context = Context()
        self._alone = Packing()
        self._together = Packing()
        # of each the gains with all that is around, and what the search makes of these
        self._parts: dict[Proposed, tuple[list[float], Part]] = {}
        self._places: dict[Fitted, Placed] = {}
        self._strokes: dict[int, Stroke] = {}
        self._pieces: dict[int, list[int]] = {}  # of each stroke the things drawn in it: mostly one
        self._count = 0
        if sketch.strokes:
            self._add(sketch.strokes)

    def add(self, stroke: Stroke) -> int:
        """Add a stroke, drawn last; returns a key to remove it by."""
        return self._add([stroke])[0]

    def _add(self, strokes: list[Stroke]) -> range:
        ink = [sampled(s.points) for s in strokes]
        things = [things_in(points) for points, _ in ink]
        given = [few for parts, (_, few) in zip(things, ink, strict=True) for _ in parts]
        new = iter(self._proposals.add([part for parts in things for part in parts], given))
        keys = range(self._count, self._count + len(strokes))
        self._count = keys.stop
        for key, stroke, parts in zip(keys, strokes, things, strict=True):
            self._strokes[key] = stroke
            self._pieces[key] = [next(new) for _ in parts]
        return keys

    def remove(self, key: int) -> None:
        """Take back the stroke that `add` returned this key for; those of the first sketch have 0, 1, 2, ..."""
        if key not in self._strokes:
            raise InputError("key", f"there is no stroke {key}")
        del self._strokes[key]
        for piece in self._pieces.pop(key):
            self._proposals.remove(piece)

    @property
    def sketch(self) -> Sketch:
        """The canvas with all its strokes, in the order of drawing."""
        return replace(self._canvas, strokes=list(self._strokes.values()))

    def recognition(
        self,
        *,
        scale: float | None = None,
        gravity: tuple[float, float] | None = None,
        overrides: Mapping[int | tuple[int, ...], str] | None = None,
        tidy: bool = False,
    ) -> Recognition:
        """The page as it is now. The arguments are those of `recognize`; strokes count from 0 as they are now."""
        forced = normal_overrides(overrides, len(self._strokes))
        keys = list(self._strokes)
        pieces = [self._pieces[key] for key in keys]
        said = {tuple(i for s in strokes for i in pieces[s]): kind for strokes, kind in forced.items()}
        proposed, told, chosen, elsewhere = self._explained(said)
        sketch = self.sketch
        number = {i: s for s, of in enumerate(pieces) for i in of}
        page = self._proposals.page
        self._places = {c: self._places.get(c) or placed(page, c) for c, _ in chosen}
        leads = {i: k for k, i in enumerate(page.pieces)}
        others = range(len(leads), len(proposed))  # what was forced
        readings = []
        for c, gain in chosen:
            rivals = _rivals(
                c, gain, [(proposed[k], told[k]) for k in (*map(leads.__getitem__, c.pieces), *others)]
            )
            strokes = tuple(sorted({number[i] for i in c.pieces}))
            readings.append(_reading(c, gain, strokes, rivals, self._places[c]))
        readings.sort(key=lambda r: r.strokes)
        read = {i for c, _ in chosen for i in c.pieces}
        for i, stroke in enumerate(sketch.strokes):
            if not read.issuperset(pieces[i]):
                readings.append(Reading("unread", (i,), 0.0, stroke.points))
        for reading in readings:
            reading.forced = forced.get(reading.strokes)
        for strokes, kind in forced.items():
            for reading in readings:
                if kind == "ignore" and reading.kind == "unread" and reading.strokes[0] in strokes:
                    reading.forced = kind
        boxes = page.strokes.measure[list(page.pieces), 1:5]
        wide = float((boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)).max()) if len(boxes) else 0.0
        scene = interpret(sketch, readings, scale, gravity, wide, tidy)
        left = tuple(sorted({number[i] for i in elsewhere - read}))
        if left:
            arrow = Reading("unread", left, 0.0, np.empty((0, 2))).named
            scene.notes.append(f"{arrow}: an arrow at a body, or of axes, or with two heads is no gravity")
        return Recognition(sketch, scene, readings)

    def _explained(
        self, forced: Overrides
    ) -> tuple[list[Proposed], list[list[float]], list[tuple[Fitted, float]], set[int]]:
        """All that is proposed, with its gains; what of it explains the page best, likewise; and the pieces of arrows
        that point at something else than gravity."""
        proposed = self._proposals.all()
        if forced:
            proposed = _with_forced(self._proposals.page, proposed, forced)
        likely: list[Pick] = self._alone.best([p.alone for p in proposed])
        page = self._proposals.page
        told = self._context.told(proposed, likely, page.size, page.drawn)
        told, elsewhere = pointing(page, proposed, told, likely)
        told = written(page, proposed, told, likely, elsewhere)
        best = self._packed(proposed, told)
        for _ in range(LENDING):
            # a body lends its side, an arrow or an X none: that is known of the whole answer alone
            lost = _not_lent([proposed[p].candidates[k] for p, k in best])
            if not lost:
                break
            told = [
                [gain - NOT_LENT * (c.lender in lost) for c, gain in zip(p.candidates, gains, strict=True)]
                if p.borrowing
                else gains
                for p, gains in zip(proposed, told, strict=True)
            ]
            best = self._packed(proposed, told)
        chosen = [(proposed[p].candidates[k], told[p][k]) for p, k in best]
        lost = _not_lent([c for c, _ in chosen])
        chosen = [t for t in chosen if t[0].lender not in lost]
        return proposed, told, _whole_arrows(_one_a_place(chosen)), elsewhere

    def _packed(self, proposed: list[Proposed], told: list[list[float]]) -> list[Pick]:
        """The best set of readings, each ink in one, given what all of them gain."""
        known, self._parts = self._parts, {}
        for p, gains in zip(proposed, told, strict=True):
            there = known.get(p)
            if there is None or there[0] != gains:
                there = gains, part([c.pieces for c in p.candidates], gains)
            self._parts[p] = there
        return self._together.best([self._parts[p][1] for p in proposed])


def _not_lent(chosen: list[Fitted]) -> set[int]:
    """The pieces of which readings borrow a side while they are of no body."""
    solid = {i for c in chosen if c.kind not in ("cross", "arrow") for i in c.pieces}
    return {c.lender for c in chosen if c.lender >= 0} - solid


def _with_forced(page: Page, proposed: list[Proposed], forced: Overrides) -> list[Proposed]:
    """What leaves the forced strokes alone, and their forced readings."""
    taken = {s for strokes in forced for s in strokes}
    out = []
    for p in proposed:
        free = [k for k, c in enumerate(p.candidates) if taken.isdisjoint(c.pieces)]
        if len(free) < len(p.candidates):
            out.append(proposing([p.candidates[k] for k in free], [p.gains[k] for k in free]))
        else:
            out.append(p)
    found = [forced_reading(page, strokes, kind) for strokes, kind in forced.items()]
    extra = [f for f in found if f is not None]
    return [*out, proposing(extra, [FORCED] * len(extra))]


# ---------------------------------------------------------------- the best explanation


def _one_a_place(chosen: list[tuple[Fitted, float]]) -> list[tuple[Fitted, float]]:
    """The chosen and their gains, with bodies that were drawn over one another in full joined to the best of them.

    No two bodies have one place; that is known of the pair, and so after the search, which scores each by itself.
    """
    chosen = sorted(chosen, key=lambda t: -t[1])
    closed = [k for k, (c, _) in enumerate(chosen) if c.closed]
    scale = np.array([chosen[k][0].scale for k in closed])
    at = np.array([chosen[k][0].middle for k in closed]).reshape(-1, 2)
    far = SAME_PLACE * np.maximum(scale, scale[:, None])
    close = np.abs(scale - scale[:, None]) <= far
    close &= np.abs(at[:, None] - at).max(axis=2, initial=0.0) <= far
    joined: set[int] = set()  # those that went into another
    for a, b in np.argwhere(np.triu(close, 1)).tolist():
        k, j = closed[a], closed[b]
        kept, other = chosen[k], chosen[j]
        if k in joined or j in joined or not _same_place(other[0], kept[0]):
            continue
        joined.add(j)
        pieces = tuple(sorted((*kept[0].pieces, *other[0].pieces)))
        chosen[k] = replace(kept[0], pieces=pieces), kept[1] + other[1]
    return [chosen[k] for k in range(len(chosen)) if k not in joined]


def _whole_arrows(chosen: list[tuple[Fitted, float]]) -> list[tuple[Fitted, float]]:
    """The chosen and their gains, with arrows that were gone over joined, and shafts from which the pen was lifted.

    That is known of the pair, and so after the search, as of bodies.
    """
    arrows = [t for t in chosen if t[0].kind == "arrow"]
    others = [t for t in chosen if t[0].kind != "arrow"]
    whole: list[tuple[Fitted, float]] = []
    for arrow, gain in sorted(arrows, key=lambda t: -t[1]):
        ends = arrow.outline.tolist()
        for k, (kept, its) in enumerate(whole):
            its_ends = kept.outline.tolist()
            if max(map(math.dist, ends, its_ends)) < SAME_PLACE * math.dist(*its_ends):
                whole[k] = replace(kept, pieces=tuple(sorted((*kept.pieces, *arrow.pieces)))), its + gain
                break
        else:
            whole.append((arrow, gain))
    bars = [t for t in others if t[0].kind == "bar" and len(t[0].outline) == 2]
    at = np.array([bar.outline for bar, _ in bars]).reshape(-1, 2, 2)
    for k, (arrow, gain) in enumerate(whole):
        tail, tip = arrow.outline
        lift = np.hypot(*(at - tail).transpose(2, 0, 1)).min(axis=1)
        near = np.flatnonzero(lift < 1.001 * LIFT * np.hypot(*(at - tip).transpose(2, 0, 1)).max(axis=1))
        for bar in (bars[n] for n in near.tolist()):
            tail = _tail_beyond(arrow, bar[0])
            if tail is not None and bar in others:
                others.remove(bar)
                pieces = tuple(sorted((*arrow.pieces, *bar[0].pieces)))
                longer = replace(arrow, pieces=pieces, outline=np.array([tail, arrow.outline[1]]))
                whole[k] = longer, gain + bar[1]
                break
    return others + whole


def _tail_beyond(arrow: Fitted, bar: Fitted) -> Array | None:
    """The far end of a bar that goes on where an arrow's shaft begins, in line with it."""
    tail, tip = arrow.outline
    near, far = sorted(bar.outline, key=lambda end: math.dist(end, tail))
    shaft, whole = tip - tail, tip - far
    long = float(np.hypot(*whole))
    off = abs(whole[0] * shaft[1] - whole[1] * shaft[0]) / max(float(np.hypot(*shaft)), 1e-9)
    along = float((near - far) @ whole) / long
    goes_on = math.dist(near, tail) < LIFT * long and along > 0 and np.hypot(*shaft) < long
    return far if goes_on and off < ASIDE * long else None


def _same_place(a: Fitted, b: Fitted) -> bool:
    if abs(a.scale - b.scale) > SAME_PLACE * max(a.scale, b.scale):
        return False
    if math.dist(a.middle, b.middle) > SAME_PLACE * a.scale:
        return False
    return all(
        abs(depth(x, y, other.outline)) < SAME_PLACE * a.scale
        for one, other in ((a, b), (b, a))
        for x, y in one.outline.tolist()
    )


def _rivals(c: Fitted, gain: float, proposed: list[tuple[Proposed, list[float]]]) -> list[Rival]:
    """What the same ink as a reading's may mean else: of each meaning the best.

    proposed: by its pieces, with the gains.
    """
    own = _meaning(c)
    best: dict[tuple[str | int, bool], Rival] = {}

    def add(kind: str, meaning: str | int, less: float, alike: bool = False) -> None:
        there = best.get((meaning, alike))
        if less < (math.inf if there is None else there.behind):
            sides = kind == "polygon" and meaning != MANY
            its = f"polygon of {meaning} sides" if sides else KINDS.get(kind, kind)
            best[meaning, alike] = Rival(its, less, alike)

    add("unread", "unread", gain)
    for p, gains in proposed:
        for other, its in zip(p.candidates, gains, strict=True):
            if other.pieces == c.pieces:
                meaning, (sides, more) = _meaning(other), other.next
                if meaning != own:
                    add(other.kind, meaning, gain - its, {c.kind, other.kind} == {"circle", "ellipse"})
                if sides and min(sides, MANY) != own:
                    add("polygon", min(sides, MANY), gain - its + more)
    return list(best.values())


def _reading(c: Fitted, gain: float, strokes: tuple[int, ...], rivals: list[Rival], place: Placed) -> Reading:
    """A chosen reading, with the others of the same ink as probabilities."""
    score, others = scored(rivals)
    return Reading(
        KINDS.get(c.kind, c.kind),
        strokes,
        score,
        place.outline,
        others,
        gain,
        min(rival.behind for rival in rivals),
        c.rough,
        place.error,
    )


def _meaning(c: Fitted) -> str | int:
    """What a reading says: a mark, a circle, or so many sides; a rectangle is a polygon of four."""
    if c.kind in ("rectangle", "polygon", "ellipse", "free"):
        return min(len(c.outline), MANY)
    return c.kind
