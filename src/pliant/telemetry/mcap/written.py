"""What a file holds, kept while it is written: a short log need not be read back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mcap.records import Channel, Schema

from pliant.telemetry.mcap.file_bytes import HeldBytes
from pliant.telemetry.mcap.pieces import Place, StoredChunk
from pliant.telemetry.mcap.reader import Contents, add

_KEPT = 64 * 2**20  # bytes of chunks; of a longer log nothing is kept


class Written:
    """The same contents as the file's, as `reader.read` would find them."""

    def __init__(self) -> None:
        self._contents: Contents | None = Contents()
        self._file = HeldBytes(b"")

    def metadata(self, name: str, data: Mapping[str, str]) -> None:
        """A metadata record."""
        if self._contents is not None:
            self._contents.metadata[name] = dict(data)

    def chunk(self, data: bytes | bytearray, groups: Iterable[tuple[tuple[int, Place], ...]]) -> None:
        """A chunk, unpacked.

        Args:
            data: its bytes.
            groups: channels of messages and where they stand; of equally built rows each channel once.
        """
        found = self._contents
        if found is None:
            return
        found.kept += len(data)
        if found.kept > _KEPT:
            self._contents = None
            return
        chunk = StoredChunk(self._file, 0, 0, found.recent, data)
        found.chunks.append(chunk)
        for group in groups:
            add(found, chunk, group)

    def finished(self, channels: Mapping[int, Channel], schemas: Mapping[int, Schema]) -> Contents | None:
        """The contents of the whole file; None: it is too long to be kept."""
        found = self._contents
        if found is not None:
            found.channels, found.schemas, found.complete = dict(channels), dict(schemas), True
        return found
