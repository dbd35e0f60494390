"""Runs a wired loop in blocks and in Python, and compares the logs byte by byte."""

from __future__ import annotations

import io

from pliant import loop
from pliant.compiled import Rows
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_info
from pliant.signals import Tick
from pliant.telemetry.recorder import Recorder
from pliant.wiring.experiment import Experiment

_STUDY = get_study("stack")


class Counts:
    """Observer: ticks that it was told of one by one, and blocks."""

    def __init__(self) -> None:
        self.single, self.blocks = 0, list[int]()

    def __call__(self, tick: Tick) -> None:
        self.single += 1

    def take_block(self, rows: Rows) -> None:
        self.blocks.append(len(rows.numbers))


def run(experiment: Experiment, ticks: int, *, python: bool, decimation: int = 1) -> tuple[bytes, loop.Outcome, Counts]:
    """Log, outcome and how the ticks came. In Python: a clock that is no range."""
    stream, counts = io.BytesIO(), Counts()
    info = run_info(_STUDY, _STUDY.case("figure8-plain"), experiment)
    clock = list(range(ticks)) if python else range(ticks)
    with Recorder(stream, info, channels=experiment.channels, decimation=decimation) as recorder:
        outcome = experiment.run(clock, [recorder, counts])
        recorder.close(outcome.failure)
    return stream.getvalue(), outcome, counts


def both(experiment: Experiment, ticks: int, decimation: int = 1) -> tuple[loop.Outcome, Counts]:
    """Runs both loops and compares them. Returns outcome and ticks of the one with blocks."""
    expected, ended, slow = run(experiment, ticks, python=True, decimation=decimation)
    log, outcome, counts = run(experiment, ticks, python=False, decimation=decimation)
    assert slow.blocks == []
    assert outcome == ended
    assert counts.single + sum(counts.blocks) == slow.single
    assert log == expected
    return outcome, counts
