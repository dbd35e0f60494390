"""The study."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pliant.experiments.base import Experiment, Study
from pliant.experiments.parameter_search import ParameterSearch
from pliant.studies.polishing import draw
from pliant.studies.polishing.cases import CASES
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.measure import WORST, measure
from pliant.studies.polishing.search import search_of
from pliant.studies.task.build_list import build_list
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class Polishing(Study[PolishingConfig]):
    """[FFMPC] Kleff et al. 2024, sections VI and VII, and beyond."""

    name = "polishing"
    title = "press on a table and draw a circle: classical, torque-feedback, force-feedback and offset-free MPC"
    cases = CASES
    worst = WORST

    def build(self, config: PolishingConfig) -> Experiment:
        """Wires the task of a run, whose last phase goes on. Raises PliantError: a robot or value that does not fit."""
        return replace(build_list(config.as_task()), duration=None)

    def metrics(self, config: PolishingConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, log)

    def figures(self, config: PolishingConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)

    def search(self, controller: str, case: str | None = None) -> ParameterSearch:
        return search_of(self.case(case or "tables-2-3-4"), controller)


STUDY = Polishing()
