"""A task of one path on a surface, as a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Result
from pliant.references.reach.check import ReachCheck
from pliant.rules import Suggestion
from pliant.studies.task import draw
from pliant.studies.task.build import build, planned
from pliant.studies.task.check import CHECKED_DRAWS, checked_path
from pliant.studies.task.config import TaskCase
from pliant.studies.task.drawn_case import as_drawn
from pliant.studies.task.file_path import pace_of_file
from pliant.studies.task.geometry import laid_out
from pliant.studies.task.landing import APPROACH
from pliant.studies.task.measure import WORST, TaskSignals, check_accept, measured, signals_of
from pliant.studies.task.search import Searched
from pliant.studies.task.task_study import TaskStudy
from pliant.studies.task.world import true_surface
from pliant.tasks.parts import Pose
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class PathStudy(TaskStudy):
    """Runs of one task of a path on a surface."""

    worst = WORST

    def build(self, config: TaskCase) -> Experiment:
        self.check_accept(config)
        return build(as_drawn(config))

    def metrics(self, config: TaskCase, log: Log) -> tuple[Metric, ...]:
        return measured(self._signals(config, log), config.accept)

    def verdict(self, config: TaskCase, metrics: Sequence[Metric]) -> str | None:
        if not metrics:
            return "the run ended before the path began: no contact was found in time"
        return None

    def searched(self, config: TaskCase) -> Searched:
        config = as_drawn(config)
        made = planned(config)
        return Searched(made.robot, config.believed(made.surface))

    def suggested(self, config: TaskCase) -> Mapping[str, Suggestion]:
        speed = Suggestion(round(planned(as_drawn(config)).approach_speed, 4), "m/s", APPROACH)
        return {**super().suggested(config), APPROACH.keys: speed}

    def about(self, config: TaskCase) -> Mapping[str, str]:
        described = config.surface.geometry(Pose()).described
        told = {**super().about(config), **({"part": described} if described else {})}
        if config.path.file is not None:
            run = as_drawn(config)
            pace = pace_of_file(run, laid_out(run, run.robot)[2])
            told |= {"pace": pace} if pace else {}
        return told

    def check_accept(self, config: TaskCase) -> None:
        check_accept(config.accept)

    def check(self, config: TaskCase, drawn: int = CHECKED_DRAWS) -> ReachCheck:
        return checked_path(config, drawn)

    def figures(self, config: TaskCase, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(as_drawn(config), experiment, log, self._signals(config, log), folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return draw.comparison(results, folder)

    def _signals(self, config: TaskCase, log: Log) -> TaskSignals:
        config = as_drawn(config)
        made = planned(config)
        surface = true_surface(config, made.surface, made.path)
        return signals_of(log, config.tool.frame, surface.geometry, made.robot.torque_limit)
