"""A long run: the memory of its recording does not grow with its length, that of its metrics by less than a channel."""

from __future__ import annotations

import ctypes
import io
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pliant.signals import Tick
from pliant.telemetry import Log, Recorder
from pliant.telemetry.describe import log_metrics
from tests.telemetry.recording import INFO

BLOCK = 512  # ticks that a recorder writes at once
BLOCKS = 40
ALLOWED = 2e4  # bytes by which a block may add to memory: what the file's own index keeps of it, several times over


_FIELDS = ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")


class _Heap(ctypes.Structure):
    """`struct mallinfo2` of the C library."""

    _fields_ = [(name, ctypes.c_size_t) for name in _FIELDS]


def in_use() -> int:
    """Bytes that are allocated, Python's own small objects excepted: those of NumPy and of compiled code."""
    library = ctypes.CDLL(None)
    library.mallinfo2.restype = _Heap
    heap = library.mallinfo2()
    return int(heap.uordblks + heap.hblkhd)


def has_mallinfo2() -> bool:
    try:
        return hasattr(ctypes.CDLL(None), "mallinfo2")
    except (OSError, TypeError):
        return False


class _Nowhere(io.RawIOBase):
    """A stream that keeps nothing, and counts blocks."""

    def __init__(self) -> None:
        super().__init__()
        self.blocks = 0

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        return len(data)

    def flush(self) -> None:
        self.blocks += 1


def growth(ticks: list[Tick], beside: Callable[[], Any]) -> float:
    """Bytes per block, when all but the last one are written. Args: beside: called after each block."""
    stream, found = _Nowhere(), list[int]()
    with Recorder(stream, INFO) as recorder:  # pyright: ignore[reportArgumentType]
        for number in range(BLOCKS):
            for tick in ticks:
                recorder(tick)
            while stream.blocks < number:
                time.sleep(1e-3)
            beside()
            found.append(in_use())
    warm = BLOCKS // 4
    return (min(found[-warm:]) - min(found[warm : 2 * warm])) / (BLOCKS - 2 * warm)


@pytest.mark.skipif(not has_mallinfo2(), reason="the C library does not tell what it has allocated")
def test_a_recorder_does_not_grow(ticks: list[Tick]) -> None:
    same = [tick for tick in ticks if tick.reference.phase == ticks[-1].reference.phase][:BLOCK]
    assert growth(same, lambda: None) < ALLOWED
    leak: list[np.ndarray] = []
    assert growth(same, lambda: leak.append(np.ones(8 * BLOCK))) > ALLOWED  # 64 bytes of each tick are kept


def peak_bytes(path: Path, of: Callable[[Log], object]) -> int:
    """Most that is allocated at a time while something is made of a log."""
    log = Log.open(path)
    tracemalloc.start()
    try:
        of(log)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_metrics_need_less_of_a_log_than_a_channel(
    ticks: list[Tick], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pliant.telemetry.mcap.file_bytes._HELD", 0)  # any file counts as long
    lengths = {"short": 20, "long": 40}  # blocks: both beyond what is unpacked at a time
    for name, blocks in lengths.items():
        with Recorder(tmp_path / f"{name}.mcap", INFO) as recorder:
            for number in range(blocks * BLOCK):
                recorder(ticks[100 + number % BLOCK])
    more = BLOCK * (lengths["long"] - lengths["short"])

    def growth_per_tick(of: Callable[[Log], object]) -> float:
        short, long = (peak_bytes(tmp_path / f"{name}.mcap", of) for name in lengths)
        return (long - short) / more

    assert growth_per_tick(log_metrics) < 40.0  # bytes: the times, their differences, and those sorted
    assert growth_per_tick(lambda log: log["command/torque"]) > 55.0  # seven numbers
