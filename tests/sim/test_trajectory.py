"""Trajectories: saved and loaded whole, in every format."""

import csv
import io
import json

import numpy as np
import pytest

from sim import InputError
from sim.trajectory import Event, Trajectory


@pytest.fixture
def run():
    rng = np.random.default_rng(3)
    n, b = 4, 2
    return Trajectory(
        times=np.arange(n) / 3,
        positions=rng.normal(size=(n, b, 2)),
        angles=rng.normal(size=(n, b)),
        velocities=rng.normal(size=(n, b, 2)),
        angular_velocities=rng.normal(size=(n, b)),
        body_ids=["ball", "größe"],
        energy=rng.normal(size=(n, 3)),
        events=[
            Event(0.25, "impact", ("ball", "größe"), (1.0, 2.0), (0.0, -3.0)),
            Event(0.5, "rest", ("ball", None), (0, 0), (0, 0)),
        ],
    )


def arrays(run):
    return run.times, run.positions, run.angles, run.velocities, run.angular_velocities, run.energy


@pytest.mark.parametrize("kind", ["npz", "json"])
def test_saved_and_loaded(run, tmp_path, kind):
    path = tmp_path / f"run.{kind}"
    path.write_bytes(getattr(run, f"to_{kind}")())
    back = Trajectory.load(path)
    assert back.body_ids == run.body_ids
    for a, b in zip(arrays(run), arrays(back), strict=True):
        assert np.array_equal(a, b)
    assert back.events == run.events


def test_npz_has_the_promised_arrays(run):
    with np.load(io.BytesIO(run.to_npz())) as z:
        assert set(z.files) == {
            "times",
            "positions",
            "angles",
            "velocities",
            "angular_velocities",
            "body_ids",
            "energy",
            "events",
        }
        assert z["positions"].shape == (4, 2, 2)
        assert z["energy"].shape == (4, 3)


def test_json_holds_the_same_as_lists(run):
    d = json.loads(run.to_json())
    assert d["positions"] == run.positions.tolist()
    assert d["body_ids"] == run.body_ids
    assert d["events"][0]["kind"] == "impact"


def test_csv_has_one_row_a_time_and_body(run):
    rows = list(csv.DictReader(io.StringIO(run.to_csv().decode())))
    assert len(rows) == 8
    assert [r["body"] for r in rows[:2]] == run.body_ids
    assert float(rows[5]["vy"]) == run.velocities[2, 1, 1]
    assert [float(rows[5][name]) for name in ("kinetic", "potential", "energy")] == run.energy[2].tolist()
    assert len(run) == 4


@pytest.mark.parametrize(
    "data", [b"", b"PK\x03\x04 broken", b"{}", b'{"times": [0]}', b"[1, 2]", b"\xff\xfe"]
)
def test_what_is_no_trajectory(tmp_path, data):
    path = tmp_path / "run.npz"
    path.write_bytes(data)
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(path)
