"""Trajectories become references; motions come from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.errors import ConfigError, OutputError, ShapeError
from pliant.references.source import FrameMotion, TrajectorySource
from pliant.references.trajectories.rotation import Fixed, QuaternionSpline, WarpedTurning
from pliant.references.trajectories.sampled import read_motion
from pliant.references.trajectories.shapes import lemniscate
from pliant.references.trajectories.trajectory import Hold
from pliant.references.trajectories.waypoints import wrench_steps
from pliant.signals import Estimate
from pliant.spatial import exp3, frame_with_z_along, log3


def estimate(time: float) -> Estimate:
    zero = np.zeros(3)
    return Estimate(time, zero, zero, zero, zero)


def test_reference_carries_pose_twist_wrench_and_posture() -> None:
    R = frame_with_z_along((0.0, -1.0, 0.0))
    tool = FrameMotion("tool", lemniscate(), R, wrench_steps((0.0, 1.0), (0.0, 40.0)))
    source = TrajectorySource([tool, FrameMotion("elbow", Hold((1.0, 2.0, 3.0)))], Hold((0.1, 0.2, 0.3)), "track")
    state = source.init(estimate(5.0))
    reference, _ = source.step(estimate(6.5), state)
    task, elbow = reference.tasks
    np.testing.assert_allclose(task.position, lemniscate().at(1.5).value)
    np.testing.assert_allclose(task.velocity, [*lemniscate().at(1.5).rate, 0, 0, 0])
    np.testing.assert_allclose(task.rotation, R)
    assert task.wrench[2] == 40.0
    assert elbow.rotation is None
    assert (reference.phase, reference.time) == ("track", 6.5)
    np.testing.assert_allclose(reference.posture, (0.1, 0.2, 0.3))


def test_two_motions_of_one_frame_are_refused() -> None:
    motion = FrameMotion("tool", lemniscate())
    with pytest.raises(ConfigError, match="one motion"):
        TrajectorySource([motion, motion])
    with pytest.raises(ShapeError, match="3 entries"):
        FrameMotion("tool", Hold((0.0,)))
    with pytest.raises(ConfigError, match="orthogonal"):
        Fixed(np.ones((3, 3)))


def write_csv(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_csv_and_npz_give_the_same_motion(tmp_path: Path) -> None:
    t = np.linspace(2.0, 4.0, 50)
    columns = {"time": t, "x": np.sin(t), "y": np.cos(t), "z": 0 * t}
    np.savez(tmp_path / "a.npz", **columns)
    lines = ["time,x,y,z"] + [",".join(repr(float(c[i])) for c in columns.values()) for i in range(50)]
    csv = read_motion(write_csv(tmp_path / "a.csv", "\n".join(lines)))
    npz = read_motion(tmp_path / "a.npz")
    for s in (0.0, 0.77, 1.99):
        np.testing.assert_allclose(csv.position.at(s).value, npz.position.at(s).value, atol=1e-12)
        np.testing.assert_allclose(csv.position.at(s).value, (np.sin(2 + s), np.cos(2 + s), 0), atol=1e-6)
    assert csv.rotation is None


def test_sampled_rotation_turns_with_its_angular_velocity(tmp_path: Path) -> None:
    t = np.linspace(0.0, 2.0, 41)
    half = 0.5 * (0.3 * t + 0.4 * t**2)
    sign = np.where(np.arange(41) % 2 == 0, 1.0, -1.0)  # a file may flip the sign of a quaternion at will
    columns = {"time": t, "x": t, "y": t, "z": t, "qw": np.cos(half), "qx": 0 * t, "qy": np.sin(half), "qz": 0 * t}
    columns |= {name: sign * columns[name] for name in ("qw", "qx", "qy", "qz")}
    np.savez(tmp_path / "r.npz", **columns)
    rotation = read_motion(tmp_path / "r.npz").rotation
    assert rotation is not None
    R, w, a = rotation.at(1.234)
    np.testing.assert_allclose(R, exp3([0, 0.3 * 1.234 + 0.4 * 1.234**2, 0]), atol=1e-6)
    np.testing.assert_allclose(w, [0, 0.3 + 0.8 * 1.234, 0], atol=1e-4)
    np.testing.assert_allclose(a, [0, 0.8, 0], atol=5e-3)


def test_angular_velocity_is_the_derivative_of_the_rotation() -> None:
    random = np.random.default_rng(3)
    turning = QuaternionSpline(np.linspace(0, 1, 6), np.array([1.0, 0, 0, 0]) + 0.4 * random.normal(size=(6, 4)))
    h = 1e-5
    for t in (0.11, 0.5, 0.93):
        before, here, after = (turning.at(s) for s in (t - h, t, t + h))
        np.testing.assert_allclose(here.velocity, log3(after.rotation @ before.rotation.T) / (2 * h), atol=1e-6)
        np.testing.assert_allclose(here.acceleration, (after.velocity - before.velocity) / (2 * h), atol=1e-3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("time,x,y\n0,1,2\n", "lacks z"),
        ("time,x,y,z,q\n0,1,2,3,4\n", "unknown columns q"),
        ("time,x,y,z,qw\n0,1,2,3,1\n", "lacks qx, qy, qz"),
        ("time,x,y,z\n0,1,2,3\n", "at least two"),
        ("time,x,y,z\n0,1,2,3\n0,1,2,3\n", "time must increase, but sample 2"),
        ("time,x,y,z\n0,1,2,3\n1,1,nan,3\n", "sample 2 .* column y"),
        ("time,x,y,z\n0,1,2,3\n1,1,two,3\n", "line 3"),
        ("time,x,y,z\n0,1,2,3\n1,1,3\n", "3 numbers for 4 columns"),
        ("time,x,y,z,qw,qx,qy,qz\n0,1,2,3,0,0,0,0\n1,1,2,3,1,0,0,0\n", "no length"),
    ],
)
def test_bad_files_are_named(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        read_motion(write_csv(tmp_path / "bad.csv", text))


def test_missing_file_and_wrong_ending(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be read"):
        read_motion(tmp_path / "none.csv")
    with pytest.raises(ConfigError, match=r"\.csv or \.npz"):
        read_motion(tmp_path / "a.txt")
    (tmp_path / "bad.npz").write_text("no archive")
    with pytest.raises(ConfigError, match="not a sampled trajectory"):
        read_motion(tmp_path / "bad.npz")


def test_a_fixed_orientation_stays_one_when_its_motion_is_eased() -> None:
    eased = FrameMotion("flange", Hold(np.zeros(3)), np.eye(3)).eased(1.0)
    assert isinstance(eased.rotation, Fixed)
    turning = QuaternionSpline(np.array([0.0, 1.0]), np.array([[1.0, 0.0, 0.0, 0.0], [1.0, 0.1, 0.0, 0.0]]))
    warped = FrameMotion("flange", Hold(np.zeros(3)), turning).eased(1.0)
    assert isinstance(warped.rotation, WarpedTurning)  # control: one that turns starts from rest
