"""Configuration that all runs of all studies share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from pliant.configuration import Config
from pliant.controllers.joint_limits import JointLimitsConfig
from pliant.errors import ConfigError, PliantError
from pliant.experiments.own_metrics import find_metric
from pliant.quantity import quantity
from pliant.robots.rotors import RotorInertia
from pliant.tasks.estimation import Estimation

MOST_STEPS = 10**8
"""of a run, of the control and of the physics"""

MOST_STEPS_PER_PERIOD = 1000
"""of the physics, between two commands; with more, a run would take too long"""


@dataclass(frozen=True)
class Dial:
    """A quantity of a task that a user may scale while it runs."""

    name: Literal["force", "speed"]
    unit: str
    value: float
    """value in the task; above zero"""
    high: float
    """largest value within the task's limits"""


class CaseConfig(Config):
    """Fields of every case of every study."""

    case: str = Field(description="name of the case")
    controller: str = Field(description="name of the controller")
    robot: str = Field(description="catalogue name, or path of a URDF or MJCF file")
    locked: dict[str, float] | None = quantity(
        None, "rad", "joint → angle at which it is fixed, replaced as a whole; none: what the catalogue locks; {}: none"
    )
    rotor_inertia: RotorInertia = None
    estimation: Estimation = Estimation()
    seed: int = Field(default=0, ge=0, description="seed of every random draw")
    duration: float = quantity(..., "s", "length of the run", gt=0.0)
    joint_limits: JointLimitsConfig | None = Field(
        default=None, description="springs at the joint limits, around any controller; none: without"
    )
    variant: str = Field(
        default="", description="label that distinguishes this run from others of the same case and controller"
    )
    own_metrics: tuple[str, ...] = Field(
        default=(), description="additional metrics: names, my_module:metric or my_file.py:metric"
    )
    log_scene: bool = Field(
        default=True, description="whether the log holds frames, shapes, paths and forces for 3-D views, at 30 Hz"
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
        """Whether `control` has a table for each controller, by name; otherwise it belongs to the one that runs."""
        return False

    @property
    def clock(self) -> Mapping[str, float]:
        """Name → s of the time steps of a run; with them a run with too many steps is refused."""
        return {}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        """Metric → begin and end of its time window, s; see `check_windows`."""
        return {}

    @property
    def dials(self) -> tuple[Dial, ...]:
        """Quantities of the task that may be scaled while it runs."""
        return ()

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


def check_windows(config: CaseConfig) -> None:
    """Raises ConfigError if a time window is not part of the run."""
    for name, (begin, end) in config.windows.items():
        if not (0.0 <= begin < min(end, config.duration)):
            raise ConfigError(
                f"{name!r} would be measured from {begin:g} s to {end:g} s, which is no part of the run: it takes"
                f" {config.duration:g} s; choose another duration or window"
            )
