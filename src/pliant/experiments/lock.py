"""Locks a folder for one sweep at a time."""

from __future__ import annotations

import fcntl
import json
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from pliant.errors import OutputError

FILE = ".sweep.lock"


@contextmanager
def locked(folder: Path) -> Generator[None]:
    """Locks a folder for this process until the block, or the process, ends. No stale lock is left behind.

    Raises:
        OutputError: another process holds it (which one), or it cannot be locked.
    """
    path = folder / FILE
    file = _take(path)
    try:
        about = {"pid": os.getpid(), "command": " ".join(["pliant", *sys.argv[1:]])}
        os.ftruncate(file, 0)
        os.pwrite(file, json.dumps(about).encode(), 0)
        yield
    finally:
        path.unlink(missing_ok=True)  # while it is held: see `_same`
        os.close(file)


def _take(path: Path) -> int:
    while True:
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o644)
        except OSError as error:
            raise OutputError(f"the folder {path.parent} cannot be locked: {error.strerror}") from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(file)
            if isinstance(error, BlockingIOError):
                raise OutputError(
                    f"the folder {path.parent} is in use by {_holder(path)}; wait for it, or name another"
                ) from None
            raise OutputError(f"the folder {path.parent} cannot be locked: {error.strerror}") from None
        if _same(file, path):
            return file
        os.close(file)


def _same(file: int, path: Path) -> bool:
    """Whether the locked file is still the one at that path; its last holder may just have removed it."""
    try:
        return os.fstat(file).st_ino == path.stat().st_ino
    except FileNotFoundError:
        return False


def _holder(path: Path) -> str:
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
        return f"process {about['pid']} (`{about['command']}`)"
    except (OSError, ValueError, KeyError, TypeError):
        return "another process"
