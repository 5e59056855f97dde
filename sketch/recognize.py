"""Ink → scene: readings of groups of strokes, scored, and the set of them that explains all the ink best.

What is optimized: the length of a description of the page.  Every reading of a group of ink says what the ink is in
fewer nats than saying the ink itself, point by point; that saving is its gain.  The answer is the set of readings, each
piece of ink in at most one, with the greatest total gain: no other set describes the page in fewer nats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.scene import Scene
from sketch import group, primitives
from sketch.ink import Sketch
from sketch.interpret import distance, inside, interpret
from sketch.pieces import Piece, cut_into_pieces
from sketch.primitives import Fitted
from sketch.reading import Reading
from sketch.search import best_packing

__all__ = ["Reading", "Recognition", "recognize"]

ANCHORS = 15.0  # nats that an X is likelier over a body than elsewhere
SLIP = 25.0  # nats that a short mark on an outline is a slip of the pen and no rod
SAME_PLACE = 60.0  # nats that an outline around another's place is the same body gone over, not a second one
DOT = 0.012  # of the page: nobody draws a smaller body
KINDS = {"ellipse": "polygon", "cross": "anchor", "arrow": "gravity"}


@dataclass(frozen=True, eq=False)
class Recognition:
    """A sketch as it was understood: the scene and the readings that it was made from."""

    sketch: Sketch
    scene: Scene
    readings: list[Reading]


def recognize(
    sketch: Sketch, *, scale: float | None = None, gravity: tuple[float, float] | None = None
) -> Recognition:
    """Read a sketch.

    Args:
        sketch: the ink.
        scale: [pixels per metre], overriding the sketch's own.
        gravity: [m/s²], y up, overriding the arrow's.
    """
    pieces = cut_into_pieces(sketch)
    candidates = _candidates(pieces)
    free = [primitives.unread(p) for p in pieces]
    gains = [sum(free[i] for i in c.pieces) - c.cost for c in candidates]
    gains = _with_context(candidates, gains, _best(candidates, gains), pieces)
    chosen = _best(candidates, gains)
    readings = [_reading(k, candidates, gains, pieces) for k in chosen]
    readings.sort(key=lambda r: r.strokes)
    read = {s for r in readings for s in r.strokes}
    for i, stroke in enumerate(sketch.strokes):
        if i not in read:
            readings.append(Reading("unread", (i,), 0.0, stroke.points))
    scene, readings = interpret(sketch, readings, scale, gravity)
    return Recognition(sketch, scene, readings)


def _candidates(pieces: list[Piece]) -> list[Fitted]:
    least_axis = 3.0
    out: list[Fitted] = []
    complete = set()
    for i, piece in enumerate(pieces):
        if piece.gap < 0.2 * piece.length:
            fits = primitives.closed(pieces, [(i, False)], least_axis)
            loop = piece.scale > 0.2 * piece.extent
            if loop or min(f.cost for f in fits) < 0.6 * primitives.unread(piece):
                complete.add(i)
    for chain in group.closing_chains(pieces, complete):
        found = primitives.closed(pieces, chain, least_axis)
        out += found
        out += _gone_over(found, pieces)
    for i, piece in enumerate(pieces):
        line = primitives.bar(i, piece)
        if line:
            out.append(line)
    for names in group.crossing_pairs(pieces):
        found = primitives.cross(pieces, names)
        if found:
            out.append(found)
    for names, tail, tip in group.arrow_groups(pieces):
        found = primitives.arrow(pieces, names, np.asarray(tail), np.asarray(tip))
        if found:
            out.append(found)
    return out


def _gone_over(found: list[Fitted], pieces: list[Piece]) -> list[Fitted]:
    """The readings of a chain with the other pieces that run along its outline as drawn once more."""
    best = min(found, key=lambda f: f.cost)
    costs = {j: primitives.absorb(best, pieces, j) for j in range(len(pieces)) if j not in best.pieces}
    for j in costs:
        if pieces[j].gap < 0.2 * pieces[j].length:
            costs[j] -= SAME_PLACE
    again = [j for j, cost in costs.items() if cost < primitives.unread(pieces[j])]
    if not again:
        return []
    sets = [again] if len(again) == 1 else [again, *([j] for j in again)]
    return [
        replace(f, pieces=tuple(sorted((*f.pieces, *more))), cost=f.cost + sum(costs[j] for j in more))
        for f in found
        for more in sets
    ]


def _best(candidates: list[Fitted], gains: list[float]) -> list[int]:
    live = [k for k, gain in enumerate(gains) if gain > 0]
    chosen = best_packing([frozenset(candidates[k].pieces) for k in live], [gains[k] for k in live])
    return [live[k] for k in chosen]


def _with_context(
    candidates: list[Fitted], gains: list[float], chosen: list[int], pieces: list[Piece]
) -> list[float]:
    """The gains, given the bodies that the ink alone makes likely: context is told last and decides what is close."""
    gains = list(gains)
    solid = ("circle", "ellipse", "rectangle", "polygon")
    bodies = [candidates[k] for k in chosen if candidates[k].kind in solid]
    lo = np.min([p.box[:2] for p in pieces], axis=0)
    hi = np.max([p.box[2:] for p in pieces], axis=0)
    dot = DOT * float(np.hypot(*(hi - lo)))
    sizes = [(c, float(np.hypot(*np.ptp(c.outline, axis=0)))) for c in bodies]
    for k, c in enumerate(candidates):
        if gains[k] < -2 * ANCHORS:
            continue
        centre = c.outline.mean(axis=0)
        others = [(b, size) for b, size in sizes if set(b.pieces).isdisjoint(c.pieces)]
        size = float(np.hypot(*np.ptp(c.outline, axis=0)))
        if size < dot:  # where the pen rested
            gains[k] -= 0.5 * (math.log(dot / max(size, 1e-9)) / 0.1) ** 2
        if c.kind == "cross":
            gains[k] += ANCHORS if any(inside(centre, b.outline) for b, _ in others) else -2 * ANCHORS
        elif c.kind == "arrow":
            gains[k] -= ANCHORS * any(inside(centre, b.outline) for b, _ in others)
        elif c.kind == "bar":
            # a short mark that touches an outline is its writer's slip, not a rod
            if any(
                size < 0.5 * large and min(distance(c.outline[e], b.outline) for e in (0, -1)) < 0.1 * large
                for b, large in others
            ):
                gains[k] -= SLIP
        elif c.kind == "circle":
            under = [
                b
                for b, large in others
                if large > 3 * size and (distance(centre, b.outline) < size / 2 or inside(centre, b.outline))
            ]
            if len({b.pieces for b in under}) > 1:
                gains[k] += ANCHORS
    return gains


def _reading(k: int, candidates: list[Fitted], gains: list[float], pieces: list[Piece]) -> Reading:
    """The chosen candidate with the others of the same ink, as probabilities."""
    same = {k: gains[k]}
    for j, c in enumerate(candidates):
        if c.pieces == candidates[k].pieces:
            same[j] = gains[j]
    top = max(same.values())
    weight: dict[str, float] = {}
    for j, gain in same.items():
        kind = KINDS.get(candidates[j].kind, candidates[j].kind)
        weight[kind] = weight.get(kind, 0.0) + math.exp(max(gain - top, -50.0))
    total = sum(weight.values())
    c = candidates[k]
    kind = KINDS.get(c.kind, c.kind)
    others = sorted(((n, w / total) for n, w in weight.items() if n != kind), key=lambda t: -t[1])
    strokes = tuple(sorted({pieces[i].stroke for i in c.pieces}))
    return Reading(kind, strokes, weight[kind] / total, c.outline, others)
