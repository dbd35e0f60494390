"""The study of the stack of passive task-space controllers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Result, Study
from pliant.experiments.parameter_search import ParameterSearch
from pliant.studies.stack import draw
from pliant.studies.stack.build import build
from pliant.studies.stack.cases import CASES
from pliant.studies.stack.config import StackCaseConfig
from pliant.studies.stack.measure import measure
from pliant.studies.stack.search import search_of
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class StackStudy(Study[StackCaseConfig]):
    """[Stack] Tiseo et al. 2020: figure-8 and line with a 7-joint arm, free, against a wall, pushed at the elbow."""

    name = "stack"
    title = "stack of passive task-space controllers on a 7-joint arm (Tiseo et al. 2020)"
    cases = CASES

    def build(self, config: StackCaseConfig) -> Experiment:
        return build(config)

    def metrics(self, config: StackCaseConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, config.robot_model(), log)

    def figures(self, config: StackCaseConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)

    def search(self, controller: str, case: str | None = None) -> ParameterSearch:
        return search_of(self.case(case or "figure8-gazebo"), controller)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return [*draw.summary_figures(results, folder), *super().summary_figures(results, folder)]


STUDY = StackStudy()
