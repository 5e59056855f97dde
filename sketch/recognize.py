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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sim.scene import InputError, Scene
from sketch.around.arrows import pointing
from sketch.around.context import Context, grounds, held_ends, linked
from sketch.around.writing import written
from sketch.explain import explain
from sketch.ink import Sketch, Stroke
from sketch.interpret import interpret
from sketch.kept import Kept
from sketch.merging import Chosen, merged
from sketch.overrides import Overrides, forced_reading, normal_overrides
from sketch.page.pieces import Page
from sketch.page.sampling import sampled
from sketch.patches import Likely, Patch, patches
from sketch.reading import Reading, Rival, scored
from sketch.scoring import Fitted
from sketch.search import Part, best, part
from sketch.shapes.cutting import things_in
from sketch.shapes.letters import Letter, Letters
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


@dataclass(frozen=True, eq=False)
class Recognition:
    """A sketch as it was understood: the scene and the readings that it was made from."""

    sketch: Sketch
    scene: Scene
    readings: list[Reading]

    def explain(self) -> str:
        """A person's account: each reading, from which strokes, why this and not the next."""
        return explain(self)


_Ways = Sequence[
    tuple[Proposed, tuple[float, ...]]
]  # with what each of it gains, given what is around it [nats]


class _Said(NamedTuple):
    """What is said of a reading: its probability, those of the others, what it gains more [nats], and where it is."""

    score: float
    others: list[tuple[str, float]]
    margin: float
    place: Placed


@dataclass(frozen=True, eq=False)
class _Settled:
    """What explains the ink of one patch best.

    Attributes:
        ways: what its pieces propose, what the caller says of it, and what it may be that is no part of the scene.
        said: of the best of these, each piece in one at most; None of what is no part of the scene.
    """

    ways: _Ways
    said: dict[Chosen, _Said | None]


@dataclass(frozen=True, eq=False)
class _Explanation:
    """What explains all the ink best.

    Attributes:
        patches: each by itself.  of: of each piece its patch.
        chosen: the best of all that is proposed, each piece in one at most.
        elsewhere: the pieces of arrows that mean something else than gravity.
    """

    patches: list[_Settled]
    of: dict[int, int]
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
    def made(self) -> int:
        """How many results were reckoned up to now that were not known: the work of reading, but for its bounds."""
        return self._kept.made

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
        page, kept, proposed = self._proposals.page, self._kept, self._proposals.all()
        said = None
        if forced:
            proposed, said = _with_forced(page, proposed, forced)
        # the strokes of a picture were chosen by what they mean else: pieces of a mark, not of a word
        letters = self._letters.possible(page, proposed) if self._canvas.picture is None else []
        more = [*(letter.proposed.ink for letter in letters), *([said.ink] if said else [])]
        every, at = patches(list(page.pieces), proposed, more, kept)
        of, count = dict(zip(page.pieces, at, strict=True)), len(every)
        ways = [[n] for n in range(count)]  # of each patch what it may be, and below which letters
        if said:
            ways[of[said.ink[0]]].append(count)
            every.append(Patch((said,)))
        written_there: list[list[Letter]] = [[] for _ in ways]
        for letter in letters:
            written_there[of[letter.proposed.ink[0]]].append(letter)
        sure = [[letter.proposed.alone for letter in there if not letter.marks] for there in written_there]
        parts = [patch.whole.alone for patch in every]
        likely = [kept(Likely, *its) for its in zip(every, _picked(kept, ways, parts, sure), strict=True)]
        held = held_ends(likely)
        if held:  # rods among what else looks like an outline, which else would tell of itself
            for n, lines in held.items():
                parts[n] = kept(linked, every[n], lines)
            likely = [kept(Likely, *its) for its in zip(every, _picked(kept, ways, parts, sure), strict=True)]
        for n, ground in grounds(likely).items():
            likely[n] = kept(Likely, every[n], (*likely[n].which, *ground))
        wholes = [patch.whole for patch in every]
        told = self._context.told(likely, held, page.size, page.drawn)
        told, elsewhere, pointers = pointing(page, likely, told, count, kept)
        left = (its for key, its in self._pieces.items() if self._strokes[key].remains)
        remains = frozenset(i for its in left for i in its)
        told = written(page, likely, told, elsewhere, remains, kept)
        settled = []
        for n, (own, there) in enumerate(zip(ways, written_there, strict=True)):
            aside = [t.proposed for t in there if not (t.marks and t.is_none(wholes[n], told[n]))]
            aside += [pointers[w] for w in own if w in pointers]
            its = *((wholes[w], tuple(told[w])) for w in own), *((p, tuple(p.gains)) for p in aside)
            settled.append(kept.through(_settled, page, *its))
        chosen = [c for patch in settled for c in patch.said]
        elsewhere = {i for c in chosen if c.fit.kind == "pointer" for i in c.fit.pieces}
        chosen = [c for c in chosen if c.fit.kind not in NO_PART]
        return _Explanation(settled, of, merged(chosen, kept), elsewhere)

    def _readings(self, best: _Explanation, stroke: Mapping[int, int]) -> list[Reading]:
        """What was chosen, each with the others of the same ink as probabilities. stroke: of each piece."""
        readings = []
        for c in best.chosen:
            its = best.patches[best.of[c.fit.pieces[0]]].said.get(c)
            if its is None:  # it was merged of several
                among = dict.fromkeys(best.patches[best.of[i]] for i in c.fit.pieces)
                its = self._kept(_said_among, self._proposals.page, c, *among)
            readings.append(
                Reading(
                    KINDS.get(c.fit.kind, c.fit.kind),
                    tuple(sorted({stroke[i] for i in c.fit.pieces})),
                    its.score,
                    its.place.outline,
                    list(its.others),
                    c.gain,
                    margin=its.margin,
                    rough=c.fit.rough,
                    error=its.place.error,
                    stray=its.place.stray,
                )
            )
        return readings


