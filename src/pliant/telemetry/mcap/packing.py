"""Bytes of records and of rows of numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from mcap.data_stream import RecordBuilder
from mcap.records import (
    McapRecord,
)

from pliant.spatial import Array


def record_bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())


def put_values(rows: npt.NDArray[np.uint8], at: int, values: npt.NDArray[np.generic]) -> None:
    """Writes (n,) values of one type at a byte of each row."""
    width = values.dtype.itemsize
    rows[:, at : at + width] = np.ascontiguousarray(values).view(np.uint8).reshape(len(rows), width)


def put_numbers(rows: npt.NDArray[np.uint8], body: int, offsets: Sequence[int], values: Array) -> int:
    """Writes (n, k) float64 values, neighbours in one go. Returns k."""
    k = len(offsets)
    if not k:
        return 0
    packed = np.ascontiguousarray(values, dtype="<f8")
    if offsets[-1] - offsets[0] == 8 * (k - 1):  # offsets only grow: then they are neighbours
        at = body + offsets[0]
        rows[:, at : at + 8 * k] = packed.view(np.uint8).reshape(len(rows), 8 * k)
    else:
        for column, offset in enumerate(offsets):
            put_values(rows, body + offset, packed[:, column])
    return k
