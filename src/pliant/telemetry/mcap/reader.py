"""Reads the records of an MCAP file fast, and as far as a damaged file goes."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from mcap.data_stream import ReadDataStream
from mcap.exceptions import InvalidMagic
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Footer, Metadata, Schema
from mcap.stream_reader import StreamReader, get_chunk_data_stream
from mcap_ros2.decoder import DecoderFactory

from pliant.errors import OutputError

_RECORD = struct.Struct("<BQ")  # opcode, length
_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time


@dataclass
class Contents:
    """What a file held."""

    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    times: dict[int, list[int]] = field(default_factory=dict)
    """channel → log times, ns"""
    data: dict[int, list[bytes]] = field(default_factory=dict)
    """channel → messages"""
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    complete: bool = False
    """False: the file ends or is damaged somewhere"""

    def texts(self, topic: str) -> list[tuple[float, str]]:
        """Time (s) and text of each std_msgs/String on a topic."""
        found: list[tuple[float, str]] = []
        for key, channel in self.channels.items():
            schema = self.schemas.get(channel.schema_id)
            if channel.topic == topic and schema is not None and schema.name == "std_msgs/msg/String":
                decode = DecoderFactory().decoder_for(channel.message_encoding, schema)
                assert decode is not None
                messages = zip(self.times.get(key, []), self.data.get(key, []), strict=True)
                found += [(time * 1e-9, str(decode(message).data)) for time, message in messages]
        return found


def read(name: str, data: bytes) -> Contents:
    """Reads a file up to its end or to its first damage.

    Args:
        name: of the file, for errors.
        data: its bytes.

    Raises:
        OutputError: it is not MCAP.
    """
    found = Contents()
    reader = StreamReader(io.BytesIO(data), emit_chunks=True, validate_crcs=True, record_size_limit=len(data))
    try:
        for record in reader.records:
            if isinstance(record, Chunk):
                _take(found, record)
            elif isinstance(record, Metadata):
                found.metadata[record.name] = record.metadata
            elif isinstance(record, Footer):
                found.complete = True
    except InvalidMagic as error:
        if not found.complete:
            what = "is empty" if not data else "is not an MCAP file (wrong first bytes)"
            raise OutputError(f"{name} {what}; a pliant log ends in .mcap") from error
    except Exception as error:  # whatever the reader makes of damaged bytes
        if len(data) < 8 or not data.startswith(b"\x89MCAP0\r\n"):
            what = "is empty" if not data else "is not an MCAP file (too short)"
            raise OutputError(f"{name} {what}; a pliant log ends in .mcap") from error
    return found


def _take(found: Contents, chunk: Chunk) -> None:
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)  # a damaged chunk gives nothing at all
    data = stream.read(size)
    for opcode, start, end in _records(data):
        if opcode == Opcode.MESSAGE:
            channel, _, time, _ = _MESSAGE.unpack_from(data, start)
            found.times.setdefault(channel, []).append(time)
            found.data.setdefault(channel, []).append(data[start + _MESSAGE.size : end])
        elif opcode == Opcode.CHANNEL:
            introduced = Channel.read(ReadDataStream(io.BytesIO(data[start:end])))
            found.channels[introduced.id] = introduced
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(ReadDataStream(io.BytesIO(data[start:end])))
            found.schemas[schema.id] = schema


def _records(data: bytes) -> Iterator[tuple[int, int, int]]:
    at = 0
    while at < len(data):
        opcode, length = _RECORD.unpack_from(data, at)
        at += _RECORD.size
        yield opcode, at, at + length
        at += length
