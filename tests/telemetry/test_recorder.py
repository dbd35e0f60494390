"""What goes into a recorder comes out of its log, number by number, whatever ends the run."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pliant.environment import Environment
from pliant.errors import ConfigError, OutputError, ShapeError
from pliant.signals import Tick
from pliant.telemetry import Channel, Log, Recorder, RunInfo
from tests.telemetry.ticks import JOINTS, make_tick

INFO = RunInfo(
    study="stack",
    case="figure8",
    controller="capped",
    robot="lwr4",
    seed=7,
    joints=JOINTS,
    torque_limits=(176.0,) * 7,
    config={"a": {"b": 1.5}},
)


def record(ticks: list[Tick], target: Path | io.BytesIO, **options: object) -> None:
    with Recorder(target, INFO, **options) as recorder:  # type: ignore[arg-type]
        for tick in ticks:
            recorder(tick)


def with_diagnostics(tick: Tick, **more: object) -> Tick:
    diagnostics = dict(tick.command.diagnostics) | more
    return dataclasses.replace(tick, command=dataclasses.replace(tick.command, diagnostics=diagnostics))


@pytest.fixture(scope="module")
def ticks() -> list[Tick]:
    return [make_tick(k) for k in range(1300)]  # more than two blocks


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


def test_same_ticks_same_bytes_and_other_ticks_other_bytes(ticks: list[Tick], tmp_path: Path) -> None:
    for name, chosen in (("a", ticks), ("b", ticks), ("c", [make_tick(k, seed=1) for k in range(1300)])):
        record(chosen, tmp_path / f"{name}.mcap")
    a, b, c = ((tmp_path / f"{name}.mcap").read_bytes() for name in "abc")
    assert a == b
    assert a != c


def test_wall_times_stay_out_of_the_log_and_go_beside_it(ticks: list[Tick], tmp_path: Path) -> None:
    record(ticks[:100], tmp_path / "a.mcap")
    record([dataclasses.replace(tick, wall={"plan": 0.5, "control": 0.5}) for tick in ticks[:100]], tmp_path / "b.mcap")
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()
    timing = json.loads((tmp_path / "b.timing.json").read_text())
    assert timing["control"]["p50_us"] == pytest.approx(5e5)
    assert timing["control"]["count"] == 100


def test_decimation_keeps_every_so_many_ticks(ticks: list[Tick]) -> None:
    with Recorder(None, INFO, decimation=10) as recorder:
        for tick in ticks:
            recorder(tick)
    log = recorder.log()
    np.testing.assert_array_equal(log["truth/q"], [tick.truth.q for tick in ticks[::10] if tick.truth is not None])
    assert log.channels["truth/q"].rate == pytest.approx(100.0)
    with pytest.raises(ConfigError, match="decimation"):
        Recorder(None, decimation=0)


def test_channels_may_appear_vanish_and_change_shape(ticks: list[Tick]) -> None:
    with Recorder(None, INFO) as recorder:
        for k, tick in enumerate(ticks[:60]):
            more: dict[str, object] = {"late": float(k)} if k >= 20 else {}
            more["wide"] = np.full(2 if k < 40 else 3, float(k))
            recorder(with_diagnostics(tick, **more))
    log = recorder.log()
    np.testing.assert_array_equal(log["late"], np.arange(20.0, 60.0))
    assert log.time("late")[0] == pytest.approx(0.020)
    np.testing.assert_array_equal(log["wide"][:, 0], np.arange(40.0))
    np.testing.assert_array_equal(log["wide[3]"][:, 0], np.arange(40.0, 60.0))
    np.testing.assert_array_equal(log["measurement/q"], [tick.measurement.q for tick in ticks[:60]])


def test_arrays_of_other_memory_layouts_and_types_are_copied_by_value(ticks: list[Tick]) -> None:
    tick = ticks[3]
    strided = np.arange(14.0)[::2]
    fortran = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    measurement = dataclasses.replace(tick.measurement, q=strided, v=np.arange(7))  # type: ignore[arg-type]
    with Recorder(None, INFO) as recorder:
        recorder(tick)
        recorder(dataclasses.replace(tick, measurement=dataclasses.replace(measurement, v=tick.measurement.v)))
    with Recorder(None, INFO) as other:
        other(dataclasses.replace(with_diagnostics(tick, **{"gain/matrix": fortran}), measurement=measurement))
    np.testing.assert_array_equal(recorder.log()["measurement/q"][1], strided)
    np.testing.assert_array_equal(other.log()["measurement/v"][0], np.arange(7))
    np.testing.assert_array_equal(other.log()["gain/matrix"][0], fortran)


def test_a_buffer_that_the_loop_reuses_is_copied(ticks: list[Tick]) -> None:
    buffer = np.zeros(7)
    with Recorder(None, INFO) as recorder:
        for k, tick in enumerate(ticks[:5]):
            buffer[:] = k
            recorder(dataclasses.replace(tick, command=dataclasses.replace(tick.command, torque=buffer)))
    np.testing.assert_array_equal(recorder.log()["command/torque"][:, 0], np.arange(5.0))


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_what_ends_the_run_keeps_what_was_recorded(
    ticks: list[Tick], tmp_path: Path, error: type[BaseException]
) -> None:
    def interrupted() -> None:
        with Recorder(tmp_path / "cut.mcap", INFO) as recorder:
            for tick in ticks[:700]:
                recorder(tick)
            raise error("stop")

    with pytest.raises(error):
        interrupted()
    log = Log.open(tmp_path / "cut.mcap")
    assert log["measurement/q"].shape == (700, 7)
    assert not log.truncated
    assert log.failure is not None


def test_a_killed_process_leaves_whole_blocks(tmp_path: Path) -> None:
    code = (
        "import sys, os, time; sys.path.insert(0, sys.argv[1])\n"
        "from ticks import make_tick\nfrom pliant.telemetry import Recorder\n"
        "recorder = Recorder(sys.argv[2])\n"
        "for k in range(1200): recorder(make_tick(k))\n"
        "while os.path.getsize(sys.argv[2]) < 500_000: time.sleep(0.01)\n"
        "os._exit(9)\n"
    )
    path = tmp_path / "killed.mcap"
    done = subprocess.run(
        [sys.executable, "-c", code, str(Path(__file__).parent), str(path)], check=False, env=os.environ, timeout=120
    )
    assert done.returncode == 9
    log = Log.open(path)
    assert log.truncated
    assert log["measurement/q"].shape[0] >= 512
    np.testing.assert_array_equal(log["measurement/q"][511], make_tick(511).measurement.q)


def test_a_recorder_that_nobody_closed_is_closed_at_exit(tmp_path: Path) -> None:
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from ticks import make_tick\nfrom pliant.telemetry import Recorder\n"
        "recorder = Recorder(sys.argv[2])\n"
        "for k in range(20): recorder(make_tick(k))\n"
    )
    path = tmp_path / "open.mcap"
    command = [sys.executable, "-c", code, str(Path(__file__).parent), str(path)]
    subprocess.run(command, check=True, env=os.environ, timeout=120)
    log = Log.open(path)
    assert not log.truncated
    assert log["measurement/q"].shape[0] == 20


def test_bad_diagnostics_are_named(ticks: list[Tick]) -> None:
    with Recorder(None) as recorder, pytest.raises(ShapeError, match="'note' must be a number"):
        recorder(with_diagnostics(ticks[0], note="hello"))
    with Recorder(None) as recorder, pytest.raises(ConfigError, match="'truth/q' must not start"):
        recorder(with_diagnostics(ticks[0], **{"truth/q": 1.0}))
    with Recorder(None) as recorder, pytest.raises(ConfigError, match="planner/progress"):
        recorder(with_diagnostics(ticks[0], **{"planner/progress": 1.0}))


def test_units_of_the_recorders_own_table_go_first(ticks: list[Tick]) -> None:
    with Recorder(None, channels=[Channel("*/energy_*", "mJ"), Channel("gain/*", "1/s")]) as recorder:
        recorder(ticks[0])
    log = recorder.log()
    assert log.channels["ee/energy_stored"].unit == "mJ"
    assert log.channels["gain/matrix"].unit == "1/s"


def test_files_that_cannot_be_written(tmp_path: Path, ticks: list[Tick]) -> None:
    with pytest.raises(OutputError, match="cannot be created"):
        Recorder(tmp_path / "nowhere" / "a.mcap")

    class Full(io.BytesIO):
        def write(self, data: bytes) -> int:  # type: ignore[override]
            if self.tell() > 1000:
                raise OSError(28, "No space left on device")
            return super().write(data)

    recorder = Recorder(Full())
    for tick in ticks[:10]:
        recorder(tick)
    with pytest.raises(OutputError, match="No space left"):
        recorder.close()
    recorder.close()  # a second call does nothing


def test_an_empty_run_leaves_a_readable_log(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", INFO):
        pass
    log = Log.open(tmp_path / "a.mcap")
    assert not log.channels
    assert log.duration == 0.0


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
