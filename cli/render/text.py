"""Lettering as on engineering drawings: letters of strokes of one width, rounded, in any size.

cv2's own letters differ between its versions, are ragged when small, and take as long to load as a second of
video takes to draw.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["lettering"]

Array = NDArray[np.float64]

# Strokes of each letter: points as column and row digits, rows from 0 (descenders) over 2 (base line) and 6
# (small letters) to 8 (capitals).  After ~ the points guide a curve; one point alone is a dot.
LETTERS = {
    "0": "~02 42 48 08 02", "1": "06 28 22", "2": "~06 08 48 45 02/02 42",
    "3": "~07 08 48 45 15/~15 45 42 02 03", "4": "32 38 04 44", "5": "48 08 05/~05 16 46 42 02 03",
    "6": "~48 08 02 42 46 06 04", "7": "08 48 12", "8": "~05 45 48 08 05/~02 42 45 05 02",
    "9": "~02 42 48 08 04 44 46", "a": "~46 06 02 42 46/46 42", "b": "08 02/~02 42 46 06 02",
    "c": "~45 46 06 02 42 43", "d": "48 42/~42 02 06 46 42", "e": "04 44/~44 46 06 02 42 43",
    "f": "~38 18 16/16 12/06 36", "g": "~42 02 06 46 42/46 42/~42 40 00 01",
    "h": "08 02/~04 06 46 44/44 42", "i": "06 02/08", "j": "16 12/~12 10 00/18", "k": "08 02/46 04/15 42",
    "l": "08 02", "m": "06 02/~04 06 36 34/34 32/~34 36 66 64/64 62", "n": "06 02/~04 06 46 44/44 42",
    "o": "~02 42 46 06 02", "p": "06 00/~02 42 46 06 02", "q": "46 40/~42 02 06 46 42",
    "r": "06 02/~04 06 36", "s": "~45 46 06 04 44 42 02 03", "t": "18 13/~13 12 32/06 36",
    "u": "06 04/~04 02 42 44/46 42", "v": "06 22 46", "w": "06 12 36 52 66", "x": "06 42/46 02",
    "y": "06 22/46 10", "z": "06 46 02 42", "A": "02 28 42/14 34", "B": "02 08/~08 48 45 05/~05 45 42 02",
    "C": "~46 48 08 02 42 44", "D": "02 08/~08 48 42 02", "E": "48 08 02 42/05 35", "F": "48 08 02/05 35",
    "G": "~47 48 08 02 42 44/44 24", "H": "08 02/48 42/05 45", "I": "08 02", "J": "38 34/~34 32 02 03",
    "K": "08 02/48 04/15 42", "L": "08 02 42", "M": "02 08 35 68 62", "N": "02 08 42 48",
    "O": "~02 52 58 08 02", "P": "02 08/~08 48 44 04", "Q": "~02 52 58 08 02/33 51",
    "R": "02 08/~08 48 44 04/24 42", "S": "~47 48 08 05 45 42 02 03", "T": "08 48/28 22",
    "U": "08 04/~04 02 42 44/44 48", "V": "08 22 48", "W": "08 12 36 52 68", "X": "08 42/48 02",
    "Y": "08 25 48/25 22", "Z": "08 48 02 42", ".": "02", ",": "12 01", ":": "03/06", "-": "05 35",
    "+": "05 45/27 23", "=": "04 44/06 46", "/": "01 38", "%": "02 48/~06 26 28 08 06/~22 42 44 24 22",
    "(": "~28 07 03 21", ")": "~08 27 23 01", "_": "01 41", "#": "02 38/22 58/04 54/06 56", "'": "08 06",
    "?": "~07 08 48 45 25 24/22",
}  # fmt: skip
CAPITAL = 6.0  # height in the units of LETTERS
GAP, SPACE = 2.0, 3.0
THICK = 0.85
OVERSAMPLE = 4


@lru_cache(maxsize=256)
def lettering(text: str, height: int) -> NDArray[Any]:
    """The text as a mask of opacity (h, w) uint8, sides even; `height` is that of a capital letter [pixels].

    A character without a letter here becomes a question mark.
    """
    import cv2

    unit = height / CAPITAL
    lines: list[Array] = []
    x = THICK
    for character in text:
        if character == " ":
            x += SPACE
            continue
        strokes = _strokes(character if character in LETTERS else "?")
        lines += [stroke + np.array([x, 0.0]) for stroke in strokes]
        x += max(float(stroke[:, 0].max()) for stroke in strokes) + GAP
    rows, columns = _even((8 + 2 * THICK) * unit), _even((x - GAP + THICK + 1) * unit)
    large = np.zeros((rows * OVERSAMPLE, columns * OVERSAMPLE), np.uint8)
    down = np.array([1, -1]) * unit * OVERSAMPLE
    points = [
        np.rint((line * down + (0, (8 + THICK) * unit * OVERSAMPLE)) * 16).astype(np.int32) for line in lines
    ]
    cv2.polylines(large, points, False, 255, max(1, round(THICK * unit * OVERSAMPLE) - 1), cv2.LINE_AA, 4)
    return cv2.resize(large, (columns, rows), interpolation=cv2.INTER_AREA)


@lru_cache(maxsize=128)
def _strokes(letter: str) -> list[Array]:
    strokes = []
    for text in LETTERS[letter].split("/"):
        points = np.array([[int(c) for c in pair] for pair in text.strip("~").split()], float)
        if len(points) == 1:
            points = np.repeat(points, 2, axis=0)
        strokes.append(_curve(points) if text.startswith("~") else points)
    return strokes


def _curve(v: Array) -> Array:
    """The curve that corner cutting leads to (Chaikin 1974): from the first to the last point, or around."""
    closed = bool(np.all(v[0] == v[-1]))
    for _ in range(3):
        a, b = v[:-1], v[1:]
        cut = np.stack([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b], axis=1).reshape(-1, 2)
        v = np.concatenate([cut, cut[:1]]) if closed else np.concatenate([v[:1], cut[1:-1], v[-1:]])
    return v


def _even(x: float) -> int:
    return 2 * int(np.ceil(x / 2))
