"""From a picture to strokes: the page, its ink, the skeleton, the strokes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sketch.scan.binding import Chains, distances, smoothed, thin, trace
from sketch.scan.paper.broken import is_broken
from sketch.scan.paper.faint import drop_faint_marks
from sketch.scan.paper.fills import FILL, fill_grain, fill_hatching, hollow_fills
from sketch.scan.paper.grain import smoothed_grain
from sketch.scan.paper.lying import drop_things
from sketch.scan.paper.page import Page, drop_specks, ink_mask, read_page
from sketch.scan.quantiles import percentile
from sketch.scan.skeleton.corners import begin_at_corner, sharpen_corners
from sketch.scan.skeleton.graph import Graph, build_graph
from sketch.scan.skeleton.ridge import centre_on_ink
from sketch.scan.skeleton.stretches import Stretches
from sketch.scan.strokes.crossed import crossed
from sketch.scan.strokes.faces import standing
from sketch.scan.strokes.hidden import going_on
from sketch.scan.strokes.overlaps import overlapping
from sketch.scan.strokes.prices import lines
from sketch.scan.strokes.rings import find_rings, take_rings
from sketch.scan.strokes.settle import settle
from sketch.scan.strokes.subdivision import Subdivision, bridged
from sketch.scan.strokes.tails import with_tails
from sketch.scan.strokes.ways import Way, Ways
from sketch.typing import Points

__all__ = ["Traced", "trace_picture"]

WORK_PIXELS = 2_500_000  # more than this are not looked at before the pen's width is known
MOST_PIXELS = 16_000_000  # that are ever looked at: no pen is as thin as a pixel of these
MOST_LINES = 4000  # between junctions: drawings of hundreds of things have as many, fine print has more
DOTTED = 0.12  # of the picture's pixels: lines of a drawing are farther apart than eight pixels
FEWEST_DOTS = 10_000  # [pixels] unless the picture is as small as a stamp
LEAST_SIDE = 8  # [pixels] of a picture that can show anything
FINEST = 0.5  # picture pixels to a pixel: the thinnest pens are thinned at twice the picture's resolution
NARROWEST_PEN = 3.0  # [pixels]: a thinner pen is thinned at twice the resolution
WIDEST_PEN = 8.0  # [pixels]: a wider pen is thinned at half the resolution
ANY_PEN = 6.4  # [pixels]: taken where there are no lines to tell
FILLED = 0.025  # of the picture's size: no pen is as wide, so that all shapes are filled
SMOOTHING = 0.8  # [points]: standard deviation of the smoothing along a stroke
CERTAIN = -5.0  # [rad²]: a ring with less strain is not looked at as anything else
FEW = 4  # lines: an X with a loop has three, what a ring joins has more
NEARBY = 4  # [pixels] within which ink is compared with the darkest


@dataclass(eq=False)
class Traced:
    """What was seen on a picture, stage by stage.

    Attributes:
        strokes: each shape (n, 2) [pixels of the picture].
        scale: picture pixels to a pixel of the stages' pictures.
        page: darkness under even light.  mask: ink 1, paper 0.  skeleton: its lines.  distance: of the ink to the
            paper.  All None where the picture is too small to show anything.
        pen: width of the pen [pixels of the stages' pictures].
        specks: how many pieces were too small to be anything.
        left_out: notes of what is on the paper and was not drawn.
        problem: why nothing was read, if there was something.
    """

    strokes: list[Points] = field(default_factory=list)
    scale: float = 1.0
    page: Page | None = None
    mask: NDArray[Any] | None = None
    skeleton: NDArray[Any] | None = None
    distance: NDArray[Any] | None = None
    pen: float = 0.0
    specks: int = 0
    left_out: list[str] = field(default_factory=list)
    problem: str = ""


def trace_picture(picture: NDArray[Any]) -> Traced:
    """Trace a BGR picture, shape (h, w, 3), uint8."""
    scale = 1.0
    while picture.shape[0] * picture.shape[1] > WORK_PIXELS * scale * scale:
        scale *= 2
    tried: set[float] = set()
    while True:
        seen = _see(picture, scale)
        if not seen.pen:
            return seen
        tried.add(scale)
        scale *= (
            2.0 if seen.pen > WIDEST_PEN or _is_dotted(seen) else 0.5 if seen.pen < NARROWEST_PEN else 1.0
        )
        pixels = picture.shape[0] * picture.shape[1] / scale**2
        if scale in tried or scale < FINEST or pixels > MOST_PIXELS or min(picture.shape[:2]) < 100 * scale:
            break
    if _is_dotted(seen):
        seen.problem = "nothing was read: dots or shading cover the picture"
    else:
        seen.strokes = _strokes(seen)
    return seen


def _is_dotted(seen: Traced) -> bool:
    """Whether the ink is the dots of a dithered or printed grey, which is looked at from farther off."""
    if seen.skeleton is None:
        return False
    return bool(np.count_nonzero(seen.skeleton) > max(DOTTED * seen.skeleton.size, FEWEST_DOTS))


def _see(picture: NDArray[Any], scale: float) -> Traced:
    """The stages up to the skeleton, at one picture pixel in `scale`; without a pen where there is no ink."""
    import cv2

    work = picture
    if scale > 1:
        work = cv2.resize(picture, None, fx=1 / scale, fy=1 / scale, interpolation=cv2.INTER_AREA)
    work = smoothed_grain(work)
    if scale < 1:
        work = cv2.resize(work, None, fx=1 / scale, fy=1 / scale, interpolation=cv2.INTER_LINEAR)
    if min(work.shape[:2]) < LEAST_SIDE:
        return Traced()
    page = read_page(work)
    seen = _inked(page, scale)
    if seen.pen and seen.skeleton is not None and is_broken(seen.skeleton, seen.pen):
        return _inked(page.smoothed(2 * NEARBY), scale)
    return seen


def _inked(page: Page, scale: float) -> Traced:
    """The stages from the page to the skeleton; without a pen where there is no ink."""
    mask, left_out = ink_mask(page, NEARBY)
    skeleton, size = thin(mask)
    distance = distances(mask)
    if size and page.edge is not None and (things := drop_things(mask, skeleton, distance, page.edge)):
        left_out.append(f"left out {things} things that lie across the edge of the sheet")
    pen = _pen_width(mask, skeleton, distance) if size else 0.0
    return Traced([], scale, page, mask, skeleton, distance, pen, left_out=left_out)


def _pen_width(mask: NDArray[Any], skeleton: NDArray[Any], distance: NDArray[Any]) -> float:
    """The width of the pen: the ink's area over its length, without what is filled."""
    import cv2

    thickness = distance[skeleton.view(np.bool_)]
    core = 2 * FILL * percentile(thickness, 20)
    pen = cv2.countNonZero(mask) / len(thickness)
    if (thick := float(thickness.max())) > core:
        side = 2 * round(2 * core) + 1  # also into its corners
        filled = cv2.dilate((distance > core).view(np.uint8), np.ones((side, side), np.uint8))
        area, length = (int(np.count_nonzero(some > filled)) for some in (mask, skeleton))
        without = area / length if length else ANY_PEN
        pen = without if thick > FILL * without else pen  # a blot is not filled
    return pen if pen < FILLED * mask.size**0.5 else ANY_PEN


def _strokes(seen: Traced) -> list[Points]:
    """The strokes of the ink that was seen: of all that may have been drawn, what makes the most sense together."""
    chains = _lines(seen)
    page, mask, distance, pen = seen.page, seen.mask, seen.distance, seen.pen
    if chains is None or page is None or mask is None or distance is None:
        return []
    graph = build_graph(chains, distance, pen)
    centre_on_ink(graph, page.darkness, pen)
    sharpen_corners(graph, distance, pen)
    drawn = Graph(graph.nodes, graph.radius, list(graph.edges))
    rings = _without_rings(graph, mask, distance, pen)
    ways = Ways(graph, pen, rings.round)
    plain = ways.likeliest() + rings.certain + rings.doubtful
    likeliest = [_drawn(way, seen) for way in plain]
    if ways.is_net:
        return _points(likeliest)
    others = [_drawn(way, seen) for way in ways.others()]
    others += [_drawn(way, seen) for way in _in_tangles(rings.tangles, likeliest + others, pen)]
    planes = [Subdivision(edges, rings.round, pen) for edges in (drawn.edges, bridged(drawn, pen))]
    stretches = Stretches({name: points for edge in graph.edges for name, points in edge.ink.items()}, pen)
    others += [_drawn(way, seen) for way in standing(planes, stretches)]
    others += with_tails(likeliest + others, pen * seen.scale)
    overlaps = [_drawn(way, seen) for way in overlapping(planes[1], rings.round, stretches)]
    others += [_drawn(way, seen) for way in going_on(plain, distance, pen)]
    others += [_drawn(way, seen) for way in crossed(drawn, plain, distance, pen)]
    if not others and not overlaps:
        return _points(likeliest)
    height, width = mask.shape
    ends = lines(likeliest + others + overlaps, pen * seen.scale)
    canvas = width * seen.scale, height * seen.scale
    chosen = settle(likeliest, others, overlaps, ends, pen * seen.scale, canvas)
    used = frozenset(name for way in chosen for name in way.ink)
    left = [ring for ring in rings.certain if (used & ends.keys()).isdisjoint(ring.ink)]
    return _points(chosen + [_drawn(way, seen) for way in ways.likeliest(without=used) + left])


def _lines(seen: Traced) -> Chains | None:
    """The lines of the skeleton, without what was not drawn as a line: fills, shading, faint marks, specks.

    What was seen is as it is without these, then. None, with the reason, where there are too many.
    """
    import cv2

    page, mask, skeleton, distance, pen = seen.page, seen.mask, seen.skeleton, seen.distance, seen.pen
    if page is None or mask is None or skeleton is None or distance is None:
        return None
    seen.specks = drop_specks(mask, distance, pen)
    if fill_hatching(mask, pen):
        distance = distances(mask)
    if hollowed := hollow_fills(mask, distance, pen):
        distance = distances(mask)
    if fill_grain(mask, distance, pen) or hollowed:
        skeleton, size = thin(mask)
    else:
        skeleton &= mask
        size = cv2.countNonZero(skeleton)
    chains = trace(skeleton, size)
    if faint := drop_faint_marks(mask, page.darkness, chains, distance, pen):
        seen.left_out.append(f"left out {faint} marks that are far fainter than the pen's")
        distance = distances(mask)
        drop_specks(mask, distance, pen)
        skeleton, size = thin(mask)
        chains = trace(skeleton, size)
    seen.skeleton, seen.distance = skeleton, distance
    if len(chains.chains) > MOST_LINES:
        seen.problem = f"nothing was read: {len(chains.chains)} lines are too many for a drawing"
        return None
    return chains


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


def _without_rings(graph: Graph, mask: NDArray[Any], distance: NDArray[Any], pen: float) -> _Rings:
    """Take the small rings out of the graph, in place: the certain ones first."""
    found, names = find_rings(mask, distance, pen), count()
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


def _drawn(way: Way, seen: Traced) -> Way:
    """A way as it is handed on: begun at a corner, smooth, in the picture's pixels."""
    points = smooth(begin_at_corner(way.points, seen.pen), SMOOTHING)
    ink = way.ink
    if seen.scale != 1:
        ink = {name: (stretch + 0.5) * seen.scale - 0.5 for name, stretch in ink.items()}
    return Way((points + 0.5) * seen.scale - 0.5, ink, way.strain)


def _points(ways: list[Way]) -> list[Points]:
    """The ways as strokes; a single point is none."""
    return [way.points for way in ways if len(way.points) > 1]


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
