"""Logs with flipped bytes and logs that are cut: a sentence, or what could be read and a word that it is not all."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from mcap.opcode import Opcode
from rich.console import Console

from pliant.errors import OutputError
from pliant.telemetry import Log, Recorder, RunInfo
from pliant.telemetry.describe import describe
from tests.telemetry.ticks import JOINTS, make_tick


def recorded(begin: float = 0.0, ticks: int = 10) -> bytes:
    buffer = io.BytesIO()
    info = RunInfo("stack", "figure8", "capped", "lwr4", 3, JOINTS, (50.0,) * 7, {"note": "plain"})
    with Recorder(buffer, info) as recorder:
        for k in range(ticks):
            recorder(make_tick(k + round(begin / 1e-3)))
    return buffer.getvalue()


@pytest.fixture(scope="module")
def whole() -> bytes:
    return recorded()


def same(log: Log, other: Log) -> bool:
    return (
        set(log.channels) == set(other.channels)
        and log.metadata == other.metadata
        and all(
            np.array_equal(log[name], other[name]) and np.array_equal(log.time(name), other.time(name))
            for name in other.channels
        )
    )


def opened(data: bytes) -> Log | None:
    """What can be read, described as for people; None where it is refused in one sentence."""
    try:
        log = Log.open(io.BytesIO(data))
    except OutputError as error:
        return None if "\n" not in str(error) else pytest.fail(f"more than a sentence: {error}")
    if len(data) % 3 == 0 or log.truncated:  # printing costs ten times what reading does
        Console(file=io.StringIO()).print(describe(log))
    return log


def test_a_flipped_byte_is_refused_or_said(whole: bytes) -> None:
    intact = Log.open(io.BytesIO(whole))
    assert not intact.truncated
    rng = np.random.default_rng(0)
    outcomes = {"refused": 0, "said": 0, "no matter": 0}
    for place in rng.choice(len(whole), 150, replace=False):
        data = bytearray(whole)
        data[place] ^= 1 << int(rng.integers(8))
        log = opened(bytes(data))
        if log is None:
            outcomes["refused"] += 1
        elif log.truncated:
            outcomes["said"] += 1
        else:
            outcomes["no matter"] += 1
            assert same(log, intact), f"byte {place} changed the log in silence"
    assert outcomes["said"] > 125, outcomes


def test_each_byte_of_the_end_is_guarded(whole: bytes) -> None:
    """The records that hold the checksums, and what comes after them."""
    intact = Log.open(io.BytesIO(whole))
    for place in range(len(whole) - 60, len(whole)):
        data = bytearray(whole)
        data[place] ^= 1 << place % 8
        log = opened(bytes(data))
        assert log is None or log.truncated or same(log, intact), f"byte {place} changed the log in silence"
    end = whole.rindex(bytes([Opcode.DATA_END]) + (4).to_bytes(8, "little"))
    for place in range(end, end + 13):
        log = opened(whole[:place] + bytes([whole[place] ^ 16]) + whole[place + 1 :])
        assert log is None or log.truncated, f"byte {place - end} of the record with the checksum"


def test_a_cut_is_refused_or_said(whole: bytes) -> None:
    rng = np.random.default_rng(1)
    for length in rng.choice(len(whole) - 1, 120, replace=False):
        log = opened(whole[: int(length)])
        assert log is None or log.truncated


def test_a_flip_is_found_only_because_the_file_has_a_checksum(whole: bytes) -> None:
    """The control: in a file without one, a changed letter of the configuration passes."""
    place = whole.index(b"plain")
    changed = whole[:place] + b"plane" + whole[place + 5 :]
    log = opened(changed)
    assert log is None or log.truncated
    end = changed.rindex(b"\x0f\x04\x00\x00\x00\x00\x00\x00\x00")  # DataEnd: opcode, length, checksum
    blind = changed[: end + 9] + bytes(4) + changed[end + 13 :]
    passed = opened(blind)
    assert passed is not None
    assert not passed.truncated
    assert passed.info.config == {"note": "plane"}


@pytest.mark.parametrize("begin", [-0.017, -5.0])
def test_a_clock_that_starts_below_zero_is_written(begin: float, tmp_path: Path) -> None:
    path = tmp_path / "early.mcap"
    path.write_bytes(recorded(begin=begin))
    log = Log.open(path)
    np.testing.assert_allclose(log.time("measurement/q"), begin + 1e-3 * np.arange(10), atol=1e-9)
    assert log.phases()[0][0] == pytest.approx(begin)
