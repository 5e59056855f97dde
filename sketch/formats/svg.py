"""SVG drawings: the lines and outlines that are seen, each a stroke.

Styles, units, transforms and `use` are svgelements' work (extra `svg`); here stands what of it is ink.
"""

from __future__ import annotations

import io
import math
import re
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.scene import InputError
from sketch.formats import arrowheads, brush, strokes
from sketch.formats.markup import Element, parse_xml
from sketch.ink import Sketch
from sketch.typing import Array

if TYPE_CHECKING:
    from xml.etree import ElementTree as ET

__all__ = ["read"]

NO_INK = ("text", "image", "foreignObject")  # seen, but no lines
UNSEEN = ("clipPath", "mask", "marker", "pattern", "title", "desc", "metadata")

NAME = re.compile(r"[A-Za-z][\w.-]*")  # what is left of another program's own element may be none
NUMBER = r"[+-]?(\d++\.?\d*+|\.\d++)([eE][+-]?\d++)?"
LENGTH = re.compile(NUMBER + r"\s*(px|pt|pc|mm|cm|in|em|ex|ch|rem|vw|vh|%)?")
# These two match the longest beginning that is right, and so never need to go back.
PATH = re.compile(r"\s*([mM]([\s,]*(" + NUMBER + r"|[MmZzLlHhVvCcSsQqTtAa]))*[\s,]*)?")
POINTS = re.compile(r"([\s,]*" + NUMBER + r")*[\s,]*")
COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
# Numbers that each command takes, again and again; an arc's flags may stand without a space between.
ARITY = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}
LENGTHS = {
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "line": ("x1", "y1", "x2", "y2"),
}
MAX_ELEMENTS = 20_000  # drawn, as often as each is used: four times the strokes that are taken
MAX_LENGTH = 2_000_000  # characters of all paths: a page of 200 strokes of 500 points has less
MAX_DEPTH = 400  # of elements and of what they use: Python itself gives up at a thousand calls
STEP = 3.0  # pixels between the points of a curve
MOST = 400  # points of one curve


def read(data: bytes) -> Sketch:
    """Read a drawing; the page is the file's width and height in pixels (96 an inch).

    Raises InputError with the line of what is wrong, and where svgelements is not installed.
    """
    root = parse_xml(data)
    length = sum(len(e.attributes.get(name, "")) for e in root.walk() for name in ("d", "points"))
    if length > MAX_LENGTH:
        raise InputError("", f"{length} characters of paths; at most {MAX_LENGTH} are taken", kind="size")
    for element in root.walk():
        _check(element)
    _Uses(root).count(root, 0)
    svg = _parsed(root)
    width, height = float(svg.width or 0), float(svg.height or 0)
    found: list[list[list[float]]] = []
    for shape in _shapes(svg):
        if not _is_paper(shape, width, height):
            found += _strokes(shape, math.hypot(width, height))
    if not found:
        raise InputError(
            "", "nothing is drawn in this SVG file", "text and pictures in it are not read", kind="empty"
        )
    page = {"width": width, "height": height} if width > 0 and height > 0 else {}
    sketch = strokes.from_objects({"strokes": found, **page})
    left = Counter(element.name for element in root.walk() if element.name in NO_INK)
    sketch.notes.extend(f"left out: {count} x {name}" for name, count in sorted(left.items()))
    return sketch


class _Uses:
    """Counts what is drawn with every `use` in the place of what it stands for.

    Few lines that use each other again and again would be more shapes than any page has.
    """

    def __init__(self, root: Element) -> None:
        self.named = {e.attributes["id"]: e for e in root.walk() if "id" in e.attributes}
        self.counts: dict[Element, int | None] = {}  # None while an element is being counted

    def count(self, element: Element, depth: int) -> int:
        if element in self.counts:
            known = self.counts[element]
            if known is None:
                raise InputError(element.place, "it is used in itself")
            return known
        if depth > MAX_DEPTH:
            raise InputError(element.place, "elements use each other too deeply", kind="size")
        self.counts[element] = None
        inside = list(element.children)
        if element.name == "use":
            target = self.named.get(element.attributes.get("href", "").removeprefix("#"))
            inside += [target] if target is not None else []
        total = 1 + sum(self.count(e, depth + 1) for e in inside)
        if total > MAX_ELEMENTS:
            raise InputError(element.place, f"more than {MAX_ELEMENTS} elements are used", kind="size")
        self.counts[element] = total
        return total


def _parsed(root: Element) -> Any:
    from xml.etree.ElementTree import tostring

    try:
        from svgelements import SVG
    except ModuleNotFoundError:
        raise InputError(
            "", "SVG drawings need the package svgelements", "pip install svgelements", kind="extra"
        ) from None
    try:
        return SVG.parse(io.BytesIO(tostring(_seen(root))), reify=True)
    except (ValueError, TypeError, ArithmeticError, LookupError, AttributeError, RecursionError) as e:
        raise InputError("", f"an SVG file that cannot be understood: {e}", kind="format") from None


def _seen(element: Element) -> ET.Element:
    """The element and what is drawn in it, as svgelements needs it."""
    from xml.etree.ElementTree import Element as Node

    attributes = dict(element.attributes)
    if element.name == "svg":
        attributes |= _page(attributes)
    node = Node(element.name, attributes)
    node.text = element.text
    for child in element.children:
        if child.name == "symbol":  # seen only where it is used
            node.append(defs := Node("defs"))
            defs.append(_seen(child))
        elif child.name not in UNSEEN and NAME.fullmatch(child.name):
            node.append(_seen(child))
    return node


