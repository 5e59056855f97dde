"""Colours and line widths: how a scene looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from sim.scene import Scene

__all__ = ["CLEAN", "RGB", "Style", "body_colors", "mix", "rgb"]

RGB: TypeAlias = tuple[int, int, int]

# Paul Tol's "bright" scheme: told apart with any of the usual kinds of colour-blindness.
PALETTE = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377")
FIXED = "#9a978f"  # anchored bodies, unless they have a colour of their own


@dataclass(frozen=True)
class Style:
    """Colours as (red, green, blue).

    Attributes:
        paper: the background.  ink: text, scale bar, gravity.  drawn: the person's strokes, lying under it.
        signal: what needs attention.
        line: width of outlines in a picture 720 pixels high [pixels].
    """

    paper: RGB = (252, 251, 248)
    ink: RGB = (45, 48, 56)
    drawn: RGB = (206, 210, 218)
    signal: RGB = (214, 40, 57)
    line: float = 2.2


CLEAN = Style()


def rgb(color: str) -> RGB:
    """ "#4477aa" as (red, green, blue)."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def mix(a: RGB, b: RGB, share: float) -> RGB:
    """`a` with a `share` (0 to 1) of `b` in it."""
    return tuple(round(x + (y - x) * share) for x, y in zip(a, b, strict=True))  # type: ignore[return-value]


def body_colors(scene: Scene) -> list[RGB]:
    """Each body's own colour, or the next of the palette; anchored bodies stay grey."""
    colors, used = [], 0
    for body in scene.bodies:
        if body.color is not None:
            colors.append(rgb(body.color))
        elif body.anchored:
            colors.append(rgb(FIXED))
        else:
            colors.append(rgb(PALETTE[used % len(PALETTE)]))
            used += 1
    return colors
