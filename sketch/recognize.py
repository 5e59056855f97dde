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
from sketch.context import Context
from sketch.cutting import things_in
from sketch.explain import explain
from sketch.ink import Sketch, Stroke
from sketch.interpret import interpret
from sketch.kernel import depth
from sketch.overrides import Overrides, forced_reading, normal_overrides
from sketch.pieces import Page
from sketch.placing import Placed, placed
from sketch.proposals import Proposals, Proposed, proposing
from sketch.reading import Reading, scored
from sketch.sampling import sampled
from sketch.scoring import Fitted
from sketch.search import Solved, best_packing

__all__ = ["Reading", "Recognition", "Recognizer", "recognize"]

Array = NDArray[np.float64]

SAME_PLACE = 0.2  # of a body's size: outlines nowhere further apart are one body, gone over
KINDS = {"ellipse": "polygon", "free": "polygon", "cross": "anchor", "arrow": "gravity"}
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
        self._canvas = sketch
        self._proposals = Proposals(math.hypot(sketch.width or 0.0, sketch.height or 0.0))
        self._context = Context()
        self._alone: Solved = {}
        self._together: Solved = {}
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
        things = [things_in(sampled(s.points)) for s in strokes]
        new = iter(self._proposals.add([part for parts in things for part in parts]))
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
        candidates, gains, chosen = self._explained(said)
        sketch = self.sketch
        number = {i: s for s, of in enumerate(pieces) for i in of}
        fits = [candidates[k] for k in chosen]
        page = self._proposals.page
        self._places = {c: self._places.get(c) or placed(page, c) for c in fits}
        readings = _readings(candidates, gains, chosen, number, self._places)
        read = {i for k in chosen for i in candidates[k].pieces}
        for i, stroke in enumerate(sketch.strokes):
            if not read.issuperset(pieces[i]):
                readings.append(Reading("unread", (i,), 0.0, stroke.points))
        for reading in readings:
            reading.forced = forced.get(reading.strokes)
        for strokes, kind in forced.items():
            for reading in readings:
                if kind == "ignore" and reading.kind == "unread" and reading.strokes[0] in strokes:
                    reading.forced = kind
        return Recognition(sketch, interpret(sketch, readings, scale, gravity, tidy), readings)

    def _explained(self, forced: Overrides) -> tuple[list[Fitted], list[float], list[int]]:
        """All candidates with their gains, and which of them explain the page best."""
        proposed = self._proposals.all()
        if forced:
            proposed = _with_forced(self._proposals.page, proposed, forced)
        candidates = [c for p in proposed for c in p.candidates]
        gains = [g for p in proposed for g in p.gains]
        likely = _best(candidates, gains, self._alone)
        gains = self._context.gains(proposed, candidates, likely, self._proposals.page.size)
        return candidates, gains, _one_a_place(candidates, gains, _best(candidates, gains, self._together))


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


def _best(candidates: list[Fitted], gains: list[float], solved: Solved) -> list[int]:
    """Indices of the disjoint candidates with the greatest total gain."""
    live = [k for k, gain in enumerate(gains) if gain > 0]
    chosen = best_packing([candidates[k].pieces for k in live], [gains[k] for k in live], solved)
    return [live[k] for k in chosen]


def _one_a_place(candidates: list[Fitted], gains: list[float], chosen: list[int]) -> list[int]:
    """The chosen, with bodies that were drawn over one another in full joined to the best of them.

    No two bodies have one place; that is known of the pair, and so after the search, which scores each by itself.
    """
    order = sorted(chosen, key=lambda k: -gains[k])
    closed = [k for k in order if candidates[k].closed]
    scale = np.array([candidates[k].scale for k in closed])
    at = np.array([candidates[k].middle for k in closed]).reshape(-1, 2)
    far = SAME_PLACE * np.maximum(scale, scale[:, None])
    close = np.abs(scale - scale[:, None]) <= far
    close &= np.abs(at[:, None] - at).max(axis=2, initial=0.0) <= far
    joined: dict[int, int] = {}  # into which reading another went
    now: dict[int, int] = {}  # what has become of a chosen reading
    for a, b in np.argwhere(np.triu(close, 1)).tolist():
        k, j = closed[a], closed[b]
        if k in joined or j in joined or not _same_place(candidates[j], candidates[now.get(k, k)]):
            continue
        joined[j] = k
        kept, other = candidates[now.get(k, k)], candidates[j]
        candidates.append(replace(kept, pieces=tuple(sorted((*kept.pieces, *other.pieces)))))
        gains.append(gains[now.get(k, k)] + gains[j])
        now[k] = len(candidates) - 1
    return [now.get(k, k) for k in order if k not in joined]


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


def _readings(
    candidates: list[Fitted],
    gains: list[float],
    chosen: list[int],
    number: dict[int, int],
    places: dict[Fitted, Placed],
) -> list[Reading]:
    """The chosen candidates, each with the other readings of the same ink as probabilities, in order of drawing.

    number: of each piece the stroke.  places: of each chosen candidate.
    """
    same: dict[tuple[int, ...], list[int]] = {candidates[k].pieces: [] for k in chosen}
    for k, c in enumerate(candidates):
        if c.pieces in same:
            same[c.pieces].append(k)
    readings = []
    for k in chosen:
        c = candidates[k]
        best: dict[str, float] = {"unread": 0.0}
        for j in same[c.pieces]:
            if _meaning(candidates[j]) != _meaning(c):
                kind = KINDS.get(candidates[j].kind, candidates[j].kind)
                best[kind] = max(best.get(kind, -math.inf), gains[j])
        kind = KINDS.get(c.kind, c.kind)
        rivals = {name: gain - gains[k] for name, gain in best.items()}
        score, others = scored(rivals)
        strokes = tuple(sorted({number[i] for i in c.pieces}))
        readings.append(
            Reading(
                kind,
                strokes,
                score,
                places[c].outline,
                others,
                gains[k],
                -max(rivals.values()),
                c.rough,
                places[c].error,
            )
        )
    return sorted(readings, key=lambda r: r.strokes)


def _meaning(c: Fitted) -> str | int:
    """What a reading says: a mark, a circle, or so many sides; a rectangle is a polygon of four."""
    if c.kind in ("rectangle", "polygon", "ellipse", "free"):
        return min(len(c.outline), MANY)
    return c.kind
