"""What a run of a scene gives: poses and velocities at the sample times, energy, and events between."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.scene import InputError

__all__ = ["Event", "Trajectory"]

Array = NDArray[np.float64]


class Event(NamedTuple):
    """Something that happened between samples.

    Attributes:
        time: [s].
        kind: "impact", "contact begun", "contact ended" or "rest".
        bodies: the pair's ids; at rest the body and None.
        point: where, in the scene's frame [m].
        impulse: on the second body, [N s] as (x, y).
    """

    time: float
    kind: str
    bodies: tuple[str, str | None]
    point: tuple[float, float]
    impulse: tuple[float, float]


@dataclass(frozen=True)
class Trajectory:
    """The motion of every body of a scene, anchored ones too, in the scene's order.

    Attributes:
        times: [s], shape (n,).
        positions: centres of mass [m], shape (n, bodies, 2).
        angles: [rad], not wrapped, shape (n, bodies).
        velocities: [m/s], shape (n, bodies, 2).
        angular_velocities: [rad/s], shape (n, bodies).
        body_ids: the scene's ids.
        energy: kinetic, potential and their sum [J], shape (n, 3); potential is zero at the scene's origin.
        events: what happened between the samples, in the order of time.
        profile: what the engine did: names that end in _time are seconds, `separation` is metres, the others are counts
            (SimProfile in core/sim.h); empty for pymunk.
    """

    times: Array
    positions: Array
    angles: Array
    velocities: Array
    angular_velocities: Array
    body_ids: list[str]
    energy: Array
    events: Sequence[Event] = field(default_factory=list)
    profile: dict[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.times)

    def to_dict(self) -> dict[str, Any]:
        """The trajectory as JSON's objects; arrays become nested lists."""
        out: dict[str, Any] = {
            "format": "sketchsim-trajectory",
            "version": 1,
            "body_ids": list(self.body_ids),
        }
        out |= {name: getattr(self, name).tolist() for name in _ARRAYS}
        out["events"] = [event._asdict() for event in self.events]
        return out

    def to_json(self) -> bytes:
        return msgspec.json.encode(self.to_dict()) + b"\n"

    def to_csv(self) -> bytes:
        """One row a time and body; the last columns are the energy [J] of the whole scene at that time."""
        import csv

        out = io.StringIO()
        write = csv.writer(out, lineterminator="\n")
        columns = ["time", "body", "x", "y", "angle", "vx", "vy", "angular_velocity"]
        write.writerow([*columns, "kinetic", "potential", "energy"])
        rows = np.concatenate(
            [self.positions, self.angles[..., None], self.velocities, self.angular_velocities[..., None]],
            axis=2,
        ).tolist()
        for time, bodies, energy in zip(self.times.tolist(), rows, self.energy.tolist(), strict=True):
            for name, values in zip(self.body_ids, bodies, strict=True):
                write.writerow([time, name, *values, *energy])
        return out.getvalue().encode()

    def to_npz(self) -> bytes:
        out = io.BytesIO()
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        np.savez(out, body_ids=np.array(self.body_ids, dtype=np.str_), events=self._event_table(), **arrays)
        return out.getvalue()

    def _event_table(self) -> NDArray[Any]:
        """The events as records with Event's fields; nobody is the empty id."""
        longest = max(map(len, self.body_ids), default=0) or 1
        record = [
            ("time", "f8"), ("kind", "U13"), ("bodies", f"U{longest}", 2), ("point", "f8", 2), ("impulse", "f8", 2)
        ]  # fmt: skip
        rows = [
            (e.time, e.kind, tuple(name or "" for name in e.bodies), e.point, e.impulse) for e in self.events
        ]
        return np.array(rows, dtype=record)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Read .npz or .json. Raises InputError for what is neither, OSError for what cannot be read."""
        data = Path(path).read_bytes()
        if data[:2] == b"PK":
            import zipfile

            try:
                with np.load(io.BytesIO(data), allow_pickle=False) as z:
                    arrays = {name: z[name] for name in _ARRAYS}
                    table = z["events"].tolist() if "events" in z.files else []
                    return cls(
                        body_ids=z["body_ids"].tolist(), events=[_event(*row) for row in table], **arrays
                    )
            except (KeyError, ValueError, OSError, zipfile.BadZipFile) as e:
                raise InputError("", f"not a trajectory: {e}", kind="format") from None
        try:
            d = msgspec.json.decode(data)
            arrays = {name: np.array(d[name], dtype=np.float64) for name in _ARRAYS}
            events = [_event(**event) for event in d.get("events", [])]
            return cls(body_ids=list(d["body_ids"]), events=events, **arrays)
        except (msgspec.DecodeError, KeyError, TypeError, ValueError) as e:
            raise InputError("", f"not a trajectory: {e}", kind="format") from None


def _event(time: float, kind: str, bodies: Any, point: Any, impulse: Any) -> Event:
    """From what files hold."""
    first, second = bodies
    return Event(time, kind, (first, second or None), (point[0], point[1]), (impulse[0], impulse[1]))


_ARRAYS = ("times", "positions", "angles", "velocities", "angular_velocities", "energy")
