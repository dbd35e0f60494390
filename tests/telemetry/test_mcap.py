"""Other readers understand the log: rosbags, which shares no code with it, and the mcap package's, with its checks."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path
from typing import Any

import mcap.reader
import numpy as np
import pytest
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from pliant.signals import Tick
from pliant.telemetry import Log, Recorder, RunInfo
from pliant.telemetry.mcap.messages import DEFINITIONS, encode, message, template
from tests.telemetry.ticks import JOINTS, make_tick

TICKS = 700  # more than one block


@pytest.fixture(scope="module")
def ticks() -> list[Tick]:
    return [make_tick(k) for k in range(TICKS)]


@pytest.fixture(scope="module")
def path(ticks: list[Tick], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mcap") / "run.mcap"
    with Recorder(path, RunInfo("stack", "figure8", seed=3, joints=JOINTS)) as recorder:
        for tick in ticks:
            recorder(tick)
    return path


@pytest.fixture(scope="module")
def messages(path: Path) -> dict[str, list[tuple[int, str, Any]]]:
    """Topic → time (ns), type and message, as rosbags reads them."""
    found: dict[str, list[tuple[int, str, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, time, data in reader.messages():
            decoded = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append((time, connection.msgtype, decoded))
    return found


def xyz(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def test_rosbags_reads_every_topic_in_full(messages: dict[str, list[tuple[int, str, Any]]]) -> None:
    counts = {topic: len(found) for topic, found in messages.items()}
    assert counts.pop("/pliant/reference/phase") == 2
    assert set(counts.values()) == {TICKS}
    assert {found[0][1] for found in messages.values()} == set(DEFINITIONS)


def test_rosbags_reads_joint_states(messages: dict[str, list[tuple[int, str, Any]]], ticks: list[Tick]) -> None:
    for (time, _, state), tick in zip(messages["/pliant/measurement/joint_states"], ticks, strict=True):
        assert time == round(tick.measurement.time * 1e9)
        assert state.header.stamp.sec * 10**9 + state.header.stamp.nanosec == time
        assert tuple(state.name) == JOINTS
        np.testing.assert_array_equal(state.position, tick.measurement.q)
        np.testing.assert_array_equal(state.velocity, tick.measurement.v)
        np.testing.assert_array_equal(state.effort, tick.measurement.torque)


def test_rosbags_reads_wrenches_in_their_frames(
    messages: dict[str, list[tuple[int, str, Any]]], ticks: list[Tick]
) -> None:
    for signal, frame_id in (
        ("measurement", "tool"),
        ("estimate", "tool_world_aligned"),
        ("truth", "tool_world_aligned"),
    ):
        for (_, _, stamped), tick in zip(messages[f"/pliant/{signal}/tool/wrench"], ticks, strict=True):
            assert stamped.header.frame_id == frame_id
            wrench = stamped.wrench
            np.testing.assert_array_equal(
                xyz(wrench.force) + xyz(wrench.torque), getattr(tick, signal).wrenches["tool"]
            )


def test_rosbags_reads_poses_and_arrays(messages: dict[str, list[tuple[int, str, Any]]], ticks: list[Tick]) -> None:
    tick = ticks[600]
    pose = messages["/pliant/truth/objects/box/pose"][600][2].pose
    q = pose.orientation
    assert tick.truth is not None
    np.testing.assert_array_equal([*xyz(pose.position), q.w, q.x, q.y, q.z], tick.truth.objects["box"])
    array = messages["/pliant/gain/matrix"][600][2]
    assert [dim.size for dim in array.layout.dim] == [2, 3]
    np.testing.assert_array_equal(array.data.reshape(2, 3), tick.command.diagnostics["gain/matrix"])
    labelled = messages["/pliant/reference/tool/stiffness"][600][2]
    assert labelled.layout.dim[0].label == "x,y,z,rx,ry,rz"
    scalar = messages["/pliant/ee/energy_stored"][600][2]
    assert scalar.data == tick.command.diagnostics["ee/energy_stored"]
    assert messages["/pliant/reference/phase"][1][2].data == "contact"


def test_the_index_of_the_file_is_right(path: Path) -> None:
    """By the index the mcap package finds the same messages as by reading from front to back; all checksums hold."""
    data = path.read_bytes()
    list(StreamReader(io.BytesIO(data), validate_crcs=True).records)
    seeking = mcap.reader.SeekingReader(io.BytesIO(data), validate_crcs=True, decoder_factories=[DecoderFactory()])
    straight = mcap.reader.NonSeekingReader(io.BytesIO(data), validate_crcs=True)
    by_index = [(c.topic, m.log_time, m.sequence, m.data) for _, c, m in seeking.iter_messages()]
    by_reading = [(c.topic, m.log_time, m.sequence, m.data) for _, c, m in straight.iter_messages()]
    assert [time for _, time, _, _ in by_index] == sorted(time for _, time, _, _ in by_reading)
    assert sorted(by_index) == sorted(by_reading)
    summary = seeking.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(by_reading)
    assert seeking.get_header().profile == "ros2"
    assert {record.name for record in seeking.iter_metadata()} == {"pliant", "pliant.units", "pliant.outcome"}


def test_rosbags_finds_a_stretch_of_time_by_the_index(path: Path, ticks: list[Tick]) -> None:
    start, stop = 505_000_000, 520_000_000  # ns: on both sides of a border between blocks
    with AnyReader([path]) as reader:
        chosen = [c for c in reader.connections if c.topic == "/pliant/command/joint_states"]
        found = [reader.deserialize(data, c.msgtype) for c, _, data in reader.messages(chosen, start, stop)]
    np.testing.assert_array_equal([state.effort for state in found], [tick.command.torque for tick in ticks[505:520]])


SIZES = {"sensor_msgs/msg/JointState": (3, 0, 3), "std_msgs/msg/Float64MultiArray": (2, 4)}


@pytest.mark.parametrize("datatype", sorted(set(DEFINITIONS) - {"std_msgs/msg/String"}))
def test_a_filled_template_is_what_the_library_encodes(datatype: str) -> None:
    names = ("a", "bcd", "e")
    made = template(datatype, SIZES.get(datatype, ()), "frame", names)
    numbers = np.random.default_rng(1).standard_normal(len(made.offsets))
    filled = bytearray(made.data)
    for offset, number in zip(made.offsets, numbers, strict=True):
        filled[offset : offset + 8] = np.float64(number).tobytes()
    if made.stamp is not None:
        filled[made.stamp : made.stamp + 8] = np.array([7, 5], dtype="<u4").tobytes()
    expected = encode(datatype, message(datatype, numbers.tolist(), SIZES.get(datatype, ()), "frame", names, (7, 5)))
    assert bytes(filled) == expected
    assert len(made.offsets) == {"Float64": 1, "PointStamped": 3, "PoseStamped": 7, "Float64MultiArray": 8}.get(
        datatype.rsplit("/", 1)[1], 6
    )


def test_a_long_array_finds_its_place() -> None:
    tick = make_tick(0)
    command = dataclasses.replace(tick.command, diagnostics={"long": np.arange(10_000.0)})
    with Recorder(None) as recorder:
        recorder(dataclasses.replace(tick, command=command))
    np.testing.assert_array_equal(recorder.log()["long"][0], np.arange(10_000.0))


def test_a_log_that_was_cut_is_read_up_to_the_cut(path: Path, ticks: list[Tick]) -> None:
    data = path.read_bytes()
    lengths = []
    for share in (0.999, 0.9, 0.75, 0.5):
        try:
            log = Log.open(io.BytesIO(data[: int(share * len(data))]))
        except Exception as error:
            pytest.fail(f"cut at {share}: {error}")
        assert log.truncated
        n = log["measurement/q"].shape[0] if "measurement/q" in log else 0
        np.testing.assert_array_equal(log["measurement/q"], [tick.measurement.q for tick in ticks[:n]]) if n else None
        lengths.append(n)
    assert lengths[0] == TICKS
    assert lengths == sorted(lengths, reverse=True)
    assert 0 < lengths[2] < TICKS


def test_a_damaged_block_gives_nothing_instead_of_nonsense(path: Path, ticks: list[Tick]) -> None:
    data = bytearray(path.read_bytes())
    data[int(0.9 * len(data))] ^= 0x40  # in the last block
    log = Log.open(io.BytesIO(bytes(data)))
    assert log.truncated
    n = log["measurement/q"].shape[0]
    assert 0 < n < TICKS
    np.testing.assert_array_equal(log["measurement/q"], [tick.measurement.q for tick in ticks[:n]])
