"""Colours and line widths: how a scene looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from sim.scene import Scene

__all__ = ["CLEAN", "RGB", "STYLES", "Paints", "Style", "body_paints", "mix", "rgb"]

RGB: TypeAlias = tuple[int, int, int]

# Paul Tol's "bright" scheme: told apart with any of the usual kinds of colour-blindness.
PALETTE = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377")
FIXED = "#9a978f"  # anchored bodies, unless they have a colour of their own


@dataclass(frozen=True)
class Style:
    """Colours as (red, green, blue).

    Attributes:
        paper: the background.  ink: text, scale bar, gravity, pivots.
        drawn: the person's strokes, lying under the bodies.
        signal: what needs attention.
        velocity, force: of the arrows that show them.
        edge: of outlines, mixed with the body's colour.
        pale, anchored_pale: share of paper in the filling of a body that moves, and of one that does not.
        line: width of outlines in a picture 720 pixels high [pixels].
        grid: colour of squares on the paper, or None.
        moves_ink: whether bodies are shown as the person's own strokes.
    """

    paper: RGB = (252, 251, 248)
    ink: RGB = (45, 48, 56)
    drawn: RGB = (206, 210, 218)
    signal: RGB = (214, 40, 57)
    velocity: RGB = (68, 119, 170)
    force: RGB = (214, 40, 57)
    edge: RGB = (45, 48, 56)
    pale: float = 0.12
    anchored_pale: float = 0.72
    line: float = 2.2
    grid: RGB | None = None
    moves_ink: bool = False


CLEAN = Style()
INK = Style(drawn=(45, 48, 56), pale=0.78, anchored_pale=0.88, moves_ink=True)
BLUEPRINT = Style(
    paper=(24, 58, 112),
    ink=(236, 242, 250),
    drawn=(52, 88, 144),
    velocity=(140, 200, 255),
    force=(255, 110, 110),
    edge=(255, 255, 255),
    pale=0.72,
    anchored_pale=0.86,
    line=2.0,
    grid=(36, 71, 127),
)
STYLES = {"clean": CLEAN, "ink": INK, "blueprint": BLUEPRINT}


class Paints(NamedTuple):
    """The colours of one body; stripes: of its hatching when it is anchored."""

    color: RGB
    filling: RGB
    edge: RGB
    stripes: RGB


def rgb(color: str) -> RGB:
    """ "#4477aa" as (red, green, blue)."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def mix(a: RGB, b: RGB, share: float) -> RGB:
    """`a` with a `share` (0 to 1) of `b` in it."""
    return tuple(round(x + (y - x) * share) for x, y in zip(a, b, strict=True))  # type: ignore[return-value]


def body_paints(scene: Scene, style: Style) -> list[Paints]:
    """Each body in its own colour, or the next of the palette; anchored bodies stay grey."""
    paints, used = [], 0
    for body in scene.bodies:
        if body.color is not None:
            color = rgb(body.color)
        elif body.anchored:
            color = rgb(FIXED)
        else:
            color = rgb(PALETTE[used % len(PALETTE)])
            used += 1
        filling = mix(color, style.paper, style.anchored_pale if body.anchored else style.pale)
        paints.append(Paints(color, filling, mix(color, style.edge, 0.62), mix(color, style.edge, 0.12)))
    return paints
