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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError, options
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array
from pliant.surfaces import PlaneSurface, SurfaceGeometry

GAIN = 30.0
"""rad/s, default k"""
TorqueSource = Literal["sent", "measured"]
ContactShare = Literal["all", "normal", "none"]
Compensation = Literal["none", "gravity", "gravity+coriolis"]


@dataclass(frozen=True, slots=True)
class MomentumState:
    """State of the observer."""

    inner: Any
    """state of the estimator inside"""
    time: float
    """s, of the last reading"""
    momentum: Array
    """p (n,), N·m s"""
    explained: Array
    """Jᵀλ + β (n,) at the last reading, N·m"""
    torques: tuple[Array, ...]
    """torques (n,) that the delayed readings do not show yet, the oldest first, N·m"""
    disturbance: Array
    """d̂ (n,), N·m"""


class MomentumObserver(Estimator[MomentumState]):
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
        self.inner, self.robot, self.gain = inner, robot, gain
        self.torque, self.contact, self.compensation = torque, contact, compensation
        self.late_readings = late_readings
        self.surface = normal if isinstance(normal, SurfaceGeometry) else PlaneSurface.facing(normal)
        self.frames = None if frames is None else frozenset(frames)
        self._ids = {frame: robot.frame_id(frame) for frame in frames or ()}
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    def init(self, measurement: Measurement) -> MomentumState:
        inner = self.inner.init(measurement)
        estimate, _ = self.inner.step(measurement, inner)
        momentum, explained = self._model_terms(measurement, estimate.wrenches)
        torques = (self._applied(measurement),) * self.late_readings
        return MomentumState(inner, measurement.time, momentum, explained, torques, np.zeros(self.robot.n))

    def step(self, measurement: Measurement, state: MomentumState) -> tuple[Estimate, MomentumState]:
        """The completed estimate and the next state.

        Raises:
            SignalError: the measurement is older than the last one.
        """
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        if period == 0.0:  # the first measurement initialises the observer and is its first step
            return changed(estimate, disturbance=state.disturbance), changed(state, inner=inner)
        torques = (*state.torques, self._applied(measurement))
        momentum, explained = self._model_terms(measurement, estimate.wrenches)
        unexplained = (momentum - state.momentum) / period - torques[0] - 0.5 * (explained + state.explained)
        share = -math.expm1(-self.gain * period)
        disturbance = state.disturbance + share * (unexplained - state.disturbance)
        after = MomentumState(inner, measurement.time, momentum, explained, torques[1:], disturbance)
        return changed(estimate, disturbance=disturbance), after

    # ------------------------------------------------------------------ inside

    def _applied(self, measurement: Measurement) -> Array:
        return measurement.torque_sent if self.torque == "sent" else measurement.torque

    def _model_terms(self, measurement: Measurement, wrenches: Mapping[str, Array]) -> tuple[Array, Array]:
        """p (n,) and Jᵀλ + β (n,) at a measurement."""
        model, data, q, v = self.robot.model, self._data, measurement.q, measurement.v
        mass = mass_matrix(model, data, q)
        C = np.array(pin.computeCoriolisMatrix(model, data, q, v))
        explained: Array = C.T @ v
        if self.compensation == "none":
            explained = explained - np.array(pin.computeGeneralizedGravity(model, data, q))
        elif self.compensation == "gravity+coriolis":
            explained = explained + C @ v
        for frame, wrench in wrenches.items():
            if self.contact != "none" and (self.frames is None or frame in self.frames):
                explained = explained + self._contact_torque(q, frame, wrench)
        return np.asarray(mass @ v, dtype=np.float64), explained

    def _contact_torque(self, q: Array, frame: str, wrench: Array) -> Array:
        """Jᵀλ (n,) of the share of a contact wrench (6,) that the model explains."""
        if not wrench.any():
            return np.zeros(self.robot.n)
        if frame not in self._ids:
            self._ids[frame] = self.robot.frame_id(frame)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.robot.model, self._data, q, self._ids[frame], axes)
        if self.contact == "normal":
            normal = self.surface.normal(self._data.oMf[self._ids[frame]].translation)
            return np.asarray(J[:3].T @ (normal * float(normal @ wrench[:3])), dtype=np.float64)
        return np.asarray(J.T @ wrench, dtype=np.float64)


def _check_option(name: str, value: str, valid: Sequence[str]) -> None:
    if value not in valid:
        raise ConfigError(f"unknown {name} {value!r}; {options(valid, value)}")
