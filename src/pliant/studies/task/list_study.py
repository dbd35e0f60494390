"""A task that is a list of phases, as a study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.errors import ConfigError
from pliant.experiments.base import Experiment, Result
from pliant.experiments.tuning import Tuning
from pliant.studies.task.build_list import build_list, listed
from pliant.studies.task.config import TaskCase
from pliant.studies.task.draw_list import list_figures
from pliant.studies.task.measure_list import check_accept_of_list, measured_list
from pliant.studies.task.study import TaskStudy
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class ListStudy(TaskStudy):
    """Runs of one task of `[[phase]]`."""

    worst = ()

    def build(self, config: TaskCase) -> Experiment:
        check_accept_of_list(config)
        return build_list(config)

    def metrics(self, config: TaskCase, log: Log) -> tuple[Metric, ...]:
        return measured_list(config, listed(config), log)

    def verdict(self, config: TaskCase, metrics: Sequence[Metric]) -> str | None:
        allowed = config.limits.force
        peak = next((metric.value for metric in metrics if metric.name == "force_peak"), 0.0)
        if allowed is not None and peak > allowed:
            return f"the force limit was passed: {peak:.3g} N, limits.force allows {allowed:g} N"
        return None

    def tuning(self, controller: str, case: str | None = None) -> Tuning:
        raise ConfigError("a list of phases cannot be tuned yet: --tune searches on a task with a path on a surface")

    def figures(self, config: TaskCase, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return list_figures(config, listed(config), experiment, log, folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return []
