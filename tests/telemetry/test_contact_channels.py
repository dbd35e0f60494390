"""Estimated properties of contacts in a log, read by `Log` and by rosbags."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from pliant.environment import Environment, EstimatedSurface
from pliant.signals import Tick
from pliant.telemetry import Log, Recorder, RunInfo

from .ticks import JOINTS, make_tick

TICKS = 7
TOUCHED = 3
"""the first tick with an estimate"""


def with_estimates(k: int) -> Tick:
    """Tick number k; from `TOUCHED` on with numbers that differ from tick to tick and from axis to axis."""
    tick = make_tick(k)
    if k < TOUCHED:
        return tick
    environment = Environment(2e4 + k, 100.0 + k, 30.0, 5.0)
    surface = EstimatedSurface(
        k + np.array([0.1, 0.2, 0.3]), k * np.array([0.01, -0.02, 0.03]), np.eye(3)[k % 3], 0.01 * k
    )
    estimate = dataclasses.replace(tick.estimate, environments={"tool": environment}, surfaces={"tool": surface})
    return dataclasses.replace(tick, estimate=estimate)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("contact") / "run.mcap"
    with Recorder(path, RunInfo("task", "tilted", joints=JOINTS)) as recorder:
        for k in range(TICKS):
            recorder(with_estimates(k))
    return path


def test_the_estimated_surface_is_in_the_log_with_its_units(path: Path) -> None:
    log = Log.open(path)
    surfaces = [with_estimates(k).estimate.surfaces["tool"] for k in range(TOUCHED, TICKS)]
    for name, unit in (("pivot", "m"), ("turn", "rad"), ("normal", "1"), ("normal_std", "rad")):
        channel = f"estimate/tool/surface/{name}"
        np.testing.assert_array_equal(log[channel], [getattr(surface, name) for surface in surfaces])
        np.testing.assert_allclose(log.time(channel), 1e-3 * np.arange(TOUCHED, TICKS))
        assert log.channels[channel].unit == unit
    assert log.channels["estimate/tool/surface/normal"].labels == ("x", "y", "z")


def test_without_an_estimate_there_is_no_such_channel() -> None:
    with Recorder(None) as recorder:
        recorder(make_tick(0))
    assert not [name for name in recorder.log().channels if "surface" in name or name.endswith("stiffness_std")]


def test_rosbags_reads_the_estimated_surface(path: Path) -> None:
    found: dict[str, list[tuple[int, str, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, time, data in reader.messages():
            decoded = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append((time, connection.msgtype, decoded))
    for name in ("pivot", "turn", "normal"):
        messages = found[f"/pliant/estimate/tool/surface/{name}"]
        assert len(messages) == TICKS - TOUCHED
        for k, (time, kind, message) in enumerate(messages, start=TOUCHED):
            assert (time, kind) == (round(1e6 * k), "std_msgs/msg/Float64MultiArray")
            assert message.layout.dim[0].label == "x,y,z"
            np.testing.assert_array_equal(message.data, getattr(with_estimates(k).estimate.surfaces["tool"], name))
    std = [message.data for _, _, message in found["/pliant/estimate/tool/surface/normal_std"]]
    np.testing.assert_array_equal(std, [0.01 * k for k in range(TOUCHED, TICKS)])
