"""A study that takes milliseconds and misbehaves on request. Importing it registers it as `toy`, in workers too."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from pliant.configuration import Config
from pliant.errors import RunFailedError
from pliant.experiments import registry
from pliant.experiments.base import CaseConfig, Experiment, Result, Study
from pliant.experiments.case import Case, seeded
from pliant.experiments.parameter_search import ParameterSearch, Range
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Measurement, Reference
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

_NONE = np.zeros(3)


class Gains(Config):
    a: float = 1.0
    b: float = 5.0


class ToyConfig(CaseConfig):
    behaviour: Literal["fine", "slow", "physics", "bug", "dies", "dies once"] = "fine"
    mark: str = ""
    gains: Gains = Gains()


class Still(Plant[None]):
    period = 0.1

    def __init__(self, config: ToyConfig) -> None:
        self.config = config

    def init(self) -> tuple[Measurement, None]:
        mark = Path(self.config.mark) / f"died{self.config.seed}"
        if self.config.behaviour == "slow":
            time.sleep(0.25)
        if self.config.behaviour == "bug":
            raise ZeroDivisionError("a bug in a run")
        if self.config.behaviour == "dies" or (self.config.behaviour == "dies once" and not mark.exists()):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return Measurement(0.0, _NONE, _NONE, _NONE, _NONE), None

    def step(self, command: Command, world: None) -> tuple[Measurement, None]:
        if self.config.behaviour == "physics":
            raise RunFailedError("it fell over")
        return Measurement(command.time + self.period, _NONE, _NONE, _NONE, _NONE), None


class Believe(Estimator[None]):
    def init(self, measurement: Measurement) -> None:
        return None

    def step(self, measurement: Measurement, state: None) -> tuple[Estimate, None]:
        return Estimate(measurement.time, _NONE, _NONE, _NONE, _NONE), None


class Rest(ReferenceSource[None]):
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        return Reference(estimate.time, posture=_NONE), None


class Idle(Controller[None]):
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, reference: Reference, state: None) -> tuple[Command, None]:
        return Command(estimate.time, _NONE, _NONE), None


class ToyStudy(Study[ToyConfig]):
    name = "toy"
    title = "A toy"
    controllers = ("idle", "other")
    cases = {  # noqa: RUF012
        name.replace(" ", "-"): Case(
            ToyConfig(case=name.replace(" ", "-"), controller="idle", robot="leg3", duration=0.3, behaviour=name),
            draws=seeded(2),
        )
        for name in ("fine", "slow", "physics", "bug", "dies", "dies once")
    }

    def shows(self, config: ToyConfig) -> bool:
        return False

    def build(self, config: ToyConfig) -> Experiment:
        return Experiment(Robot.load(config.robot), Still(config), Believe(), Rest(), Idle(), warnings=("a toy",))

    def metrics(self, config: ToyConfig, log: Log) -> tuple[Metric, ...]:
        a, b = np.log10(config.gains.a), config.gains.b
        error = (a + 1.0) ** 2 + (b - 2.0) ** 2 + 0.1
        return (
            Metric("E_λ", float(error), "N", paper=0.1 + 0.2, target=0.1 * 3),
            Metric("never", float("inf") if config.seed % 2 else float("nan"), "s", at_least=True),
            Metric("seed", float(config.seed) / 3.0, ""),
        )

    def figures(self, config: ToyConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return []

    def search(self, controller: str, case: str | None = None) -> ParameterSearch:
        if controller == "other":
            return super().search(controller)
        return ParameterSearch(
            {"gains.a": Range(1e-3, 1e2, log=True), "gains.b": Range(-10.0, 10.0)},
            [self.case(case or "fine")],
            lambda results: _mean(results),
            {"gains.a": 1.0, "gains.b": 5.0},
        )


def _mean(results: Sequence[Result]) -> float:
    return float(np.mean([result.metrics[0].value for result in results]))


STUDY = ToyStudy()
# the file may be loaded under another name too (pytest's importlib mode): registry and pickles know this one
sys.modules.setdefault("tests.studies.toy", sys.modules[__name__])
registry._MODULES["toy"] = "tests.studies.toy"
