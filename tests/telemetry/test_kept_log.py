"""A log that was kept while it was written is the one that its file holds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pliant.telemetry.log import Log
from pliant.telemetry.mcap import written
from pliant.telemetry.recorder import Recorder
from tests.telemetry.ticks import make_tick


def recorded(path: Path, kept: bool = True) -> Recorder:
    """Two phases, and a channel that comes later."""
    recorder = Recorder(path, kept=kept)
    for index in range(1500):
        tick = make_tick(index)
        more = {"late": float(index)} if index > 700 else {}
        reference = replace(tick.reference, phase="begin" if index < 600 else "end")
        command = replace(tick.command, diagnostics={**tick.command.diagnostics, **more})
        recorder(replace(tick, reference=reference, command=command))
    return recorder


def same(ours: Log, theirs: Log) -> bool:
    alike = ours.channels == theirs.channels and ours.metadata == theirs.metadata and ours.phases() == theirs.phases()
    return alike and all(
        np.array_equal(ours[name], theirs[name], equal_nan=True) and np.array_equal(ours.time(name), theirs.time(name))
        for name in theirs.channels
    )


def test_it_is_the_log_of_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = recorded(tmp_path / "a.mcap")
    with monkeypatch.context() as nothing:
        nothing.setattr(Log, "open", None)  # it is not read
        ours = recorder.log()
    assert not ours.truncated
    assert same(ours, Log.open(tmp_path / "a.mcap"))
    (part,) = ours.parts("measurement/q", "late")
    assert len(part[0]) == len(part[1]) == 1500 - 701
    other = recorded(tmp_path / "b.mcap", kept=False)
    assert same(other.log(), ours)
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_a_long_log_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(written, "_KEPT", 10_000)
    recorder = recorded(tmp_path / "a.mcap")
    assert same(recorder.log(), Log.open(tmp_path / "a.mcap"))
    with monkeypatch.context() as nothing:
        nothing.setattr(Log, "open", None)
        with pytest.raises(TypeError):
            recorder.log()
