"""Reads the records of an MCAP file fast, and up to the first damage of a file."""

from __future__ import annotations

import contextlib
import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, DataEnd, Footer, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream
from mcap_ros2.decoder import DecoderFactory

from pliant.errors import OutputError
from pliant.telemetry.mcap.file_bytes import FileBytes, HeldBytes

Bytes = npt.NDArray[np.uint8]

_MAGIC = b"\x89MCAP0\r\n"
_RECORD = struct.Struct("<BQ")  # opcode, length
_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
_TIME = 6  # bytes of a message before its log time
_KEPT = 160 * 2**20  # bytes of unpacked chunks that stay in memory; those of a longer log are unpacked when asked for


@dataclass
class _Chunk:
    """A chunk of a file: unpacked, or where it stands."""

    file: FileBytes
    start: int
    end: int
    data: bytes | None = None

    def unpacked(self) -> bytes:
        if self.data is not None:
            return self.data
        return _unpacked(self.file.part(self.start, self.end))


@dataclass(frozen=True, slots=True)
class Piece:
    """Messages of one channel in one chunk, all of the same length."""

    chunk: _Chunk
    at: int
    """byte of the chunk where the first message's log time stands"""
    stride: int
    """bytes from one message of the channel to the next"""
    count: int
    length: int
    """bytes of a message"""

    def times(self) -> npt.NDArray[np.int64]:
        """(count,) log times in ns."""
        return np.ascontiguousarray(self._rows(0, 8)).view("<i8")[:, 0]

    def messages(self) -> Bytes:
        """(count, length) bytes."""
        return self._rows(_MESSAGE.size - _TIME, self.length)

    def _rows(self, start: int, length: int) -> Bytes:
        data = np.frombuffer(self.chunk.unpacked(), dtype=np.uint8)[self.at + start :]
        return np.lib.stride_tricks.as_strided(data, (self.count, length), (self.stride, 1), writeable=False)


@dataclass
class Contents:
    """The contents of a file."""

    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    pieces: dict[int, list[Piece]] = field(default_factory=dict)
    """channel → its messages, in the order of the file"""
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    complete: bool = False
    """False: the file ends or is damaged somewhere"""
    chunks: list[_Chunk] = field(default_factory=list)
    """those that stay unpacked"""
    kept: int = 0
    """bytes that the chunks have, unpacked"""

    def texts(self, topic: str) -> list[tuple[float, str]]:
        """Time (s) and text of each std_msgs/String on a topic."""
        found: list[tuple[float, str]] = []
        for key, channel in self.channels.items():
            schema = self.schemas.get(channel.schema_id)
            if channel.topic == topic and schema is not None and schema.name == "std_msgs/msg/String":
                decode = DecoderFactory().decoder_for(channel.message_encoding, schema)
                assert decode is not None
                for piece in self.pieces.get(key, []):
                    messages = zip(piece.times(), piece.messages(), strict=True)
                    found += [(float(time) * 1e-9, str(decode(message.tobytes()).data)) for time, message in messages]
        return found


def read(name: str, file: bytes | FileBytes) -> Contents:
    """Reads a file up to its end or to its first damage.

    Args:
        name: of the file, for errors.
        file: its bytes, or where they are read from; of a file that is not held they must stay as they are.

    Raises:
        OutputError: it is not MCAP.
    """
    held = HeldBytes(file) if isinstance(file, bytes) else file
    if held.part(0, len(_MAGIC)) != _MAGIC:
        what = "is empty" if not held.size else "is not an MCAP file (wrong first bytes)"
        raise OutputError(f"{name} {what}; a pliant log ends in .mcap")
    found, whole = Contents(), False
    with contextlib.suppress(Exception):  # any error of damaged bytes: what was read before is kept
        for opcode, start, content, crc in _file_records(held):
            if opcode == Opcode.CHUNK:
                _take(found, _Chunk(held, start, start + len(content)), content)
            elif opcode == Opcode.METADATA:
                record = Metadata.read(_stream(content))
                found.metadata[record.name] = record.metadata
            elif opcode == Opcode.DATA_END:
                _check(DataEnd.read(_stream(content)).data_section_crc, crc)
                whole = True
            elif opcode == Opcode.FOOTER:
                footer, end = Footer.read(_stream(content)), start + len(content)
                _check(footer.summary_crc, zlib.crc32(held.part(footer.summary_start, end - 4)))
                found.complete = whole and held.part(end, held.size) == _MAGIC
                break
    return found


