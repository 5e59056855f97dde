"""The .svg output: the scene as it is drawn, in metres turned to the picture's pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from cli.render.figure import Figure
from cli.render.ink import Ink
from cli.render.style import RGB, Paints
from sim.scene import Circle, Joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["svg"]


def svg(figure: Figure, ink: Ink | None = None) -> bytes:
    """The scene before it moves, as SVG 1.1."""
    (width, height), style = figure.camera.size, figure.style
    strokes = _strokes(figure, ink or [])
    bodies = [_body(figure, k) for k in range(len(figure.scene.bodies))]
    if style.moves_ink and ink:
        content = [*bodies, *strokes]
    else:
        supports = [_support(figure, joint) for joint in figure.scene.joints if None in joint.bodies]
        pivots = [_pivot(figure, joint) for joint in figure.scene.joints]
        content = [*strokes, *supports, *bodies, *pivots]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}" stroke-linejoin="round" stroke-linecap="round" fill="none">',
            f'<rect width="{width}" height="{height}" fill="{_css(style.paper)}"/>',
            *content,
            *_annotations(figure),
            "</svg>\n",
        ]
    ).encode()


def _strokes(figure: Figure, ink: Ink) -> list[str]:
    """The person's strokes."""
    return [
        f'<g stroke="{_css(figure.style.drawn)}" stroke-width="{figure.pen.unit:g}">',
        *(f'<polyline points="{_points(figure.camera.pixels(stroke))}"/>' for _, stroke in ink),
        "</g>",
    ]


def _body(figure: Figure, k: int) -> str:
    """A body under its id as the title."""
    body, paints, line = figure.scene.bodies[k], figure.paints[k], figure.pen.width
    plain = figure.style.moves_ink
    hatched = body.anchored and not plain
    before = _hatch(f"hatch{k}", 11 * figure.pen.unit, paints) if hatched else ""
    edge = "" if plain else f' stroke="{_css(paints.edge)}" stroke-width="{line:g}"'
    look = f'fill="{f"url(#hatch{k})" if hatched else _css(paints.filling)}"{edge}'
    named = f"<title>{_text(body.id)}</title>"
    if not isinstance(body.shape, Circle):
        corners = _points(figure.camera.pixels(np.array(body.outline())))
        return f'{before}<polygon points="{corners}" {look}>{named}</polygon>'
    x, y = figure.camera.pixels(np.array(body.position))
    r = body.shape.radius * figure.camera.scale
    mark = ""
    if not body.anchored:
        end = f"M{x:.2f} {y:.2f}l{r * np.cos(body.angle):.2f} {-r * np.sin(body.angle):.2f}"
        mark = f'<path d="{end}" stroke="{_css(paints.edge)}" stroke-width="{line:g}"/>'
    return f'{before}<g><circle cx="{x:.2f}" cy="{y:.2f}" r="{r:.2f}" {look}/>{mark}{named}</g>'


def _pivot(figure: Figure, joint: Joint) -> str:
    x, y = figure.camera.pixels(np.array(joint.position))
    u, paper, ink = figure.pen.unit, _css(figure.style.paper), _css(figure.style.ink)
    ring = f'r="{6 * u:g}" fill="{paper}" stroke="{ink}" stroke-width="{figure.pen.width:g}"'
    at = f'cx="{x:.2f}" cy="{y:.2f}"'
    return f'<circle {at} {ring}/><circle {at} r="{2.4 * u:g}" fill="{ink}"/>'


def _support(figure: Figure, joint: Joint) -> str:
    """The triangle on hatched ground under a pivot on the background."""
    x, y = figure.camera.pixels(np.array(joint.position))
    u = figure.pen.unit
    lines = [f"M{x:.2f} {y:.2f}l{15 * u:g} {24 * u:g}h{-30 * u:g}z", f"m{-22.5 * u:g} {24 * u:g}h{45 * u:g}"]
    lines += [f"M{x + k * u:.2f} {y + 24 * u:.2f}l{-6 * u:g} {8 * u:g}" for k in range(-17, 23, 8)]
    return (
        f'<path d="{"".join(lines)}" stroke="{_css(figure.style.ink)}" stroke-width="{figure.pen.width:g}"/>'
    )


def _hatch(name: str, period: float, paints: Paints) -> str:
    """The pattern of what is fixed."""
    return (
        f'<pattern id="{name}" patternUnits="userSpaceOnUse" width="{period:g}" height="{period:g}" '
        f'patternTransform="rotate(45)"><rect width="{period:g}" height="{period:g}" '
        f'fill="{_css(paints.filling)}"/><path d="M0 0V{period:g}" stroke="{_css(paints.stripes)}" '
        f'stroke-width="{0.25 * period:g}"/></pattern>'
    )


def _annotations(figure: Figure) -> list[str]:
    """The scale bar and gravity."""
    width, u, ink = figure.camera.size[0], figure.pen.unit, _css(figure.style.ink)
    x, y, long = figure.bar.left, figure.bar.bottom, figure.bar.long
    font = (
        f'font-family="sans-serif" font-size="{18 * u:g}" fill="{ink}" '
        f'stroke="{_css(figure.style.paper)}" stroke-width="{4 * u:g}" paint-order="stroke"'
    )
    bar = f"M{x:g} {y - 5 * u:g}v{10 * u:g}m0 {-5 * u:g}h{long:.2f}m0 {-5 * u:g}v{10 * u:g}"
    out = [
        f'<path d="{bar}" stroke="{ink}" stroke-width="{figure.pen.width:g}"/>',
        f'<text x="{x:g}" y="{y - 12 * u:g}" {font}>{figure.bar.label}</text>',
    ]
    g = np.array(figure.scene.gravity) * (1, -1)
    if not g.any():
        return [
            *out,
            f'<text x="{width - 24 * u:g}" y="{34 * u:g}" text-anchor="end" {font}>no gravity</text>',
        ]
    along = g / np.hypot(*g)
    across = np.array([-along[1], along[0]])
    middle = np.array([width - 48 * u, 52 * u])
    tip = middle + along * 26 * u
    arrow = [middle - along * 26 * u, tip]
    head = [tip + (-along + 0.5 * side * across) * 13 * u for side in (1, -1)]
    strokes = (arrow, [head[0], tip, head[1]])
    lines = "".join(f'<polyline points="{_points(np.array(stroke))}"/>' for stroke in strokes)
    out.append(f'<g stroke="{ink}" stroke-width="{1.4 * figure.pen.width:g}">{lines}</g>')
    x, y = middle + np.array([-30, 6]) * u + (abs(along[0]) > 0.7) * np.array([24, 26]) * u
    return [*out, f'<text x="{x:g}" y="{y:g}" {font}>g</text>']


def _points(pixels: NDArray[np.float64]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in pixels)


def _text(text: str) -> str:
    return quoteattr(text)[1:-1]


def _css(color: RGB) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)
