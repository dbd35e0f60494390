"""Messages of a file by channel: where they stand, and their bytes when they are asked for."""

from __future__ import annotations

import io
import itertools
import struct
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from mcap.data_stream import ReadDataStream
from mcap.records import Chunk
from mcap.stream_reader import get_chunk_data_stream

from pliant.telemetry.mcap.file_bytes import FileBytes

Bytes = npt.NDArray[np.uint8]

MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
_TIME = 6  # bytes of a message before its log time
_RECENT = 16  # unpacked chunks of a long file that stay in memory: channels are read side by side


class Recent:
    """The chunks that were unpacked last."""

    def __init__(self) -> None:
        self._data: OrderedDict[int, bytes] = OrderedDict()

    def get(self, chunk: StoredChunk) -> bytes:
        data = self._data.pop(chunk.start, None)
        if data is None:
            data = unpacked(chunk.file.part(chunk.start, chunk.end))
        self._data[chunk.start] = data
        while len(self._data) > _RECENT:
            self._data.popitem(last=False)
        return data


@dataclass(slots=True)
class StoredChunk:
    """A chunk of a file: unpacked, or where it stands."""

    file: FileBytes
    start: int
    end: int
    recent: Recent
    data: bytes | bytearray | None = None

    def unpacked(self) -> bytes | bytearray:
        return self.recent.get(self) if self.data is None else self.data


@dataclass(frozen=True, slots=True)
class Place:
    """Where the messages of a channel stand in a chunk, all of the same length."""

    at: int
    """byte of the chunk where the first message's content begins"""
    stride: int
    """bytes from one message of the channel to the next"""
    count: int
    length: int
    """bytes of a message"""

    def time(self, data: bytes | bytearray, number: int) -> int:
        """Log time in ns of one message; −1: of the last."""
        at = self.at + _TIME + number % self.count * self.stride
        return int.from_bytes(data[at : at + 8], "little", signed=True)

    def times(self, data: bytes | bytearray) -> npt.NDArray[np.int64]:
        """(count,) log times in ns."""
        return np.ascontiguousarray(self._rows(data, _TIME, 8)).view("<i8")[:, 0]

    def messages(self, data: bytes | bytearray) -> Bytes:
        """(count, length) bytes."""
        return self._rows(data, MESSAGE.size, self.length)

    def _rows(self, data: bytes | bytearray, start: int, length: int) -> Bytes:
        rest = np.frombuffer(data, dtype=np.uint8)[self.at + start :]
        return np.lib.stride_tricks.as_strided(rest, (self.count, length), (self.stride, 1), writeable=False)


@dataclass(frozen=True, slots=True)
class Piece:
    """Messages of one channel in chunks in which they stand alike."""

    place: Place
    chunks: list[StoredChunk]
    """the same list for all channels whose messages have the same times in these chunks"""

    @property
    def count(self) -> int:
        return self.place.count * len(self.chunks)

    @property
    def length(self) -> int:
        """Bytes of a message."""
        return self.place.length

    def times(self) -> npt.NDArray[np.int64]:
        """(count,) log times in ns."""
        return np.concatenate([self.place.times(chunk.unpacked()) for chunk in self.chunks])

    def ends(self) -> tuple[int, int]:
        """Log times of the first message and of the last, ns."""
        first, last = (self.place.time(self.chunks[at].unpacked(), at) for at in (0, -1))
        return first, last

    def messages(self, begin: int, end: int) -> Iterator[tuple[int, Bytes]]:
        """Those from one number to another, chunk by chunk: (k, length) bytes, and the number of the first."""
        first = begin // self.place.count
        for number, chunk in enumerate(itertools.islice(self.chunks, first, None), first):
            start = number * self.place.count
            if start >= end:
                return
            rows = self.place.messages(chunk.unpacked())[max(begin - start, 0) : end - start]
            yield max(start, begin), rows


def unpacked(packed: bytes) -> bytes:
    """The content of a chunk record."""
    stream, size = get_chunk_data_stream(Chunk.read(ReadDataStream(io.BytesIO(packed))), validate_crc=True)
    return stream.read(size)
