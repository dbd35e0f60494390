"""The generalised-momentum observer: which joint torque acts that the model does not explain."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.estimation.momentum_observer import GAIN, Compensation, ContactShare, TorqueSource
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array
from pliant.surfaces import PlaneSurface, SurfaceGeometry


@dataclass(frozen=True, slots=True)
class MomentumState:
    """What the observer remembers."""

    inner: Any
    """state of the estimator inside"""
    time: float
    """s, of the last reading"""
    momentum: Array
    """p (n,), N·m s"""
    explained: Array
    """Jᵀλ + β (n,) at the last reading, N·m"""
    torques: tuple[Array, ...]
    """torques (n,) that the readings do not show yet, the oldest first, N·m"""
    disturbance: Array
    """d̂ (n,), N·m"""


class MomentumTwin(Estimator[MomentumState]):
    """Adds `Estimate.disturbance` to another estimator; works in contact and in free space."""

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
        """The completed estimate and the next state."""
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        if period == 0.0:  # the first measurement starts the observer and is its first step, too
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
