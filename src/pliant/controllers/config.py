"""Typed configurations of the controllers: what each number means, its unit, its range and a sensible default."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pliant.controllers.attractor import Law, PhaseSettings
from pliant.controllers.profiles import Shape
from pliant.controllers.task import FrameTask
from pliant.entries import ControllerConfig
from pliant.errors import PliantError
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

NotNegative = Annotated[float, Field(ge=0.0)]
PerAxis = NotNegative | tuple[NotNegative, NotNegative, NotNegative]
"""one number for x, y and z, or one for each"""


class TranslationConfig(ControllerConfig):
    """Impedance of the three positions."""

    stiffness: PerAxis = Field(
        default=2500.0,
        description="K_0: force per error near the target; x, y, z or one for all",
        json_schema_extra={"unit": "N/m", "minimum": 0.0, "maximum": 30000.0},
    )
    force_max: PerAxis = Field(
        default=100.0,
        description="F_max: bound of the commanded force, however large the error; an impact can be harder",
        json_schema_extra={"unit": "N", "minimum": 0.0, "maximum": 300.0},
    )
    range: PerAxis = Field(
        default=0.06,
        description="x_b: error at which F_max is reached",
        json_schema_extra={"unit": "m", "minimum": 0.001, "maximum": 0.5},
    )
    linear_range: PerAxis | None = Field(
        default=None,
        description="x_0: end of the linear part; none: 0.95 x_b, or where 0.95 F_max is reached",
        json_schema_extra={"unit": "m", "minimum": 0.0, "maximum": 0.5},
    )


class RotationConfig(ControllerConfig):
    """Impedance of the three rotations, about the world's axes."""

    stiffness: PerAxis = Field(
        default=60.0,
        description="K_0: moment per angle near the target; x, y, z or one for all",
        json_schema_extra={"unit": "N·m/rad", "minimum": 0.0, "maximum": 500.0},
    )
    force_max: PerAxis = Field(
        default=12.0,
        description="F_max: bound of the moment about each axis, at any angle",
        json_schema_extra={"unit": "N·m", "minimum": 0.0, "maximum": 150.0},
    )
    range: PerAxis = Field(
        default=0.30,
        description="x_b: angle at which F_max is reached",
        json_schema_extra={"unit": "rad", "minimum": 0.01, "maximum": 3.0},
    )
    linear_range: PerAxis | None = Field(
        default=None,
        description="x_0: end of the linear part; none: 0.95 x_b, or where 0.95 F_max is reached",
        json_schema_extra={"unit": "rad", "minimum": 0.0, "maximum": 3.0},
    )


class FrameTaskConfig(ControllerConfig):
    """One frame that a fractal impedance holds."""

    frame: str = Field(description="frame of the robot")
    translation: TranslationConfig = Field(default=TranslationConfig(), description="impedance of the position")
    rotation: RotationConfig | None = Field(
        default=None, description="impedance of the orientation; none leaves it free"
    )
    profile: Shape = Field(default=Shape.EXPONENTIAL, description="how the force bends towards F_max")

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        try:
            self.tuning()
        except PliantError as error:
            raise ValueError(f"frame {self.frame!r}: {error}") from None
        return self

    def tuning(self) -> ImpedanceTuning:
        """The numbers as a tuning of 3 or 6 axes, which a reference can carry."""
        groups = [self.translation] if self.rotation is None else [self.translation, self.rotation]
        bends = [_three(group.linear_range, group) for group in groups]
        given = any(group.linear_range is not None for group in groups)
        return ImpedanceTuning(
            stiffness=np.concatenate([_spread(group.stiffness) for group in groups]),
            force_max=np.concatenate([_spread(group.force_max) for group in groups]),
            range=np.concatenate([_spread(group.range) for group in groups]),
            linear_range=np.concatenate(bends) if given else None,
        )

    def task(self, label: str) -> FrameTask:
        """The task under a label."""
        return FrameTask(self.frame, self.tuning(), label, self.profile)


