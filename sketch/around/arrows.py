"""Which arrow is gravity: of several the likeliest on free paper. What begins at a body says how that moves, two from
one place are a pair of axes, and a line with a head at either end says how long something is."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from sketch.kept import Kept
from sketch.kernel import depths
from sketch.page.near import Boxes, boxes_around, overlap
from sketch.page.pieces import Page, Piece
from sketch.patches import Likely
from sketch.scoring import Fitted
from sketch.shapes.proposals import Pick, Proposed, proposing
from sketch.typing import Array, Box

__all__ = ["likeliest_arrow", "pointing", "prefer_arrow"]

# nats that the likeliest arrow is likelier than by its ink, and any other rarer: few pages have two
ONE_ARROW = 15.0
SECOND = 1.0  # nats that the likeliest arrow gains more than any other, however these are drawn
SURE = 40.0  # nats, at most, by which how well an arrow is drawn says that it is the likeliest
LONGEST = 10.0  # nats for each time that one is e times as long as another: what is beside a body is smaller
BESIDE = 40.0  # nats that an arrow is rarer that runs along a body or points at one
NEAR = 0.4  # of an arrow's length: as far from it a body has no part in what it means, nearer some of BESIDE
PLACES = np.linspace(0, 1, 5)[:, None]  # shares of its length at which it is asked how far off a body it is

# An arrow that begins at a body and points away says how that moves.
AT_BODY = 0.25  # of its length: as near to the body is its tail
AWAY = 0.7  # of its length: as much further from the body is its tip
ALONG = 0.5  # likewise where another arrow may be gravity: a velocity is drawn along what a body slides on

# Two arrows of one place, at a right angle, are a pair of axes.
SAME_TAIL = 0.2  # of the shorter one's length: as near to each other are their tails
ALIKE = 2.0  # times that one is as long as the other, at most
UPRIGHT = 0.4  # cosine of the angle between them, at most

# An arrow with a head at its tail too says how long something is.
MARK = 0.3  # of its length: strokes of that head are no larger
AT_TAIL = 0.05  # of its length: as near to the tail they come
SIDES = 0.015  # of its length: as far they reach to either side of it


def pointing(
    page: Page, every: Sequence[Likely], told: list[list[float]], by_ink: int, kept: Kept
) -> tuple[list[list[float]], set[int], dict[int, Proposed]]:
    """Gains, with one arrow likelier and the others rarer; the pieces of likely arrows that mean something else; and
    all that do, as pointers, with what they gain by their ink, by patch.

    every: what the ink makes likely of each patch.  told: the gains of all that is proposed.  by_ink: how many patches
    are not said by the caller.
    """
    proposed = [own.patch.whole for own in every]
    arrows = [(n, k) for n, p in enumerate(proposed[:by_ink]) for k in p.arrows if told[n][k] > -ONE_ARROW]
    if not arrows:
        return told, set(), {}
    likely = [(n, k) for n, own in enumerate(every) for k in own.which]
    found = dict(zip(arrows, _losses(page, every, arrows, kept), strict=True))
    others = (proposed[n].candidates[k] for n, k in likely if found.get((n, k), (0.0, AWAY))[1] >= ALONG)
    taken = {i for c in others if c.kind != "bar" for i in c.pieces}
    most_away = AWAY
    if any(
        away < ALONG and taken.isdisjoint(proposed[n].candidates[k].pieces)
        for (n, k), (_, away) in found.items()
    ):
        most_away = ALONG
    losses = {pick: math.inf if away > most_away else loss for pick, (loss, away) in found.items()}
    other = {
        i
        for pick in likely
        if losses.get(pick) == math.inf
        for i in proposed[pick[0]].candidates[pick[1]].pieces
    }

    def gain(pick: Pick) -> float:
        n, k = pick
        long = math.dist(*proposed[n].candidates[k].outline.tolist())
        return min(told[n][k], SURE) - losses[pick] + LONGEST * math.log(max(long, 1e-9))

    free = [pick for pick, loss in losses.items() if loss < math.inf]
    first = likeliest_arrow(proposed, told, free, likely, gain)
    pointers = [pick for pick, loss in losses.items() if loss == math.inf]
    rarer = list(told)
    for (n, k), loss in losses.items():
        rarer[n] = own = list(told[n]) if rarer[n] is told[n] else rarer[n]
        own[k] -= loss
    if first is not None:
        most = rarer[first[0]][first[1]] + ONE_ARROW - SECOND
        prefer_arrow(proposed, rarer, arrows, first, most)
    by: dict[int, list[int]] = {}
    for n, k in pointers:
        by.setdefault(n, []).append(k)
    return rarer, other, {n: kept(_pointers, proposed[n], tuple(its)) for n, its in by.items()}


def _pointers(proposed: Proposed, which: tuple[int, ...]) -> Proposed:
    """Some of the arrows that are proposed, as they mean something else than gravity."""
    return proposing(
        [replace(proposed.candidates[k], kind="pointer") for k in which],
        [proposed.gains[k] - ONE_ARROW for k in which],
    )


def likeliest_arrow(
    proposed: list[Proposed],
    told: list[list[float]],
    arrows: list[Pick],
    likely: list[Pick],
    gain: Callable[[Pick], float],
) -> Pick | None:
    """The arrow that gains the most, of some: of those that are likely, or else of those on ink of nothing likelier."""
    chosen = set(likely)
    some = [pick for pick in arrows if pick in chosen]
    if not some:
        others = (proposed[n].candidates[k] for n, k in likely if told[n][k] > 0)
        taken = {i for c in others if c.kind != "bar" for i in c.pieces}
        some = [(n, k) for n, k in arrows if taken.isdisjoint(proposed[n].candidates[k].pieces)]
    return max(some, key=gain, default=None)


def prefer_arrow(
    proposed: list[Proposed], told: list[list[float]], arrows: list[Pick], first: Pick, most: float = math.inf
) -> None:
    """Make one arrow likelier, however its ink is read as one, and all others rarer, in place; these gain no more than
    `most`."""
    its = set(proposed[first[0]].candidates[first[1]].pieces)
    for n, k in arrows:
        if its.isdisjoint(proposed[n].candidates[k].pieces):
            told[n][k] = min(told[n][k] - ONE_ARROW, most)
        else:
            told[n][k] += ONE_ARROW


def _losses(
    page: Page, likely: Sequence[Likely], arrows: list[Pick], kept: Kept
) -> list[tuple[float, float]]:
    """Nats that each of some arrows is rarer as gravity than by its ink; and how far it leads away from a body that it
    begins at, as a share of its length, infinite if it means something else for sure.

    likely: what the ink makes so, of each patch.
    """
    marks = [(c, row) for own in likely for c, row in own.chosen if c.closed or c.kind == "arrow"]
    boxes = Boxes(np.array([row[:4] for _, row in marks]).reshape(-1, 4))
    taken = {i for own in likely for c, _ in own.closed for i in c.pieces}
    which: dict[int, list[int]] = {}
    for n, k in arrows:
        which.setdefault(n, []).append(k)
    found = []
    for n, ks in which.items():
        proposed = likely[n].patch.whole
        box = kept(_surroundings, proposed)
        near = tuple(marks[k][0] for k in boxes.touching(box))
        idle = tuple(p for p in page.around(*box) if p.index not in taken)
        found += kept(_losses_there, page, proposed, tuple(ks), near, idle)
    return found


def _surroundings(proposed: Proposed) -> Box:
    """The box that has all that says what the arrows of a patch mean."""
    ends, longs = _ends([proposed.candidates[k] for k in proposed.arrows])
    reach = NEAR * longs[:, None]
    (x0, y0), (x1, y1) = (ends.min(axis=1) - reach).min(axis=0), (ends.max(axis=1) + reach).max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def _ends(arrows: list[Fitted]) -> tuple[Array, Array]:
    """Tails and tips of some arrows [pixels], (n, 2, 2), and how long these are."""
    ends = np.array([arrow.outline for arrow in arrows])
    return ends, np.maximum(np.hypot(*(ends[:, 1] - ends[:, 0]).T), 1e-9)


def _losses_there(
    page: Page, proposed: Proposed, which: tuple[int, ...], near: tuple[Fitted, ...], idle: tuple[Piece, ...]
) -> list[tuple[float, float]]:
    """As of `_losses`, of some arrows of one patch, given what is likely in their surroundings, and the pieces there of
    no body."""
    arrows = [proposed.candidates[k] for k in which]
    ends, longs = _ends(arrows)
    bodies = [c for c in near if c.closed]
    likely = [c for c in near if c.kind == "arrow"]
    elsewhere = _axes(arrows, ends, longs, likely) if likely else set()
    if idle:
        elsewhere |= _two_headed(page, arrows, ends, longs, idle)
    apart: list[list[Fitted]] = [[] for _ in arrows]
    if bodies:
        boxes, reach = boxes_around([c.outline for c in bodies]), NEAR * longs[:, None]
        beside = overlap(boxes, np.concatenate([ends.min(axis=1) - reach, ends.max(axis=1) + reach], axis=1))
        for k, b in np.argwhere(beside).tolist():
            if set(arrows[k].pieces).isdisjoint(bodies[b].pieces):
                apart[k].append(bodies[b])
    return [
        (0.0, math.inf) if k in elsewhere else _beside(ends[k], long, apart[k]) if apart[k] else (0.0, 0.0)
        for k, long in enumerate(longs.tolist())
    ]


def _beside(ends: Array, long: float, bodies: list[Fitted]) -> tuple[float, float]:
    """Nats that an arrow of some length is rarer for the bodies beside it; and how far it leads away from one that it
    begins at, as a share of its length."""
    tail, tip = ends
    along, away, places = NEAR * long, 0.0, tail + PLACES * (tip - tail)
    for body in bodies:
        first, *others = depths(places, body.outline)
        if first < AT_BODY * long:
            away = max(away, (others[-1] - first) / long)
        along = min(along, first, *others)
    return BESIDE * (1 - max(along, 0.0) / (NEAR * long)), away


def _axes(arrows: list[Fitted], ends: Array, longs: Array, likely: list[Fitted]) -> set[int]:
    """Which arrows begin where another does that is likely, at a right angle to it."""
    others = np.array([arrow.outline for arrow in likely]).reshape(-1, 2, 2)
    ways, its = ends[:, 1] - ends[:, 0], others[:, 1] - others[:, 0]
    wide, long = np.hypot(*its.T), longs[:, None]
    least = np.minimum(wide, long)
    pair = np.hypot(*(ends[:, None, 0] - others[:, 0]).transpose(2, 0, 1)) < SAME_TAIL * least
    pair &= (np.abs(ways @ its.T) < UPRIGHT * wide * long) & (np.maximum(wide, long) < ALIKE * least)
    return {k for k, j in np.argwhere(pair).tolist() if set(arrows[k].pieces).isdisjoint(likely[j].pieces)}


def _two_headed(
    page: Page, arrows: list[Fitted], ends: Array, longs: Array, idle: Sequence[Piece]
) -> set[int]:
    """At the tails of which arrows there is ink, on both sides, that means nothing else."""
    boxes = np.array([p.box for p in idle]).reshape(-1, 4)
    tails, reach = ends[:, 0], AT_TAIL * longs
    at_tail = np.concatenate([tails - reach[:, None], tails + reach[:, None]], axis=1)
    sides: dict[int, list[float]] = {}
    for k, j in np.argwhere(overlap(boxes, at_tail)).tolist():
        p, long = idle[j], float(longs[k])
        if p.extent > MARK * long or p.index in arrows[k].pieces:
            continue
        off = page.strokes.samples[p.stroke] - tails[k]
        if np.hypot(*off.T).min() < reach[k]:
            ux, uy = (ends[k, 1] - tails[k]) / long
            across = off @ (-uy, ux)
            sides.setdefault(k, []).extend((float(across.min()) / long, float(across.max()) / long))
    return {k for k, off in sides.items() if min(off) < -SIDES and max(off) > SIDES}
