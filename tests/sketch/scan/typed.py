"""What is printed on a sheet before anyone draws on it: a worksheet's title, its problem and lines to answer on, a
letterhead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["Print", "typed"]

Array = NDArray[Any]

FINE = 2  # as ink, print is drawn with this many pixels for one, each way
BELOW = 1.9  # times the height of its capitals: from a line of print to the next
TEXT = (
    "A ball of mass rolls down the ramp without slipping and hits block at rest Find its speed when time from is "
    "to in Draw forces that act on each body Gravity 9.81 m/s2 friction 0.3 neglect air released at height h What "
    "happens next? (see figure) Explain your answer, using energy; a cart with two wheels, beam pivots about pin."
)


@dataclass(frozen=True)
class Print:
    """What is printed above a drawing and below it.

    Attributes:
        tall: height of a capital [pixels of the drawing].  face: a font of cv2's.  heavy: its lines' width, as a share
            of that height.
        fields: whether there are a name and a date to fill in, on lines, first.
        title: whether there is one, with a line below it from margin to margin.
        problem: lines of text.  answer: lines to write on, below the drawing, with a question before them.
    """

    tall: float = 17.0
    face: int = cv2.FONT_HERSHEY_COMPLEX
    heavy: float = 0.1
    fields: bool = False
    title: bool = False
    problem: int = 0
    answer: int = 0

    @property
    def above(self) -> float:
        """Height of what is above the drawing [pixels of the drawing]."""
        return BELOW * self.tall * (1.5 * self.fields + 2.5 * self.title + self.problem)

    @property
    def below(self) -> float:
        """Likewise, below it."""
        return BELOW * self.tall * (1.5 * self.answer + 1) if self.answer else 0.0


def typed(print_: Print, size: tuple[int, int], up: float, rng: np.random.Generator) -> Array:
    """How much of each pixel of a sheet is printed on, 0 to 1.

    size: height and width of the sheet [pixels].  up: pixels for one of the drawing.
    """
    height, width = (FINE * side for side in size)
    image = np.zeros((height, width), np.uint8)
    left, right = round(0.06 * width), round(0.94 * width)
    unit = FINE * up * print_.tall
    down = BELOW * unit
    heavy = max(1, round(print_.heavy * unit))
    words = TEXT.split()

    def write(text: str, x: float, y: float, large: float = 1.0, wide: int = 0) -> float:
        """Returns where it ends."""
        tall = large * unit
        scale = cv2.getFontScaleFromHeight(print_.face, round(tall), 1)
        thick = wide or max(1, round(large * heavy / 2))
        place = (round(x), round(y))
        cv2.putText(image, text, place, print_.face, scale, 255, thick, cv2.LINE_AA)
        return x + cv2.getTextSize(text, print_.face, scale, thick)[0][0]

    def rule(a: float, b: float, y: float) -> None:
        cv2.line(image, (round(a), round(y)), (round(b), round(y)), 255, max(1, heavy // 2), cv2.LINE_AA)

    def line(first: str) -> str:
        text = first
        while True:
            longer = f"{text} {words[rng.integers(len(words))]}"
            scale = cv2.getFontScaleFromHeight(print_.face, round(unit), 1)
            if cv2.getTextSize(longer, print_.face, scale, heavy)[0][0] > right - left:
                return text
            text = longer

    y = 1.6 * unit
    if print_.fields:
        a = write("Name:", left, y)
        rule(a + unit, 0.55 * width, y + 0.2 * unit)
        a = write("Date:", 0.6 * width, y)
        rule(a + unit, right, y + 0.2 * unit)
        y += 1.5 * down
    if print_.title:
        y += 0.5 * unit
        write("Physics 7 - Worksheet 3: Machines", left + 0.15 * (right - left), y, 1.6)
        rule(left, right, y + 0.9 * unit)
        y += 1.9 * down
    for k in range(print_.problem):
        text = line(f"{rng.integers(1, 9)}." if not k else "  ")
        if k == print_.problem - 1:
            text = text[: round(len(text) * rng.uniform(0.3, 1.0))]
        write(text, left, y)
        y += down
    if print_.answer:
        y = height - BELOW * unit * (1.5 * print_.answer)
        write(line("a)")[: int(rng.integers(20, 60))], left, y - 0.4 * down)
        for k in range(print_.answer):
            rule(left, right, y + 1.5 * k * down + down)
    return np.asarray(cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA) / np.float32(255))
