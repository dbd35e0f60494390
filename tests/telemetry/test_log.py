"""Files that are no logs give one clear sentence; logs describe themselves."""

from __future__ import annotations

import io
from pathlib import Path

import mcap.reader
import mcap.writer
import numpy as np
import pytest
from rich.console import Console

from pliant.errors import ConfigError, OutputError
from pliant.signals import Tick
from pliant.telemetry import Log, Recorder, RunInfo
from pliant.telemetry.describe import describe, log_metrics
from tests.telemetry.recording import INFO, with_diagnostics
from tests.telemetry.ticks import JOINTS, make_tick


@pytest.fixture(scope="module")
def log() -> Log:
    with Recorder(None, RunInfo("stack", "figure8", "capped", "lwr4", 3, JOINTS, (50.0,) * 7)) as recorder:
        for k in range(40):
            recorder(make_tick(k))
    return recorder.log()


def foreign() -> bytes:
    buffer = io.BytesIO()
    writer = mcap.writer.Writer(buffer)
    writer.start()
    writer.finish()
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"x", "not an MCAP file"),
        (b"time,q\n0,1\n" * 50, "not an MCAP file"),
        (b"\x89MCAP0\r\n", "cut off or damaged"),
        (b"\x89MCAP0\r\n" + b"\xff" * 100, "cut off or damaged"),
        (foreign(), "not one of pliant's"),
    ],
)
def test_what_is_not_a_log_says_so(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "file.mcap"
    path.write_bytes(content)
    with pytest.raises(OutputError, match=says) as caught:
        Log.open(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        Log.open(tmp_path / "none.mcap")
    with pytest.raises(OutputError, match="not a regular file"):
        Log.open(tmp_path)


def test_an_unknown_channel_names_the_closest(log: Log) -> None:
    with pytest.raises(ConfigError, match="did you mean 'measurement/q'"):
        log["mesurement/q"]


def test_arrays_cannot_be_changed_by_accident(log: Log) -> None:
    with pytest.raises(ValueError, match="read-only"):
        log["measurement/q"][0] = 1.0


def test_description_names_run_channels_and_metrics(log: Log) -> None:
    console = Console(width=160, record=True, file=io.StringIO())
    console.print(describe(log))
    text = console.export_text()
    for expected in (
        "stack · figure8 · capped",
        "lwr4",
        "contact from 0.030 s",
        *log.channels,
        "rad/s",
        "torque variation",
    ):
        assert expected in text
    assert "cut off" not in text


def test_metrics_of_a_log_come_from_the_true_signals(log: Log) -> None:
    found = {metric.name: metric for metric in log_metrics(log)}
    error = log["truth/tool/position"] - log["reference/tool/position"]
    assert found["tool position rmse y"].value == pytest.approx(1e3 * np.sqrt(np.mean(error[:, 1] ** 2)))
    force = log["truth/tool/wrench"][:, 2] - log["reference/tool/wrench"][:, 2]
    assert found["tool force rms error z"].value == pytest.approx(np.sqrt(np.mean(force**2)))
    assert found["tool position rmse y"].unit == "mm"
    steps = np.abs(np.diff(log["command/torque"], axis=0))
    assert found["torque change per tick"].value == pytest.approx(100.0 * steps.max() / 50.0)
    assert found["time at a torque limit"].value == 100.0
    assert not any(name.startswith("elbow") for name in found)  # the log has no true position of the elbow


def shuffled(data: bytes) -> bytes:
    """The same log, its messages chunked and ordered by another writer: no two rows of a chunk are built alike."""
    reader = mcap.reader.NonSeekingReader(io.BytesIO(data))
    messages = list(reader.iter_messages())
    records = list(mcap.reader.SeekingReader(io.BytesIO(data)).iter_metadata())
    messages.sort(key=lambda found: (found[2].log_time, hash((found[1].id, found[2].log_time // 3_000_000))))
    buffer = io.BytesIO()
    writer = mcap.writer.Writer(buffer, chunk_size=20_000)
    writer.start()
    for record in records:
        writer.add_metadata(record.name, record.metadata)
    ids: dict[int, int] = {}
    for schema, channel, message in messages:
        if channel.id not in ids:
            assert schema is not None
            known = writer.register_schema(schema.name, schema.encoding, schema.data)
            ids[channel.id] = writer.register_channel(channel.topic, "cdr", known, channel.metadata)
        writer.add_message(ids[channel.id], message.log_time, message.data, message.publish_time)
    writer.finish()
    return buffer.getvalue()


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("log") / "a.mcap"
    with Recorder(path, RunInfo("stack", "figure8", "capped", "lwr4", 3, JOINTS, (50.0,) * 7)) as recorder:
        for k in range(700):  # more than a block
            recorder(make_tick(k))
    return path.read_bytes()


def test_the_order_of_messages_does_not_matter(written: bytes) -> None:
    usual, other = Log.open(io.BytesIO(written)), Log.open(io.BytesIO(shuffled(written)))
    assert set(usual.channels) == set(other.channels)
    assert usual.phases() == other.phases()
    for name in usual.channels:
        np.testing.assert_array_equal(usual[name], other[name])
        np.testing.assert_array_equal(usual.time(name), other.time(name))


def test_a_log_that_does_not_stay_unpacked_reads_the_same(written: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = Log.open(io.BytesIO(written))
    monkeypatch.setattr("pliant.telemetry.mcap.reader._KEPT", 0)
    packed = Log.open(io.BytesIO(written))
    assert packed.duration == usual.duration
    for name in usual.channels:
        np.testing.assert_array_equal(usual[name], packed[name])
        np.testing.assert_array_equal(usual.time(name), packed.time(name))


def test_a_long_log_stays_in_its_file_and_reads_the_same(
    written: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = Log.open(io.BytesIO(written))
    path = tmp_path / "long.mcap"
    path.write_bytes(written)
    monkeypatch.setattr("pliant.telemetry.mcap.file_bytes._HELD", 0)
    long = Log.open(path)
    path.unlink()  # it stays open
    assert not long.truncated
    assert long.duration == usual.duration
    for name in usual.channels:
        np.testing.assert_array_equal(usual[name], long[name])
        np.testing.assert_array_equal(usual.time(name), long.time(name))


@pytest.mark.parametrize("share", [0.3, 0.9])
def test_a_long_log_that_was_cut_off_is_read_up_to_the_cut(
    share: float, written: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cut = written[: int(share * len(written))]
    usual = Log.open(io.BytesIO(cut))
    path = tmp_path / "cut.mcap"
    path.write_bytes(cut)
    monkeypatch.setattr("pliant.telemetry.mcap.file_bytes._HELD", 0)
    long = Log.open(path)
    assert long.truncated
    assert usual.truncated
    assert set(long.channels) == set(usual.channels)
    for name in usual.channels:
        np.testing.assert_array_equal(usual[name], long[name])


def test_few_channels_stay_in_memory_and_the_others_are_read_again(
    written: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = Log.open(io.BytesIO(written))
    first, second = list(log.channels)[:2]
    held = log[first]
    assert log[second] is log[second]
    assert log[first] is held
    monkeypatch.setattr("pliant.telemetry.log._CACHED", 0)
    again = Log.open(io.BytesIO(written))
    held, other = again[first], again[second]
    assert again[second] is other
    assert again[first] is not held
    np.testing.assert_array_equal(again[first], held)


def test_parts_of_a_long_log_are_its_channels(written: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = Log.open(io.BytesIO(written))
    path = tmp_path / "long.mcap"
    path.write_bytes(written)
    monkeypatch.setattr("pliant.telemetry.mcap.file_bytes._HELD", 0)
    monkeypatch.setattr("pliant.telemetry.log._PART", 100)
    long = Log.open(path)
    q, torque = usual["measurement/q"], usual["command/torque"]
    where = (np.arange(len(q)) >= 37) & (np.arange(len(q)) < 601)
    for log, count in ((usual, 1), (long, 6)):
        parts = list(log.parts("measurement/q", "command/torque", where=where))
        assert len(parts) == count
        np.testing.assert_array_equal(np.concatenate([part for part, _ in parts]), q[where])
        np.testing.assert_array_equal(np.concatenate([part for _, part in parts]), torque[where])
        steps = [np.diff(part, axis=0) for (part,) in log.parts("measurement/q", where=where, before=1)]
        np.testing.assert_array_equal(np.concatenate(steps), np.diff(q[where], axis=0))
        assert list(log.parts("measurement/q", where=np.zeros(len(q), dtype=bool))) == []
    assert len(list(long.parts("measurement/q"))) == -(-len(q) // 100)


def test_a_channel_that_began_later_stands_beside_the_last_samples(ticks: list[Tick]) -> None:
    with Recorder(None, INFO) as recorder:
        for k, tick in enumerate(ticks[:60]):
            late: dict[str, object] = {"late": float(k)} if k >= 20 else {}
            recorder(with_diagnostics(tick, **late))
    log = recorder.log()
    ((found, q),) = log.parts("late", "truth/q")
    np.testing.assert_array_equal(found, np.arange(20.0, 60.0))
    np.testing.assert_array_equal(q, log["truth/q"][20:])
