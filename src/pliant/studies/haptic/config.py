"""Typed configuration of the haptic study.

Source of the task: [HapFIC] Tiseo et al. 2021, sec. III. What the paper leaves open (timing, places, gravity) is
chosen here. The paper's torque is the transposed Jacobian times the wrench (eq. 5), without a gravity term, and it does
not say whether the simulated leg is weightless or compensates itself: here the robot compensates gravity by itself,
see `hardware.compensation`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from pliant.controllers.attractor import Law
from pliant.controllers.config import FrameTaskConfig, StackConfig, TranslationConfig
from pliant.controllers.profiles import Shape
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import PliantError
from pliant.experiments.base import CaseConfig
from pliant.experiments.config import Config, merged
from pliant.references.exploration.config import ExplorationConfig
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.wiring.recipes import HapticConfig as HapticRecipe
from pliant.wiring.registry import find_controller
from pliant.wiring.wire import parameters_for

JUDGED = "haptic"
"""the controller that the targets are for"""
FAMILY = "haptic"
"""of the controllers whose parameters are `impedance` and `exploration`"""
TASK = "foot"
"""label of the impedance in channel names"""

_Number = Annotated[float, Field(ge=-1e6, le=1e6)]
Vector = tuple[_Number, _Number, _Number]
NotNegative = Annotated[float, Field(ge=0.0, le=1e8)]
Triple = tuple[NotNegative, NotNegative, NotNegative]


def quantity(default: Any, unit: str, description: str, **limits: Any) -> Any:
    """A field with a unit."""
    return Field(default, description=description, json_schema_extra={"unit": unit}, **limits)


_Edge = Annotated[float, Field(ge=1e-4, le=100.0)]  # m
_Scale = Annotated[float, Field(ge=1e-3, le=1e3)]


class Impedance(Config):
    """The fractal impedance at the foot; x, y, z. Defaults: [HapFIC] sec. III."""

    stiffness: Triple = quantity((6000.0, 6000.0, 12000.0), "N/m", "K_0: force per error near the target")
    force_max: Triple = quantity((150.0, 150.0, 300.0), "N", "F_max: bound of the commanded force, not of an impact")
    range: Triple = quantity(
        (0.025, 0.025, 0.025), "m", "x_b: error at which F_max is reached, and bound of the exploration"
    )
    law: Law = Field(default=Law.CAPPED, description="force on the way back to the target")
    profile: Shape = Field(default=Shape.TANH, description="how the force bends towards F_max")

    def tuning(self) -> ImpedanceTuning:
        """The numbers as a value that references carry."""
        return ImpedanceTuning(np.array(self.stiffness), np.array(self.force_max), np.array(self.range))

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        try:
            self.tuning()
        except PliantError as error:
            raise ValueError(str(error)) from None
        return self


class Material(Config):
    """What a thing feels like. Defaults: the rigid objects of [HapFIC] sec. III."""

    stiffness: float = quantity(1e6, "N/m", "K of every contact point", gt=0.0, le=1e9)
    damping: float = quantity(1e4, "N s/m", "D", ge=0.0, le=1e9)
    friction: float = quantity(0.5, "1", "Coulomb coefficient at rest", ge=0.0, le=10.0)
    friction_moving: float = quantity(0.3, "1", "Coulomb coefficient while sliding", ge=0.0, le=10.0)


SMOOTH = Material(friction=0.0, friction_moving=0.0)
SOFT = Material(stiffness=1e3, damping=1e2)


class Floor(Config):
    """A plane through a point on the world's z axis."""

    height: float = quantity(0.0, "m", "where it meets the world's z axis", ge=-10.0, le=10.0)
    tilt: Vector = quantity((0.0, 0.0, 0.0), "rad", "about the world's x and y axes; the third is not used")
    material: Material = SMOOTH


class BoxConfig(Config):
    """A rigid box."""

    size: tuple[_Edge, _Edge, _Edge] = quantity((0.12, 0.2, 0.2), "m", "edge lengths")
    position: Vector = quantity((0.21, 0.0, 0.1), "m", "of its centre")
    mass: float = quantity(2.0, "kg", "0: fixed to the world", ge=0.0, le=1e5)
    material: Material = Material()


class BallConfig(Config):
    """A soft ball."""

    radius: float = quantity(0.1, "m", "", ge=1e-4, le=100.0)
    position: Vector = quantity((0.12, 0.0, 0.1), "m", "of its centre")
    mass: float = quantity(0.5, "kg", "0: fixed to the world", ge=0.0, le=1e5)
    material: Material = SOFT


class Environment(Config):
    """What stands around the leg; contacts follow the explicit law with stiction."""

    floor: Floor | None = Floor()
    box: BoxConfig | None = None
    ball: BallConfig | None = None
    shank: bool = Field(default=False, description="whether the shank touches things, too")