class PhaseConfig(ControllerConfig):
    """How an axis decides between divergence and convergence. The defaults serve noise-free and noisy robots alike."""

    rate_cutoff: float = Field(
        default=80.0, gt=0.0, description="low-pass on the rate of the error", json_schema_extra={"unit": "Hz"}
    )
    rate_floor: float = Field(
        default=0.5e-3, gt=0.0, description="rates below it tell no direction", json_schema_extra={"unit": "m/s"}
    )
    rate_floor_angular: float = Field(
        default=0.5e-3, gt=0.0, description="rates below it tell no direction", json_schema_extra={"unit": "rad/s"}
    )
    noise_time: float = Field(
        default=0.2, gt=0.0, description="time over which the noise is learned", json_schema_extra={"unit": "s"}
    )
    hold_limit: float = Field(
        default=0.030,
        ge=0.0,
        description="how long a phase is held while the rate tells nothing; then the axis diverges",
        json_schema_extra={"unit": "s"},
    )
    blend_time: float = Field(
        default=0.008,
        ge=0.0,
        description="time over which the force steps up where a convergence ends; 0: at once",
        json_schema_extra={"unit": "s"},
    )

    def settings(self) -> PhaseSettings:
        """The same numbers as the controllers take them."""
        return PhaseSettings(**self.model_dump())


class StackConfig(ControllerConfig):
    """A stack of fractal impedances."""

    tasks: dict[str, FrameTaskConfig | None] = Field(
        description="label → task; the label names the channels. None drops a task of the default"
    )
    law: Law = Field(default=Law.CAPPED, description="force on the way back to the target")
    phases: PhaseConfig = Field(default=PhaseConfig(), description="thresholds of the phase logic")
    joint_damping: float = Field(
        default=0.0,
        ge=0.0,
        description="of every joint, added by the controller; what a plain spring needs to come to rest",
        json_schema_extra={"unit": "N·m s/rad", "minimum": 0.0, "maximum": 20.0},
    )
    force_damping: float = Field(
        default=0.0,
        ge=0.0,
        description="of a frame's motion along the force that is asked of it; damps the contact and not the path",
        json_schema_extra={"unit": "N·s/m", "minimum": 0.0, "maximum": 1000.0},
    )
    gravity_compensation: bool = Field(
        default=False, description="add the model's gravity torque; off where the robot compensates itself"
    )

    @model_validator(mode="after")
    def _has_a_task(self) -> Self:
        if not self.frame_tasks():
            raise ValueError("a stack needs at least one task")
        return self

    def frame_tasks(self) -> tuple[FrameTask, ...]:
        """The tasks that are not dropped."""
        return tuple(task.task(label) for label, task in self.tasks.items() if task is not None)

    def driven_frames(self) -> tuple[str, ...]:
        return tuple(task.frame for task in self.tasks.values() if task is not None)

    def impedances(self) -> Mapping[str, ImpedanceTuning]:
        return {task.frame: task.tuning for task in self.frame_tasks()}


class OperationalSpaceConfig(ControllerConfig):
    """Khatib's operational-space controller with a dynamically consistent posture."""

    frame: str = Field(default="flange", description="frame of the robot that follows the first task")
    stiffness: float = Field(
        default=400.0,
        ge=0.0,
        description="acceleration per position error",
        json_schema_extra={"unit": "1/s²", "minimum": 0.0, "maximum": 4000.0},
    )
    damping_ratio: float = Field(
        default=1.0,
        ge=0.0,
        description="1 is critical",
        json_schema_extra={"unit": "1", "minimum": 0.0, "maximum": 2.0},
    )
    posture_stiffness: float = Field(
        default=50.0,
        ge=0.0,
        description="joint acceleration per joint error, in what the task leaves free",
        json_schema_extra={"unit": "1/s²", "minimum": 0.0, "maximum": 400.0},
    )
    singularity_damping: float = Field(
        default=0.02,
        gt=0.0,
        description="δ in Λ = (J M⁻¹ Jᵀ + δ² I)⁻¹: bounds the forces near singularities, costs accuracy",
        json_schema_extra={"unit": "kg^-1/2", "minimum": 0.001, "maximum": 1.0},
    )
    compensation: Literal["none", "coriolis", "gravity+coriolis"] = Field(
        default="gravity+coriolis",
        description="what the model adds; without gravity where the robot compensates itself",
    )


def _spread(value: PerAxis) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=np.float64), 3).copy()


def _three(bend: PerAxis | None, group: TranslationConfig | RotationConfig) -> Array:
    """x_0 of a group, derived where it is left open (the other group may have given its own)."""
    if bend is not None:
        return _spread(bend)
    stiffness, force_max = _spread(group.stiffness), _spread(group.force_max)
    reach = np.divide(force_max, stiffness, out=np.zeros(3), where=stiffness > 0.0)
    return 0.95 * np.minimum(_spread(group.range), reach)
