"""What a run is written as: the endings of files, and who writes each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from cli.arguments import UsageError
from cli.outputs import Outputs, ending

if TYPE_CHECKING:
    from cli.render.animation import Extras
    from cli.render.camera import Camera
    from cli.render.figure import Figure
    from cli.render.ink import Ink
    from sim.scene import Scene
    from sim.trajectory import Trajectory
    from sketch.recognize import Recognition

__all__ = ["ENDINGS", "SEEN", "Look", "Run"]

DATA = {".npz": "to_npz", ".json": "to_json", ".csv": "to_csv"}
VIDEO = (".mp4", ".webm", ".gif")
SEEN = (*VIDEO, ".html", ".png")  # the motion as pictures
ENDINGS = (*VIDEO, ".html", ".png", ".svg", *DATA)

MAX_PIXELS = 120_000_000  # of the background that a camera following a body runs over


@dataclass(frozen=True)
class Look:
    """How a run is to be shown.

    style: "clean", "ink" or "blueprint".  follow: the id of a body that stays in the middle, or None.
    """

    size: tuple[int, int] = (1280, 720)
    style: str = "clean"
    trails: bool = False
    vectors: bool = False
    follow: str | None = None


@dataclass
class Run:
    """A scene with its motion, ready to be written; title: the input's name."""

    title: str
    scene: Scene
    motion: Trajectory
    fps: float
    look: Look = field(default_factory=Look)
    recognition: Recognition | None = None

    def write(self, files: Outputs, target: str, progress: Callable[[float], None]) -> None:
        """Add `target` to the files, in the form that its ending says."""
        kind = ending(target)
        if kind in DATA:
            files.write(target, getattr(self.motion, DATA[kind])())
        elif kind == ".html":
            from cli.render.page import page

            files.write(target, page(self.fitted, self.motion, self.title, self.ink, self.extras))
        elif kind == ".svg":
            from cli.render.vector import svg

            files.write(target, svg(self._still(slice(1)), self.ink))
        elif kind == ".png":
            from cli.render.still import png, strobe

            files.write(target, png(strobe(self._still(slice(None)), self.motion, self.look.trails)))
        else:
            self._write_video(files.stage(target), kind, progress)

    def _write_video(self, path: str, kind: str, progress: Callable[[float], None]) -> None:
        follow, extras = self.followed, self.extras
        figure = self.fitted if follow is None else self._following(follow)
        if kind == ".gif":
            from cli.render.gif import write_gif

            write_gif(path, figure, self.motion, self.fps, extras, progress)
        else:
            from cli.render.video import write_video

            write_video(path, figure, self.motion, self.fps, kind, extras, progress)

    @property
    def followed(self) -> int | None:
        """The index of the body in the middle."""
        if self.look.follow is None:
            return None
        return [body.id for body in self.scene.bodies].index(self.look.follow)

    @property
    def extras(self) -> Extras:
        from cli.render.animation import Extras

        return Extras(self.look.trails, self.look.vectors, self.followed)

    @cached_property
    def ink(self) -> Ink:
        from cli.render.ink import world_strokes

        return [] if self.recognition is None else world_strokes(self.recognition)

    @cached_property
    def camera(self) -> Camera:
        from cli.render.camera import fit

        return fit(self.scene, self.look.size, self.motion)

    @cached_property
    def fitted(self) -> Figure:
        """The figure under a camera that stands still."""
        from cli.render.figure import Figure
        from cli.render.style import STYLES

        return Figure(self.scene, self.camera, STYLES[self.look.style], self.ink)

    def _still(self, samples: slice) -> Figure:
        """The figure for one picture: of all, or about the way of the followed body at these samples."""
        if self.followed is None:
            return self.fitted
        from cli.render.camera import about, reach
        from cli.render.figure import Figure
        from cli.render.style import STYLES

        path = self.motion.positions[samples, self.followed]
        camera = about(self.camera, path, reach(self.scene, self.followed))
        return Figure(self.scene, camera, STYLES[self.look.style], self.ink)

    def _following(self, body: int) -> Figure:
        """The figure under a camera that takes in all that comes into view on the way of a body."""
        from cli.render.camera import along
        from cli.render.figure import Figure
        from cli.render.style import STYLES

        camera = along(self.camera, self.motion.positions[:, body])
        if camera.size[0] * camera.size[1] > MAX_PIXELS:
            raise UsageError(
                f"--camera: {self.look.follow} goes too far to be followed",
                "make --size or --duration smaller",
            )
        return Figure(self.scene, camera, STYLES[self.look.style], self.ink, self.look.size)

    def lost(self) -> list[tuple[str, float]]:
        """Moving bodies that end out of the picture, and when each was last seen [s]."""
        from cli.render.camera import outside

        return [] if self.look.follow is not None else outside(self.scene, self.motion, self.camera)
