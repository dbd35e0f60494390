"""A low-passed contact force without the filter's lag, which is compensated by a contact model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.estimation.filters import LowPass, Memory
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array
from pliant.surfaces import SurfaceGeometry


@dataclass(frozen=True, slots=True)
class ComplementaryState:
    """State of the estimator."""

    inner: Any
    time: float
    """s, of the last reading"""
    modelled: float
    """N, −∫ K ṗ·n dt of this contact"""
    filter: Memory | None
    """of the wrench minus what is modelled; None before the first step"""
    touched: bool = False
    """whether the frame was in contact at the last reading"""


class ComplementaryForce(Estimator[ComplementaryState]):
    """The contact wrench is H w + (1 − H) w_m with a low-pass H and w_m = −n ∫ K ṗ·n dt, the force by which a spring K
    changes with the motion: slow changes come from the sensor, fast ones from the joints.

    With the right K, n and the surface at rest the sum has no lag, and sensor errors above the cutoff are still
    removed. A motion along n without a change of force (a path on a surface whose tilt differs from n) causes an error
    of K ṗ·n times the filter's delay.

    Args:
        inner: where the estimates come from.
        robot: the model.
        frame: that touches.
        filter: H.
        stiffness: K, N/m, as believed.
        surface: as believed; n is its normal where the frame is.

    Raises:
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        inner: Estimator[Any],
        robot: Robot,
        frame: str,
        filter: LowPass,
        stiffness: float,
        surface: SurfaceGeometry,
    ) -> None:
        self.inner, self.frame, self.stiffness = inner, frame, stiffness
        self._robot, self._filter, self._surface = robot, filter, surface
        self._index = robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    def init(self, measurement: Measurement) -> ComplementaryState:
        return ComplementaryState(self.inner.init(measurement), measurement.time, 0.0, None)

    def step(self, measurement: Measurement, state: ComplementaryState) -> tuple[Estimate, ComplementaryState]:
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        wrench = estimate.wrenches.get(self.frame)
        if wrench is None:
            return estimate, ComplementaryState(inner, measurement.time, 0.0, None)
        normal, speed = self._motion(estimate)
        touches = estimate.contacts.get(self.frame, False)
        modelled = state.modelled - self.stiffness * speed * period if touches else 0.0
        along = np.concatenate([normal, np.zeros(3)])
        rest = wrench - modelled * along
        memory = state.filter
        if memory is None or touches != state.touched:  # model and filter are reset
            memory = self._filter.init(rest)
        passed, memory = self._filter.step(rest, memory)
        wrenches = {**estimate.wrenches, self.frame: passed + modelled * along}
        after = ComplementaryState(inner, measurement.time, modelled, memory, touches)
        return changed(estimate, wrenches=wrenches), after

    def _motion(self, estimate: Estimate) -> tuple[Array, float]:
        """Normal (3,) where the frame is, and its speed along it, m/s."""
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self._robot.model, self._data, estimate.q, self._index, axes)
        normal = self._surface.normal(np.array(self._data.oMf[self._index].translation))
        return normal, float(normal @ (J[:3] @ estimate.v))