def _picked(
    kept: Kept, ways: list[list[int]], parts: list[Part], sure: list[list[Part]]
) -> list[tuple[int, ...]]:
    """Which of each patch explain its ink best, each ink in one.

    ways: of each patch what it may be.  parts: of each of those.  sure: letters that may be there.
    """
    picked: list[list[int]] = [[] for _ in parts]
    for own, there in zip(ways, sure, strict=True):
        for q, k in kept.through(best, *(parts[n] for n in own), *there):
            if q < len(own):
                picked[own[q]].append(k)
    return [tuple(ks) for ks in picked]


def _settled(kept: Kept, page: Page, *ways: tuple[Proposed, tuple[float, ...]]) -> _Settled:
    """The best set of readings of a patch, without what borrows a side of no body.

    A body lends its side, an arrow or an X none: that is known of the whole answer alone.
    """
    picks = _packed(kept, ways)
    for _ in range(LENDING):
        lost = _not_lent([ways[n][0].candidates[k] for n, k in picks])
        if not lost:
            break
        ways = tuple((p, _without(p, gains, lost) if p.borrowing else gains) for p, gains in ways)
        picks = _packed(kept, ways)
    chosen = [Chosen(ways[n][0].candidates[k], ways[n][1][k]) for n, k in picks]
    lost = _not_lent([c.fit for c in chosen])
    left = [c for c in chosen if c.fit.lender not in lost]
    return _Settled(ways, {c: None if c.fit.kind in NO_PART else _said(page, c, ways) for c in left})


def _packed(kept: Kept, ways: _Ways) -> list[Pick]:
    """The best set of readings, each ink in one."""
    return best(kept, *(part([c.pieces for c in p.candidates], gains) for p, gains in ways))


def _without(proposed: Proposed, gains: Sequence[float], lost: set[int]) -> tuple[float, ...]:
    """The gains, less for what borrows a side of some pieces."""
    return tuple(
        gain - NOT_LENT * (c.lender in lost) for c, gain in zip(proposed.candidates, gains, strict=True)
    )


def _not_lent(chosen: list[Fitted]) -> set[int]:
    """The pieces of which readings borrow a side while they are of no body."""
    solid = {i for c in chosen if c.kind not in ("cross", "arrow") for i in c.pieces}
    return {c.lender for c in chosen if c.lender >= 0} - solid


def _with_forced(
    page: Page, proposed: list[Proposed], forced: Overrides
) -> tuple[list[Proposed], Proposed | None]:
    """What leaves the forced strokes alone, and their forced readings, if there are any."""
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
    return out, proposing(extra, [FORCED] * len(extra)) if extra else None


# ---------------------------------------------------------------- readings of what was chosen


def _mark_forced(readings: list[Reading], forced: Overrides) -> None:
    """Note in readings what the caller said of their strokes."""
    ignored = {s for strokes, kind in forced.items() if kind == "ignore" for s in strokes}
    for reading in readings:
        reading.forced = forced.get(reading.strokes)
        if reading.kind == "unread" and reading.strokes[0] in ignored:
            reading.forced = "ignore"


def _said(page: Page, chosen: Chosen, ways: _Ways) -> _Said:
    """What is said of a reading, given all that its ink may mean."""
    rivals = _rivals(chosen, ways)
    return _Said(*scored(rivals), min(rival.behind for rival in rivals), placed(page, chosen.fit))


def _said_among(page: Page, chosen: Chosen, *patches: _Settled) -> _Said:
    """Likewise of one whose ink is in several patches."""
    return _said(page, chosen, [way for patch in patches for way in patch.ways])


def _rivals(chosen: Chosen, ways: _Ways) -> list[Rival]:
    """What the same ink as a reading's may mean else: of each meaning the best.

    ways: all that may be of its pieces, with the gains.
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
    for p, gains in ways:
        for k in p.of_ink.get(fit.pieces, ()):
            other, its = p.candidates[k], gains[k]
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
