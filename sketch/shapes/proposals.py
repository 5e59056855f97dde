"""What each piece of ink may be, by itself and with those around it: readings of groups, before any choice.

A piece proposes the groups in which it leads: outlines of which it is drawn first, an X likewise, arrows of
which it is the shaft. Its proposals depend on the ink around it alone, and are made anew only where that ink
has changed; the dear fits, of outlines and crosses, are kept.

What cannot be in the answer is left out as early as that is known, and changes nothing: a reading that loses more
than HOPELESS is not priced to its end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from sketch.kernel import off_outline
from sketch.lazy import lazy
from sketch.page.grouping import WIDE, closing_chains, closing_ink, crosses, crossing, in_line, shafts
from sketch.page.loose import Chain, End
from sketch.page.near import boxes_around
from sketch.page.pieces import Looked, Page, Piece
from sketch.scoring import Fitted, misfit_of
from sketch.search import Part, part
from sketch.shapes.bars import bars_again, read_bar, read_bar_of_two, read_line, read_line_gone_over
from sketch.shapes.marks import read_arrows, read_cross, read_cross_over, with_strays
from sketch.shapes.outlines import LEAST_AXIS, read_borrowing, read_outline
from sketch.typing import Array, Box

__all__ = ["HOPELESS", "Pick", "Proposals", "Proposed", "Row", "proposing"]

PLAIN = 0.5  # of the nats of its free ink: an outline said in less is tried as nothing else
APART = 0.2  # of its length: a stroke whose ends are further apart is no outline by itself
CLOSED = 0.04  # of its ink: what is missing, at most, of an outline that needs no other ink
NEARLY = 0.1  # likewise, of one that needs none but what closes it
NARROW = 0.2  # of its extent: the shorter half axis of an outline that is narrow
WELL_SAID = 0.6  # of the nats of its free ink: an outline that is said in less is complete, though narrow
MEANT = 4.0  # nats that a reading is to save: less would be luck, as so many are tried
THINNEST = 1.001 * LEAST_AXIS  # of the page: outlines that are no wider were judged as wider than they are
LITTLE = 0.2  # of an outline's scale: pieces whose distance from it is compared with their own
ALONG = 0.3  # of an outline's scale: as near to it is what may be drawn along it once more
MOST_GROUPS = (
    32  # that one piece leads: of an ordinary page's hardly one leads ten, in shading each leads any number
)
HOPELESS = 40.0  # nats that a reading may lose: what stands around it says less than that for it

Key = tuple[tuple[int, ...], Hashable]  # the pieces that a fit is of, and how they are taken
Fits = dict[Key, list[Fitted]]
Row = list[float]  # where a reading lies: least x and y, greatest x and y, extent [pixels]
Pick = tuple[int, int]  # what was proposed by which piece, and which of it


@dataclass(eq=False, slots=True)
class Alone:
    """A piece by itself.

    Attributes:
        outlines: its readings as a closed outline; none where it is wide open.
        gapes: what is missing of it, as a share of its ink, where it needs no others but to close it; else infinite.
        complete: whether it closes by itself, and so needs no others.
        plain: whether it looks like nothing else.
    """

    outlines: list[Fitted]
    gapes: float
    complete: bool
    plain: bool

    def of(self, index: int) -> Alone:
        """The same of another piece, whose ink goes the same way."""
        return replace(self, outlines=[replace(f, pieces=(index,)) for f in self.outlines])


@dataclass(eq=False)
class Proposed:
    """What one piece proposed. What is made of it is made when it is asked for: not all of a picture's is.

    Never changed once it is made, but for that.

    Attributes:
        candidates: readings of groups that it leads, and gains: what each saves against saying its ink freely.
        looked: what it saw of the page.
        fits: of which they were made.
    """

    candidates: list[Fitted]
    gains: list[float]
    looked: Looked
    fits: Fits

    @lazy
    def pieces(self) -> frozenset[int]:
        """The pieces of all groups."""
        return frozenset(i for c in self.candidates for i in c.pieces)

    @lazy
    def ink(self) -> list[int]:
        """These, and those that lend sides to them."""
        return sorted(self.pieces.union(c.lender for c in self.candidates if c.lender >= 0))

    @lazy
    def rows(self) -> list[Row]:
        """Of the outline of each candidate its least x and y, greatest x and y, and extent [pixels]."""
        return _rows(self.candidates)

    @lazy
    def box(self) -> Box:
        """The box around all these outlines."""
        return _around(self.rows)

    @lazy
    def seen(self) -> Box:
        """The box around all boxes of what it saw."""
        return _around(self.looked.boxes)

    @lazy
    def of_ink(self) -> dict[tuple[int, ...], list[int]]:
        """Which of the candidates are of some pieces."""
        which: dict[tuple[int, ...], list[int]] = {}
        for k, c in enumerate(self.candidates):
            which.setdefault(c.pieces, []).append(k)
        return which

    @lazy
    def arrows(self) -> list[int]:
        """Which of the candidates are arrows."""
        return [k for k, c in enumerate(self.candidates) if c.kind == "arrow"]

    @lazy
    def bars(self) -> list[int]:
        """Which of them are bars."""
        return [k for k, c in enumerate(self.candidates) if c.kind == "bar"]

    def course(self, line: Fitted) -> tuple[Array, Row]:
        """One of these bars as it bends along its ink, and where it is: over a long one the hand strays further than
        what stands on it is large."""
        its = (k for k in self.bars if self.candidates[k].pieces == line.pieces)
        k = max(its, key=lambda k: len(self.candidates[k].outline))
        return self.candidates[k].outline, self.rows[k]

    @lazy
    def borrowing(self) -> bool:
        """Whether some have a side of another body."""
        return any(c.lender >= 0 for c in self.candidates)

    @lazy
    def alone(self) -> Part:
        """What they gain by themselves."""
        return part([c.pieces for c in self.candidates], self.gains)


class Proposals:
    """The proposals of all pieces of a page, kept as its strokes come and go."""

    def __init__(self, canvas: float, rivals: Sequence[Set[int]] = ()) -> None:
        """canvas: diagonal [pixels], or 0.  rivals: as of `Page`."""
        self.page = Page(canvas, rivals)
        self.by_piece: dict[int, Proposed] = {}
        self.free: dict[int, float] = {}  # nats to say a piece freely
        self._alone: dict[int, Alone] = {}
        self._stale: set[int] = set()

    def add(self, strokes: list[Array], given: Sequence[Array | None] = ()) -> range:
        """Add strokes, (n, 2) [pixels]; returns their indices.  given: as of `Page.add`."""
        new = self.page.add(strokes, given)
        self._settle([i for i in new if i in self.page.pieces])
        return new

    def remove(self, index: int) -> None:
        """Take a stroke away."""
        if index not in self.page.pieces:
            return
        self._forget(index)
        self.page.remove(index)
        self.by_piece.pop(index, None)
        del self.free[index]
        self._stale.discard(index)
        self._settle([])

    def all(self) -> list[Proposed]:
        """What all pieces propose, in the order of drawing."""
        page = self.page
        if self._stale:
            new = []
            for i in sorted(self._stale):
                known = self.by_piece.get(i)
                self.by_piece[i] = own = self._propose(page.pieces[i], known.fits if known else {})
                new.append(own)
            self._stale.clear()
            rows = iter(
                _rows([c for own in new for c in own.candidates])
            )  # of many at once, which is sooner done
            for own in new:
                own.rows = list(islice(rows, len(own.candidates)))
        return [self.by_piece[i] for i in page.pieces]

    # ------------------------------------------------------------ what has changed

    def _settle(self, new: list[int]) -> None:
        """Take in new pieces, and what they change of the page as a whole."""
        before = self.page.size
        changed = self.page.settle()
        again = {i for i in changed if i in self._alone}
        thin = THINNEST * max(before, self.page.size) if before != self.page.size else 0.0
        if thin:
            again |= {i for i, a in self._alone.items() if _thin(a.outlines, thin)}
        for i in again:
            self._forget(i)
            self.by_piece.pop(i, None)
        # whoever has fits of their ink looked there
        for i in list(self.by_piece) if thin else self._stale.intersection(self.by_piece) if again else ():
            fits = self.by_piece[i].fits
            for key in [k for k, found in fits.items() if not again.isdisjoint(k[0]) or _thin(found, thin)]:
                del fits[key]
                self._stale.add(i)
        first: dict[bytes, int] = {}  # a picture's strokes may share their ways, and differ in their ink
        for i in sorted(again.union(new)):
            p = self.page.pieces[i]
            self.free[i] = p.unread
            k = first.setdefault(p.points.tobytes(), i) if p.given is None else i
            self._alone[i] = self._read_alone(p) if k == i else self._alone[k].of(i)
        for i in sorted(again.union(new)):
            ends = set() if self._alone[i].complete else self.page.ends.loosen(i)
            self._touch(i, ends)
            self._stale.add(i)

    def _forget(self, index: int) -> None:
        """Whatever was said of a piece's ink is said anew."""
        del self._alone[index]
        self._touch(index, self.page.ends.tighten(index))

    def _touch(self, index: int, ends: set[End]) -> None:
        """Let those propose anew who looked where a piece comes or goes, or at these ends."""
        x0, y0, x1, y1 = self.page.pieces[index].box
        for i, p in self.by_piece.items():
            if i in self._stale:
                continue
            a, b, c, d = p.seen
            near = a <= x1 and b <= y1 and c >= x0 and d >= y0
            if (
                near and any(a <= x1 and b <= y1 and c >= x0 and d >= y0 for a, b, c, d in p.looked.boxes)
            ) or (ends and not ends.isdisjoint(p.looked.ends)):
                self._stale.add(i)

    # ------------------------------------------------------------ readings

    def _read_alone(self, p: Piece) -> Alone:
        if p.gap >= APART * p.length:
            return Alone([], math.inf, False, False)
        outlines = read_outline(self.page, [(p.index, False)])
        best = min(outlines, key=lambda f: f.cost)
        loop = best.gap < CLOSED and best.narrow > NARROW * p.extent
        nearly = best.gap < NEARLY and (loop or best.cost < WELL_SAID * p.unread)
        complete = nearly and best.gap < CLOSED
        return Alone(
            outlines,
            p.gap / p.length if nearly else math.inf,
            complete,
            nearly and best.cost < PLAIN * p.unread,
        )

    def _propose(self, p: Piece, known: Fits) -> Proposed:
        """Every reading of every group that a piece leads."""
        page, alone = self.page, self._alone[p.index]
        page.looked = looked = Looked()
        fits: Fits = {}

        def fitted(key: Key, fit: Callable[[], list[Fitted]]) -> list[Fitted]:
            found = known.get(key)
            fits[key] = fit() if found is None else found
            return fits[key]

        out: list[Fitted] = []
        whole: list[tuple[float, frozenset[int]]] = []
        for gap, chain in [(0.0, [(p.index, False)])] if alone.complete else closing_chains(page, p.index):
            group = frozenset(i for i, _ in chain)
            if any(closed < group and tight + WIDE < gap for tight, closed in whole):
                continue
            if len(chain) > 1 and gap > min(self._alone[i].gapes for i in group):
                continue  # one of them lacks less by itself
            if len(chain) == 1 and alone.outlines:
                found = alone.outlines
            else:
                key = tuple(i for i, _ in chain), tuple(back for _, back in chain)
                found = fitted(key, partial(_read_chain, page, chain))
            if len(chain) == 2 and _thin(found, THINNEST * page.size):
                continue  # a line that was drawn twice
            best = min(found, key=lambda f: f.cost)
            said = self._said(best.pieces)
            if best.gap < CLOSED and best.cost < PLAIN * said:  # it needs no further ink
                whole.append((gap, group))
            out += found
            if best.cost <= said:
                out += _again(page, found, best)
        for way, j, ink in () if alone.gapes < math.inf else closing_ink(page, p):
            out += fitted(
                ((*(i for i, _ in way), j), ("borrowing", *way)), partial(read_borrowing, page, way, j, ink)
            )
        out += _kept(read_bar(page, p)) + _kept(read_line(p)) + _kept(read_line_gone_over(p))
        beside = list(in_line(page, p))
        for q in beside:
            for bar in _kept(read_bar_of_two(page, p, q)):
                out += [bar, *bars_again(page, bar, beside)]
                for other in crossing(page, bar):
                    most = self._said((*bar.pieces, other.index)) + HOPELESS
                    out += _kept(read_cross_over(bar, other, most))
        if not alone.plain:
            for names in crosses(page, p):
                most = self._said(names) + HOPELESS
                for cross in fitted((names, "cross"), lambda n=names, m=most: _kept(read_cross(page, n, m))):  # type: ignore[misc]
                    out += [cross, *with_strays(page, cross, self._said(cross.pieces))]
            out += self._arrows(p)
        every = [(c, self._said(c.pieces) - c.cost - MEANT) for c in out]
        likely = _best_groups([(c, gain) for c, gain in every if gain > -HOPELESS])
        return proposing([c for c, _ in likely], [gain for _, gain in likely], looked, fits)

    def _said(self, names: tuple[int, ...]) -> float:
        """Nats to say pieces freely."""
        return sum(map(self.free.__getitem__, names))

    def _arrows(self, p: Piece) -> list[Fitted]:
        """Arrows of which a piece is the shaft, the best of each group."""
        best: dict[tuple[int, ...], Fitted] = {}
        for arrow in read_arrows(self.page, list(shafts(self.page, p)), HOPELESS):
            for mark in (arrow, *with_strays(self.page, arrow, self._said(arrow.pieces))):
                if mark.pieces not in best or mark.cost < best[mark.pieces].cost:
                    best[mark.pieces] = mark
        return list(best.values())


