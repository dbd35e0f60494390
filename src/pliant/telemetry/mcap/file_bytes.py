"""The bytes of a file: held in memory, or, of a long file, read when they are asked for."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Protocol

from pliant.errors import OutputError
from pliant.files import read_file

_HELD = 48 * 2**20  # bytes of a file that is held in memory


class FileBytes(Protocol):
    """Bytes of a file."""

    @property
    def size(self) -> int:
        """How many there are."""
        ...

    def part(self, start: int, end: int) -> bytes:
        """Those from one place to another; fewer where the file ends before."""
        ...


class HeldBytes:
    """Bytes in memory."""

    def __init__(self, data: bytes) -> None:
        self._data, self.size = data, len(data)

    def part(self, start: int, end: int) -> bytes:
        return self._data[start:end]


class LongFile:
    """Bytes of a file that stays open, for as long as this value lives.

    The file can be deleted meanwhile where the system allows it (Linux and macOS do); it must not be written to.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("rb")
        self._lock = threading.Lock()
        self.size = path.stat().st_size

    def part(self, start: int, end: int) -> bytes:
        with self._lock:
            self._file.seek(start)
            return self._file.read(end - start)

    def __del__(self) -> None:
        if hasattr(self, "_file"):
            self._file.close()


def bytes_of(path: Path) -> FileBytes:
    """The bytes of a file, held if it is not long.

    Raises:
        OutputError: as `read_file`.
    """
    try:
        if path.is_file() and path.stat().st_size > _HELD:
            return LongFile(path)
    except OSError as error:
        raise OutputError(f"{path} cannot be read: {error.strerror or error}") from None
    return HeldBytes(read_file(path))
