"""Contact wrenches from force/torque sensors, and whether the frames touch anything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array, cross


@dataclass(frozen=True)
class CarriedMass:
    """What a sensor carries and feels, and how its zero is off: both are taken out of the reading."""

    mass: float = 0.0
    """kg"""
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in the sensor's axes"""
    bias: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """(6,) what the sensor reads without any load, in its own axes, N and N·m"""


@dataclass(frozen=True)
class TouchThresholds:
    """When a frame is believed to touch: hysteresis on the size of its contact force."""

    begin: float = 1.0
    """N above which contact begins"""
    end: float = 0.5
    """N below which it ends"""
    linger: float = 5e-3
    """s that the force has to stay below"""

    def __post_init__(self) -> None:
        if not 0.0 <= self.end <= self.begin or self.linger < 0.0:
            raise ConfigError(f"touch thresholds need 0 <= end <= begin and linger >= 0, got {self}")


@dataclass(frozen=True, slots=True)
class WrenchState:
    """State of the estimator."""

    velocity: Array
    """(n,) filtered, rad/s"""
    above: Mapping[str, float]
    """frame → s when its force was last above `TouchThresholds.end`; −∞: it does not touch"""


class WrenchEstimator(Estimator[WrenchState]):
    """Passes joint signals on, turns sensor readings into contact wrenches in world axes, and says what touches.

    Args:
        robot: gives the sensors' orientation.
        carried: sensor frame → what it carries; frames that are not named carry nothing.
        thresholds: when a frame touches.
        velocity_gain: α of v ← v + α (v_measured − v); 1 filters nothing.

    Raises:
        ConfigError: the gain is not within (0, 1].
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        robot: Robot,
        carried: Mapping[str, CarriedMass] | None = None,
        thresholds: TouchThresholds | None = None,
        *,
        velocity_gain: float = 1.0,
    ) -> None:
        if not 0.0 < velocity_gain <= 1.0:
            raise ConfigError(f"velocity_gain must lie within (0, 1], got {velocity_gain}")
        self.robot, self.carried = robot, dict(carried or {})
        self.thresholds, self.velocity_gain = thresholds or TouchThresholds(), velocity_gain
        self._model, self._data = robot.model, robot.model.createData()
        self._frames = {name: robot.frame_id(name) for name in self.carried}

    def init(self, measurement: Measurement) -> WrenchState:
        return WrenchState(measurement.v, dict.fromkeys(measurement.wrenches, -np.inf))

    def step(self, measurement: Measurement, state: WrenchState) -> tuple[Estimate, WrenchState]:
        v = state.velocity + self.velocity_gain * (measurement.v - state.velocity)
        pin.framesForwardKinematics(self._model, self._data, measurement.q)
        wrenches = {frame: self._contact_wrench(frame, wrench) for frame, wrench in measurement.wrenches.items()}
        above = {frame: self._above(frame, wrench, measurement.time, state) for frame, wrench in wrenches.items()}
        contacts = {frame: measurement.time - last <= self.thresholds.linger for frame, last in above.items()}
        estimate = Estimate(
            measurement.time, measurement.q, v, measurement.torque, measurement.torque_sent, wrenches, contacts
        )
        return estimate, WrenchState(v, above)

    def _contact_wrench(self, frame: str, reading: Array) -> Array:
        """(6,) world axes, of a reading (6,) in the sensor's axes."""
        if frame not in self._frames:
            self._frames[frame] = self.robot.frame_id(frame)
        R_world_sensor: Array = np.array(self._data.oMf[self._frames[frame]].rotation)
        carried = self.carried.get(frame)
        if carried is not None:
            reading = reading - np.array(carried.bias)
        wrench = np.concatenate([R_world_sensor @ reading[:3], R_world_sensor @ reading[3:]])
        if carried is None or carried.mass == 0.0:
            return wrench
        weight: Array = carried.mass * np.array(self._model.gravity.linear)
        lever: Array = R_world_sensor @ np.array(carried.center)
        return wrench - np.concatenate([weight, cross(lever, weight)])

    def _above(self, frame: str, wrench: Array, time: float, state: WrenchState) -> float:
        last = state.above.get(frame, -np.inf)
        touching = time - last <= self.thresholds.linger
        size = float(np.linalg.norm(wrench[:3]))
        return time if size > (self.thresholds.end if touching else self.thresholds.begin) else last
