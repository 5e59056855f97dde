"""What was recognized, drawn over the ink."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import BLOOM, ONE, Box, Canvas, fixed
from cli.render.outline import segment
from cli.render.style import CLEAN, PALETTE, RGB, mix, rgb
from cli.render.text import lettering

if TYPE_CHECKING:
    from sketch.ink import Stroke
    from sketch.recognize import Reading, Recognition

__all__ = ["overlay"]

Array = NDArray[np.float64]

# of an overlay [pixels]; a larger picture is reduced, a smaller one drawn as large as it is
LONGER_SIDE = 1600
SURE = 0.95  # probability from which a name stands alone
BODIES = ("circle", "rectangle", "polygon", "bar")
ANCHOR, PIVOT, GRAVITY = (rgb(color) for color in ("#b5651d", "#111418", "#0b6e4f"))


def overlay(recognition: Recognition) -> Canvas:
    """The page with its ink, every reading's outline and name over it; ink that was not read in red."""
    sketch = recognition.sketch
    if sketch.picture is not None:
        height, width = sketch.picture.shape[:2]
    else:
        width, height = sketch.width or _extent(recognition, 0), sketch.height or _extent(recognition, 1)
    scale = min(1.0, LONGER_SIDE / max(width, height))
    canvas = Canvas.plain((max(1, round(width * scale)), max(1, round(height * scale))), CLEAN.paper)
    page = _Page(canvas, scale)
    if sketch.picture is not None:
        page.lay(sketch.picture)
    page.ink([stroke.points for stroke in sketch.strokes], (120, 126, 138))
    ids = {tuple(body.strokes or ()): body.id for body in recognition.scene.bodies}
    bodies = 0
    labels: list[tuple[Array, str, RGB]] = []
    for reading in sorted(recognition.readings, key=lambda reading: reading.kind == "unread"):  # on top
        color = _color(reading, bodies)
        bodies += reading.kind in BODIES
        _draw_reading(page, reading, color, [sketch.strokes[k].points for k in reading.strokes])
        labels.append((_label_at(reading, sketch.strokes), _name(reading, ids), color))
    for at, text, color in labels:  # last, so that no outline crosses a name
        page.label(at, text, color)
    return canvas


def _extent(recognition: Recognition, axis: int) -> float:
    ends = [
        float(stroke.points[:, axis].max()) for stroke in recognition.sketch.strokes if len(stroke.points)
    ]
    return max(ends, default=64.0) + 20


def _color(reading: Reading, nth: int) -> RGB:
    special = {"anchor": ANCHOR, "pivot": PIVOT, "gravity": GRAVITY, "unread": CLEAN.signal}
    return special.get(reading.kind) or rgb(PALETTE[nth % len(PALETTE)])


def _draw_reading(page: _Page, reading: Reading, color: RGB, strokes: list[Array]) -> None:
    v = reading.outline
    if reading.kind == "bar":
        page.lines(v, color)
    elif reading.kind in BODIES:
        page.tint(v, color, 0.16)
        page.lines(v, color, closed=True)
    elif reading.kind == "anchor" and len(v) >= 4:
        page.lines(v[:2], color, width=4)
        page.lines(v[2:4], color, width=4)
    elif reading.kind == "pivot":
        page.tint(v, color, 0.25)
        page.lines(v, color, closed=True)
    elif reading.kind == "gravity" and len(v) >= 2:
        page.arrow(v[0], v[1], color)
    else:
        page.ink(strokes, color, width=2)


def _name(reading: Reading, ids: dict[tuple[int, ...], str]) -> str:
    """What it is, as notes and `--read` name it: a body by its id, all else by its strokes; and how probable that is
    where there is a doubt.

    ids: of bodies, by their strokes.
    """
    name = f"{reading.kind} {','.join(map(str, reading.strokes))}"
    if reading.kind in BODIES:
        name = f"{ids.get(reading.strokes, '')} {reading.kind}".strip()
    return name if reading.kind == "unread" or reading.score >= SURE else f"{name} {reading.score:.0%}"


