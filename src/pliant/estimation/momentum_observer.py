"""The generalised-momentum observer: estimates the joint torque that the model does not explain.

With d everything that is missing in the model (friction, a wrong payload, a bias of the drives, a push),

    M(q) v̇ + C(q, v) v + g(q) = τ + Jᵀλ + d,        p = M v
    ṗ = τ + Jᵀλ + d + β(q, v),                      β = Cᵀ v − g        (because Ṁ = C + Cᵀ)

and the observer `d̂ = k (p(t) − p(0) − ∫ (τ + Jᵀλ + β + d̂) dt)` is a first-order low-pass of d, `ḋ̂ = k (d − d̂)`,
without an acceleration and without inverting M. Source: De Luca, Mattone, "Sensorless robot collision detection and
hybrid force/motion control", ICRA 2005; De Luca, Albu-Schäffer, Haddadin, Hirzinger, "Collision detection and safe
reaction with the DLR-III lightweight manipulator arm", IROS 2006.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, get_args

import numpy.typing as npt

from pliant._estimation import MomentumStage
from pliant.errors import ConfigError, options
from pliant.estimation.chain import ChainedEstimator
from pliant.estimation.compiled_surface import compiled_surface, surface_facing
from pliant.interfaces import Estimator
from pliant.rigid_body import tree_of
from pliant.robot import Robot
from pliant.surfaces import SurfaceGeometry

GAIN = 30.0
"""rad/s, default k"""
TorqueSource = Literal["sent", "measured"]
ContactShare = Literal["all", "normal", "none"]
Compensation = Literal["none", "gravity", "gravity+coriolis"]


class MomentumObserver(ChainedEstimator):
    """Adds `Estimate.disturbance` to another estimator; works in contact and in free space.

    Each step matches the continuous observer's response to a constant d exactly:
    `d̂ ← d̂ + (1 − e^{−kT}) ((p − p_before)/T − τ − mean(Jᵀλ + β) − d̂)`, the mean taken over both ends of the period.
    A controller compensates the disturbance by sending `u − d̂`.

    Joint signals come from the measurement itself (a velocity filter would show up as a disturbance), contact wrenches
    from the estimator inside, which has removed the tool's weight from them.

    Args:
        inner: the estimator whose estimates are completed.
        robot: the dynamic model.
        gain: k, rad/s. A higher gain converges faster and passes more velocity noise, about k M σ_v.
        torque: "sent" counts everything between the command and the link as disturbance (bias, gain, friction of the
            drives); "measured" uses the joint torque sensors, so that only torques on the link side remain.
        contact: which part of the contact wrenches belongs to the model. "normal": the force along `normal`, so that
            friction at the contact is part of d̂; "all": the whole wrench; "none": contact is a disturbance.
        normal: (3,) outward normal of the surface in the world, any length above zero, or the believed surface itself
            where its normal turns.
        frames: whose contact wrenches count; None: every one that the estimator inside reports.
        compensation: what the robot's own controller adds to the torque without reporting it.
        late_readings: whole periods by which q and v are older than the torque that arrives with them.

    Raises:
        ConfigError: an option that does not exist, a gain that is not above zero, a normal without length.
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        inner: Estimator[Any],
        robot: Robot,
        *,
        gain: float = GAIN,
        torque: TorqueSource = "sent",
        contact: ContactShare = "normal",
        normal: npt.ArrayLike | SurfaceGeometry = (0.0, 0.0, 1.0),
        frames: Sequence[str] | None = None,
        compensation: Compensation = "none",
        late_readings: int = 0,
    ) -> None:
        if not (math.isfinite(gain) and gain > 0.0):
            raise ConfigError(f"the gain of a momentum observer must be above zero (rad/s), got {gain}")
        if late_readings < 0:
            raise ConfigError(f"late_readings must not be negative (periods), got {late_readings}")
        _check_option("torque", torque, get_args(TorqueSource))
        _check_option("contact", contact, get_args(ContactShare))
        _check_option("compensation", compensation, get_args(Compensation))
        self.robot, self.gain = robot, gain
        self.torque, self.contact, self.compensation = torque, contact, compensation
        self.late_readings = late_readings
        self.surface = surface_facing(normal)
        self.frames = None if frames is None else frozenset(frames)
        for frame in frames or ():
            robot.frame_id(frame)
        counted = () if contact == "none" else frames
        stage = MomentumStage(
            robot=tree_of(robot.model),
            gain=gain,
            measured=torque == "measured",
            surface=compiled_surface(self.surface),
            along_normal=contact == "normal",
            frames=None if counted is None else list(counted),
            gravity=compensation != "none",
            coriolis=compensation == "gravity+coriolis",
            late=late_readings,
        )
        super().__init__(stage, inner, frozenset({"disturbance"}), named=robot if counted is None else None)


def _check_option(name: str, value: str, valid: Sequence[str]) -> None:
    if value not in valid:
        raise ConfigError(f"unknown {name} {value!r}; {options(valid, value)}")
