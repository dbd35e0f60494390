"""Pose of a surface, from the points at which a tool touched it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.environment import EstimatedSurface
from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array, cross, skew
from pliant.surfaces import SurfaceGeometry

_AVERAGED = 10  # least number of readings between two points, or noise alone would look like a motion


@dataclass(frozen=True)
class SurfaceFitConfig:
    """Prior uncertainty of the surface, and noise of the contact points.

    Raises:
        ConfigError: on construction, a number that is not finite and above zero (a radius may be zero).
    """

    radius: float = 0.0
    """m, of the contact sphere about the contact frame's origin"""
    stiffness: float = 2e4
    """N/m, believed stiffness of the surface"""
    shift_std: float = 0.01
    """m, standard deviation of the believed surface's position"""
    turn_std: float = math.radians(5.0)
    """rad, standard deviation of its orientation"""
    place_std: float = 5e-4
    """m, standard deviation of a contact point: kinematics, and errors of the stiffness"""
    spacing: float = 2e-3
    """m between two contact points; the readings in between are averaged, at least ten"""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and (value > 0.0 or (name == "radius" and value == 0.0))):
                raise ConfigError(f"{name} of a surface fit must be finite and above zero, got {value}")


@dataclass(frozen=True, slots=True)
class SurfaceFitState:
    """State of the fit between two ticks."""

    inner: Any
    pivot: Array | None = None
    """(3,) m; None: no contact yet"""
    shift_turn: Array = field(default_factory=lambda: np.zeros(6))
    """(6,) m and rad, of the believed surface"""
    covariance: Array = field(default_factory=lambda: np.zeros((6, 6)))
    """(6, 6)"""
    last: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) m, the last contact point"""
    summed: Array | None = None
    """(4,) sums over the readings since the last contact point: position (m) and normal force (N)"""
    count: int = 0
    felt: EstimatedSurface | None = None


class SurfaceEstimator(Estimator[SurfaceFitState]):
    """Fills `Estimate.surfaces` for one contact frame: the believed surface is turned and shifted to fit the points
    that the tool touched (a Kalman filter over shift and rotation vector, 6 numbers that do not change, linear about
    the belief; its prior is the uncertainty of the belief). Only positions are used, never the direction of the force,
    which deviates by the friction angle during sliding. Along a direction in which the tool has not moved the believed
    tilt stays, and `normal_std` says how uncertain it is.

    Args:
        inner: the estimator before it.
        robot: as believed.
        frame: contact frame, the centre of the ball that touches.
        surface: as believed.
        config: prior and noise.
    """

    def __init__(
        self, inner: Estimator[Any], robot: Robot, frame: str, surface: SurfaceGeometry, config: SurfaceFitConfig
    ) -> None:
        self.inner, self.robot, self.frame, self.surface, self.config = inner, robot, frame, surface, config
        self._frame = robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step
        self._prior = np.diag([config.shift_std**2] * 3 + [config.turn_std**2] * 3)

    def init(self, measurement: Measurement) -> SurfaceFitState:
        return SurfaceFitState(self.inner.init(measurement))

    def step(self, measurement: Measurement, state: SurfaceFitState) -> tuple[Estimate, SurfaceFitState]:
        estimate, inner = self.inner.step(measurement, state.inner)
        state = changed(state, inner=inner)
        wrench = estimate.wrenches.get(self.frame)
        if wrench is None or not estimate.contacts.get(self.frame, False):
            state = changed(state, summed=None, count=0)
        else:
            state = self._touched(self._position(estimate.q), wrench, state)
        if state.felt is not None:
            estimate = changed(estimate, surfaces={**estimate.surfaces, self.frame: state.felt})
        return estimate, state

    # ------------------------------------------------------------------ inside

    def _position(self, q: Array) -> Array:
        pin.forwardKinematics(self.robot.model, self._data, q)
        return np.array(pin.updateFramePlacement(self.robot.model, self._data, self._frame).translation)

    def _touched(self, position: Array, wrench: Array, state: SurfaceFitState) -> SurfaceFitState:
        """The state after a reading in contact."""
        if state.felt is None:
            found = SurfaceFitState(state.inner, position, np.zeros(6), self._prior, position)
            return changed(found, felt=self._felt(position, found))
        reading = np.append(position, state.felt.normal @ wrench[:3])
        summed = reading if state.summed is None else state.summed + reading
        state = changed(state, summed=summed, count=state.count + 1)
        mean = summed / state.count
        if state.count < _AVERAGED or math.dist(mean[:3], state.last) < self.config.spacing:
            return state
        state = changed(self._fitted(mean[:3], float(mean[3]), state), last=mean[:3], summed=None, count=0)
        return changed(state, felt=self._felt(position, state))

    def _fitted(self, place: Array, force: float, state: SurfaceFitState) -> SurfaceFitState:
        """One step of the filter: the distance of the sphere's centre from the surface is its radius minus the
        deflection of the surface."""
        assert state.pivot is not None
        spread = state.covariance
        distance = self._moved(state).near(place).distance
        # derivatives at the believed surface in every step: at a changing estimate they would add false information
        # about directions that are not observed
        n = self.surface.normal(place)
        H = -np.concatenate([n, cross(place - state.pivot, n)])
        gain = spread @ H / (float(H @ spread @ H) + self.config.place_std**2)
        x = state.shift_turn + gain * (self.config.radius - force / self.config.stiffness - distance)
        spread = spread - np.outer(gain, H @ spread)
        return changed(state, shift_turn=x, covariance=0.5 * (spread + spread.T))

    def _moved(self, state: SurfaceFitState) -> SurfaceGeometry:
        return self.surface.moved(state.shift_turn[:3], state.shift_turn[3:], state.pivot)

    def _felt(self, position: Array, state: SurfaceFitState) -> EstimatedSurface:
        assert state.pivot is not None
        normal = self._moved(state).normal(position)
        turned = skew(normal)  # a small turn ω moves the normal by ω × n
        spread = turned @ state.covariance[3:, 3:] @ turned.T
        std = math.sqrt(max(float(np.linalg.eigvalsh(spread)[-1]), 0.0))
        return EstimatedSurface(state.pivot, state.shift_turn[3:], normal, std)
