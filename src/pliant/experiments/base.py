"""Base of a study: cases, how their runs are built, metrics of a log, figures."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic

from pliant.configuration import merged
from pliant.errors import ConfigError, options
from pliant.experiments.base_config import CaseConfig as CaseConfig
from pliant.experiments.base_config import check_windows as check_windows
from pliant.experiments.case import C, Case, Row, row_runs
from pliant.experiments.parameter_search import ParameterSearch
from pliant.experiments.result import Result as Result
from pliant.experiments.row_keys import refuse_row_keys
from pliant.rules import Suggestion
from pliant.telemetry.log import Log
from pliant.telemetry.plots.style import save
from pliant.telemetry.summary import Metric
from pliant.wiring.experiment import Experiment as Experiment
from pliant.wiring.registry import controllers

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Study(ABC, Generic[C]):
    """A family of cases with the same builder, metrics and figures."""

    name: str
    title: str
    """one line of text, for listings"""
    cases: Mapping[str, Case[C]]
    """by name; the first is the default"""
    worst: Collection[str] = ()
    """names of metrics for which a row shows the worst run; for others it shows the mean"""

    @property
    def controllers(self) -> Sequence[str]:
        """Names that `controller` can take; beside them, `module:Class` and `file.py:Class`."""
        return tuple(controllers())

    def case(self, name: str) -> C:
        """Configuration of a case. Raises ConfigError, with the cases there are, if it does not exist."""
        if name not in self.cases:
            raise ConfigError(f"study {self.name!r} has no case {name!r}; {options(self.cases, name)}")
        return self.cases[name].config

    @property
    def config_type(self) -> type[C]:
        """Of the configuration of its runs."""
        return type(next(iter(self.cases.values())).config)

    def rows(self, base: C) -> Sequence[Row]:
        """The rows of a case, for its present configuration."""
        return self.cases[base.case].rows

    def runs(self, case: str, seeds: int | None = None, changes: Mapping[str, Any] | None = None) -> Sequence[C]:
        """Every run of a case in the full study: baselines, variants and seeds.

        Args:
            case: name of the case.
            seeds: number of seeds where a case has random draws; None: the study's default.
            changes: of the case, nested; rows are made of the changed case.

        Raises:
            ConfigError: no such case, a value that breaks a rule, or a key that rows set themselves.
        """
        given = changes or {}
        base = merged(self.case(case), given)
        made = [(row, row_runs(base, row, self.cases[case].draws, seeds)) for row in self.rows(base)]
        refuse_row_keys(base, made, given)
        return [run for _, runs in made for run in runs]

    def shows(self, config: C) -> bool:
        """Whether a run of the full study keeps its log and gets figures; of other runs only the metrics are kept."""
        case = self.cases.get(config.case)
        row = None if case is None else case.row_of(config)
        shown = not config.variant if row is None or row.shown is None else row.shown
        return config.seed == 0 and shown

    @abstractmethod
    def build(self, config: C) -> Experiment:
        """Wires the loop of a case."""

    @abstractmethod
    def metrics(self, config: C, log: Log) -> tuple[Metric, ...]:
        """Measures a run; nothing is simulated here. The paper's numbers and targets are the case's."""

    def judged(self, config: C, log: Log) -> tuple[Metric, ...]:
        """The metrics of a run with the paper's numbers and targets of its case."""
        metrics, case = self.metrics(config, log), self.cases.get(config.case)
        return metrics if case is None else case.beside(config, metrics)

    def suggested(self, config: C) -> Mapping[str, Suggestion]:
        """Key → what follows from the rest of a configuration where it says nothing."""
        return {}

    def verdict(self, config: C, metrics: Sequence[Metric]) -> str | None:
        """The reason why a run that reached its end still counts as failed; None if it does not."""
        return None

    @abstractmethod
    def figures(self, config: C, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        """Draws one run."""

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        """Figures of several runs together: the figures of each case that has runs."""
        made: dict[str, Figure] = {}
        for name, case in self.cases.items():
            found = [result for result in results if result.config.case == name]
            for figure in case.figures if found else ():
                made |= figure(case, found)
        return [save(figure, folder / f"{name}.png") for name, figure in made.items()]

    def note(self, config: C) -> str:
        """What a full study of a case does that its user may not expect, in a sentence; empty: nothing."""
        return ""

    def search(self, controller: str, case: str | None = None) -> ParameterSearch:
        """How the parameters of a controller are searched, on the robot and with the delays of a case (None: the
        study's default). Raises ConfigError if the study has no search."""
        raise ConfigError(f"study {self.name!r} cannot be tuned; a study can if it overrides `Study.search`")

    def changed_search(self, controller: str, case: str | None, changes: Mapping[str, Any]) -> ParameterSearch:
        """The search on runs that are changed. A study whose start follows from the runs overrides this, too."""
        sought = self.search(controller, case)
        return replace(sought, runs=[merged(config, changes) for config in sought.runs])
