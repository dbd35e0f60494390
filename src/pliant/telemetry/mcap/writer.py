"""Writes blocks of equally built ticks as an MCAP file, a chunk per block.

The mcap package's own writer takes one message per call, which costs more than the control loop that it records. Here
a block becomes one array of bytes, with one row per tick, into which the columns are copied. Nothing in the file
depends on the wall clock.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import BinaryIO

import mcap
import mcap_ros2
import numpy as np
import numpy.typing as npt
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from pliant.spatial import Array
from pliant.telemetry.mcap.messages import DEFINITIONS, encode
from pliant.telemetry.mcap.packing import record_bytes
from pliant.telemetry.mcap.pieces import Place
from pliant.telemetry.mcap.reader import Contents
from pliant.telemetry.mcap.rows import ENVELOPE, INDEX, MESSAGE, RECORD, RowPlan, index_records
from pliant.telemetry.mcap.scene_messages import SCENE_DEFINITIONS
from pliant.telemetry.mcap.topics import Topic
from pliant.telemetry.mcap.written import Written

_MAGIC = b"\x89MCAP0\r\n"
_ZSTD = zstandard.ZstdCompressionParameters(
    strategy=zstandard.STRATEGY_FAST, window_log=17, hash_log=14, min_match=7, target_length=2
)
"""Numbers with noise hardly compress, what stands between them is as in the row before: speed counts. A window of some
tens of rows stays in the processor's cache; a match is at least 7 bytes, as a number's own bytes hardly repeat."""
_DEFINITIONS = {**DEFINITIONS, **SCENE_DEFINITIONS}
_LIBRARY = f"pliant with mcap {mcap.__version__}, mcap-ros2-support {mcap_ros2.__version__}"


@dataclass
class _OpenChunk:
    """What goes into the chunk under construction."""

    head: RecordBuilder = field(default_factory=RecordBuilder)
    """schema and channel records that it introduces"""


class McapFile:
    """An MCAP file that grows by blocks. Not for use by several threads at once."""

    def __init__(self, stream: BinaryIO, kept: bool = False) -> None:
        """Starts a file.

        Args:
            stream: open for writing, at its start; it stays open at `finish`.
            kept: keeps what it writes in memory, too, where it is not long: see `contents`.
        """
        self._stream = stream
        self._at, self._crc = 0, 0
        self._schemas: dict[str, Schema] = {}
        self._channels: dict[tuple[str, str, bytes], Channel] = {}
        self._counts: dict[int, int] = {}
        self._sequence: dict[int, int] = {}
        self._index = bytearray()
        self._spans: list[tuple[int, int]] = []
        self._metadata: list[MetadataIndex] = []
        self._plans: dict[object, RowPlan] = {}
        self._written = Written() if kept else None
        self._compressor = zstandard.ZstdCompressor(compression_params=_ZSTD)
        self._write(_MAGIC)
        self._write(record_bytes(Header("ros2", _LIBRARY)))

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Adds a metadata record."""
        record = record_bytes(Metadata(name, dict(data)))
        self._metadata.append(MetadataIndex(self._at, len(record), name))
        self._write(record)
        if self._written is not None:
            self._written.metadata(name, data)

    def contents(self) -> Contents | None:
        """What the finished file holds; None: it was not kept, or it is too long for that."""
        if self._written is None:
            return None
        channels = {channel.id: channel for channel in self._channels.values()}
        return self._written.finished(channels, {schema.id: schema for schema in self._schemas.values()})

    def add_block(self, topics: Sequence[Topic], times: npt.NDArray[np.int64], columns: Mapping[str, Array]) -> None:
        """Writes one message per topic and tick.

        Args:
            topics: in the order in which a tick's messages are written.
            times: (n,) log time in ns since the start of the run.
            columns: channel → (n, …) values.
        """
        if not len(times):
            return
        chunk = _OpenChunk()
        ids = [self._channel(t.name, t.datatype, t.template.data, t.metadata, chunk) for t in topics]
        head = bytes(chunk.head.end())
        plan = self._plan(topics, ids)
        data = plan.packed(head, times, [self._next(channel, len(times)) for channel in ids], columns)
        index, begins = index_records(ids, plan.begins, times, len(plan.template), len(head))
        at = dict(zip(ids, begins, strict=True))
        self._add_chunk(data, index, at, int(times.min()), int(times.max()))
        if self._written is not None:
            self._written.chunk(data, [plan.places(ids, len(times), len(head))])

    def add_text(self, topic: str, time: int, text: str) -> None:
        """Writes one std_msgs/String at a log time in ns."""
        self.add_messages(topic, "std_msgs/msg/String", [(time, encode("std_msgs/msg/String", {"data": text}))])

    def add_messages(self, topic: str, datatype: str, messages: Sequence[tuple[int, bytes]]) -> None:
        """Writes messages that are encoded already, as one chunk. Args: messages: log time in ns and CDR of each."""
        if not messages:
            return
        chunk = _OpenChunk()
        channel = self._channel(topic, datatype, b"", dict, chunk)
        data = bytearray(chunk.head.end())
        first, entries, places = self._next(channel, len(messages)), list[int](), list[tuple[tuple[int, Place]]]()
        for number, (time, body) in enumerate(messages, first):
            entries += time, len(data)
            places.append(((channel, Place(len(data) + RECORD, 0, 1, len(body))),))
            data += MESSAGE.pack(Opcode.MESSAGE, ENVELOPE + len(body), channel, number, time, time) + body
        index = INDEX.pack(Opcode.MESSAGE_INDEX, 6 + 8 * len(entries), channel, 8 * len(entries))
        index += struct.pack(f"<{len(entries)}Q", *entries)
        times = [time for time, _ in messages]
        self._add_chunk(data, index, {channel: 0}, min(times), max(times))
        if self._written is not None:
            self._written.chunk(data, places)

    def finish(self) -> None:
        """Writes the index. Without it the file is readable up to its last block."""
        self._write(record_bytes(DataEnd(self._crc)))  # a byte that changes later shows
        start = self._at
        summary, offsets = b"", b""
        for opcode, group in (
            (Opcode.SCHEMA, _joined(self._schemas.values())),
            (Opcode.CHANNEL, _joined(self._channels.values())),
            (Opcode.STATISTICS, record_bytes(self._statistics())),
            (Opcode.CHUNK_INDEX, bytes(self._index)),
            (Opcode.METADATA_INDEX, _joined(self._metadata)),
        ):
            if group:
                offsets += record_bytes(SummaryOffset(opcode, start + len(summary), len(group)))
            summary += group
        offset_start = start + len(summary)
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        crc = zlib.crc32(head, zlib.crc32(summary + offsets))
        self._write(summary + offsets + record_bytes(Footer(start, offset_start, crc)) + _MAGIC)
        self._stream.flush()

    # ------------------------------------------------------------------ parts

    def _write(self, data: bytes) -> None:
        self._stream.write(data)
        self._at += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def _channel(
        self, topic: str, datatype: str, data: bytes, metadata: Callable[[], dict[str, str]], chunk: _OpenChunk
    ) -> int:
        """Id of a topic's channel. A topic whose messages change their layout gets a second channel, as MCAP allows."""
        key = (topic, datatype, data)
        if key in self._channels:
            return self._channels[key].id
        if datatype not in self._schemas:
            schema = Schema(len(self._schemas) + 1, _DEFINITIONS[datatype].encode(), "ros2msg", datatype)
            self._schemas[datatype] = schema
            schema.write(chunk.head)
        channel = Channel(len(self._channels) + 1, topic, "cdr", metadata(), self._schemas[datatype].id)
        self._channels[key] = channel
        channel.write(chunk.head)
        return channel.id

    def _plan(self, topics: Sequence[Topic], ids: Sequence[int]) -> RowPlan:
        key = tuple(ids), tuple([topic.parts for topic in topics])
        if key not in self._plans:
            self._plans[key] = RowPlan.of(topics, ids)
        return self._plans[key]

    def _next(self, channel: int, count: int) -> int:
        start = self._sequence.get(channel, 0)
        self._sequence[channel] = start + count
        self._counts[channel] = self._counts.get(channel, 0) + count
        return start

    def _add_chunk(self, data: bytearray, index: bytes, begins: Mapping[int, int], first: int, last: int) -> None:
        """Args: index: records of the messages' index; begins: channel → where its record begins in them."""
        packed = self._compressor.compress(data)
        record = record_bytes(Chunk("zstd", packed, last, first, zlib.crc32(data), len(data)))
        chunk_start = self._at
        self._write(record)
        offsets = {channel: self._at + at for channel, at in begins.items()}
        self._write(index)
        self._spans.append((first, last))
        self._index += record_bytes(
            ChunkIndex(
                chunk_length=len(record),
                chunk_start_offset=chunk_start,
                compression="zstd",
                compressed_size=len(packed),
                message_end_time=last,
                message_index_length=len(index),
                message_index_offsets=offsets,
                message_start_time=first,
                uncompressed_size=len(data),
            )
        )
        self._stream.flush()  # what is written survives the process

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._spans),
            message_count=sum(self._counts.values()),
            message_end_time=max((last for _, last in self._spans), default=0),
            message_start_time=min((first for first, _ in self._spans), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )


def _joined(records: Iterable[Schema | Channel | MetadataIndex]) -> bytes:
    return b"".join(record_bytes(record) for record in records)