def _page(attributes: dict[str, str]) -> dict[str, str]:
    """The size of an <svg> where its view box alone says it, and the view box where the size alone does.

    Without the one there is no page, and without the other lengths in per cent are not those of the page.
    """
    sides = [LENGTH.fullmatch(attributes.get(name, "").strip()) for name in ("width", "height")]
    known = [side for side in sides if side is not None and side[3] != "%"]
    box = re.split(r"[\s,]+", attributes.get("viewBox", "").strip())
    if len(box) == 4 and not known:
        return {"width": box[2], "height": box[3]}
    if len(box) != 4 and len(known) == 2 and all(side[3] in (None, "px") for side in known):
        return {"viewBox": "0 0 " + " ".join(side[0].removesuffix("px").strip() for side in known)}
    return {}


def _check(element: Element) -> None:
    """That numbers are numbers: svgelements leaves out what it cannot read without a word."""
    for name in LENGTHS.get(element.name, ()):
        value = element.attributes.get(name, "0").strip()
        if LENGTH.fullmatch(value) is None and value not in ("", "auto"):
            raise InputError(element.place, f"{name} is not a length: {value[:40]!r}")
    data = {"path": ("d", PATH), "polyline": ("points", POINTS), "polygon": ("points", POINTS)}
    if element.name in data:
        name, pattern = data[element.name]
        value = element.attributes.get(name, "").lstrip()
        found = pattern.match(value)
        end = found.end() if found is not None else 0
        if end < len(value):
            raise InputError(element.place, f"{name} cannot be read from {value[end : end + 20]!r} on")
        for command in COMMAND.finditer(value) if name == "d" else ():
            arity, count = ARITY.get(command[1].upper()), len(re.findall(NUMBER, command[2]))
            if arity and (count == 0 or count % arity):
                raise InputError(
                    element.place, f"d has {count} numbers after {command[1]}, which takes them by {arity}"
                )


def _shapes(svg: Any) -> Iterator[Any]:
    """The shapes that leave a mark, in the order of drawing."""
    from svgelements import Shape

    for shape in svg.elements():
        hidden = isinstance(shape, Shape) and (shape.values or {}).get("visibility", "visible") != "visible"
        if isinstance(shape, Shape) and not hidden and (_shows(shape.stroke) or _shows(shape.fill)):
            yield shape


def _shows(color: Any) -> bool:
    return color is not None and color.value is not None and color.alpha != 0


def _is_paper(shape: Any, width: float, height: float) -> bool:
    """Whether a shape without an outline covers the page: programs put it under their drawings."""
    if _shows(shape.stroke) or width <= 0 or height <= 0:
        return False
    box = shape.bbox()
    if box is None:
        return False
    slack = 0.01 * max(width, height)
    return bool(box[0] <= slack and box[1] <= slack and box[2] >= width - slack and box[3] >= height - slack)


def _strokes(shape: Any, diagonal: float) -> list[list[list[float]]]:
    """A stroke for each part of a shape between two lifts of the pen [pixels], and the heads of arrows.

    diagonal: of the page.
    """
    from svgelements import Path

    path = abs(Path(shape))
    found: list[list[list[float]]] = []
    for part in path.as_subpaths():
        points = _points(part)
        if len(points) < 2:
            continue
        if not _shows(shape.stroke):
            points = _filled(points, diagonal)
        found.append(points.tolist())
    if found:
        values = shape.values or {}
        ends = (("marker-start", found[0][1::-1]), ("marker-end", found[-1][-2:]))
        for name, (before, tip) in ends:
            if values.get(name, "none") != "none":
                head = arrowheads.head((before[0], before[1]), (tip[0], tip[1]))
                found += [[list(point) for point in head]] if head else []
    return found


def _filled(outline: Array, diagonal: float) -> Array:
    """What a filling without an outline shows: where a pen went, or its own border, which ends where it began."""
    middle = brush.centre_line(outline, diagonal) if np.isfinite(outline).all() else None
    if middle is not None:
        return middle
    return outline if bool((outline[0] == outline[-1]).all()) else np.concatenate([outline, outline[:1]])


def _points(part: Any) -> Array:
    from svgelements import Close, Line, Move

    runs: list[Array] = []
    for segment in part:
        if not isinstance(segment, (Move, Line, Close)):
            runs.append(_curve(segment))
        elif segment.end is not None:
            runs.append(np.array([[segment.end.x, segment.end.y]]))
    points = np.concatenate(runs) if runs else np.zeros((0, 2))
    new = np.ones(len(points), bool)  # closing a path that is closed already adds nothing
    with np.errstate(invalid="ignore"):  # of infinite points, which whoever reads them reports
        new[1:] = ~(np.abs(np.diff(points, axis=0)).max(axis=1) <= 1e-6)
    return points[new]


def _curve(segment: Any) -> Array:
    """Points of a curve after its first, about STEP apart."""
    rough = _along(segment, 17)
    if not np.isfinite(rough).all():
        return rough[1:]  # whoever reads the points says so
    length = min(float(np.hypot(*np.diff(rough, axis=0).T).sum()), STEP * MOST)
    return _along(segment, max(8, math.ceil(length / STEP)) + 1)[1:]


def _along(segment: Any, count: int) -> Array:
    points = [segment.point(t) for t in np.linspace(0, 1, count).tolist()]
    return np.array([[p.x, p.y] for p in points])
