"""Typed configurations of the controllers: each number with its meaning, unit, range and default."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from pliant.controllers.attractor import Law
from pliant.controllers.operational_space import Compensation, OperationalSpace
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.controllers.task import FrameTask
from pliant.entries import ControllerConfig
from pliant.errors import PliantError
from pliant.quantity import quantity
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

NotNegative = Annotated[float, Field(ge=0.0)]
PerAxis = NotNegative | tuple[NotNegative, NotNegative, NotNegative]
"""one number for x, y and z, or one for each"""


class TranslationConfig(ControllerConfig):
    """Impedance of the three positions."""

    stiffness: PerAxis = quantity(
        2500.0, "N/m", "K_0: force per error near the target; x, y, z or one for all", shown=(0.0, 30000.0)
    )
    force_max: PerAxis = quantity(
        100.0,
        "N",
        "F_max: bound of the commanded force, however large the error; an impact can be harder",
        shown=(0.0, 300.0),
    )
    range: PerAxis = quantity(0.06, "m", "x_b: error at which F_max is reached", shown=(0.001, 0.5))
    linear_range: PerAxis | None = quantity(
        None, "m", "x_0: end of the linear part; none: 0.95 x_b, or where 0.95 F_max is reached", shown=(0.0, 0.5)
    )


class RotationConfig(ControllerConfig):
    """Impedance of the three rotations, about the world's axes."""

    stiffness: PerAxis = quantity(
        60.0, "N·m/rad", "K_0: moment per angle near the target; x, y, z or one for all", shown=(0.0, 500.0)
    )
    force_max: PerAxis = quantity(
        12.0, "N·m", "F_max: bound of the moment about each axis, at any angle", shown=(0.0, 150.0)
    )
    range: PerAxis = quantity(0.30, "rad", "x_b: angle at which F_max is reached", shown=(0.01, 3.0))
    linear_range: PerAxis | None = quantity(
        None, "rad", "x_0: end of the linear part; none: 0.95 x_b, or where 0.95 F_max is reached", shown=(0.0, 3.0)
    )


class FrameTaskConfig(ControllerConfig):
    """One frame that a fractal impedance holds."""

    frame: str = Field(description="frame of the robot")
    translation: TranslationConfig = Field(default=TranslationConfig(), description="impedance of the position")
    rotation: RotationConfig | None = Field(
        default=None, description="impedance of the orientation; none leaves it free"
    )
    profile: Shape = Field(default=Shape.EXPONENTIAL, description="shape of the bend of the force towards F_max")

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        try:
            ForceProfile.of(self.tuning(), self.profile)
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


class StackConfig(ControllerConfig):
    """A stack of fractal impedances."""

    tasks: dict[str, FrameTaskConfig | None] = Field(
        description="label → task; the label names the channels. None drops a task of the default"
    )
    law: Law = Field(default=Law.CAPPED, description="force on the way back to the target")
    phases: PhaseSettings = Field(default=PhaseSettings(), description="thresholds of the phase logic")
    joint_damping: float = quantity(
        0.0,
        "N·m s/rad",
        "of every joint, added by the controller; a plain spring needs it to come to rest",
        shown=(0.0, 20.0),
        ge=0.0,
    )
    motion_damping: float = quantity(
        0.0,
        "1/s",
        "of what a frame's velocity differs from its reference's by, with the inertia that the frame has, and of"
        " self-motion",
        shown=(0.0, 200.0),
        ge=0.0,
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

    frame: str = Field(default="flange", description="controlled frame; it follows the first task")
    stiffness: float = quantity(
        OperationalSpace.stiffness, "1/s²", "acceleration per position error", shown=(0.0, 4000.0), ge=0.0
    )
    damping_ratio: float = quantity(OperationalSpace.damping_ratio, "1", "1 is critical", shown=(0.0, 2.0), ge=0.0)
    posture_stiffness: float = quantity(
        OperationalSpace.posture_stiffness,
        "1/s²",
        "joint acceleration per joint error, in the null space of the task",
        shown=(0.0, 400.0),
        ge=0.0,
    )
    singularity_damping: float = quantity(
        OperationalSpace.singularity_damping,
        "kg^-1/2",
        "δ in Λ = (J M⁻¹ Jᵀ + δ² I)⁻¹: bounds the forces near singularities, costs accuracy",
        shown=(0.001, 1.0),
        gt=0.0,
    )
    compensation: Compensation = Field(
        default=OperationalSpace.compensation,
        description="what the model adds; without gravity where the robot compensates itself",
    )
    force_integral: float = quantity(
        OperationalSpace.force_integral,
        "1/s",
        "k_i: along force axes F_d + k_i ∫(F_d − F) is pressed while there is contact; 0: no force is regulated",
        shown=(0.0, 60.0),
        ge=0.0,
    )


def _spread(value: PerAxis) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=np.float64), 3).copy()


def _three(bend: PerAxis | None, group: TranslationConfig | RotationConfig) -> Array:
    """x_0 of one group, derived where it is not given (the other group may have its own)."""
    if bend is not None:
        return _spread(bend)
    stiffness, force_max = _spread(group.stiffness), _spread(group.force_max)
    reach = np.divide(force_max, stiffness, out=np.zeros(3), where=stiffness > 0.0)
    return 0.95 * np.minimum(_spread(group.range), reach)
