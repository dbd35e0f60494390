"""A task file as a study: its variants are the cases, its `[sweep]` the rows."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pliant.configuration import overlaid, validated
from pliant.errors import ConfigError
from pliant.experiments.base import Experiment, Result, Study
from pliant.experiments.case import Case, Row, seeded
from pliant.experiments.tuning import Tuning, nested
from pliant.studies.task import draw
from pliant.studies.task.build import build, planned
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.measure import WORST, Signals, check_accept, measured, signals_of
from pliant.studies.task.tuning import tuning_of
from pliant.studies.task.world import true_surface
from pliant.tasks.files import TaskFile, checked, read_task
from pliant.tasks.task import Task
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

_SEEDS = 3


class TaskStudy(Study[TaskCase]):
    """Runs of one task.

    Args:
        name: of the task: its file or its name in the catalogue.
        cases: name → run; the first is the task itself, the others are its variants.
    """

    worst = WORST

    def __init__(self, name: str, cases: Mapping[str, TaskCase]) -> None:
        self.name = name
        self.cases = {case: Case(config, (), _draws) for case, config in cases.items()}
        self.title = next(iter(cases.values())).description or "a contact task"

    def rows(self, base: TaskCase) -> Sequence[Row]:
        """Every combination of the values of `[sweep]`."""
        sweep = {key: values for key, values in base.sweep.items() if key != "seeds"}
        for key, values in sweep.items():
            if not isinstance(values, list | tuple):
                raise ConfigError(f"sweep.{key}: a list of values, got {values!r}")
        rows: list[Row] = []
        for values in itertools.product(*sweep.values()):
            changes: dict[str, Any] = {}
            for key, value in zip(sweep, values, strict=True):
                changes = overlaid(None, changes, nested({key: value}))
            named = [f"{key} {value}" for key, value in zip(sweep, values, strict=True) if key != "controller"]
            controller = changes.pop("controller", None)
            rows.append(Row(", ".join(named), controller, changes))
        return rows

    def shows(self, config: TaskCase) -> bool:
        return config.seed == 0

    def build(self, config: TaskCase) -> Experiment:
        check_accept(config.accept)
        return build(config)

    def metrics(self, config: TaskCase, log: Log) -> tuple[Metric, ...]:
        return measured(self._signals(config, log), config.accept)

    def verdict(self, config: TaskCase, metrics: Sequence[Metric]) -> str | None:
        if not metrics:
            return "the run ended before the path began: no contact was found in time"
        allowed = config.limits.force
        peak = next(metric.value for metric in metrics if metric.name == "force_peak")
        if allowed is not None and peak > allowed:
            return f"the force limit was passed: {peak:.3g} N along the normal, limits.force allows {allowed:g} N"
        return None

    def tuning(self, controller: str, case: str | None = None) -> Tuning:
        return tuning_of(self.case(case or next(iter(self.cases))), controller)

    def figures(self, config: TaskCase, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, self._signals(config, log), folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return draw.comparison(results, folder)

    def _signals(self, config: TaskCase, log: Log) -> Signals:
        made = planned(config)
        surface = true_surface(config, made.surface, made.path)
        return signals_of(log, config.tool.frame, surface.geometry, made.robot.torque_limit)


def _draws(base: TaskCase, seeds: int | None) -> Sequence[Mapping[str, Any]]:
    return seeded(int(base.sweep.get("seeds", _SEEDS)))(base, seeds)


def whole(name: str, values: Mapping[str, Any]) -> tuple[TaskStudy, TaskCase]:
    """A task without its file. Args: name: of the task; values: all of one run. Raises ConfigError."""
    case = validated(TaskCase, values)
    return _kind(name, {case.case: case}), case


def study_of(name: str) -> TaskStudy:
    """The study of a task file, or of a task of the catalogue.

    Raises:
        ConfigError: there is none, or it is no task.
    """
    found: TaskFile = read_task(name)
    tasks: dict[str, Task] = {found.name: found.task}
    for variant, changes in found.variants.items():
        if variant in tasks:
            raise ConfigError(f"{found.path}: a variant cannot have the name of its file, {variant!r}")
        tasks[variant] = checked(found.path, overlaid(Task, found.task.model_dump(), changes))
    return _kind(name, {key: case_of(task, key) for key, task in tasks.items()})


def _kind(name: str, cases: Mapping[str, TaskCase]) -> TaskStudy:
    """Of a path on a surface, or of a list of phases. Raises ConfigError where variants mix the two."""
    from pliant.studies.task.list_study import ListStudy

    lists = {key: bool(case.phase) for key, case in cases.items()}
    if len(set(lists.values())) > 1:
        odd = next(key for key, is_list in lists.items() if is_list is not next(iter(lists.values())))
        raise ConfigError(f"{name}: its variant {odd!r} is of another kind: all have [[phase]], or none has")
    return (ListStudy if any(lists.values()) else TaskStudy)(name, cases)
