"""Frames to an animated GIF: one palette chosen for the whole motion, endless loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cli.render.animation import PLAIN, Extras, Sheet, drawn, frame_count
from cli.render.canvas import Canvas
from cli.render.figure import Figure
from cli.render.video import writing

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["choose_palette", "nearest_of", "quantized", "write_gif"]

Bytes = NDArray[np.uint8]

FASTEST = 25  # frames a second; GIF counts hundredths of a second, and browsers slow down below two of them
EXACT = 96  # the palette's colours that are taken over as they are: those of the large areas
SAMPLES, PIXELS = 8, 2_000_000  # frames, and at most so many pixels of them, that the palette is chosen from


def write_gif(
    path: str,
    figure: Figure,
    motion: Trajectory,
    fps: float,
    extras: Extras = PLAIN,
    progress: Callable[[float], None] = lambda _: None,
) -> None:
    """Write a GIF to `path`; of more than 25 frames a second only so many are taken."""
    import av

    count = frame_count(motion)
    every = max(1, round(fps / FASTEST))
    size = figure.pen.size
    page = Sheet(Canvas.plain(size, figure.style.paper))
    palette = choose_palette(_samples(figure, motion, page))
    nearest = nearest_of(palette)
    with writing(path), av.open(path, "w", format="gif", options={"loop": "0"}) as container:
        stream: Any = container.add_stream("gif", rate=Fraction(100))
        (stream.width, stream.height), stream.pix_fmt = size, "pal8"
        stream.codec_context.time_base = Fraction(1, 100)
        shown = -1
        for k, sheet in drawn(figure, motion, fps, lambda: page, extras):
            if k // every == shown and k != count - 1:
                continue
            shown = k // every
            (bgr,) = sheet.canvas.planes
            frame = _indexed(quantized(bgr, nearest), palette)
            frame.pts, frame.time_base = round(100 * k / fps), Fraction(1, 100)
            container.mux(stream.encode(frame))
            progress((k + 1) / count)
        container.mux(stream.encode(None))


def _samples(figure: Figure, motion: Trajectory, page: Sheet) -> list[Bytes]:
    """A few frames spread over the motion."""
    numbers = set(np.linspace(0, frame_count(motion) - 1, SAMPLES).astype(int).tolist())
    found: list[Bytes] = []
    for number in sorted(numbers):
        page.canvas.copy_from(figure.background)
        figure.fill(page.canvas, figure.place(motion.positions[number], motion.angles[number]))
        found.append(page.canvas.planes[0].copy())
    return found


def choose_palette(pictures: list[Bytes]) -> Bytes:
    """256 colours (256, 3), BGR: the commonest as they are, the others by the centres of their clusters."""
    import cv2

    every = math.ceil(math.sqrt(sum(picture[..., 0].size for picture in pictures) / PIXELS))
    pixels = np.concatenate([picture[::every, ::every].reshape(-1, 3) for picture in pictures])
    codes = pixels.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    found, counts = np.unique(codes, return_counts=True)
    found = found[np.argsort(-counts, kind="stable")]
    colors = np.stack([found >> 16, found >> 8 & 255, found & 255], axis=1).astype(np.float32)
    palette = colors[:EXACT]
    rest = colors[EXACT : EXACT + 20_000]
    wanted = 256 - len(palette)
    if len(rest) > wanted:
        cv2.setRNGSeed(1)
        stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 12, 0.5)
        start = np.zeros((len(rest), 1), np.int32)
        _, _, centres = cv2.kmeans(rest, wanted, start, stop, 1, cv2.KMEANS_PP_CENTERS)
        rest = np.asarray(centres, np.float32)
    palette = np.concatenate([palette, rest])
    filled = np.zeros((256, 3), np.uint8)
    filled[: len(palette)] = np.rint(palette)
    return filled


def quantized(bgr: Bytes, nearest: Bytes) -> Bytes:
    """Each pixel's colour in the palette that `nearest_of` was given."""
    return np.asarray(nearest[_coarse(bgr)])


def _coarse(bgr: Bytes) -> NDArray[np.uint16]:
    """Each pixel's colour to five, six and five bits."""
    b, g, r = (bgr[..., k].astype(np.uint16) for k in range(3))
    return np.asarray((b >> 3) << 11 | (g >> 2) << 5 | r >> 3)


def nearest_of(palette: Bytes) -> Bytes:
    """For each coarse colour the palette's nearest, shape (65536,); palette: as from choose_palette."""
    code = np.arange(1 << 16)
    colors = np.stack([(code >> 11) * 8 + 4, (code >> 5 & 63) * 4 + 2, (code & 31) * 8 + 4], axis=1)
    shades = palette.astype(np.float32)
    nearest = np.empty(len(colors), np.uint8)
    for some in np.array_split(code, 32):  # not all at once: that would be 64 MB
        # |a - b|² less |a|², which is the same for the whole row
        distance = np.sum(shades**2, axis=1) - 2 * colors[some].astype(np.float32) @ shades.T
        nearest[some] = np.argmin(distance, axis=1)
    # The large areas keep their very colours, whatever is nearer to the middle of their coarse ones.
    large = np.arange(EXACT - 1, -1, -1)  # the commonest last
    nearest[_coarse(palette[large])] = large
    return nearest


def _indexed(picture: Bytes, palette: Bytes) -> Any:
    """A frame of palette indices (h, w); the palette goes with it."""
    import av

    height, width = picture.shape
    frame = av.VideoFrame(width, height, "pal8")
    pixels, colors = frame.planes
    rows = np.frombuffer(pixels, np.uint8).reshape(-1, pixels.line_size)  # type: ignore[call-overload]
    rows[:height, :width] = picture
    argb = np.concatenate([palette, np.full((256, 1), 255, np.uint8)], axis=1)
    np.frombuffer(colors, np.uint8)[:1024] = argb.reshape(-1)  # type: ignore[call-overload]
    return frame
