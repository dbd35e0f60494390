"""Adds the belief about the environment's stiffness and damping to another estimator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.estimation import FitConfig
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array
from pliant.surfaces import PlaneSurface, SurfaceGeometry
from tests.twins.estimator_chain.environment_fit import FitState, FitTwin


@dataclass(frozen=True, slots=True)
class EnvironmentState:
    """State of the inner estimator and of the fit."""

    inner: Any
    fit: FitState
    found_at: Array | None = None
    """(3,) m, where the frame was when the estimate was found"""


class EnvironmentTwin(Estimator[EnvironmentState]):
    """Fills `Estimate.environments` for one contact frame, from its normal force and its motion."""

    def __init__(
        self,
        inner: Estimator[Any],
        robot: Robot,
        frame: str,
        period: float,
        *,
        normal: npt.ArrayLike | SurfaceGeometry = (0.0, 0.0, 1.0),
        config: FitConfig | None = None,
        sliding: float | None = None,
        reach: float | None = None,
        kept: float = math.inf,
    ) -> None:
        self.inner, self.robot, self.frame, self.sliding = inner, robot, frame, sliding
        self.reach, self.kept = math.inf if reach is None else reach, kept
        self.surface = normal if isinstance(normal, SurfaceGeometry) else PlaneSurface.facing(normal)
        self.fit = FitTwin(config or FitConfig(), period)
        self._frame = robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    def init(self, measurement: Measurement) -> EnvironmentState:
        return EnvironmentState(self.inner.init(measurement), FitState())

    def step(self, measurement: Measurement, state: EnvironmentState) -> tuple[Estimate, EnvironmentState]:
        estimate, inner = self.inner.step(measurement, state.inner)
        wrench = estimate.wrenches.get(self.frame)
        fit, found_at = state.fit, state.found_at
        if wrench is not None:
            model, data = self.robot.model, self._data
            pin.forwardKinematics(model, data, estimate.q, estimate.v)
            position = pin.updateFramePlacement(model, data, self._frame).translation
            axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            velocity = pin.getFrameVelocity(model, data, self._frame, axes).linear
            distance, normal, _ = self.surface.near(position)
            rate = -float(normal @ velocity)
            across = velocity + rate * normal
            sliding = math.sqrt(across.dot(across))
            if self.sliding is None or sliding <= self.sliding:
                fit = self.fit.step(float(normal @ np.asarray(wrench[:3])), -distance, rate, fit)
            if fit.found is not state.fit.found:
                found_at = np.array(position)
            soft = fit.found is not None and fit.found.stiffness < self.kept
            if soft and found_at is not None and np.linalg.norm(position - found_at) > self.reach:
                fit = changed(fit, found=None)
        if fit.found is not None:
            estimate = changed(estimate, environments={**estimate.environments, self.frame: fit.found})
        return estimate, EnvironmentState(inner, fit, found_at)
