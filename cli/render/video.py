"""Frames to video: drawn by one thread, encoded by another."""

from __future__ import annotations

import contextlib
import os
import queue
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from cli.render.animation import PLAIN, Extras, Sheet, drawn, frame_count
from cli.render.canvas import Canvas
from cli.render.figure import Figure

if TYPE_CHECKING:
    from sim.trajectory import Trajectory

__all__ = ["CODECS", "sheet", "write_video", "writing"]

AHEAD = 4  # frames that are drawn on or wait to be encoded; no more are made
PIXELS = "nv12"  # yuv420p with the colours side by side, as x264 keeps it: two planes to draw on, not three


@dataclass(frozen=True)
class Codec:
    """An encoder, what it takes, and the file around it."""

    name: str
    options: dict[str, str]
    threads: int
    pixels: str
    container: str
    container_options: dict[str, str]


CODECS = {
    # Measured at 1280x720 in flat colours, ms a frame and kB for 10 s: ultrafast crf 20 1.4 and 1200, qp 20
    # 1.0 and 850, superfast crf 20 2.4 and 540, veryfast crf 20 3.2 and 290.  A fixed quantizer needs no look
    # ahead; weighing whether small differences are worth their bits costs 5 % more time for 2 % less size.
    # A second thread of the encoder's, beside that which draws, takes 9 % more CPU for 10 % less time.
    ".mp4": Codec(
        "libx264",
        {"preset": "ultrafast", "qp": "21", "x264-params": "no-dct-decimate=1"},
        1,
        PIXELS,
        "mp4",
        {"movflags": "faststart"},
    ),
    ".webm": Codec(
        "libvpx-vp9",
        {"deadline": "realtime", "cpu-used": "8", "crf": "28", "b": "0"},
        2,
        "yuv420p",
        "webm",
        {"fflags": "+bitexact"},
    ),
}


def write_video(
    path: str,
    figure: Figure,
    motion: Trajectory,
    fps: float,
    ending: str = ".mp4",
    extras: Extras = PLAIN,
    progress: Callable[[float], None] = lambda _: None,
) -> None:
    """Write a video to `path`; `ending` says which kind, .mp4 (H.264) or .webm (VP9)."""
    import av

    codec = CODECS[ending]
    rate = Fraction(fps).limit_denominator(100_000)
    size = figure.pen.size
    with (
        writing(path),
        av.open(path, "w", format=codec.container, options=codec.container_options) as container,
    ):
        stream: Any = container.add_stream(codec.name, rate=rate, options=codec.options)
        (stream.width, stream.height), stream.pix_fmt = size, codec.pixels
        stream.codec_context.time_base = 1 / rate
        stream.codec_context.thread_count = codec.threads
        _tag_colors(stream.codec_context)
        free: queue.SimpleQueue[Sheet] = queue.SimpleQueue()
        for _ in range(AHEAD):
            free.put(sheet(size))

        def encode(item: tuple[int, Sheet]) -> None:
            number, done = item
            done.frame.pts, done.frame.time_base = number, 1 / rate
            container.mux(stream.encode(done.frame))

        with _Worker(encode, lambda item: free.put(item[1])) as encoder:
            for item in drawn(figure, motion, fps, free.get, extras):
                encoder.put(item)
                progress((item[0] + 1) / frame_count(motion))
        container.mux(stream.encode(None))


@contextlib.contextmanager
def writing(path: str) -> Iterator[None]:
    """Turn the library's words for a full disk and the like into Python's."""
    import av

    try:
        yield
    except av.FFmpegError as e:
        if e.errno is None or e.errno <= 0:
            raise
        raise OSError(e.errno, os.strerror(e.errno), path) from e


def sheet(size: tuple[int, int]) -> Sheet:
    """A frame to encode, and a canvas whose pixels are the frame's own."""
    import av

    width, height = size
    frame = av.VideoFrame(width, height, PIXELS)
    y, uv = (np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size) for plane in frame.planes)  # type: ignore[call-overload]
    planes = (y[:height, :width], uv.reshape(len(uv), -1, 2)[: height // 2, : width // 2])
    return Sheet(Canvas(planes), frame)


def _tag_colors(codec: Any) -> None:
    """Say what Canvas computes: BT.601's matrix, sRGB's primaries, limited range (numbers of ITU-T H.273)."""
    codec.colorspace = 6
    codec.color_primaries = 1
    codec.color_trc = 1
    codec.color_range = 1


class _Worker:
    """A thread that works on the items of a queue; what it raises is raised again where items are put.

    release: is given every item afterwards, also those that are dropped because an earlier one failed.
    """

    def __init__(self, work: Callable[[Any], None], release: Callable[[Any], None]) -> None:
        self._work, self._release, self._items = work, release, queue.SimpleQueue[Any]()
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        while (item := self._items.get()) is not None:
            if self._failure is None:
                try:
                    self._work(item)
                except BaseException as e:
                    self._failure = e
            self._release(item)

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
