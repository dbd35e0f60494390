"""Typed configuration of the stack study.

Source of the task: [Stack] Tiseo et al. 2020, sec. III and Table I. Numbers, and what the paper leaves open (period,
ramp, wall, pushes), stand in the task files of the catalogue; defaults are read from there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from pliant.configuration import Config
from pliant.controllers.presets import SOFT_STACK, STIFF_STACK, TABLE_I_ROBOT, TABLE_I_SIMULATION
from pliant.controllers.step_limit import DEFAULT_SHARE, TorqueStep
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig
from pliant.quantity import in_order, quantity
from pliant.robot import Robot
from pliant.studies.stack.paper_task import FIGURE8, LINE, PLAIN, PUSHED, RETUNED, WALL, wall_of
from pliant.wiring.registry import find_controller
from pliant.wiring.wire import parameters_for

PathKind = Literal["figure8", "line", "stretch", "hold"]


_WALL = wall_of(WALL)
_Force = Annotated[float, Field(ge=0.0, le=1e4)]  # N
_Time = Annotated[float, Field(ge=1e-3, le=1e4)]  # s
_Factor = Annotated[float, Field(ge=1e-3, le=1e3)]
Span = Annotated[tuple[_Time, _Time], AfterValidator(in_order)]
"""s, least and most"""


class StackPath(Config):
    """Motion of the tool. It starts from rest within `ramp`."""

    kind: PathKind = Field(
        default="figure8",
        description="figure8: x 0.1 m, z 0.2 m; line: along x; stretch: along −y until the elbow is straight; hold",
    )
    period: float = quantity(FIGURE8.period, "s", "of the figure-8", ge=0.01, le=1e4)
    amplitude: float = quantity(LINE.size[0], "m", "of the line", gt=0.0, le=10.0)
    peak_speed: float = quantity(LINE.peak_speed, "m/s", "of the line", gt=0.0, le=100.0)
    ramp: float = quantity(FIGURE8.ramp, "s", "time in which the motion starts from rest", ge=0.0, le=1e4)
    method: Literal["mink", "aico"] = Field(
        default="mink",
        description="inverse kinematics for the posture: quadratic programs, or one-step approximate inference",
    )


class Joints(Config):
    """How the simulated joints behave."""

    friction: float = quantity(0.0, "N·m", "dry friction of each joint", ge=0.0, le=1e4)
    damping: float = quantity(0.0, "N·m s/rad", "of each joint", ge=0.0, le=1e4)
    compensation: Literal["none", "gravity", "gravity+coriolis"] = Field(
        default="none", description="what the robot compensates by itself"
    )
    velocity_filter: float = quantity(
        1.0, "1", "share of a new sample in the low-passed joint velocity; 1: no filter", gt=0.0, le=1.0
    )


class Wall(Config):
    """A wall in the tool's path that is unknown to the controller."""

    x: float = quantity(_WALL["x"], "m", "where it stops the tool", ge=-10.0, le=10.0)
    stiffness: float = quantity(_WALL["stiffness"], "N/m", "of the contact", gt=0.0, le=1e8)
    damping: float = quantity(_WALL["damping"], "N s/m", "of the contact", ge=0.0, le=1e8)
    friction: float = quantity(_WALL["friction"], "1", "Coulomb coefficient", ge=0.0, le=10.0)


class RandomPushes(Config):
    """Random pushes on a frame, one after the other."""

    frame: str = Field(default=PUSHED["frame"], description="that is pushed")
    force: Annotated[tuple[_Force, _Force], AfterValidator(in_order)] = quantity(PUSHED["force"], "N", "least and most")
    duration: Span = quantity(PUSHED["duration"], "s", "of a push, least and most")
    gap: Span = quantity(PUSHED["gap"], "s", "between two pushes, least and most")
    end: float | None = quantity(None, "s", "from which on no push begins; none: the end of the run", gt=0.0)


