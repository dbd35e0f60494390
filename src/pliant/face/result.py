"""Results of `pliant.run` and `pliant.compare`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from pliant.experiments import base
from pliant.experiments.base import CaseConfig, Study
from pliant.experiments.summarise import summarised
from pliant.face.metric_rows import MetricRows
from pliant.telemetry.log import Log
from pliant.telemetry.plots.log import figures
from pliant.telemetry.summary import Metric, Summary
from pliant.telemetry.table import summary_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH = 140  # columns of a table as text


@dataclass(frozen=True)
class RunResult:
    """Result of one run."""

    study: Study[Any] = field(repr=False)
    run: base.Result = field(repr=False)
    log: Log = field(repr=False)
    """every signal of the run; `log["truth/flange/position"]` is an array (n, 3)"""

    @property
    def config(self) -> CaseConfig:
        """The complete configuration of the run."""
        return self.run.config

    @property
    def metrics(self) -> Mapping[str, Metric]:
        """Name → value, unit, the paper's number and the target; empty where the run stopped early."""
        return {metric.name: metric for metric in self.run.metrics}

    @property
    def failure(self) -> str | None:
        """The failure as one sentence; None if it did not fail."""
        return self.run.failure

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the run."""
        return self.run.warnings

    @property
    def summary(self) -> Summary:
        """The same as summary.json."""
        return summarised(self.study, [self.run])

    def table(self) -> str:
        """The metrics beside the paper's numbers and the targets, as text."""
        return _text(self.summary)

    def plot(self) -> dict[str, Figure]:
        """Name → figure: per frame its error, path and forces; torques, posture, energies. No file is written."""
        return figures(self.log)

    def __str__(self) -> str:
        return self.table()


@dataclass(frozen=True)
class Comparison(MetricRows):
    """Several controllers on the same task with the same seeds."""

    study: Study[Any] = field(repr=False)
    runs: Sequence[base.Result]
    """results of every controller and seed"""

    @cached_property
    def summary(self) -> Summary:
        """One case per controller: means over the seeds, failed runs counted."""
        return summarised(self.study, self.runs)

    @property
    def metrics(self) -> Mapping[str, Mapping[str, Metric]]:
        """Controller → name → metric over its seeds."""
        return {case.name: {metric.name: metric for metric in case.metrics} for case in self.summary.cases}

    def table(self) -> str:
        """Every controller's metrics, and how many of its runs failed, as text."""
        return _text(self.summary)

    def columns(self) -> dict[str, list[Any]]:
        """One row per run and metric as lists: controller, seed, metric, value, unit, failure; a run without metrics
        has one row."""
        return self.rows(self.runs, {})

    def __str__(self) -> str:
        return self.table()


def save(result: RunResult, folder: Path) -> Path:
    """Writes summary.json into the folder of the log. Returns the file. Raises OutputError."""
    return result.summary.write(folder)


def _text(summary: Summary) -> str:
    console = Console(file=StringIO(), width=_WIDTH, color_system=None)
    with console.capture() as captured:
        console.print(summary_table(summary))
    return captured.get()
