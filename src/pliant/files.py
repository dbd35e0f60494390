"""Files that a user names: read completely, or refused with one sentence."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from pliant.errors import ConfigError, OutputError


def read_file(path: str | os.PathLike[str], most: float = float("inf")) -> bytes:
    """The content of a regular file.

    Args:
        path: of the file.
        most: its largest size, bytes.

    Raises:
        OutputError: it does not exist, cannot be read, is larger, or is a folder, a pipe or a device.
    """
    try:
        about = Path(path).stat()
        if not stat.S_ISREG(about.st_mode):
            raise OutputError(f"{path} cannot be read: it is not a regular file")
        if about.st_size > most:
            raise OutputError(f"{path} cannot be read: it has {about.st_size} bytes, at most {most:.0f} are allowed")
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        raise OutputError(f"{path!s} cannot be read: {_why(error)}") from None


def read_text(path: str | os.PathLike[str], most: float = float("inf")) -> str:
    """The same as text; a byte order mark is left out.

    Raises:
        OutputError: as `read_file`.
        ConfigError: it is not UTF-8.
    """
    try:
        return read_file(path, most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path} is not UTF-8 text (byte {error.start}); save it as UTF-8") from None


def _why(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