class GainChanges(Config):
    """Random changes of every gain and force bound while the robot moves."""

    rate: float = quantity(RETUNED["rate"], "Hz", "changes per second", gt=0.0, le=1e3)
    factor: Annotated[tuple[_Factor, _Factor], AfterValidator(in_order)] = quantity(
        RETUNED["factor"], "1", "range of the factor on K_0 and F_max"
    )
    ranges: bool = Field(default=False, description="x_0 and x_b change as well, by factors of the same range")


FRAMES = ("flange", "elbow")
"""the tool's and the elbow's frame, where the controller has none of its own"""

PRESETS: Mapping[str, Mapping[str, ControllerConfig]] = {
    "stack": {
        "stiff": STIFF_STACK,
        "soft": SOFT_STACK,
        "table-1-simulation": TABLE_I_SIMULATION,
        "table-1-robot": TABLE_I_ROBOT,
    }
}
"""family of controllers → name → parameters of the two tasks; "stiff" and "soft" are pliant's own for the simulated and
the hardware-like robot. Other families start from what suits the task"""


class StackCaseConfig(CaseConfig):
    """One run of the stack of passive task-space controllers."""

    controller: str = Field(default="stack", description="name of the controller; see `pliant list controllers`")
    robot: str = Field(default=PLAIN.robot, description="catalogue name, or path of a URDF or MJCF file")
    duration: float = quantity(PLAIN.phase[0].longest, "s", "length of the run", gt=0.0)
    period: float = quantity(
        PLAIN.simulation.period, "s", "control period, a whole multiple of the physics step", gt=0.0
    )
    physics_step: float = quantity(PLAIN.simulation.physics_step, "s", "of the simulation", gt=0.0)
    path: StackPath = StackPath()
    joints: Joints = Joints()
    preset: Literal["stiff", "soft", "table-1-simulation", "table-1-robot"] = Field(
        default="stiff", description="parameters of the stack that `control` starts from"
    )
    control: dict[str, Any] = Field(
        default={},
        description="changes to the controller's parameters, e.g. control.tasks.ee.translation.stiffness=8000",
    )
    torque_step: TorqueStep = DEFAULT_SHARE
    model_mass_error: float = quantity(
        0.0,
        "1",
        "share by which each link's mass is off in the model of a controller that has one, drawn uniformly within ±",
        ge=0.0,
        lt=1.0,
    )
    wall: Wall | None = Field(default=None, description="in the tool's path; none: without")
    pushes: RandomPushes | None = Field(default=None, description="on a frame; none: without")
    retuning: GainChanges | None = Field(default=None, description="while the robot moves; none: without")

    @property
    def clock(self) -> Mapping[str, float]:
        return {"period": self.period, "physics_step": self.physics_step}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        return {"motion of the tool": (self.settled, self.duration)}

    @property
    def settled(self) -> float:
        """s from which metrics count: one second after the ramp."""
        return self.path.ramp + 1.0

    @property
    def entry(self) -> ControllerEntry[Any]:
        """The chosen controller."""
        return find_controller(self.controller)

    def robot_model(self) -> Robot:
        """The arm."""
        return Robot.load(self.robot, locked=self.locked, rotor_inertia=self.rotor_inertia)

    @property
    def believed(self) -> Believed:
        """What the controller may know."""
        return Believed(frames=FRAMES, period=self.period, compensation=self.joints.compensation)

    def parameters(self) -> ControllerConfig:
        """The controller's parameters: preset, then `control`. Raises ConfigError for an unknown key or a bad value."""
        entry = self.entry
        preset = PRESETS.get(entry.family, {}).get(self.preset)
        if preset is None:
            return parameters_for(entry, self.robot_model(), self.believed, self.control)
        return entry.changed(entry.over(preset), self.control)

    def frames(self) -> tuple[str, str]:
        """Tool and elbow frame: those of the first two tasks."""
        preset = PRESETS.get(self.entry.family, {}).get(self.preset)
        chosen = FRAMES if preset is None else self.parameters().driven_frames()
        if len(chosen) != 2:
            raise ConfigError(f"this study drives two frames, a tool and an elbow; control.tasks names {len(chosen)}")
        return chosen[0], chosen[1]

    @model_validator(mode="after")
    def _has_good_parameters(self) -> Self:
        self.parameters()
        self.frames()
        return self
