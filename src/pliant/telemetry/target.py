"""Output of a recorder, and its clock."""

from __future__ import annotations

import io
from pathlib import Path
from typing import BinaryIO

from pliant.errors import OutputError


def whole_seconds_below(first: int) -> int:
    """ns by which a clock that begins at `first` ns, below zero, is shifted; one second more than necessary."""
    return 0 if first >= 0 else (-first // 1_000_000_000 + 2) * 1_000_000_000


def open_target(target: Path | str | BinaryIO | None) -> tuple[BinaryIO, bool]:
    if target is None:
        return io.BytesIO(), False
    if not isinstance(target, (str, Path)):
        return target, False
    try:
        return Path(target).open("wb"), True
    except OSError as error:
        raise OutputError(f"the log {target} cannot be created: {error.strerror}") from error
