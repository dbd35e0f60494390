"""What a study is: typed cases, a way to build each, metrics from its log, and figures."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Generic, Self, TypeVar

from pydantic import Field, field_validator, model_validator

from pliant.controllers.joint_limits import JointLimitsConfig
from pliant.errors import ConfigError, PliantError, options
from pliant.experiments.config import Config
from pliant.experiments.own_metrics import find_metric
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric
from pliant.wiring.experiment import Experiment as Experiment
from pliant.wiring.registry import controllers

if TYPE_CHECKING:
    from pliant.experiments.tuning import Tuning


MOST_STEPS = 10**8
"""of a run, of the control and of the physics"""

MOST_STEPS_PER_PERIOD = 1000
"""of the physics: between two commands; a run with more of them does not end while anyone waits"""


class CaseConfig(Config):
    """What every case of every study has."""

    case: str = Field(description="name of the case")
    controller: str = Field(description="name of the controller")
    robot: str = Field(description="catalogue name, or path of a URDF or MJCF file")
    locked: dict[str, float] | None = Field(
        default=None,
        description="joint → angle at which it is fixed, replaced as a whole; none: what the catalogue locks; {}: none",
        json_schema_extra={"unit": "rad"},
    )
    seed: int = Field(default=0, ge=0, description="of every random draw")
    duration: float = Field(gt=0.0, description="length of the run", json_schema_extra={"unit": "s"})
    joint_limits: JointLimitsConfig | None = Field(
        default=None, description="springs that keep the joints off their limits, round any controller; none: without"
    )
    variant: str = Field(
        default="", description="what distinguishes this run from others of the same case and controller"
    )
    own_metrics: tuple[str, ...] = Field(
        default=(), description="metrics beside the study's: names, my_module:metric or my_file.py:metric"
    )

    @field_validator("own_metrics")
    @classmethod
    def _are_metrics(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        try:
            for name in names:
                find_metric(name)
        except PliantError as error:
            raise ValueError(str(error)) from None
        return names

    @property
    def control_by_name(self) -> bool:
        """Whether `control` holds a table for each controller, by its name; otherwise it is of the one that runs."""
        return False

    @property
    def clock(self) -> Mapping[str, float]:
        """Name → s of the steps that a run is made of; a run that would not end for years is refused by them."""
        return {}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        """What is measured → s, begin and end of the time in which it is; see `check_windows`."""
        return {}

    @model_validator(mode="after")
    def _comes_to_an_end(self) -> Self:
        for name, step in self.clock.items():
            if not 1.0 <= self.duration / step * (1.0 + 1e-9) <= MOST_STEPS:
                raise ValueError(
                    f"a run takes 1 to {MOST_STEPS:.0e} steps; duration / {name} = {self.duration:g} s / {step:g} s"
                )
        if self.clock and max(self.clock.values()) > MOST_STEPS_PER_PERIOD * min(self.clock.values()) * (1.0 + 1e-9):
            steps = ", ".join(f"{name} {step:g} s" for name, step in self.clock.items())
            raise ValueError(
                f"steps of a run are within a factor of {MOST_STEPS_PER_PERIOD} of each other, got {steps}"
            )
        return self


C = TypeVar("C", bound=CaseConfig)


def check_windows(config: CaseConfig) -> None:
    """Raises ConfigError if something would be measured at a time that is not part of the run."""
    for name, (begin, end) in config.windows.items():
        if not (0.0 <= begin < min(end, config.duration)):
            raise ConfigError(
                f"{name!r} would be measured from {begin:g} s to {end:g} s, which is no part of the run: it takes"
                f" {config.duration:g} s; choose another duration or window"
            )


@dataclass(frozen=True)
class Result:
    """What came out of one run."""

    config: CaseConfig
    metrics: tuple[Metric, ...]
    failure: str | None = None
    """why it stopped early; None if it ran to its end"""
    warnings: tuple[str, ...] = ()
    log: Path | None = None
    figures: tuple[Path, ...] = field(default=())


class Study(ABC, Generic[C]):
    """A family of cases that are built, measured and drawn the same way."""

    name: str
    title: str
    """one line, for people"""
    cases: Mapping[str, C]
    """name → its configuration; the first is the default"""
    worst: Collection[str] = ()
    """names of metrics that the worst run of a row decides; of the others it shows the mean"""

    @property
    def controllers(self) -> Sequence[str]:
        """Names that `controller` can take; beside them, `module:Class` and `file.py:Class`."""
        return tuple(controllers())

    def case(self, name: str) -> C:
        """Configuration of a case. Raises ConfigError, with the cases there are, if it does not exist."""
        if name not in self.cases:
            raise ConfigError(f"study {self.name!r} has no case {name!r}; {options(self.cases, name)}")
        return self.cases[name]

    def runs(self, case: str, seeds: int | None = None) -> Sequence[C]:
        """Every run of a case in the full study: baselines, variants and seeds.

        Args:
            case: name of the case.
            seeds: how many, where draws are random; None: as many as the study deems enough.
        """
        return [self.case(case)]

    def shows(self, config: C) -> bool:
        """Whether a run of the full study keeps its log and is drawn; the others leave their metrics only."""
        return config.seed == 0 and not config.variant

    @abstractmethod
    def build(self, config: C) -> Experiment:
        """Wires the loop of a case."""

    @abstractmethod
    def metrics(self, config: C, log: Log) -> tuple[Metric, ...]:
        """Measures a run; the paper's number and the target stand beside where there is one."""

    def verdict(self, config: C, metrics: Sequence[Metric]) -> str | None:
        """Why a run that reached its end counts as failed all the same; None if it does not."""
        return None

    @abstractmethod
    def figures(self, config: C, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        """Draws one run."""

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        """Draws what only several runs together show."""
        return []

    def report(self, results: Sequence[Result]) -> str:
        """Tables as the paper prints them, in Markdown, for the study's report; empty where there are none."""
        return ""

    def tuning(self, controller: str, case: str | None = None) -> Tuning:
        """How the parameters of a controller are searched, on the robot and with the delays of a case (None: of the
        study's choice). Raises ConfigError if the study does not say."""
        raise ConfigError(f"study {self.name!r} cannot be tuned; a study can if it overrides `Study.tuning`")
