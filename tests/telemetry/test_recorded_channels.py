"""What goes into a recorder comes out of its log, number by number, with its unit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pliant.environment import Environment
from pliant.signals import Tick
from pliant.telemetry import Log, Recorder
from tests.telemetry.recording import INFO, record
from tests.telemetry.ticks import JOINTS, make_tick


@pytest.fixture(scope="module")
def log(ticks: list[Tick], tmp_path_factory: pytest.TempPathFactory) -> Log:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    record(ticks, path)
    return Log.open(path)


EXPECTED = {
    "measurement/q": lambda t: t.measurement.q,
    "measurement/v": lambda t: t.measurement.v,
    "measurement/torque": lambda t: t.measurement.torque,
    "measurement/torque_sent": lambda t: t.measurement.torque_sent,
    "measurement/tool/wrench": lambda t: t.measurement.wrenches["tool"],
    "estimate/q": lambda t: t.estimate.q,
    "estimate/v": lambda t: t.estimate.v,
    "estimate/torque": lambda t: t.estimate.torque,
    "estimate/torque_sent": lambda t: t.estimate.torque_sent,
    "estimate/disturbance": lambda t: t.estimate.disturbance,
    "estimate/tool/wrench": lambda t: t.estimate.wrenches["tool"],
    "estimate/tool/contact": lambda t: float(t.estimate.contacts["tool"]),
    "reference/posture": lambda t: t.reference.posture,
    "reference/tool/position": lambda t: t.reference.tasks[0].position,
    "reference/tool/velocity": lambda t: t.reference.tasks[0].velocity,
    "reference/tool/acceleration": lambda t: t.reference.tasks[0].acceleration,
    "reference/tool/wrench": lambda t: t.reference.tasks[0].wrench,
    "reference/tool/stiffness": lambda t: t.reference.tasks[0].tuning.stiffness,
    "reference/tool/force_max": lambda t: t.reference.tasks[0].tuning.force_max,
    "reference/tool/range": lambda t: t.reference.tasks[0].tuning.range,
    "reference/tool/linear_range": lambda t: t.reference.tasks[0].tuning.linear_range,
    "reference/elbow/position": lambda t: t.reference.tasks[1].position,
    "reference/elbow/velocity": lambda t: t.reference.tasks[1].velocity,
    "reference/elbow/acceleration": lambda t: t.reference.tasks[1].acceleration,
    "reference/elbow/wrench": lambda t: t.reference.tasks[1].wrench,
    "command/torque": lambda t: t.command.torque,
    "command/clamped": lambda t: t.command.clamped,
    "truth/q": lambda t: t.truth.q,
    "truth/v": lambda t: t.truth.v,
    "truth/torque": lambda t: t.truth.torque,
    "truth/tool/position": lambda t: t.truth.positions["tool"],
    "truth/tool/wrench": lambda t: t.truth.wrenches["tool"],
    "truth/objects/box/pose": lambda t: t.truth.objects["box"],
    "planner/progress": lambda t: t.reference.diagnostics["planner/progress"],
    "ee/energy_stored": lambda t: t.command.diagnostics["ee/energy_stored"],
    "ee/force": lambda t: t.command.diagnostics["ee/force"],
    "guard/fault": lambda t: float(t.guard),
    "gain/matrix": lambda t: t.command.diagnostics["gain/matrix"],
}
ROTATIONS = {
    "reference/tool/quaternion": lambda t: t.reference.tasks[0].rotation,
    "truth/tool/quaternion": lambda t: t.truth.rotations["tool"],
}


def test_the_log_has_these_channels_and_no_other(log: Log) -> None:
    assert set(log.channels) == set(EXPECTED) | set(ROTATIONS)


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_numbers_come_back_bit_for_bit(log: Log, ticks: list[Tick], name: str) -> None:
    np.testing.assert_array_equal(log[name], np.array([EXPECTED[name](tick) for tick in ticks]))
    np.testing.assert_allclose(log.time(name), [tick.measurement.time for tick in ticks], atol=1e-12)


@pytest.mark.parametrize("name", sorted(ROTATIONS))
def test_rotations_come_back_as_quaternions(log: Log, ticks: list[Tick], name: str) -> None:
    w, x, y, z = log[name].T
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)
    np.testing.assert_allclose(R, np.array([ROTATIONS[name](tick) for tick in ticks]), atol=1e-12)


def test_metadata_units_and_phases(log: Log) -> None:
    assert log.info == INFO
    assert log.channels["measurement/q"].labels == JOINTS
    assert log.channels["measurement/q"].rate == pytest.approx(1000.0)
    assert {log.channels[name].unit for name in ("truth/torque", "command/clamped")} == {"N·m"}
    assert log.channels["ee/energy_stored"].unit == "J"
    assert log.channels["gain/matrix"].unit == ""
    assert log.channels["gain/matrix"].shape == (2, 3)
    assert log.phases() == [(0.0, "reach"), (pytest.approx(0.03), "contact")]
    assert not log.truncated
    assert log.failure is None
    assert "ee/energy_stored: J" in log.metadata["pliant.units"]["/pliant/ee/energy_stored"]


def test_what_a_contact_feels_like_is_in_the_log_with_its_units() -> None:
    def felt(k: int) -> Tick:
        tick = make_tick(k)
        found = Environment(2e4 + k, 100.0 + k, 30.0, np.inf if k == 0 else 5.0)
        return dataclasses.replace(tick, estimate=dataclasses.replace(tick.estimate, environments={"tool": found}))

    recorder = Recorder(None, INFO)
    recorder(make_tick(0))  # baseline: without an estimator there is no such channel
    for k in range(1, 4):
        recorder(felt(k))
    log = recorder.log()
    np.testing.assert_array_equal(log["estimate/tool/stiffness"], [20001.0, 20002.0, 20003.0])
    np.testing.assert_array_equal(log["estimate/tool/damping"], [101.0, 102.0, 103.0])
    np.testing.assert_array_equal(log["estimate/tool/damping_std"], [5.0, 5.0, 5.0])
    assert log.channels["estimate/tool/stiffness_std"].unit == "N/m"
    unsure = Recorder(None, INFO)
    unsure(felt(0))
    assert np.isinf(unsure.log()["estimate/tool/damping_std"]).all()