def _label_at(reading: Reading, strokes: list[Stroke]) -> Array:
    """The topmost point of the outline above its middle; of the ink where there is no outline."""
    v = reading.outline
    if reading.kind == "gravity" and len(v):
        tail: Array = v[0]
        return tail
    if len(v) < 2:
        v = np.concatenate([strokes[k].points for k in reading.strokes])
    middle = float(v[:, 0].min() + v[:, 0].max()) / 2
    ends = np.roll(v, -1, axis=0)
    crosses = (v[:, 0] - middle) * (ends[:, 0] - middle) <= 0
    a, b = v[crosses], ends[crosses]
    along = np.divide(middle - a[:, 0], b[:, 0] - a[:, 0], out=np.zeros(len(a)), where=b[:, 0] != a[:, 0])
    return np.array([middle, float((a[:, 1] + along * (b[:, 1] - a[:, 1])).min(initial=v[:, 1].max()))])


class _Page:
    """A canvas in the sketch's own pixels."""

    def __init__(self, canvas: Canvas, scale: float) -> None:
        self.canvas, self.scale = canvas, scale
        self.size = (canvas.planes[0].shape[1], canvas.planes[0].shape[0])
        self.unit = max(0.7, max(self.size) / 1280)
        self._taken: list[Box] = []

    def lay(self, picture: NDArray[np.uint8]) -> None:
        """The picture itself, paled, under everything."""
        import cv2

        small = cv2.resize(picture, self.size, interpolation=cv2.INTER_AREA)
        self.canvas.planes[0][:] = cv2.addWeighted(small, 0.55, np.full_like(small, 255), 0.45, 0)

    def ink(self, strokes: list[Array], color: RGB, width: int = 1) -> None:
        import cv2

        lines = [fixed(points * self.scale) for points in strokes]
        cv2.polylines(self.canvas.planes[0], lines, False, color[::-1], width, cv2.LINE_AA, 4)

    def tint(self, v: Array, color: RGB, share: float) -> None:
        import cv2

        mask = np.zeros(self.size[::-1], np.uint8)
        cv2.fillPoly(mask, [fixed(v * self.scale)], round(255 * share), cv2.LINE_AA, 4)
        self.canvas.blend(mask, (0, 0), color)

    def lines(self, v: Array, color: RGB, closed: bool = False, width: float = 2.4) -> None:
        """Straight lines of a true width through the points, round at the corners."""
        import cv2

        v = v * self.scale
        wide = max(width * self.unit - 2 * BLOOM, 0.4)
        ends = np.roll(v, -1, axis=0) if closed else v[1:]
        for a, b in zip(v, ends, strict=False):
            self.canvas.polygon(fixed(segment(a, b, wide)), color)
        for p in v:
            x, y = fixed(p).tolist()
            cv2.circle(self.canvas.planes[0], (x, y), round(wide / 2 * ONE), color[::-1], -1, cv2.LINE_AA, 4)

    def arrow(self, tail: Array, head: Array, color: RGB) -> None:
        along = (head - tail) / max(float(np.hypot(*(head - tail))), 1e-9)
        across, size = np.array([-along[1], along[0]]), 16 * self.unit / self.scale
        self.lines(np.array([tail, head]), color, width=3.4)
        sides = [head - along * size + across * size * side for side in (0.5, -0.5)]
        self.lines(np.array([sides[0], head, sides[1]]), color, width=3.4)

    def label(self, at: Array, text: str, color: RGB) -> None:
        """A name on a pale plate, centred above a point, inside the page and clear of other names."""
        mask = lettering(text, max(8, round(10 * self.unit)))
        height, width = mask.shape
        x = int(np.clip(at[0] * self.scale - width / 2, 0, max(0, self.size[0] - width)))
        above = at[1] * self.scale - height - 2
        tries = [above + height * k for k in (0, -1, 1, -2, 2, -3, 3)]
        y = next((y for y in tries if self._is_free((x, int(y), x + width, int(y) + height))), above)
        y = int(np.clip(y, 0, max(0, self.size[1] - height)))
        self._taken.append((x, y, x + width, y + height))
        self.canvas.blend(np.full((height, width), 190, np.uint8), (x, y), CLEAN.paper)
        self.canvas.blend(mask, (x, y), mix(color, (0, 0, 0), 0.35))

    def _is_free(self, box: Box) -> bool:
        left, top, right, bottom = box
        return (
            top >= 0
            and bottom <= self.size[1]
            and not any(left < r and x < right and top < b and t < bottom for x, t, r, b in self._taken)
        )
