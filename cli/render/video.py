"""Frames to video: drawn by one thread, encoded by another."""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cli.render.canvas import Box, Canvas
from cli.render.figure import Figure

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["Sheet", "changes", "clock", "drawn", "frame_count", "write_video"]

# Measured at 1280x720 in flat colours, ms a frame and kB for 10 s: ultrafast crf 20 1.4 and 1200, qp 20 1.0
# and 850, superfast crf 20 2.4 and 540, veryfast crf 20 3.2 and 290.  A fixed quantizer needs no look ahead.
X264 = {"preset": "ultrafast", "qp": "21"}
THREADS = 2
PIXELS = "nv12"  # yuv420p as x264 keeps it inside; two planes to draw on instead of three

CHUNK = 64  # frames whose poses are computed at once: memory does not grow with the length
AHEAD = 4  # frames drawn but not yet encoded


def frame_count(motion: Trajectory) -> int:
    """Frames that last as long as the motion: each sample but the last is shown until the next."""
    return max(1, len(motion) - 1)


def write_video(
    path: str,
    figure: Figure,
    motion: Trajectory,
    fps: float,
    progress: Callable[[float], None] = lambda _: None,
) -> None:
    """Write H.264 to `path` (.mp4)."""
    import av

    rate = Fraction(fps).limit_denominator(100_000)
    width, height = figure.camera.size
    with av.open(path, "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream: Any = container.add_stream("libx264", rate=rate, options=X264)
        stream.width, stream.height, stream.pix_fmt = width, height, PIXELS
        stream.codec_context.time_base = 1 / rate
        stream.codec_context.thread_count = THREADS
        _tag_colors(stream.codec_context)
        free: queue.SimpleQueue[Sheet] = queue.SimpleQueue()
        for _ in range(AHEAD):
            free.put(Sheet(av.VideoFrame(width, height, PIXELS)))

        def encode(item: tuple[int, Sheet]) -> None:
            number, sheet = item
            sheet.frame.pts, sheet.frame.time_base = number, 1 / rate
            container.mux(stream.encode(sheet.frame))
            free.put(sheet)

        with _Worker(encode, AHEAD) as encoder:
            for item in drawn(figure, motion, fps, free.get):
                encoder.put(item)
                progress((item[0] + 1) / frame_count(motion))
        container.mux(stream.encode(None))


class Sheet:
    """A frame of the encoder's, and a canvas on its pixels that knows where it was drawn on."""

    def __init__(self, frame: Any) -> None:
        self.frame, self.canvas = frame, _canvas_on(frame)
        self.used: list[Box] = [(0, 0, *self.canvas.planes[0].shape[1::-1])]

    def clean(self, background: Canvas) -> None:
        for box in self.used:
            self.canvas.copy_from(background, box)


def drawn(
    figure: Figure, motion: Trajectory, fps: float, take: Callable[[], Sheet]
) -> Iterator[tuple[int, Sheet]]:
    """The number and the sheet of every frame that shows something new, and of the last."""
    background = figure.background.to_yuv()
    count = frame_count(motion)
    changed = changes(figure, motion, count)
    times = clock(changed, fps)
    for start in range(0, count, CHUNK):
        span = slice(start, min(start + CHUNK, count))
        placed = figure.place(motion.positions[span], motion.angles[span])
        boxes = figure.boxes(placed)
        for k in range(span.start, span.stop):
            if changed[k] or times[k] != times[k - 1] or k in (0, count - 1):
                sheet = take()
                sheet.clean(background)
                figure.fill(sheet.canvas, placed[k - start])
                sheet.used = [boxes[k - start], figure.caption(sheet.canvas, times[k])]
                yield k, sheet


def changes(figure: Figure, motion: Trajectory, count: int) -> NDArray[np.bool_]:
    """Which of the first `count` samples show a picture unlike that of the sample before; the first does."""
    changed = np.ones(count, bool)
    for start in range(1, count, CHUNK):
        span = slice(start - 1, min(start + CHUNK, count))
        changed[start : span.stop] = figure.changes(figure.place(motion.positions[span], motion.angles[span]))
    return changed


def clock(changed: NDArray[np.bool_], fps: float) -> list[str]:
    """The time that each frame shows: in tenths of a second, in whole ones where nothing moves for so long.

    A clock that ran on in tenths would make every frame of a scene at rest a new one.
    """
    texts: list[str] = []
    edges = [*np.flatnonzero(changed).tolist(), len(changed)]
    for begin, end in pairwise(edges):
        still = end - begin > max(fps, 1)
        for k in range(begin, end):
            tenths = math.floor(k / fps * 10 + 1e-6)
            if still and k > begin and tenths // 10 * 10 > math.floor(begin / fps * 10 + 1e-6):
                tenths = tenths // 10 * 10
            elif still and k > begin:
                tenths = math.floor(begin / fps * 10 + 1e-6)
            texts.append(f"{tenths // 10}.{tenths % 10} s")
    return texts


def _canvas_on(frame: Any) -> Canvas:
    """A canvas whose pixels are the frame's own."""
    width = frame.width
    y, uv = (np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size) for plane in frame.planes)
    return Canvas((y[: frame.height, :width], uv.reshape(len(uv), -1, 2)[: frame.height // 2, : width // 2]))


def _tag_colors(codec: Any) -> None:
    """Say what Canvas computes: BT.601's matrix, sRGB's primaries, limited range (numbers of ITU-T H.273)."""
    codec.colorspace = 6
    codec.color_primaries = 1
    codec.color_trc = 1
    codec.color_range = 1


class _Worker:
    """A thread that takes items from a short queue; what it raises is raised again where items are put."""

    def __init__(self, work: Callable[[Any], None], ahead: int) -> None:
        self._work, self._items = work, queue.Queue[Any](ahead)
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        while (item := self._items.get()) is not None:
            if self._failure is None:
                try:
                    self._work(item)
                except BaseException as e:
                    self._failure = e

    def put(self, item: Any) -> None:
        self._items.put(item)
        if self._failure is not None:
            raise self._failure

    def __enter__(self) -> _Worker:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._items.put(None)
        self._thread.join()
        if kind is None and self._failure is not None:
            raise self._failure