def _thin(found: list[Fitted], narrowest: float) -> bool:
    """Whether an outline is so narrow that it depends on the page's size how it was judged."""
    return bool(found) and 0 < found[0].narrow <= narrowest


def _best_groups(readings: list[tuple[Fitted, float]]) -> list[tuple[Fitted, float]]:
    """Of readings, with their gains, those of the groups that gain the most by the piece, and of a piece alone."""
    best: dict[tuple[int, ...], float] = {}
    for c, gain in readings:
        best[c.pieces] = max(
            gain / len(c.pieces) if len(c.pieces) > 1 else math.inf, best.get(c.pieces, -math.inf)
        )
    if len(best) <= MOST_GROUPS:
        return readings
    most = set(sorted(best, key=best.__getitem__, reverse=True)[:MOST_GROUPS])
    return [(c, gain) for c, gain in readings if c.pieces in most]


def proposing(
    candidates: list[Fitted], gains: list[float], looked: Looked | None = None, fits: Fits | None = None
) -> Proposed:
    """Readings with their gains; looked, fits: what they depend on, and were made of."""
    return Proposed(candidates, gains, Looked() if looked is None else looked, {} if fits is None else fits)


def _rows(fits: Sequence[Fitted]) -> list[Row]:
    """Of the outline of each fit its least x and y, greatest x and y, and extent [pixels]."""
    boxes = boxes_around([c.outline for c in fits])
    wide = np.hypot(boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1])
    rows: list[Row] = np.column_stack([boxes, wide]).tolist()
    return rows


