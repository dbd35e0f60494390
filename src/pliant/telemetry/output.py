"""Checks of output folders and files, made before a run starts."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from pliant.errors import OutputError


def output_folder(path: str | os.PathLike[str]) -> Path:
    """Makes a folder that can be written to.

    Args:
        path: of the folder; its parents are made as well.

    Returns:
        The folder.

    Raises:
        OutputError: it cannot be created or written to.
    """
    folder = _expanded(Path(path))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise OutputError(f"the output folder {folder} cannot be created: a file of that name is there") from error
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        raise OutputError(f"the output folder {folder} cannot be created: {_why(error)}") from error
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"the output folder {folder} cannot be written to: {_why(error)}") from error
    return folder


def write_text(path: Path, text: str) -> None:
    """Writes a text file whole or not at all: the old one stays until the new one is complete.

    Raises:
        OutputError: it cannot be written.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise OutputError(f"{path} cannot be written: {_why(error)}") from error


def _expanded(path: Path) -> Path:
    try:
        return path.expanduser()
    except RuntimeError as error:  # there is no such user
        raise OutputError(f"the output folder {path} cannot be created: {error}") from None


def _why(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
