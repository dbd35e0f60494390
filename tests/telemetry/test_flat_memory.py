"""A long recording: memory does not grow with its length."""

from __future__ import annotations

import ctypes
import io
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pliant.signals import Tick
from pliant.telemetry import Recorder
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
