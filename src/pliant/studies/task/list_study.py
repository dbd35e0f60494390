"""A task that is a list of phases, as a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Result
from pliant.references.reach.check import ReachCheck
from pliant.rules import Suggestion
from pliant.studies.task.build_list import build_list, listed
from pliant.studies.task.check import CHECKED_DRAWS, checked_list
from pliant.studies.task.config import TaskCase
from pliant.studies.task.draw_list import list_figures
from pliant.studies.task.drawn_case import as_drawn
from pliant.studies.task.landing import suggested_landings, told_landing
from pliant.studies.task.measure_list import check_accept_of_list, measured_list
from pliant.studies.task.search import Searched
from pliant.studies.task.task_study import TaskStudy
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class ListStudy(TaskStudy):
    """Runs of one task of `[[phase]]`."""

    def build(self, config: TaskCase) -> Experiment:
        self.check_accept(config)
        return build_list(as_drawn(config))

    def metrics(self, config: TaskCase, log: Log) -> tuple[Metric, ...]:
        run = as_drawn(config)
        return measured_list(run, listed(run), log)

    def searched(self, config: TaskCase) -> Searched:
        made = listed(as_drawn(config))
        return Searched(made.robot, made.believed)

    def suggested(self, config: TaskCase) -> Mapping[str, Suggestion]:
        run = as_drawn(config)
        return {**super().suggested(config), **suggested_landings(run, listed(run).landings)}

    def about(self, config: TaskCase) -> Mapping[str, str]:
        run = as_drawn(config)
        told = [told_landing(run, name, one) for name, one in listed(run).landings.items()]
        landing = {"landing": "; ".join(told)} if told else {}
        return {**super().about(config), **landing}

    def check_accept(self, config: TaskCase) -> None:
        check_accept_of_list(config)

    def check(self, config: TaskCase, drawn: int = CHECKED_DRAWS) -> ReachCheck:
        return checked_list(config, drawn)

    def figures(self, config: TaskCase, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        run = as_drawn(config)
        return list_figures(run, listed(run), experiment, log, folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return []
