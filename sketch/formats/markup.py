"""XML as a small tree that remembers its lines; what could blow up while it is read is refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn

from sim.scene import InputError

__all__ = ["Element", "parse_xml"]

MAX_BYTES = 24 << 20  # as of stroke JSON: as XML the same ink is no smaller
MAX_DEPTH = 200  # elements within elements: drawing programs nest groups ten deep or so
KEPT = {"xml:id": "id", "xlink:href": "href"}  # of the attributes with a prefix


@dataclass(eq=False)
class Element:
    """An element, its name without the prefix of its namespace.

    attributes: those without a prefix, and xml:id and xlink:href without theirs.
    text: all characters directly inside.
    line: where it begins, from 1.
    """

    name: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    @property
    def place(self) -> str:
        """For messages: ``line 12: <trace>``."""
        return f"line {self.line}: <{self.name}>"

    def walk(self) -> Iterator[Element]:
        """This element and all below it, in the file's order."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed(element.children)


def parse_xml(data: bytes) -> Element:
    """The root of an XML file. Raises InputError with line and column for what is not XML.

    Entities of the file's own are refused: nested, they grow a small file without bound.
    """
    from xml.parsers import expat

    if len(data) > MAX_BYTES:
        raise InputError(
            "", f"{len(data) / 1e6:.0f} MB of XML; at most {MAX_BYTES / 1e6:.0f} MB are taken", kind="size"
        )
    parser = expat.ParserCreate()
    parser.buffer_text = True
    top = Element("", {}, 0)
    inside, texts = [top], [[""]]

    def refuse(name: str, *_: object) -> NoReturn:
        raise InputError(
            f"line {parser.CurrentLineNumber}",
            f"the entity {name!r} is not taken",
            "save it as plain XML",
            kind="format",
        )

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(inside) > MAX_DEPTH:
            raise InputError(f"line {parser.CurrentLineNumber}", "elements nested too deeply", kind="format")
        local = {KEPT[key]: value for key, value in attributes.items() if key in KEPT}
        local |= {key: value for key, value in attributes.items() if ":" not in key and key != "xmlns"}
        element = Element(name.rpartition(":")[2], local, parser.CurrentLineNumber)
        inside[-1].children.append(element)
        inside.append(element)
        texts.append([])

    def end(_: str) -> None:
        inside.pop().text = "".join(texts.pop())

    parser.EntityDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = lambda text: texts[-1].append(text)
    try:
        parser.Parse(data, True)
    except expat.ExpatError as e:
        problem = expat.ErrorString(e.code)
        raise InputError(
            f"line {e.lineno} column {e.offset + 1}", f"not XML: {problem}", kind="format"
        ) from None
    except (LookupError, ValueError) as e:  # an encoding that Python does not know
        if isinstance(e, InputError):
            raise
        raise InputError("line 1", f"not XML: {e}", kind="format") from None
    return top.children[0]
