"""Bytes of records."""

from __future__ import annotations

from mcap.data_stream import RecordBuilder
from mcap.records import (
    McapRecord,
)


def record_bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())
