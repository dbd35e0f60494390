"""Writes CDR, the binary form of ROS 2 messages, where a whole array goes in at once."""

from __future__ import annotations

import struct
from collections.abc import Iterable

import numpy as np

from pliant.spatial import Array

_HEADER = b"\x00\x01\x00\x00"  # plain CDR, little endian
_WIDTH = {"?": 1, "B": 1, "i": 4, "I": 4, "f": 4, "d": 8}


class CdrBuffer:
    """A message under construction: values in the order of its fields, each aligned to its own width."""

    def __init__(self) -> None:
        self._data = bytearray()

    def put(self, kind: str, *values: float) -> None:
        """Numbers of one type, as `struct` calls it: ? (bool), B, i, I, f, d."""
        self._align(_WIDTH[kind])
        self._data += struct.pack(f"<{len(values)}{kind}", *values)

    def text(self, value: str) -> None:
        """A string."""
        data = value.encode() + b"\x00"
        self.put("I", len(data))
        self._data += data

    def stamp(self, time: int) -> None:
        """builtin_interfaces/Time. Args: time: ns."""
        seconds, rest = divmod(time, 1_000_000_000)
        self.put("i", seconds)
        self.put("I", rest)

    def doubles(self, values: Array | Iterable[float]) -> None:
        """float64 numbers of fixed count, such as the three of a point."""
        self._align(8)
        self._data += np.asarray(values, dtype="<f8").tobytes()

    def points(self, values: Array) -> None:
        """A sequence of geometry_msgs/Point. Args: values: (n, 3) m."""
        self.put("I", len(values))
        if len(values):
            self.doubles(values)

    @property
    def size(self) -> int:
        """Bytes of the message so far."""
        return len(_HEADER) + len(self._data)

    def finished(self) -> bytes:
        """The message."""
        return _HEADER + bytes(self._data)

    def _align(self, width: int) -> None:
        self._data += bytes(-len(self._data) % width)
