"""Ink → scene: readings of groups of strokes, scored, and the set of them that explains all the ink best.

What is optimized: the length of a description of the page. Every reading of a group of ink says what the
ink is in fewer nats than saying the ink itself, point by point; that saving is its gain (`sketch.scoring`).
The answer is the set of readings, each piece of ink in at most one, with the greatest total gain, found
exactly (`sketch.search`): no other set of the readings at hand describes the page in fewer nats. It is
found twice: first from the ink alone, then with what the bodies of the first answer say about the marks on
and around them (`sketch.around.context`).

Readings depend on the ink around them alone (`sketch.shapes.proposals`). So a `Recognizer` that gets one stroke more
looks anew at its neighbourhood, and comes to the same scene as one that gets them all at once.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sim.scene import InputError, Scene
from sketch.around.arrows import pointing
from sketch.around.context import Context
from sketch.around.writing import written
from sketch.explain import explain
from sketch.ink import Sketch, Stroke
from sketch.interpret import interpret
from sketch.kept import Kept
from sketch.merging import Chosen, merged
from sketch.overrides import Overrides, forced_reading, normal_overrides
from sketch.page.pieces import Page
from sketch.page.sampling import sampled
from sketch.reading import Reading, Rival, scored
from sketch.scoring import Fitted
from sketch.search import Packing, Part, part
from sketch.shapes.cutting import things_in
from sketch.shapes.letters import Letters
from sketch.shapes.placing import Placed, placed
from sketch.shapes.proposals import Pick, Proposals, Proposed, proposing

__all__ = ["Reading", "Recognition", "Recognizer", "recognize"]

NO_PART = ("letter", "pointer")  # kinds of readings that are no part of the scene
KINDS = {
    "ellipse": "polygon",
    "free": "polygon",
    "cross": "anchor",
    "arrow": "gravity",
    **dict.fromkeys(NO_PART, "unread"),
}
LENDING = 3  # times, at most, that readings are chosen anew without the sides that no body lent
NOT_LENT = 1e3  # nats that these lose
FORCED = 1e6  # nats that a reading gains by having been said by the caller
MANY = 8  # sides from which on nobody counts them


_Gains = list[tuple[Proposed, list[float]]]  # of what some pieces proposed


@dataclass(frozen=True, eq=False)
class Recognition:
    """A sketch as it was understood: the scene and the readings that it was made from."""

    sketch: Sketch
    scene: Scene
    readings: list[Reading]

    def explain(self) -> str:
        """A person's account: each reading, from which strokes, why this and not the next."""
        return explain(self)


