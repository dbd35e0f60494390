"""What a recorder keeps: the same bytes of the same ticks, channels that change, what ends a run, what it refuses."""

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

from pliant.errors import ConfigError, OutputError, ShapeError
from pliant.signals import Tick
from pliant.telemetry import Channel, Log, Recorder
from tests.telemetry.recording import INFO, record, with_diagnostics
from tests.telemetry.ticks import make_tick


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
