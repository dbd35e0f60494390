"""Typed configuration of the haptic study.

Source of the task: [HapFIC] Tiseo et al. 2021, sec. III. What the paper leaves open (timing, places, gravity) is
chosen here. The paper's torque is the transposed Jacobian times the wrench (eq. 5), without a gravity term, and it does
not say whether the simulated leg is weightless or compensates itself: here the robot compensates gravity by itself,
see `hardware.compensation`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from pliant.configuration import Config
from pliant.controllers.config import FrameTaskConfig, StackConfig, TranslationConfig
from pliant.controllers.step_limit import DEFAULT_SHARE, TorqueStep
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import PliantError
from pliant.experiments.base import CaseConfig
from pliant.quantity import quantity
from pliant.references.exploration.config import ExplorationConfig
from pliant.robot import Robot
from pliant.studies.haptic.scene_config import HapticScene, Hardware
from pliant.studies.haptic.steps_config import FootImpedance, OnlineChanges, Step
from pliant.tasks.phase import PlannerConfig
from pliant.wiring.recipes import HapticConfig as HapticRecipe
from pliant.wiring.registry import find_controller
from pliant.wiring.wire import parameters_for

JUDGED = "haptic"
"""the controller that the targets are for"""
FAMILY = "haptic"
"""of the controllers whose parameters are `impedance` and `exploration`"""
TASK = "foot"
"""label of the impedance in channel names"""


class Check(Config):
    """One metric: of which signal, when, and what it should keep to. All on true signals."""

    kind: Literal[
        "rms",
        "max",
        "settle",
        "breaks",
        "peak",
        "lateral",
        "return",
        "offset",
        "off-bound",
        "beyond-bound",
        "unreachable",
        "tilt",
        "speed",
        "over",
        "link",
        "knee",
        "reachable",
        "share",
    ] = Field(description="what is measured; see `pliant.studies.haptic.measure`")
    name: str = Field(description="of the metric")
    begin: float = quantity(0.0, "s", "start of the window; the command's time for `settle`", ge=0.0)
    end: float | None = quantity(None, "s", "end of the window; none: of the run", ge=0.0, le=1e9)
    axis: int = Field(default=2, ge=0, le=2, description="x, y, z")
    wanted: float | None = quantity(None, "N", "desired force; none: from the log", ge=-1e6, le=1e6)
    before: float | None = quantity(
        None, "N", "force before a step; none: the true force at its command", ge=-1e6, le=1e6
    )
    relative: bool = Field(default=False, description="as a share of the desired force")
    target: float | None = quantity(None, "that of the metric", "bound of the metric", ge=-1e9, le=1e9)


class HapticCaseConfig(CaseConfig):
    """One run of the leg."""

    controller: str = Field(
        default="haptic",
        description="haptic: pliant's; haptic-paper: as printed, except the planner; haptic-hold: impedance alone; or"
        " another, see `pliant list controllers`",
    )
    robot: str = Field(default="leg3", description="catalogue name, or path of a URDF or MJCF file")
    frame: str = Field(default="foot", description="frame that presses; it carries the force sensor")
    sensor: bool = Field(default=True, description="whether there is a force sensor at the frame")
    duration: float = quantity(7.0, "s", "length of the run", gt=0.0)
    period: float = quantity(1e-3, "s", "control period", gt=0.0)
    physics_step: float = quantity(2e-5, "s", "of the simulation", gt=0.0)
    environment: HapticScene = HapticScene()
    impedance: FootImpedance = FootImpedance()
    exploration: ExplorationConfig = ExplorationConfig()
    planner: PlannerConfig = PlannerConfig()
    hardware: Hardware = Hardware()
    control: dict[str, Any] = Field(
        default={}, description="changes to the controller's parameters beside `impedance` and `exploration`"
    )
    torque_step: TorqueStep = DEFAULT_SHARE
    start: tuple[float, ...] | None = quantity(None, "rad", "joint positions at the start; none: the robot's home")
    steps: tuple[Step, ...] = Field(
        min_length=1, description="steps of the user, in order of time; the first one gives target and force"
    )
    online: OnlineChanges | None = Field(default=None, description="random changes, after the steps")
    random: bool = Field(default=False, description="draw surface, masses and force from the seed")
    checks: tuple[Check, ...] = Field(default=(), description="metrics of the run")
    snapshots: tuple[float, ...] = quantity((), "s", "moments that are drawn")

    @field_validator("controller")
    @classmethod
    def _is_known(cls, name: str) -> str:
        try:
            find_controller(name)
        except PliantError as error:
            raise ValueError(str(error)) from None
        return name

    @property
    def clock(self) -> Mapping[str, float]:
        return {"period": self.period, "physics_step": self.physics_step}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        return {check.name: (check.begin, math.inf if check.end is None else check.end) for check in self.checks}

    @property
    def entry(self) -> ControllerEntry[Any]:
        """The chosen controller."""
        return find_controller(self.controller)

    @property
    def pressing(self) -> bool:
        """Whether a force is asked for at some time."""
        return any(step.force is not None and any(step.force) for step in self.steps)

    @property
    def believed(self) -> Believed:
        """What the controller may know."""
        return Believed(
            frames=(self.frame,),
            period=self.period,
            oriented=False,
            presses=self.frame if self.pressing else None,
            compensation=self.hardware.compensation,
            sensing_delay=self.hardware.force_delay,
            computation_delay=self.hardware.command_delay,
            noise_force=self.estimation.noise_force,
            tunings={self.frame: self.impedance.tuning()},
        )

    def controller_parameters(self, robot: Robot) -> ControllerConfig:
        """Those of the chosen controller: the study's for its family, otherwise what suits the task; then `control`."""
        entry = self.entry
        bases = {FAMILY: self._recipe()}
        base = bases.get(entry.family)
        if base is None:
            return parameters_for(entry, robot, self.believed, self.control)
        return entry.changed(entry.over(base), self.control)

    def _recipe(self) -> ControllerConfig:
        own = self.impedance
        foot = FrameTaskConfig(
            frame=self.frame,
            translation=TranslationConfig(stiffness=own.stiffness, force_max=own.force_max, range=own.range),
            profile=own.profile,
        )
        return HapticRecipe(impedance=StackConfig(tasks={TASK: foot}, law=own.law), exploration=self.exploration)

    @model_validator(mode="after")
    def _is_in_order(self) -> Self:
        first = self.steps[0]
        if first.time != 0.0 or first.target is None:
            raise ValueError("the first step must be at time 0 and have a target")
        if any(b.time <= a.time for a, b in zip(self.steps[:-1], self.steps[1:], strict=True)):
            raise ValueError("the times of the steps must increase")
        return self