@dataclass(frozen=True, eq=False)
class _Explanation:
    """What explains all the ink best, and what it was chosen from.

    Attributes:
        proposed: by each piece in the order of drawing, then by the caller, then what is no part of the scene.
        told: the gains of all that was proposed, with what is around it [nats].
        chosen: the best of it, each piece in one at most.
        elsewhere: the pieces of arrows that mean something else than gravity.
    """

    proposed: list[Proposed]
    told: list[list[float]]
    chosen: list[Chosen]
    elsewhere: set[int]


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
        self._letters = Letters()
        self._kept = Kept()
        self._alone = Packing()
        self._together = Packing()
        # of each the gains with all that is around, and what the search makes of these
        self._parts: dict[Proposed, tuple[list[float], Part]] = {}
        self._places: dict[Fitted, Placed] = {}
        # of each reading, given what it and its rivals gain, its probability, theirs, and what it gains more
        self._scores: dict[Fitted, tuple[float, _Gains, float, list[tuple[str, float]], float]] = {}
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
        things = things_in([points for points, _ in ink])
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
        pieces = [self._pieces[key] for key in self._strokes]
        stroke = {i: s for s, of in enumerate(pieces) for i in of}
        best = self._explained({tuple(i for s in of for i in pieces[s]): kind for of, kind in forced.items()})
        sketch, page = self.sketch, self._proposals.page
        readings = sorted(self._readings(best, stroke), key=lambda r: r.strokes)
        read = {i for c in best.chosen for i in c.fit.pieces}
        for s, its in enumerate(sketch.strokes):
            if not read.issuperset(pieces[s]):
                readings.append(Reading("unread", (s,), 0.0, its.points))
        _mark_forced(readings, forced)
        boxes = page.strokes.measure[list(page.pieces), 1:5]
        wide = float((boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)).max()) if len(boxes) else 0.0
        scene = interpret(sketch, list(self._strokes), readings, scale, gravity, wide, self._kept, tidy)
        self._kept.forget()
        left = tuple(sorted({stroke[i] for i in best.elsewhere - read}))
        if left:
            arrow = Reading("unread", left, 0.0, np.empty((0, 2))).named
            scene.notes.append(f"{arrow}: an arrow at a body, or of axes, or with two heads is no gravity")
        return Recognition(sketch, scene, readings)

    def _explained(self, forced: Overrides) -> _Explanation:
        """What is proposed, and what of it explains all the ink best. forced: by their pieces."""
        proposed = self._proposals.all()
        if forced:
            proposed = _with_forced(self._proposals.page, proposed, forced)
        page = self._proposals.page
        # the strokes of a picture were chosen by what they mean else: pieces of a mark, not of a word
        letters = self._letters.possible(page, proposed) if self._canvas.picture is None else []
        sure = (letter.proposed for letter in letters if not letter.marks)
        likely = self._alone.best([p.alone for p in (*proposed, *sure)])
        likely = [pick for pick in likely if pick[0] < len(proposed)]
        told = self._context.told(proposed, likely, page.size, page.drawn)
        told, elsewhere, pointed = pointing(page, proposed, told, likely)
        left = (its for key, its in self._pieces.items() if self._strokes[key].remains)
        remains = frozenset(i for its in left for i in its)
        told = written(page, proposed, told, likely, elsewhere, remains)
        known = {i: (p.gains, gains) for i, p, gains in zip(page.pieces, proposed, told, strict=False)}
        aside = [*(letter.proposed for letter in letters if not letter.is_none(known)), pointed]
        proposed, told = [*proposed, *aside], [*told, *(p.gains for p in aside)]
        told, chosen = self._lending(proposed, told)
        elsewhere = {i for c in chosen if c.fit.kind == "pointer" for i in c.fit.pieces}
        chosen = [c for c in chosen if c.fit.kind not in NO_PART]
        return _Explanation(proposed, told, merged(chosen), elsewhere)

    def _lending(
        self, proposed: list[Proposed], told: list[list[float]]
    ) -> tuple[list[list[float]], list[Chosen]]:
        """The gains without what borrows a side of no body, and the best set of readings by them.

        A body lends its side, an arrow or an X none: that is known of the whole answer alone.
        """
        best = self._packed(proposed, told)
        for _ in range(LENDING):
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
        chosen = [Chosen(proposed[p].candidates[k], told[p][k]) for p, k in best]
        lost = _not_lent([c.fit for c in chosen])
        return told, [c for c in chosen if c.fit.lender not in lost]

    def _readings(self, best: _Explanation, stroke: Mapping[int, int]) -> list[Reading]:
        """What was chosen, each with the others of the same ink as probabilities. stroke: of each piece."""
        page = self._proposals.page
        self._places = {c.fit: self._places.get(c.fit) or placed(page, c.fit) for c in best.chosen}
        leads = {i: k for k, i in enumerate(page.pieces)}  # each piece proposes what its ink may be,
        further = defaultdict[tuple[int, ...], list[int]](list)  # and what comes after, of the same ink
        for k in range(len(leads), len(best.proposed)):
            for fit in best.proposed[k].candidates:
                further[fit.pieces].append(k)
        known, self._scores = self._scores, {}
        readings = []
        for c in best.chosen:
            by = (*map(leads.__getitem__, c.fit.pieces), *further[c.fit.pieces])
            gains = [(best.proposed[k], best.told[k]) for k in by]
            there = known.get(c.fit)
            if there is None or there[:2] != (c.gain, gains):
                rivals = _rivals(c, gains)
                there = c.gain, gains, *scored(rivals), min(rival.behind for rival in rivals)
            self._scores[c.fit] = there
            _, _, score, others, margin = there
            place = self._places[c.fit]
            readings.append(
                Reading(
                    KINDS.get(c.fit.kind, c.fit.kind),
                    tuple(sorted({stroke[i] for i in c.fit.pieces})),
                    score,
                    place.outline,
                    list(others),
                    c.gain,
                    margin=margin,
                    rough=c.fit.rough,
                    error=place.error,
                )
            )
        return readings

    def _packed(self, proposed: list[Proposed], told: list[list[float]]) -> list[Pick]:
        """The best set of readings, each ink in one, given what all of them gain."""
        known, self._parts = self._parts, {}
        for p, gains in zip(proposed, told, strict=True):
            there = known.get(p)
            if there is None or there[0] != gains:
                there = gains, p.alone if gains == p.gains else part([c.pieces for c in p.candidates], gains)
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


# ---------------------------------------------------------------- readings of what was chosen


def _mark_forced(readings: list[Reading], forced: Overrides) -> None:
    """Note in readings what the caller said of their strokes."""
    ignored = {s for strokes, kind in forced.items() if kind == "ignore" for s in strokes}
    for reading in readings:
        reading.forced = forced.get(reading.strokes)
        if reading.kind == "unread" and reading.strokes[0] in ignored:
            reading.forced = "ignore"


def _rivals(chosen: Chosen, proposed: list[tuple[Proposed, list[float]]]) -> list[Rival]:
    """What the same ink as a reading's may mean else: of each meaning the best.

    proposed: by its pieces, with the gains.
    """
    fit, gain = chosen
    own = _meaning(fit)
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
            if other.pieces == fit.pieces:
                meaning, (sides, more) = _meaning(other), other.next
                if meaning != own:
                    add(other.kind, meaning, gain - its, {fit.kind, other.kind} == {"circle", "ellipse"})
                if sides and min(sides, MANY) != own:
                    add("polygon", min(sides, MANY), gain - its + more)
    return list(best.values())


def _meaning(fit: Fitted) -> str | int:
    """What a reading says: a mark, a circle, or so many sides; a rectangle is a polygon of four."""
    if fit.kind in NO_PART:
        return "unread"
    if fit.kind in ("rectangle", "polygon", "ellipse", "free"):
        return min(len(fit.outline), MANY)
    return fit.kind