class Hardware(Config):
    """How the leg's joints, drives and sensors behave."""

    compensation: Literal["none", "gravity", "gravity+coriolis"] = Field(
        default="gravity", description="what the leg compensates by itself; the paper does not say"
    )
    joint_damping: float = quantity(0.0, "N·m s/rad", "in the joints' mechanics", ge=0.0, le=1e4)
    bandwidth: float | None = quantity(
        None, "Hz", "first-order torque response of the drives; none: immediate", gt=0.0, le=1e5
    )
    peak_torque: float | None = quantity(None, "N·m", "largest motor torque; none: the robot's limit", gt=0.0, le=1e6)
    mass_scale: tuple[_Scale, ...] | None = quantity(
        None, "1", "factor on the mass and inertia of each joint's link; none: 1"
    )
    force_noise: float = quantity(0.0, "N", "standard deviation of the force sensor's white noise", ge=0.0, le=1e4)
    force_delay: float = quantity(0.0, "s", "age of the force signal", ge=0.0, le=1.0)
    command_delay: float = quantity(0.0, "s", "from a measurement to the effect of its command", ge=0.0, le=1.0)

    @property
    def perfect(self) -> bool:
        """Whether nothing stands between controller and plant."""
        return (
            self.bandwidth is None
            and self.peak_torque is None
            and not (self.force_noise or self.force_delay or self.command_delay)
        )


class Planner(Config):
    """How targets that jump become motion."""

    kind: Literal["superposition", "attractor"] = Field(
        default="superposition",
        description="superposition: never leaves the hull of the targets; attractor: [HapFIC] eq. 2-3, corrected, which"
        " haptic-paper always has",
    )
    speed: float = quantity(0.2, "m/s", "fastest motion of the target", ge=1e-4, le=100.0)
    acceleration: float = quantity(2.0, "m/s²", "largest acceleration of the target", ge=1e-4, le=1e4)


class Step(Config):
    """What the user changes at a time. What is not given stays as it was."""

    time: float = quantity(0.0, "s", "since the start", ge=0.0, le=1e6)
    name: str = Field(default="", description="of the phase that begins, for figures")
    target: Vector | None = quantity(None, "m", "of the foot")
    force: Vector | None = quantity(None, "N", "F_d: desired reaction of the environment on the foot")
    stiffness: Triple | None = quantity(None, "N/m", "K_0")
    force_max: Triple | None = quantity(None, "N", "F_max")
    range: Triple | None = quantity(None, "m", "x_b")
    reset: bool | None = Field(default=None, description="let the offset return when contact is lost")


class OnlineChanges(Config):
    """Random changes of F_d, K_0, F_max, x_b, reset and target, drawn from the seed; some do not fit together."""

    count: int = Field(default=50, ge=1, le=10_000, description="how many")
    rate: float = quantity(4.0, "Hz", "changes per second", ge=1e-3, le=1e3)
    begin: float = quantity(1.0, "s", "of the first one", gt=0.0, le=1e6)


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
    name: str
    begin: float = quantity(0.0, "s", "start of the window; the command's time for `settle`", ge=0.0)
    end: float | None = quantity(None, "s", "end of the window; none: of the run")
    axis: int = Field(default=2, ge=0, le=2, description="x, y, z")
    wanted: float | None = quantity(None, "N", "force that was asked for; none: as the log has it")
    before: float | None = quantity(None, "N", "force before a step; none: the true force at its command")
    relative: bool = Field(default=False, description="as a share of the force that was asked for")
    target: float | None = Field(default=None, description="bound of the metric")


class HapticConfig(CaseConfig):
    """One run of the leg."""

    controller: str = Field(
        default="haptic",
        description="haptic: pliant's; haptic-paper: as printed, but for the planner; haptic-hold: impedance alone; or"
        " any other, see `pliant list controllers`",
    )
    robot: str = Field(default="leg3", description="catalogue name, or path of a URDF or MJCF file")
    frame: str = Field(default="foot", description="frame that presses; it carries the force sensor")
    sensor: bool = Field(default=True, description="whether there is a force sensor at the frame")
    duration: float = Field(default=7.0, gt=0.0, description="length of the run", json_schema_extra={"unit": "s"})
    period: float = quantity(1e-3, "s", "control period", gt=0.0)
    physics_step: float = quantity(2e-5, "s", "", gt=0.0)
    environment: Environment = Environment()
    impedance: Impedance = Impedance()
    exploration: ExplorationConfig = ExplorationConfig()
    planner: Planner = Planner()
    hardware: Hardware = Hardware()
    control: dict[str, Any] = Field(
        default={}, description="changes to the controller's parameters beside `impedance` and `exploration`"
    )
    torque_step: float | None = quantity(
        None,
        "1",
        "largest change of a joint's torque per period, as a share of its limit; none: unbounded",
        gt=0.0,
        le=1e3,
    )
    start: tuple[float, ...] | None = quantity(None, "rad", "joint positions at the start; none: the robot's home")
    steps: tuple[Step, ...] = Field(
        min_length=1, description="what the user does, in order of time; the first one gives target and force"
    )
    online: OnlineChanges | None = Field(default=None, description="random changes, after the steps")
    random: bool = Field(default=False, description="draw surface, masses and force from the seed")
    checks: tuple[Check, ...] = Field(default=(), description="what the run is judged by")
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
            tunings={self.frame: self.impedance.tuning()},
        )

    def controller_parameters(self, robot: Robot) -> ControllerConfig:
        """Those of the chosen controller: the study's for its family, otherwise what suits the task; then `control`."""
        entry = self.entry
        bases = {FAMILY: self._recipe()}
        base = bases.get(entry.family)
        if base is None:
            return parameters_for(entry, robot, self.believed, self.control)
        return merged(entry.over(base), self.control)

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
