"""Outlines: bodies are closed, so of two ways through a junction the one that closes outlines is the better.

Where two outlines touch, the smoothest way may well lead from one into the other and leave neither closed.
Hence what is sought is not the smoothest pairing at each junction, but the set of pairings with the least

    sum of the costs at all junctions - CLOSED * number of outlines that close

by going through the junctions, one at a time, until none can be paired better.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from sketch.scan.skeleton.graph import End, Graph
from sketch.scan.skeleton.junctions import LONELY, Junction, Pairs, turn_cost

__all__ = ["SMOOTH", "Choice", "close_outlines", "ends_cost"]

CLOSED = 2.5  # [rad²] what a closed outline is worth: the corner of a square that closes it
COINCIDENCE = 0.9  # [rad²] for every further line that ends at the same place
SMOOTH = 0.3  # [rad²]: two branches that continue each other so well do not both end there
GAP = 0.15  # of an outline's length: what its ends may be apart
SHORTEST = 8.0  # pen widths: less is no outline
MOST_BRANCHES = 6  # of a junction that is looked at: there are 76 ways to pair six
SWEEPS = 3


@dataclass(frozen=True, eq=False)
class Choice:
    """Another way to pair a junction's branches, and by how much it is worse [rad²]."""

    junction: Junction
    pairs: Pairs
    extra: float


def close_outlines(graph: Graph, junctions: list[Junction], pen: float) -> list[Choice]:
    """Pair the branches of all junctions, in place, as well as can be; returns what was not chosen.

    pen: its width [pixels].
    """
    partner: dict[End, End] = {}
    where: dict[End, int] = {}
    for k, junction in enumerate(junctions):
        where.update((branch.end, k) for branch in junction.branches)
        _link(partner, junction, junction.pairs)
    lengths = [edge.length for edge in graph.edges]
    shortest = SHORTEST * pen

    def closed(junction: Junction) -> int:
        """How many outlines go through a junction."""
        count = 0
        seen: set[int] = set()
        for branch in junction.branches:
            if branch.end[0] not in seen:
                trail, around = _trail(partner, branch.end)
                seen.update(e for e, _ in trail)
                count += _is_outline(graph, trail, around, where, lengths, shortest)
        return count

    choices: dict[int, list[Choice]] = {}
    for _ in range(SWEEPS):
        changed = False
        for k, junction in enumerate(junctions):
            if not 2 <= len(junction.branches) <= MOST_BRANCHES:
                continue
            options = _options(junction)
            values = []
            for cost, pairs in options:
                _link(partner, junction, pairs)
                values.append(cost - CLOSED * closed(junction))
            best = int(np.argmin(values))
            chosen = options[best][1]
            choices[k] = [
                Choice(junction, pairs, value - values[best])
                for n, ((_, pairs), value) in enumerate(zip(options, values, strict=True))
                if n != best
            ]
            changed |= set(chosen) != set(junction.pairs)
            junction.pairs = chosen
            _link(partner, junction, chosen)
        if not changed:
            break
    return [choice for found in choices.values() for choice in found]


def _link(partner: dict[End, End], junction: Junction, pairs: Pairs) -> None:
    for branch in junction.branches:
        partner.pop(branch.end, None)
    for i, j in pairs:
        a, b = junction.branches[i].end, junction.branches[j].end
        partner[a], partner[b] = b, a


def _options(junction: Junction) -> list[tuple[float, Pairs]]:
    """All ways to pair the branches with their costs, cheapest first, without the hopeless ones."""
    cost = {
        (i, j): turn_cost(junction.branches[i], junction.branches[j])
        for j in range(len(junction.branches))
        for i in range(j)
    }
    count = len(junction.branches)
    smooth = [pair for pair, turn in cost.items() if turn < SMOOTH]
    options = []
    for pairs in map(list, _matchings(count)):
        passing = {branch for pair in pairs for branch in pair}
        if all(i in passing or j in passing for i, j in smooth):
            options.append((sum(cost[pair] for pair in pairs) + ends_cost(count - len(passing)), pairs))
    options.sort(key=lambda option: option[0])
    return [option for option in options if option[0] < options[0][0] + 2 * CLOSED]


def ends_cost(ends: int) -> float:
    """What it costs that lines end at a junction: that several do so at one place is no coincidence."""
    return LONELY * ends + COINCIDENCE * max(ends - 1, 0)


@cache
def _matchings(count: int) -> tuple[tuple[tuple[int, int], ...], ...]:
    """All sets of disjoint pairs of `count` things."""

    def of(left: tuple[int, ...]) -> list[tuple[tuple[int, int], ...]]:
        if len(left) < 2:
            return [()]
        first, rest = left[0], left[1:]
        found = of(rest)
        for k, other in enumerate(rest):
            found += [((first, other), *more) for more in of(rest[:k] + rest[k + 1 :])]
        return found

    return tuple(of(tuple(range(count))))


def _trail(partner: dict[End, End], end: End) -> tuple[list[End], bool]:
    """The edges of the course through an edge, by the ends at which it enters them; whether it closes."""
    trail = [end]
    while (after := partner.get((trail[-1][0], 1 - trail[-1][1]))) is not None:
        if after[0] == end[0]:
            return trail, True
        trail.append(after)
    before: list[End] = []
    at = partner.get(end)
    while at is not None:
        before.append((at[0], 1 - at[1]))
        at = partner.get((at[0], 1 - at[1]))
    return before[::-1] + trail, False


def _is_outline(
    graph: Graph, trail: list[End], around: bool, where: dict[End, int], lengths: list[float], shortest: float
) -> bool:
    """Whether a course is closed, or as good as closed, and does not pass a junction twice."""
    drawn = sum(lengths[e] for e, _ in trail)
    if drawn < shortest:
        return False
    if not around:
        first, (e, side) = trail[0], trail[-1]
        gap = graph.outward(first)[0] - graph.outward((e, 1 - side))[0]
        if np.hypot(gap[0], gap[1]) > GAP * drawn:
            return False
    passed = [where[end] for end in trail if end in where]
    if not around:
        e, side = trail[-1]
        passed += [where[end] for end in [(e, 1 - side)] if end in where]
    return len(passed) == len(set(passed))
