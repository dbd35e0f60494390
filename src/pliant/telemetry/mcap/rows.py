"""Message records of a block of ticks as one array of bytes, a row per tick, and their index."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode

from pliant._telemetry import pack
from pliant.spatial import Array
from pliant.telemetry.mcap.pieces import Place
from pliant.telemetry.mcap.topics import Topic

MESSAGE = struct.Struct("<BQHIQQ")  # opcode, length, channel, sequence, log time, publish time
ENVELOPE = 22  # bytes of a message record before its data, counted by its length field
RECORD = 9  # bytes of a record before its content: opcode and length
INDEX = struct.Struct("<BQHI")  # opcode, length, channel, bytes of its entries


@dataclass(frozen=True, slots=True)
class RowPlan:
    """Where everything stands in a row."""

    template: bytes
    """a row without its numbers"""
    begins: tuple[int, ...]
    """byte at which each topic's record begins"""
    stamps: tuple[int, ...]
    """byte at which its stamp does; -1: it has none"""
    lengths: tuple[int, ...]
    """bytes of a topic's message"""
    numbers: tuple[tuple[str, tuple[int, ...]], ...]
    """channel, and the byte of each of its entries"""

    @classmethod
    def of(cls, topics: Sequence[Topic], ids: Sequence[int]) -> RowPlan:
        """Args: topics: in the order in which a tick's messages are written; ids: of their channels in the file."""
        row, begins, stamps = bytearray(), list[int](), list[int]()
        numbers: list[tuple[str, tuple[int, ...]]] = []
        for topic, channel in zip(topics, ids, strict=True):
            made, body = topic.template, len(row) + MESSAGE.size
            begins.append(len(row))
            stamps.append(-1 if made.stamp is None else body + made.stamp)
            row += MESSAGE.pack(Opcode.MESSAGE, ENVELOPE + len(made.data), channel, 0, 0, 0) + made.data
            slot = 0
            for part, order in topic.parts:
                at = dict(zip(order, made.offsets[slot : slot + len(order)], strict=True))
                slot += len(order)
                if order:
                    numbers.append((part.name, tuple(body + at[entry] for entry in range(len(order)))))
        lengths = tuple([len(topic.template.data) for topic in topics])
        return cls(bytes(row), tuple(begins), tuple(stamps), lengths, tuple(numbers))

    def packed(
        self, head: bytes, times: npt.NDArray[np.int64], firsts: Iterable[int], columns: Mapping[str, Array]
    ) -> bytearray:
        """The content of a chunk: its head, and n rows of message records behind it.

        Args:
            head: bytes before the rows.
            times: (n,) log time in ns.
            firsts: sequence number of each topic's first message.
            columns: channel → (n, …) values.
        """
        width = len(self.template)
        data = bytearray(len(head) + len(times) * width)
        data[: len(head)] = head
        rows = np.frombuffer(data, dtype=np.uint8, offset=len(head)).reshape(len(times), width)
        records = list(zip(self.begins, firsts, self.stamps, strict=True))
        numbers = [(columns[name].reshape(len(times), -1), places) for name, places in self.numbers]
        pack(self.template, records, numbers, np.ascontiguousarray(times), rows)
        return data

    def places(self, ids: Sequence[int], count: int, first: int) -> tuple[tuple[int, Place], ...]:
        """Where messages stand in a chunk. Args: ids; count: rows; first: byte at which the first of them begins."""
        ends = zip(ids, self.begins, self.lengths, strict=True)
        width = len(self.template)
        return tuple([(channel, Place(first + at + RECORD, width, count, length)) for channel, at, length in ends])


def index_records(
    ids: Sequence[int], begins: Sequence[int], times: npt.NDArray[np.int64], width: int, first: int
) -> tuple[bytes, list[int]]:
    """A MESSAGEINDEX record for each topic of a chunk of rows, one after the other, and where each of them begins.

    Args:
        ids: of the topics' channels in the file.
        begins: byte of a row at which each topic's record begins.
        times: (n,) log time in ns.
        width: bytes of a row.
        first: byte of the chunk at which the first row begins.
    """
    size = 16 * len(times)
    record = np.dtype([("head", np.uint8, INDEX.size), ("entries", "<u8", (len(times), 2))])
    records = np.empty(len(ids), dtype=record)
    heads = b"".join(INDEX.pack(Opcode.MESSAGE_INDEX, 6 + size, channel, size) for channel in ids)
    records["head"] = np.frombuffer(heads, dtype=np.uint8).reshape(len(ids), INDEX.size)
    records["entries"][:, :, 0] = times
    at = first + width * np.arange(len(times), dtype=np.uint64)
    records["entries"][:, :, 1] = at + np.array(begins, dtype=np.uint64)[:, None]
    return records.tobytes(), [place * record.itemsize for place in range(len(ids))]
