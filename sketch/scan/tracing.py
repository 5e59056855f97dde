"""From a picture to strokes: what is seen, the ways that the pen may have gone, and which of them it went."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sketch.ink import Stroke
from sketch.page.sampling import FEW as SAMPLES
from sketch.scan.binding import Chains, smoothed
from sketch.scan.looking import Seen, look
from sketch.scan.skeleton.corners import begin_at_corner, sharpen_corners
from sketch.scan.skeleton.graph import Graph, build_graph
from sketch.scan.skeleton.ridge import centre_on_ink
from sketch.scan.skeleton.stretches import Stretches
from sketch.scan.strokes.crossed import crossed
from sketch.scan.strokes.faces import standing, with_all_ink
from sketch.scan.strokes.hidden import going_on
from sketch.scan.strokes.overlaps import overlapping
from sketch.scan.strokes.prices import lines
from sketch.scan.strokes.remains import remaining
from sketch.scan.strokes.rings import find_rings, is_part, take_rings
from sketch.scan.strokes.settle import settle
from sketch.scan.strokes.subdivision import Subdivision, bridged
from sketch.scan.strokes.tails import with_tails
from sketch.scan.strokes.ways import Way, Ways
from sketch.typing import Image, Points

__all__ = ["Traced", "trace_picture"]

MOST_LINES = 4000  # between junctions: drawings of hundreds of things have as many, fine print has more
SMOOTHING = 0.8  # [points]: standard deviation of the smoothing along a stroke
SPACING = 0.333  # pen widths between the points of a stroke: ink shows nothing of its course that is finer
CERTAIN = -5.0  # [rad²]: a ring with less strain is not looked at as anything else
FEW = 4  # lines: an X with a loop has three, what a ring joins has more


@dataclass(eq=False)
class Traced:
    """What was read of a picture.

    Attributes:
        strokes: in the pixels of the picture.
        seen: what they were read from; None where the picture is too small to show anything.
        problem: why nothing was read, if there was something.
    """

    strokes: list[Stroke]
    seen: Seen | None
    problem: str = ""


def trace_picture(picture: Image) -> Traced:
    """Trace a BGR picture."""
    seen = look(picture)
    if seen is None or not seen.pen:
        return Traced([], seen)
    if seen.is_dotted:
        return Traced([], seen, "nothing was read: dots or shading cover the picture")
    chains = seen.lines()
    if (count := len(chains.chains)) > MOST_LINES:
        return Traced([], seen, f"nothing was read: {count} lines are too many for a drawing")
    return Traced(_strokes(chains, seen), seen)


def _strokes(chains: Chains, seen: Seen) -> list[Stroke]:
    """The strokes of the ink that was seen: of all that may have been drawn, what makes the most sense together."""
    page, mask, distance, pen = seen.page, seen.mask, seen.distance, seen.pen
    graph = build_graph(chains, distance, pen)
    centre_on_ink(graph, page.darkness, pen)
    sharpen_corners(graph, distance, pen)
    drawn = Graph(graph.nodes, graph.radius, list(graph.edges))
    rings = _without_rings(graph, mask, distance, pen)
    ways = Ways(graph, pen, rings.round)
    plain = ways.likeliest() + rings.certain + rings.doubtful
    likeliest = [_drawn(way, seen) for way in plain]
    if ways.is_net:
        return _drawn_as(likeliest, pen * seen.scale)
    stretches = Stretches({name: points for edge in graph.edges for name, points in edge.ink.items()}, pen)
    others = [_drawn(way, seen) for way in with_all_ink(ways.others(), stretches)]
    within = _in_tangles(rings.tangles, likeliest + others, pen)
    others += [_drawn(way, seen) for way in within if not is_part(way, rings.round, pen)]
    planes = [Subdivision(edges, rings.round, pen) for edges in (drawn.edges, bridged(drawn, pen))]
    others += [_drawn(way, seen) for way in standing(planes, stretches)]
    others += with_tails(likeliest + others, pen * seen.scale)
    overlaps = [_drawn(way, seen) for way in overlapping(planes[1], rings.round, stretches)]
    others += [_drawn(way, seen) for way in going_on(plain, distance, pen)]
    others += [_drawn(way, seen) for way in crossed(drawn, plain, distance, pen)]
    if not others and not overlaps:
        return _drawn_as(likeliest, pen * seen.scale)
    height, width = mask.shape
    ends = lines(likeliest + others + overlaps, pen * seen.scale)
    canvas = width * seen.scale, height * seen.scale
    chosen = settle(likeliest, others, overlaps, ends, pen * seen.scale, canvas)
    used = frozenset(name for way in chosen for name in way.ink)
    left = [ring for ring in rings.certain if (used & ends.keys()).isdisjoint(ring.ink)]
    others = [_drawn(way, seen) for way in ways.likeliest(without=used) + left]
    remains = remaining(others, chosen, drawn, seen.scale)
    kept = chosen + [way for way in others if way not in remains]
    return _drawn_as(kept, pen * seen.scale) + _drawn_as(remains, pen * seen.scale, remains=True)


class _Rings(NamedTuple):
    """The small rings of a drawing.

    Attributes:
        round: the ways around all that are round, each shape (n, 2) [pixels], best first.
        certain: those of them that are nothing else, with their ink.  doubtful: likewise, the others.
        tangles: graphs of what may be drawn otherwise than with a ring, as they were with it.
    """

    round: list[Points]
    certain: list[Way]
    doubtful: list[Way]
    tangles: list[Graph]


def _without_rings(graph: Graph, mask: Image, distance: NDArray[np.float32], pen: float) -> _Rings:
    """Take the small rings out of the graph, in place: the certain ones first."""
    found, names = find_rings(mask, distance, pen, graph.edges), count()
    plain, certain = take_rings(graph, [ring for ring in found if ring.strain < CERTAIN], pen, names)
    whole, doubtful = take_rings(graph, [ring for ring in found if ring.strain >= CERTAIN], pen, names)
    tangles = [tangle for tangle in (_small_pieces(plain), whole) if tangle is not None]
    return _Rings([ring.points for ring in found], certain, doubtful, tangles)


def _small_pieces(graph: Graph | None) -> Graph | None:
    """Those pieces of a tangle that may be one stroke by themselves; None without any."""
    few = [] if graph is None else [e for piece in graph.pieces() if len(piece) <= FEW for e in piece]
    return Graph(graph.nodes, graph.radius, [graph.edges[e] for e in few]) if graph and few else None


def _in_tangles(tangles: list[Graph], known: list[Way], pen: float) -> list[Way]:
    """The ways through tangles that are not of the same ink as one that is known."""
    inks, found = {frozenset(way.ink) for way in known}, list[Way]()
    for tangle in tangles:
        ways = Ways(tangle, pen)
        new = [way for way in ways.likeliest() + ways.others() if frozenset(way.ink) not in inks]
        inks |= {frozenset(way.ink) for way in new}
        found += new
    return found


def _drawn(way: Way, seen: Seen) -> Way:
    """A way as it is handed on: begun at a corner, smooth, in points as far apart as the pen can tell, in the picture's
    pixels."""
    points = _spaced(smooth(begin_at_corner(way.points, seen.pen), SMOOTHING), SPACING * seen.pen)
    ink = way.ink
    if seen.scale != 1:
        ink = {name: (stretch + 0.5) * seen.scale - 0.5 for name, stretch in ink.items()}
    return Way((points + 0.5) * seen.scale - 0.5, ink, way.strain)


def _spaced(points: Points, apart: float) -> Points:
    """Of points a pixel apart those about `apart`, with both ends; more, where that would leave no more than are taken
    for the samples of a tablet that cut corners."""
    step = min(round(apart), (len(points) - 1) // SAMPLES)
    return points if step < 2 else np.concatenate([points[:-1:step], points[-1:]])


def _drawn_as(ways: list[Way], pen: float, *, remains: bool = False) -> list[Stroke]:
    """The ways as strokes; a single place is none. remains: whether they are what others left of their ink.

    pen: its width, in the pixels of the ways.
    """
    strokes = [Stroke(_ended(way.points, pen), remains=remains) for way in ways]
    return [stroke for stroke in strokes if stroke.has_length]


def _ended(points: Points, pen: float) -> Points:
    """A stroke; a closed one that turns back so sharply where it begins that a pen's width away both its ends are still
    in the same ink, without that last bit: a tail's tip is no place where an outline closes."""
    off = np.hypot(*(points - points[0]).T)
    away = np.flatnonzero(off > pen)
    if off[-1] > 0 or not len(away):
        return points
    first, last = points[away[[0, -1]]].tolist()
    return points[: away[-1] + 1] if math.dist(first, last) < pen else points


def smooth(points: Points, sigma: float) -> Points:
    """Points smoothed along the stroke by a Gaussian of `sigma` points; the ends of an open stroke stay."""
    if len(points) < 4:
        return points
    if math.dist(*points[[0, -1]].tolist()) < 1e-9:
        out = smoothed(points[:-1], _gaussian(sigma), closed=True)
        return np.concatenate([out, out[:1]])
    return smoothed(points, _gaussian(sigma), closed=False)


@cache
def _gaussian(sigma: float) -> NDArray[np.float64]:
    """The weights of a Gaussian, which add up to one."""
    reach = int(np.ceil(3 * sigma))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.asarray(weights / weights.sum())