def _kept(found: Fitted | None) -> list[Fitted]:
    return [] if found is None else [found]


def _read_chain(page: Page, chain: Chain) -> list[Fitted]:
    """The readings of an outline of several pieces, of which the little ones run along it to their own precision.

    Else a letter beside a box's corner would be a part of it: it is no further off than a long side may be.
    """
    found = read_outline(page, chain)
    little = [p for p in (page.pieces[i] for i, _ in chain) if p.scale < LITTLE * found[0].scale]
    if not little or len(chain) == 1:
        return found
    strokes, free = [p.stroke for p in little], sum(page.pieces[i].unread for i, _ in chain)
    out = []
    for f in found:
        if f.cost < free:
            off, _ = off_outline(page.strokes, strokes, f.outline)
            # along its own ink an outline of any course says nothing of what is little beside it
            said = (
                p.unread if f.kind == "free" else min(misfit_of(p, square), p.unread)
                for p, square in zip(little, off, strict=True)
            )
            f = replace(f, cost=f.cost + sum(said))
        out.append(f)
    return out


def _again(page: Page, found: list[Fitted], best: Fitted) -> list[Fitted]:
    """The readings of an outline together with the other pieces that run along the best, as drawn once more."""
    costs = page.again(best.outline, ALONG * best.scale, best.pieces, best.scale)
    return [together for f in found for together in f.together(costs)] if costs else []


def _around(boxes: Sequence[Sequence[float]]) -> Box:
    """The box around boxes, the first four numbers of each; of none one that touches nothing."""
    if not boxes:
        return math.inf, math.inf, -math.inf, -math.inf
    x0, y0, x1, y1, *_ = zip(*boxes, strict=True)
    return min(x0), min(y0), max(x1), max(y1)
