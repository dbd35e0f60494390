"""`pliant.rollout`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments import base
from pliant.experiments.base import Study, check_windows
from pliant.experiments.choice import chosen
from pliant.experiments.sweep import results_in_order
from pliant.face.changes import checked_changes
from pliant.face.metric_rows import MetricRows
from pliant.spatial import Array
from pliant.tasks.task import Task


@dataclass(frozen=True)
class Rollout(MetricRows):
    """Results of many runs of one case: every change with every seed."""

    study: Study[Any] = field(repr=False)
    changes: Sequence[Mapping[str, Any]]
    """what each group of runs changes of the case"""
    seeds: Sequence[int]
    runs: Sequence[base.Result] = field(repr=False)
    """of the first change with every seed, then of the second change, …"""

    def values(self, metric: str) -> Array:
        """(changes, seeds) values of a metric; NaN where a run stopped early.

        Raises:
            ConfigError: no run has such a metric.
        """
        found = [next((m.value for m in run.metrics if m.name == metric), math.nan) for run in self.runs]
        names = {m.name: None for run in self.runs for m in run.metrics}
        if metric not in names:
            raise ConfigError(
                f"no run has a metric {metric!r}; there are {', '.join(names) or 'none: all runs failed'}"
            )
        return np.array(found, dtype=np.float64).reshape(len(self.changes), len(self.seeds))

    @property
    def failures(self) -> Mapping[tuple[int, int], str]:
        """(number of the change, seed) → why that run failed."""
        places = [(change, seed) for change in range(len(self.changes)) for seed in self.seeds]
        return {place: run.failure for place, run in zip(places, self.runs, strict=True) if run.failure is not None}

    def columns(self) -> dict[str, list[Any]]:
        """One row per run and metric as lists, with the number of the change; a run without metrics has one row."""
        numbers = [change for change in range(len(self.changes)) for _ in self.seeds]
        return self.rows(self.runs, {"change": numbers})


def rollout(
    what: str | Path | Task,
    *,
    seeds: int | Sequence[int] = 1,
    changes: Sequence[Mapping[str, Any]] = ({},),
    case: str | None = None,
    controller: str | None = None,
    robot: str | None = None,
    metrics: Sequence[str] | None = None,
    jobs: int = 1,
) -> Rollout:
    """Runs one case many times, without logs: every change with every seed.

    A run here is the run of `pliant.run` with the same values, bit for bit, whatever the number of jobs.

    Args:
        what: as of `pliant.run`.
        seeds: the seeds, or how many, beginning with the case's own.
        changes: what each group of runs changes, as the changes of `pliant.run`; `controller` and `robot` may be
            among them.
        case: of the study; None: its first.
        controller: as of `pliant.run`; None: the case's.
        robot: catalogue name, or path of a file; None: the case's.
        metrics: of your own beside the study's.
        jobs: runs at the same time, each in a process of its own.

    Returns:
        Metrics of every run; runs that failed say why.

    Raises:
        PliantError: bad input, in one sentence; nothing was run.
    """
    if isinstance(changes, Mapping | str) or not changes:
        raise ConfigError(f"a rollout takes a list of changes, each a mapping, got {changes!r}")
    overrides = {"controller": controller, "robot": robot, "own_metrics": metrics}
    asked = chosen(what if isinstance(what, Task) else str(what), case, overrides, {})
    numbers = _seeds(seeds, asked.config.seed)
    if any("seed" in change for change in changes):
        raise ConfigError("a rollout runs each of its changes with every seed: give the seeds as `seeds`")
    changed = [merged(asked.config, checked_changes(change)) for change in changes]
    for config in changed:
        check_windows(config)
        asked.study.build(config)  # errors are found before anything runs
    configs = [merged(config, {"seed": seed}) for config in changed for seed in numbers]
    return Rollout(asked.study, tuple(changes), numbers, results_in_order(asked.study.name, configs, jobs))


def _seeds(given: int | Sequence[int], first: int) -> tuple[int, ...]:
    found = tuple(range(first, first + given)) if isinstance(given, int) else tuple(given)
    if not found or len(set(found)) < len(found):
        raise ConfigError(f"a rollout needs at least one seed, and each once, got {given!r}")
    return found
