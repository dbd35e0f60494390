"""Runs one configuration of a study: loop, log, metrics, figures."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pliant.compiled import Rows
from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig, Experiment, Result, Study
from pliant.experiments.drawn import drawn_scene
from pliant.experiments.own_metrics import own_metrics
from pliant.experiments.verdict import StartNotes, physical_verdict
from pliant.interfaces import Observer
from pliant.signals import Tick
from pliant.telemetry.info import RunInfo
from pliant.telemetry.log import Log
from pliant.telemetry.recorder import Recorder
from pliant.telemetry.summary import Metric

Progress = Callable[[float], None]
"""called with the completed share of the run, 0…1"""


def run_case(
    study: Study[Any],
    config: CaseConfig,
    folder: Path | None = None,
    *,
    progress: Progress | None = None,
    observers: Sequence[Observer] = (),
    figures: bool = True,
    experiment: Experiment | None = None,
    pace: Callable[[Iterable[object]], Iterable[object]] = iter,
) -> Result:
    """Runs a configuration to its end, or to the failure that stops it; what was recorded until then is kept.

    Args:
        study: the study that the configuration belongs to.
        config: what to run.
        folder: where log and figures go; None keeps the log in memory and draws nothing.
        progress: called with the completed share.
        observers: additional observers of the loop.
        figures: whether to draw.
        experiment: the wired loop, if the caller already built it.
        pace: makes a clock of the periods to run, for example one that follows wall time.

    Returns:
        Metrics, failure and files. KeyboardInterrupt passes through after the log was closed.
    """
    wired = experiment or study.build(config)
    stem = file_stem(config)
    recorder = Recorder(
        None if folder is None else folder / f"{stem}.mcap",
        run_info(study, config, wired),
        channels=wired.channels,
        scene=drawn_scene(wired) if folder is not None and config.log_scene else None,
        kept=True,
    )
    ticks = round(run_length(config, wired) / wired.plant.period)
    notes = StartNotes()
    watchers: list[Observer] = [recorder, notes, *observers]
    if progress is not None:
        watchers.append(_Reporter(progress, ticks))
    with recorder:
        outcome = wired.run(pace(range(ticks)), watchers)
        recorder.close(outcome.failure)
    log = recorder.log()
    wired = replace(wired, warnings=(*wired.warnings, *(notes.sentences or ())))
    return _measured(study, config, wired, log, outcome.failure, folder, figures)


def run_length(config: CaseConfig, experiment: Experiment) -> float:
    """s: as configured, or until the task is done."""
    return config.duration if experiment.duration is None else min(config.duration, experiment.duration)


def run_info(study: Study[Any], config: CaseConfig, experiment: Experiment) -> RunInfo:
    """Identity of the run for its log."""
    return RunInfo(
        study=study.name,
        case=config.case,
        controller=config.controller,
        robot=config.robot,
        seed=config.seed,
        joints=experiment.robot.joint_names,
        torque_limits=tuple(experiment.robot.torque_limit),
        config=config.model_dump(mode="json"),
    )


def file_stem(config: CaseConfig) -> str:
    """Name of a run's files, without suffix."""
    parts = (config.case, config.controller, config.variant, f"seed{config.seed}")
    text = "_".join(part for part in parts if part)
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", text)


def _measured(
    study: Study[Any],
    config: CaseConfig,
    wired: Experiment,
    log: Log,
    failure: str | None,
    folder: Path | None,
    figures: bool,
) -> Result:
    path = folder / f"{file_stem(config)}.mcap" if folder is not None else None
    if failure is not None:
        return Result(config, (), failure, wired.warnings, path)
    drawn = study.figures(config, wired, log, folder) if folder is not None and figures else []
    judged = study.judged(config, log)
    measured = _each_once((*judged, *own_metrics(config.own_metrics, config, log)))
    verdicts = (study.verdict(config, judged), physical_verdict(log, wired.robot))
    failure = "; ".join(verdict for verdict in verdicts if verdict) or None
    return Result(config, measured, failure, wired.warnings, path, tuple(drawn))


def _each_once(metrics: tuple[Metric, ...]) -> tuple[Metric, ...]:
    names = [metric.name for metric in metrics]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ConfigError(f"a run has each metric once; {twice} would be there twice: give your own other names")
    return metrics


class _Reporter:
    """Reports the progress at most ten times per second."""

    def __init__(self, progress: Progress, ticks: int) -> None:
        self._progress, self._ticks = progress, ticks
        self._count, self._next = 0, 0.0

    def __call__(self, tick: Tick) -> None:
        self._passed(1)

    def take_block(self, rows: Rows) -> None:
        self._passed(len(rows.numbers))

    def _passed(self, ticks: int) -> None:
        self._count += ticks
        now = time.monotonic()
        if now >= self._next or self._count == self._ticks:
            self._next = now + 0.1
            self._progress(self._count / self._ticks)
