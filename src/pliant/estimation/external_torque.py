"""External torque and contact force from the joint torque sensors and the model.

[FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft contact approach", 2024,
eq. 37 relates the three: `τ̂ = RNEA(q, v, v̇) − τ_ext`. The authors read τ_ext from the drives and compute τ̂; here the
joint torque is measured and τ_ext is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.estimation.filters import Butterworth, Memory
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array

_SINGULAR = 1e-2
"""smallest singular value of Jᵀ relative to its largest below which a direction of the force counts as unobservable"""


@dataclass(frozen=True, slots=True)
class ExternalTorqueState:
    """State of the estimator."""

    inner: Any
    time: float
    """s, of the last reading"""
    v: Array
    """(n,) of the last reading, rad/s"""
    filter: Memory | None
    """of acceleration and the rest; None before the second reading"""


class ExternalTorqueEstimator(Estimator[ExternalTorqueState]):
    """τ_ext = RNEA(q, v, v̇) − τ̂, and with a contact frame the force that explains it best.

    The acceleration comes from differences of v through a second-order Butterworth filter, as in the paper. With
    `aligned` the measured torque and the bias forces pass the same filter, so that both have the same delay; without it
    (the paper's form) a fast motion appears as an external torque.

    Without a frame `Estimate.disturbance` is τ_ext. With one, `Estimate.wrenches[frame]` is the least-squares solution
    of `Jᵀ λ = τ_ext` (world axes), it replaces the reading of a sensor at that frame, and `Estimate.disturbance` is
    what λ leaves unexplained. In directions in which the arm is close to singular, the force is zero.

    Args:
        inner: the estimator whose estimates are completed.
        robot: the model.
        period: s between two measurements.
        cutoff: Hz of the filter.
        frame: of the contact; None for no force.
        dimension: 3 for a force at the frame's origin, 6 for a wrench.
        aligned: whether the torque passes the acceleration's filter, too.

    Raises:
        ConfigError: a cutoff that is not between 0 and half the sampling rate, another dimension.
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        inner: Estimator[Any],
        robot: Robot,
        period: float,
        *,
        cutoff: float = 20.0,
        frame: str | None = None,
        dimension: Literal[3, 6] = 3,
        aligned: bool = True,
    ) -> None:
        if dimension not in (3, 6):
            raise ConfigError(f"the dimension of a contact is 3 (force) or 6 (wrench), got {dimension}")
        self.inner, self.robot, self.frame, self.dimension, self.aligned = inner, robot, frame, dimension, aligned
        self._filter = Butterworth(cutoff, period)
        self._index = None if frame is None else robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    def init(self, measurement: Measurement) -> ExternalTorqueState:
        return ExternalTorqueState(self.inner.init(measurement), measurement.time, measurement.v, None)

    def step(self, measurement: Measurement, state: ExternalTorqueState) -> tuple[Estimate, ExternalTorqueState]:
        """The completed estimate and the next state.

        Raises:
            SignalError: the measurement is older than the last one.
        """
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        external, memory = self._external_torque(measurement, state, period)
        estimate = self._completed(estimate, measurement.q, external)
        return estimate, ExternalTorqueState(inner, measurement.time, measurement.v, memory)

    # ------------------------------------------------------------------ inside

    def _external_torque(
        self, measurement: Measurement, state: ExternalTorqueState, period: float
    ) -> tuple[Array, Memory | None]:
        q, v, n = measurement.q, measurement.v, self.robot.n
        bias = np.array(pin.nonLinearEffects(self.robot.model, self._data, q, v))
        rest = bias - measurement.torque
        memory, a = state.filter, np.zeros(n)
        if period > 0.0:
            raw = np.concatenate([(v - state.v) / period, rest])
            start = np.concatenate([np.zeros(n), rest])
            passed, memory = self._filter.step(raw, memory or self._filter.init(start))
            a, rest = passed[:n], passed[n:] if self.aligned else rest
        inertial = inverse_dynamics(self.robot, self._data, q, v, a) - bias
        return inertial + rest, memory

    def _completed(self, estimate: Estimate, q: Array, external: Array) -> Estimate:
        if self.frame is None:
            return changed(estimate, disturbance=external)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.robot.model, self._data, q, self._index, axes)[: self.dimension]
        force = contact_force(J, external)
        wrench = np.concatenate([force, np.zeros(6 - self.dimension)])
        unexplained = np.asarray(external - J.T @ force, dtype=np.float64)
        return changed(estimate, disturbance=unexplained, wrenches={**estimate.wrenches, self.frame: wrench})


def inverse_dynamics(robot: Robot, data: pin.Data, q: Array, v: Array, a: Array) -> Array:
    """RNEA(q, v, a) (n,), N·m: the joint torque that moves the robot so without any contact."""
    return np.array(pin.rnea(robot.model, data, q, v, a), dtype=np.float64)


def contact_force(J: Array, external: Array) -> Array:
    """Least-squares λ (k,) of Jᵀ λ = τ_ext; zero in directions with hardly any effect on the joints.

    Args:
        J: (k, n) contact Jacobian.
        external: τ_ext (n,), N·m.
    """
    return np.asarray(np.linalg.lstsq(J.T, external, rcond=_SINGULAR)[0], dtype=np.float64)
