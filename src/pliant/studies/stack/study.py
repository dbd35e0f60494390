"""The study of the stack of passive task-space controllers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Result, Study
from pliant.experiments.config import merged
from pliant.experiments.tuning import Tuning
from pliant.studies.stack import draw
from pliant.studies.stack.build import build
from pliant.studies.stack.config import CASES, StackConfig
from pliant.studies.stack.measure import JUDGED, measure
from pliant.studies.stack.tuning import tuning_of
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

_ARMS = ("stack-paper", "spring", "operational-space")
_PUSHED_SEEDS = 10


class StackStudy(Study[StackConfig]):
    """[Stack] Tiseo et al. 2020: figure-8 and line with a 7-joint arm, free, against a wall, pushed at the elbow."""

    name = "stack"
    title = "stack of passive task-space controllers on a 7-joint arm (Tiseo et al. 2020)"
    cases = CASES

    def build(self, config: StackConfig) -> Experiment:
        return build(config)

    def runs(self, case: str, seeds: int | None = None) -> Sequence[StackConfig]:
        config = self.case(case)
        count = (seeds or _PUSHED_SEEDS) if config.pushes is not None or config.retuning is not None else 1
        runs = [config.model_copy(update={"seed": seed}) for seed in range(count)]
        if case == "balance":
            return [_with_elbow(config, force) for force in draw.BALANCE_FORCES]
        if config.retuning is not None:
            return runs
        table_1 = "table-1-simulation" if config.preset == "stiff" else "table-1-robot"
        printed = {"preset": table_1, "control": {}, "variant": "table-1"}
        runs.append(merged(config, printed))
        runs += [merged(config, {"controller": arm, "control": {}}) for arm in _ARMS]
        runs.append(merged(config, {**printed, "controller": "stack-paper"}))
        return runs

    def shows(self, config: StackConfig) -> bool:
        return super().shows(config) and config.controller == JUDGED

    def metrics(self, config: StackConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, config.robot_model(), log)

    def figures(self, config: StackConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)

    def tuning(self, controller: str, case: str | None = None) -> Tuning:
        return tuning_of(self.case(case or "figure8-gazebo"), controller)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return draw.summary_figures(results, folder)


def _with_elbow(config: StackConfig, force: float) -> StackConfig:
    """The same run with another strength of the elbow's task; 0 N switches it off."""
    elbow = (
        {"force_max": force, "stiffness": 0.0}
        if force == 0.0
        else {"force_max": force, "linear_range": min(0.01, 0.5 * force / 5000.0)}
    )
    control = {"tasks": {**config.control.get("tasks", {}), "elbow": {"translation": elbow}}}
    return merged(config, {"control": control, "variant": f"elbow-{force:g}N"})


STUDY = StackStudy()
