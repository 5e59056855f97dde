"""InkML, the W3C's markup of ink (Recommendation of 20 September 2011): traces, their formats and contexts.

Y grows downwards, as the specification has it, unless a channel's orientation is "-ve".  Brushes, mappings and
views are not looked at.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from sim.scene import InputError
from sketch.formats import strokes
from sketch.formats.markup import Element, parse_xml
from sketch.ink import Sketch

__all__ = ["read"]

Row = list[float]

# One value of a point: the order of difference, then a number, a hexadecimal number, a boolean, * or ?.
VALUE = re.compile(
    r"""\s*(?P<order>[!'"]?)\s*(?P<value>[+-]?\s*(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|-?\#[0-9A-Fa-f]+|[TF*?])"""
)
NUMBERS = re.compile(r"[\d\s.,eE+-]*")
ORDERS = {"!": 0, "'": 1, '"': 2}  # of difference, by the sign before a value
# Of the units that InkML has for time, and for a channel's resolution.
MILLISECONDS = {"s": 1e3, "ms": 1.0, "us": 1e-3}
PER_CENTIMETRE = {"1/cm": 1.0, "1/mm": 10.0, "1/in": 1 / 2.54, "1/m": 0.01, "1/pt": 72 / 2.54}


@dataclass(frozen=True)
class Channel:
    """A column of a trace. factor: of its values, to pixels of the page or milliseconds; sign included."""

    name: str
    factor: float = 1.0
    intermittent: bool = False


Format = tuple[Channel, ...]

PLAIN: Format = (Channel("X"), Channel("Y"))  # where nothing else is said


@dataclass
class _Trace:
    """A stroke, or a piece of one: it goes on from the trace named in `prior`."""

    element: Element
    format: Format
    prior: str


def read(data: bytes) -> Sketch:
    """Read a file of ink. Raises InputError with the line of what is wrong."""
    root = parse_xml(data)
    if root.name != "ink":
        raise InputError(root.place, "not InkML, whose outermost element is <ink>", kind="format")
    named = {e.attributes["id"]: e for e in root.walk() if "id" in e.attributes}
    found: list[tuple[str, list[Row]]] = []
    for trace in _traces(root, PLAIN, named):
        rows = _rows(trace)
        if trace.prior:
            before = next((points for name, points in found if name == trace.prior), None)
            if before is None:
                raise InputError(trace.element.place, f"there is no trace {trace.prior!r} before it")
            before += rows
            found.append((trace.element.attributes.get("id", ""), before))
        else:
            found.append((trace.element.attributes.get("id", ""), rows))
    whole = list({id(points): points for _, points in found}.values())
    if not whole:
        raise InputError("", "there are no traces: nothing was drawn", kind="empty")
    return strokes.from_objects({"strokes": [points for points in whole if points]})


def _traces(inside: Element, format: Format, named: dict[str, Element]) -> Iterator[_Trace]:
    """The traces that were drawn, in order; a context among them holds for those that follow."""
    for element in inside.children:
        if element.name == "context":
            format = _format_of(element, named) or format
        elif element.name == "traceGroup":
            yield from _traces(element, _referred(element, named) or format, named)
        elif element.name == "trace" and element.attributes.get("type", "penDown") != "penUp":
            prior = ""
            if element.attributes.get("continuation", "begin") != "begin":
                prior = element.attributes.get("priorRef", "").removeprefix("#")
            yield _Trace(element, _referred(element, named) or format, prior)


def _referred(element: Element, named: dict[str, Element]) -> Format | None:
    """The format of the context that an element refers to."""
    target = _target(element, "contextRef", named)
    return _format_of(target, named) if target is not None else None


def _target(element: Element, key: str, named: dict[str, Element]) -> Element | None:
    name = element.attributes.get(key, "")
    if not name or name == "#DefaultContext":
        return None
    if name.removeprefix("#") not in named:
        raise InputError(element.place, f"{key}: there is no {name!r} in this file")
    return named[name.removeprefix("#")]


def _format_of(element: Element, named: dict[str, Element], depth: int = 0) -> Format | None:
    """The format that a context, an ink source or a format's own element leads to."""
    if depth > 10:
        raise InputError(element.place, "contexts refer to each other in a circle")
    if element.name == "traceFormat":
        return _channels(element, None)
    for child in element.children:  # what stands in the element itself overrides what it refers to
        if child.name == "traceFormat":
            return _channels(child, element)
        if child.name == "inkSource" and (found := _format_of(child, named, depth + 1)) is not None:
            return found
    for key in ("traceFormatRef", "inkSourceRef", "contextRef"):
        target = _target(element, key, named)
        if target is not None and (found := _format_of(target, named, depth + 1)) is not None:
            return found
    return None


def _channels(format: Element, source: Element | None) -> Format:
    """The channels in a point's order; source: an ink source, which may say how fine each channel is."""
    resolution = _resolutions(source)
    finest = max(resolution.get("X", 0.0), resolution.get("Y", 0.0))
    found = []
    for element in format.walk():
        if element.name != "channel":
            continue
        name = element.attributes.get("name", "")
        factor = -1.0 if element.attributes.get("orientation", "+ve") == "-ve" else 1.0
        if name in ("X", "Y") and resolution.get(name):
            factor *= finest / resolution[name]
        if name == "T":
            factor *= MILLISECONDS.get(element.attributes.get("units", "ms"), 1.0)
        found.append(Channel(name, factor))
    often = len(found) - sum(
        len([e for e in group.walk() if e.name == "channel"])
        for group in format.children
        if group.name == "intermittentChannels"
    )
    channels = tuple(Channel(c.name, c.factor, k >= often) for k, c in enumerate(found))
    if not {"X", "Y"} <= {channel.name for channel in channels if not channel.intermittent}:
        raise InputError(format.place, "there is no channel X, or none Y")
    return channels


def _resolutions(source: Element | None) -> dict[str, float]:
    """Values a centimetre of the channels of an ink source."""
    found: dict[str, float] = {}
    for element in source.walk() if source is not None else ():
        if element.name == "channelProperty" and element.attributes.get("name") == "resolution":
            try:
                value = float(element.attributes.get("value", ""))
            except ValueError:
                raise InputError(element.place, "value is not a number") from None
            per = PER_CENTIMETRE.get(element.attributes.get("units", ""))
            if per and math.isfinite(value) and value > 0:
                found[element.attributes.get("channel", "")] = value * per
    return found


def _rows(trace: _Trace) -> list[Row]:
    """The points [x, y] or [x, y, t] of a trace."""
    columns = {channel.name: k for k, channel in enumerate(trace.format)}
    wanted = [(columns[name], trace.format[columns[name]].factor) for name in "XYT" if name in columns]
    least = sum(not channel.intermittent for channel in trace.format)
    rows: list[Row] = []
    for values in _explicit(trace, least) or _told(trace, least):
        row = [values[k] * factor for k, factor in wanted]
        if all(map(math.isfinite, row[:2])):
            rows.append(row if all(map(math.isfinite, row)) else row[:2])
    return rows


def _explicit(trace: _Trace, least: int) -> list[Row]:
    """The values of points that are nothing but numbers between spaces, as most are; else none."""
    text = trace.element.text.strip().removesuffix(",")
    if NUMBERS.fullmatch(text) is None:
        return []
    try:
        points = [[float(value) for value in point.split()] for point in text.split(",")]
    except ValueError:
        return []
    width = len(trace.format)
    return points if least == width and all(len(point) == width for point in points) else []


def _told(trace: _Trace, least: int) -> Iterator[Row]:
    """The values of every point, by all that the specification allows to write."""
    state = [_Column() for _ in trace.format]
    texts = trace.element.text.split(",")
    for number, text in enumerate(texts):
        if not text.strip():
            if number == len(texts) - 1:  # a comma may end a trace
                continue
            raise InputError(f"{trace.element.place} point {number}", "there is none between two commas")
        place = f"{trace.element.place} point {number}"
        count = _take(text, state, place)
        if count < least:
            raise InputError(place, f"{count} values of {least} channels")
        yield [column.value for column in state]


def _take(text: str, state: list[_Column], place: str) -> int:
    """Read a point's values into their columns; returns how many there were."""
    at, count = 0, 0
    while at < len(text) and not text[at:].isspace():
        found = VALUE.match(text, at)
        if found is None:
            raise InputError(place, f"{text[at:].strip()[:20]!r} is no value")
        if count == len(state):
            raise InputError(place, f"more values than its {len(state)} channels")
        try:
            state[count].take(found["order"], found["value"])
        except ValueError as e:
            raise InputError(place, str(e)) from None
        at, count = found.end(), count + 1
    return count


@dataclass
class _Column:
    """The running value of a channel, its difference and the order that its next values are of."""

    value: float = math.nan
    change: float = 0.0
    turn: float = 0.0
    order: int = 0

    def take(self, sign: str, text: str) -> None:
        """The next value: explicit, or a first or second difference; ``*`` is the last one once more."""
        if sign:
            self.order = ORDERS[sign]
        if self.order and math.isnan(self.value):
            raise ValueError("a trace begins with explicit values, not with differences")
        if text == "?":  # not known
            if not self.order:
                self.value = math.nan
            return
        given = self._last if text == "*" else _number(text)
        if self.order == 0:
            self.change, self.turn = 0.0, 0.0
            self.value = given
        elif self.order == 1:
            self.change, self.turn = given, 0.0
            self.value += self.change
        else:
            self.turn = given
            self.change += self.turn
            self.value += self.change

    @property
    def _last(self) -> float:
        return (self.value, self.change, self.turn)[self.order]


def _number(text: str) -> float:
    if text in "TF":
        return float(text == "T")
    if "#" in text:
        sign, _, digits = text.partition("#")
        return float(int(sign + digits, 16))
    return float(text.replace(" ", ""))
