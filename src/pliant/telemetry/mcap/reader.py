"""Reads the records of an MCAP file fast, and up to the first damage of a file."""

from __future__ import annotations

import contextlib
import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, DataEnd, Footer, Metadata, Schema
from mcap_ros2.decoder import DecoderFactory

from pliant.errors import OutputError
from pliant.telemetry.mcap.file_bytes import FileBytes, HeldBytes
from pliant.telemetry.mcap.pieces import MESSAGE, Piece, Place, Recent, StoredChunk, unpacked

_MAGIC = b"\x89MCAP0\r\n"
_RECORD = struct.Struct("<BQ")  # opcode, length
_TIME = 6  # bytes of a message before its log time
_KEPT = 160 * 2**20  # bytes of unpacked chunks that stay in memory; those of a longer log are unpacked when asked for


@dataclass
class Contents:
    """The contents of a file."""

    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    pieces: dict[int, list[Piece]] = field(default_factory=dict)
    """channel → its messages, in the order of the file"""
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    held: bool = True
    """whether the bytes of the file are in memory"""
    complete: bool = False
    """False: the file ends or is damaged somewhere"""
    chunks: list[StoredChunk] = field(default_factory=list)
    """those that stay unpacked"""
    kept: int = 0
    """bytes that the chunks have, unpacked"""
    recent: Recent = field(default_factory=Recent)
    alike: dict[tuple[tuple[int, Place], ...], list[StoredChunk]] = field(default_factory=dict)
    """channels and places of a row → the latest chunks with such rows"""

    def texts(self, topic: str) -> list[tuple[float, str]]:
        """Time (s) and text of each std_msgs/String on a topic."""
        found: list[tuple[float, str]] = []
        for key, channel in self.channels.items():
            schema = self.schemas.get(channel.schema_id)
            if channel.topic == topic and schema is not None and schema.name == "std_msgs/msg/String":
                decode = DecoderFactory().decoder_for(channel.message_encoding, schema)
                assert decode is not None
                for piece in self.pieces.get(key, []):
                    rows = (row for _, part in piece.messages(0, piece.count) for row in part)
                    messages = zip(piece.times(), rows, strict=True)
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
    found, whole = Contents(held=isinstance(held, HeldBytes)), False
    with contextlib.suppress(Exception):  # any error of damaged bytes: what was read before is kept
        for opcode, start, content, crc in _file_records(held):
            if opcode == Opcode.CHUNK:
                _take(found, StoredChunk(held, start, start + len(content), found.recent), content)
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


def _take(found: Contents, chunk: StoredChunk, packed: bytes) -> None:
    """Adds what a chunk holds: equally built rows at once, anything else message by message."""
    data = unpacked(packed)  # a damaged chunk gives nothing at all
    _keep(found, chunk, data)
    first = True
    for opcode, start, end in _records(data, 0):
        if opcode == Opcode.MESSAGE:
            rows = _rows(data, start - _RECORD.size) if first else []
            add(found, chunk, tuple(rows) or ((_channel(data, start), Place(start, 0, 1, end - start - MESSAGE.size)),))
            if rows:
                return
            first = False
        elif opcode == Opcode.CHANNEL:
            introduced = Channel.read(_stream(data[start:end]))
            found.channels[introduced.id] = introduced
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(_stream(data[start:end]))
            found.schemas[schema.id] = schema


def add(found: Contents, chunk: StoredChunk, rows: tuple[tuple[int, Place], ...]) -> None:
    """Adds messages of a chunk: to the pieces before, where those are of the same rows, so that a long log has few."""
    chunks = found.alike.get(rows)
    if chunks is not None and all(found.pieces[channel][-1].chunks is chunks for channel, _ in rows):
        chunks.append(chunk)
        return
    found.alike[rows] = chunks = [chunk]
    for channel, place in rows:
        found.pieces.setdefault(channel, []).append(Piece(place, chunks))


def _keep(found: Contents, chunk: StoredChunk, data: bytes) -> None:
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


def _rows(data: bytes, at: int) -> list[tuple[int, Place]]:
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
    return [(channel, Place(start, stride, count, end - start - MESSAGE.size)) for channel, start, end in row]


def _alike(data: bytes, at: int, count: int, stride: int, starts: list[int]) -> bool:
    """Whether opcode, length and channel of every message are those of the first row, and its time that of its row."""
    rows = np.frombuffer(data, dtype=np.uint8, offset=at).reshape(count, stride)
    for start in (start - at for start in starts):
        head, time = slice(start - _RECORD.size, start + 2), slice(start + _TIME, start + _TIME + 8)
        first = slice(starts[0] - at + _TIME, starts[0] - at + _TIME + 8)
        if not (np.all(rows[:, head] == rows[0, head]) and np.array_equal(rows[:, time], rows[:, first])):
            return False
    return True


def _channel(data: bytes, start: int) -> int:
    return int(MESSAGE.unpack_from(data, start)[0])


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