def _check(wanted: int, found: int) -> None:
    if wanted not in (0, found):  # 0: the writer made none
        raise ValueError("the checksum does not fit the bytes")


def _file_records(file: FileBytes) -> Iterator[tuple[int, int, bytes, int]]:
    """Opcode of each record of a file, where its content begins, its content, and the checksum of all before it."""
    at, crc = len(_MAGIC), zlib.crc32(_MAGIC)
    while at < file.size:
        head = file.part(at, at + _RECORD.size)
        opcode, length = _RECORD.unpack(head)
        start, at = at + _RECORD.size, at + _RECORD.size + length
        if at > file.size:
            raise ValueError("the file ends within a record")
        content = file.part(start, at)
        yield opcode, start, content, crc
        crc = zlib.crc32(content, zlib.crc32(head, crc))


def _take(found: Contents, chunk: _Chunk, packed: bytes) -> None:
    """Adds what a chunk holds: equally built rows at once, anything else message by message."""
    data = _unpacked(packed)  # a damaged chunk gives nothing at all
    _keep(found, chunk, data)
    first = True
    for opcode, start, end in _records(data, 0):
        if opcode == Opcode.MESSAGE:
            rows = _rows(chunk, data, start - _RECORD.size) if first else []
            alone = [(_channel(data, start), Piece(chunk, start + _TIME, 0, 1, end - start - _MESSAGE.size))]
            for channel, piece in rows or alone:
                found.pieces.setdefault(channel, []).append(piece)
            if rows:
                return
            first = False
        elif opcode == Opcode.CHANNEL:
            introduced = Channel.read(_stream(data[start:end]))
            found.channels[introduced.id] = introduced
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(_stream(data[start:end]))
            found.schemas[schema.id] = schema


def _keep(found: Contents, chunk: _Chunk, data: bytes) -> None:
    """Keeps a chunk of a file that is held unpacked, or none any more where all together are too large."""
    if not isinstance(chunk.file, HeldBytes):
        return
    found.kept += len(data)
    if found.kept <= _KEPT:
        chunk.data = data
        found.chunks.append(chunk)
        return
    for one in found.chunks:
        one.data = None
    found.chunks.clear()


def _rows(chunk: _Chunk, data: bytes, at: int) -> list[tuple[int, Piece]]:
    """Channels and messages of a chunk from a byte on, if equally built rows fill it to its end; else nothing."""
    row: list[tuple[int, int, int]] = []
    for opcode, start, end in _records(data, at):
        if opcode != Opcode.MESSAGE:
            return []
        if row and _channel(data, start) == row[0][0]:
            break
        row.append((_channel(data, start), start, end))
    stride = row[-1][2] - at
    count, rest = divmod(len(data) - at, stride)
    if rest or not _alike(data, at, count, stride, [start for _, start, _ in row]):
        return []
    return [(c, Piece(chunk, start + _TIME, stride, count, end - start - _MESSAGE.size)) for c, start, end in row]


def _alike(data: bytes, at: int, count: int, stride: int, starts: list[int]) -> bool:
    """Whether opcode, length and channel of every message are those of the first row."""
    rows = np.frombuffer(data, dtype=np.uint8, offset=at).reshape(count, stride)
    heads = [slice(start - at - _RECORD.size, start - at + 2) for start in starts]
    return all(bool(np.all(rows[:, head] == rows[0, head])) for head in heads)


def _channel(data: bytes, start: int) -> int:
    return int(_MESSAGE.unpack_from(data, start)[0])


def _records(data: bytes, at: int) -> Iterator[tuple[int, int, int]]:
    """Opcode of each record from a byte on, and where its content begins and ends."""
    while at < len(data):
        opcode, length = _RECORD.unpack_from(data, at)
        start, at = at + _RECORD.size, at + _RECORD.size + length
        if at > len(data):
            raise ValueError("the data end within a record")
        yield opcode, start, at


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(io.BytesIO(content))


def _unpacked(packed: bytes) -> bytes:
    stream, size = get_chunk_data_stream(Chunk.read(_stream(packed)), validate_crc=True)
    return stream.read(size)
