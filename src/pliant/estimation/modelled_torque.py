"""Joint torques from the model and the force sensor instead of the joints' own sensors.

[FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft contact approach", 2024,
eq. 37 and sec. VIII-C: on its robot the joint torque sensors and the force/torque sensor did not agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.estimation.external_torque import inverse_dynamics
from pliant.estimation.filters import Butterworth, Memory
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class ModelledTorqueState:
    """State of the estimator."""

    inner: Any
    time: float
    """s, of the last reading"""
    v: Array
    """(n,) of the last reading, rad/s"""
    acceleration: Memory
    """of the filter"""


class ModelledTorqueEstimator(Estimator[ModelledTorqueState]):
    """`Estimate.torque` becomes τ̂ = RNEA(q, v, v̇) − τ_ext ([FFMPC] eq. 37) with τ_ext = Jᵀλ of the contact wrench.

    The authors read τ_ext from the drives and found that it agrees with their force sensor; here it is the force
    sensor's. The acceleration comes from differences of v through a second-order Butterworth filter, as in the paper,
    which leaves its cutoff open.

    Args:
        inner: the estimator whose torque is replaced; it gives the frame's contact wrench.
        robot: the model.
        frame: of the contact.
        period: s between two measurements.
        cutoff: Hz of the filter.

    Raises:
        ConfigError: a cutoff that is not between 0 and half the sampling rate.
        RobotError: a frame that the robot does not have.
    """

    def __init__(self, inner: Estimator[Any], robot: Robot, frame: str, period: float, *, cutoff: float = 30.0) -> None:
        self.inner, self.robot, self.frame = inner, robot, frame
        self._filter = Butterworth(cutoff, period)
        self._index = robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    def init(self, measurement: Measurement) -> ModelledTorqueState:
        at_rest = self._filter.init(np.zeros(self.robot.n))
        return ModelledTorqueState(self.inner.init(measurement), measurement.time, measurement.v, at_rest)

    def step(self, measurement: Measurement, state: ModelledTorqueState) -> tuple[Estimate, ModelledTorqueState]:
        """The estimate with its torque replaced, and the next state.

        Raises:
            SignalError: the measurement is older than the last one.
        """
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        raw = (measurement.v - state.v) / period if period > 0.0 else np.zeros(self.robot.n)
        a, memory = self._filter.step(raw, state.acceleration)
        q, v = measurement.q, measurement.v
        torque = inverse_dynamics(self.robot, self._data, q, v, a)
        if (wrench := estimate.wrenches.get(self.frame)) is not None:
            axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            J = pin.computeFrameJacobian(self.robot.model, self._data, q, self._index, axes)
            torque = torque - J.T @ wrench
        return changed(estimate, torque=torque), ModelledTorqueState(inner, measurement.time, measurement.v, memory)
