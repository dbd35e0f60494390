"""A folder is held by one sweep at a time."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest

from pliant.errors import OutputError
from pliant.experiments.lock import FILE, locked


def test_the_second_is_told_who_holds_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/pliant", "study", "stack"])
    with locked(tmp_path):
        holder = re.escape(f"in use by process {os.getpid()} (`pliant study stack`)")
        with pytest.raises(OutputError, match=holder), locked(tmp_path):
            pass
        (tmp_path / FILE).write_text("[]")  # whatever stands there
        with pytest.raises(OutputError, match="in use by another process"), locked(tmp_path):
            pass


def test_nothing_is_left_and_what_was_left_does_not_count(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), locked(tmp_path):
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []
    (tmp_path / FILE).write_text('{"pid": 1, "command": "pliant study"}')  # of a process that was killed
    with locked(tmp_path):
        pass


def test_a_folder_that_cannot_be_locked_is_refused(tmp_path: Path) -> None:
    (tmp_path / FILE).mkdir()
    with pytest.raises(OutputError, match="cannot be locked"), locked(tmp_path):
        pass
