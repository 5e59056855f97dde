"""Ink → scene: readings of groups of strokes, scored, and the set of them that explains all the ink best.

What is optimized: the length of a description of the page. Every reading of a group of ink says what the
ink is in fewer nats than saying the ink itself, point by point; that saving is its gain (`sketch.scoring`).
The answer is the set of readings, each piece of ink in at most one, with the greatest total gain, found
exactly (`sketch.search`): no other set of the readings at hand describes the page in fewer nats. It is
found twice: first from the ink alone, then with what the bodies of the first answer say about the marks on
and around them (`sketch.context`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from sim.scene import Scene
from sketch.context import with_context
from sketch.explain import explain
from sketch.grouping import arrow_groups, closing_chains, crosses
from sketch.ink import Sketch
from sketch.interpret import interpret
from sketch.kernel import depth
from sketch.marks import read_arrow, read_bar, read_cross, with_strays
from sketch.outlines import gone_over, read_outline
from sketch.overrides import Overrides, forced_reading, normal_overrides
from sketch.pieces import Page, page_of
from sketch.reading import Reading
from sketch.scoring import Fitted, unread
from sketch.search import best_packing

__all__ = ["Reading", "Recognition", "recognize"]

PLAIN = 0.5  # of the nats of its free ink: an outline said in less is tried as nothing else
SAME_PLACE = 0.2  # of a body's size: outlines nowhere further apart are one body, gone over
KINDS = {"ellipse": "polygon", "free": "polygon", "cross": "anchor", "arrow": "gravity"}


FORCED = 1e6  # nats that a reading gains by having been said by the caller


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
) -> Recognition:
    """Read a sketch.

    Args:
        sketch: the ink.
        scale: [pixels per metre], overriding the sketch's own.
        gravity: [m/s²], y up, overriding the arrow's.
        overrides: what some strokes are, as ``{(3, 4): "anchor", 7: "ball", 9: "ignore"}``: one of
            `sketch.overrides.KINDS`; the rest is read around them.
    """
    forced = normal_overrides(overrides, len(sketch.strokes))
    page = page_of(sketch)
    candidates = read_groups(page)
    free = [unread(p) for p in page.pieces]
    gains = [sum(free[i] for i in c.pieces) - c.cost for c in candidates]
    if forced:
        candidates, gains = _with_forced(page, candidates, gains, forced)
    likely = _best(candidates, gains)
    size = max(page.size, math.hypot(sketch.width or 0.0, sketch.height or 0.0))
    gains = with_context(candidates, gains, likely, size)
    chosen = _one_a_place(candidates, gains, _best(candidates, gains))
    readings = _readings(page, candidates, gains, chosen)
    read = {s for r in readings for s in r.strokes}
    for i, stroke in enumerate(sketch.strokes):
        if i not in read:
            readings.append(Reading("unread", (i,), 0.0, stroke.points))
    for reading in readings:
        reading.forced = forced.get(reading.strokes)
    for strokes, kind in forced.items():
        for reading in readings:
            if kind == "ignore" and reading.kind == "unread" and reading.strokes[0] in strokes:
                reading.forced = kind
    scene = interpret(sketch, readings, scale, gravity)
    return Recognition(sketch, scene, readings)


def _with_forced(
    page: Page, candidates: list[Fitted], gains: list[float], forced: Overrides
) -> tuple[list[Fitted], list[float]]:
    """The candidates that leave the forced strokes alone, and the forced readings."""
    taken = {s for strokes in forced for s in strokes}
    free = [k for k, c in enumerate(candidates) if not any(page.pieces[i].stroke in taken for i in c.pieces)]
    found = [forced_reading(page, strokes, kind) for strokes, kind in forced.items()]
    extra = [f for f in found if f is not None]
    return [candidates[k] for k in free] + extra, [gains[k] for k in free] + [FORCED] * len(extra)


# ---------------------------------------------------------------- candidates


def read_groups(page: Page) -> list[Fitted]:
    """Every reading of every group of pieces that lie together."""
    out: list[Fitted] = []
    complete, plain = set(), set()  # pieces that close by themselves; and those that look like nothing else
    single = {}
    for p in page.pieces:
        if p.gap < 0.2 * p.length:
            single[p.index] = read_outline(page, [(p.index, False)])
            best = min(single[p.index], key=lambda f: f.cost)
            loop = p.gap < 0.12 * p.length and p.scale > 0.2 * p.extent
            if best.gap < 0.1 and (loop or best.cost < 0.6 * unread(p)):
                complete.add(p.index)
                if best.cost < PLAIN * unread(p):
                    plain.add(p.index)
    outlines = []
    for chain in closing_chains(page, complete):
        alone = single.get(chain[0][0]) if len(chain) == 1 else None
        outlines.append(alone or read_outline(page, chain))
    for found in outlines:
        out += found
        out += _gone_over(page, found)
    for p in page.pieces:
        out += _kept(read_bar(p))
    free = [unread(p) for p in page.pieces]
    for names in crosses(page, plain):
        for cross in _kept(read_cross(page, names)):
            out += [cross, *with_strays(page, cross, free)]
    arrows: dict[tuple[int, ...], Fitted] = {}
    for names, tail, toward in arrow_groups(page, plain):
        arrow = read_arrow(page, names, tail, toward)
        for mark in [arrow, *with_strays(page, arrow, free)] if arrow else []:
            if mark.pieces not in arrows or mark.cost < arrows[mark.pieces].cost:
                arrows[mark.pieces] = mark
    out += arrows.values()
    return out


def _kept(found: Fitted | None) -> list[Fitted]:
    return [] if found is None else [found]


def _gone_over(page: Page, found: list[Fitted]) -> list[Fitted]:
    """The readings of an outline together with the other pieces that run along it, as drawn once more."""
    best = min(found, key=lambda f: f.cost)
    costs: dict[int, float] = {}
    for p in page.within(best.outline, 0.3 * best.scale):
        if p.index in best.pieces or not page.apart(p.index, best.pieces):
            continue
        cost = gone_over(page, best, p.index)
        if cost < unread(p):
            costs[p.index] = cost
    sets = [tuple(costs)] if costs else []
    if len(costs) > 1:
        sets += [(j,) for j in costs]
    return [
        replace(f, pieces=tuple(sorted((*f.pieces, *more))), cost=f.cost + sum(costs[j] for j in more))
        for f in found
        for more in sets
    ]


# ---------------------------------------------------------------- the best explanation


def _best(candidates: list[Fitted], gains: list[float]) -> list[int]:
    """Indices of the disjoint candidates with the greatest total gain."""
    live = [k for k, gain in enumerate(gains) if gain > 0]
    chosen = best_packing([frozenset(candidates[k].pieces) for k in live], [gains[k] for k in live])
    return [live[k] for k in chosen]


def _one_a_place(candidates: list[Fitted], gains: list[float], chosen: list[int]) -> list[int]:
    """The chosen, with bodies that were drawn over one another in full joined to the best of them.

    No two bodies have one place; that is known of the pair, and so after the search, which scores each by itself.
    """
    out: list[int] = []
    for k in sorted(chosen, key=lambda k: -gains[k]):
        c = candidates[k]
        twin = next((j for j in out if _same_place(c, candidates[j])), None)
        if twin is None:
            out.append(k)
            continue
        kept = candidates[twin]
        both = replace(kept, pieces=tuple(sorted((*kept.pieces, *c.pieces))))
        candidates.append(both)
        gains.append(gains[twin] + gains[k])
        out[out.index(twin)] = len(candidates) - 1
    return out


def _same_place(a: Fitted, b: Fitted) -> bool:
    if not (a.closed and b.closed) or abs(a.scale - b.scale) > SAME_PLACE * max(a.scale, b.scale):
        return False
    if math.dist(a.outline.mean(axis=0), b.outline.mean(axis=0)) > SAME_PLACE * a.scale:
        return False
    return all(
        abs(depth(x, y, other.outline)) < SAME_PLACE * a.scale
        for one, other in ((a, b), (b, a))
        for x, y in one.outline.tolist()
    )


def _readings(page: Page, candidates: list[Fitted], gains: list[float], chosen: list[int]) -> list[Reading]:
    """The chosen candidates, each with the other readings of the same ink as probabilities, in order of
    drawing."""
    same: dict[tuple[int, ...], list[int]] = {}
    for k, c in enumerate(candidates):
        same.setdefault(c.pieces, []).append(k)
    readings = []
    for k in chosen:
        c = candidates[k]
        weight: dict[str, float] = {}
        for j in same[c.pieces]:
            kind = KINDS.get(candidates[j].kind, candidates[j].kind)
            weight[kind] = weight.get(kind, 0.0) + math.exp(min(max(gains[j] - gains[k], -50.0), 50.0))
        weight["unread"] = math.exp(-min(gains[k], 50.0))
        total = sum(weight.values())
        kind = KINDS.get(c.kind, c.kind)
        others = sorted(((n, w / total) for n, w in weight.items() if n != kind), key=lambda t: -t[1])
        strokes = tuple(sorted({page.pieces[i].stroke for i in c.pieces}))
        readings.append(Reading(kind, strokes, weight[kind] / total, c.outline, others, gains[k], c.rough))
    return sorted(readings, key=lambda r: r.strokes)
