"""Frames to video: drawn by one thread, encoded by another."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from cli.render.canvas import Canvas
from cli.render.figure import Figure

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["frame_count", "write_video"]

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
        stream: Any = container.add_stream("libx264", rate=rate, options={"preset": "ultrafast", "crf": "20"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.time_base = 1 / rate
        _tag_colors(stream.codec_context)
        free: queue.SimpleQueue[Any] = queue.SimpleQueue()
        for _ in range(AHEAD):
            free.put(av.VideoFrame(width, height, "yuv420p"))

        def encode(item: tuple[int, Any]) -> None:
            number, frame = item
            frame.pts, frame.time_base = number, 1 / rate
            container.mux(stream.encode(frame))
            free.put(frame)

        with _Worker(encode, AHEAD) as encoder:
            for item in _drawn(figure, motion, free.get):
                encoder.put(item)
                progress((item[0] + 1) / frame_count(motion))
        container.mux(stream.encode(None))


def _drawn(figure: Figure, motion: Trajectory, take: Callable[[], Any]) -> Iterator[tuple[int, Any]]:
    """Every frame's number and its drawn av.VideoFrame."""
    background = figure.background.to_yuv()
    count = frame_count(motion)
    for start in range(0, count, CHUNK):
        stop = min(start + CHUNK, count)
        placed = figure.place(motion.positions[start:stop], motion.angles[start:stop])
        for k in range(start, stop):
            frame = take()
            canvas = _canvas_on(frame)
            canvas.copy_from(background)
            figure.fill(canvas, placed[k - start])
            figure.clock(canvas, float(motion.times[k]))
            yield k, frame


def _canvas_on(frame: Any) -> Canvas:
    """A canvas whose pixels are the frame's own."""
    planes = []
    for plane in frame.planes:
        rows = np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)
        planes.append(rows[:, : plane.width])
    return Canvas(tuple(planes))


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
