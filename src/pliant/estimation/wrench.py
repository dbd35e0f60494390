"""Contact wrenches and contact states from force/torque sensors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.estimation.carried_mass import CarriedMass, SensorMotion
from pliant.estimation.joint_acceleration import AccelerationState, JointAcceleration
from pliant.estimation.tare import Tare, TareState, tare_step
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array, cross


@dataclass(frozen=True)
class TouchThresholds:
    """Contact detection of a frame: hysteresis on the magnitude of its contact force."""

    begin: float = 1.0
    """N above which contact begins"""
    end: float = 0.5
    """N below which it ends"""
    linger: float = 5e-3
    """s for which the force must stay below `end`"""

    def __post_init__(self) -> None:
        if not 0.0 <= self.end <= self.begin or self.linger < 0.0:
            raise ConfigError(f"touch thresholds need 0 <= end <= begin and linger >= 0, got {self}")


@dataclass(frozen=True, slots=True)
class WrenchState:
    """State of the estimator."""

    velocity: Array
    """(n,) filtered, rad/s"""
    above: Mapping[str, float]
    """frame → s when its force was last above `TouchThresholds.end`; −∞: no contact"""
    acceleration: AccelerationState
    tare: TareState | None
    """None: no taring"""


class WrenchEstimator(Estimator[WrenchState]):
    """Passes joint signals on, converts sensor readings into contact wrenches in world axes, and detects contacts.

    Weight and inertia of the load are subtracted from the reading; the joint accelerations come from
    differences of v, whose error `JointAcceleration` states.

    Args:
        robot: gives the sensors' motion.
        carried: sensor frame → what it carries; frames that are not named carry nothing.
        thresholds: thresholds of the contact detection.
        velocity_gain: α of v ← v + α (v_measured − v); 1 filters nothing. The accelerations do not use it.
        contact_frames: sensor frame → contact frame beyond it; wrench and contact are given at that frame and under its
            name. Other sensors use their own frame.
        acceleration: how joint accelerations are found.
        tare: how unknown loads of the sensors are tared at the start; None: no taring.

    Raises:
        ConfigError: the gain is not within (0, 1], a contact frame that the sensor cannot feel or that has two sensors.
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        robot: Robot,
        carried: Mapping[str, CarriedMass] | None = None,
        thresholds: TouchThresholds | None = None,
        *,
        velocity_gain: float = 1.0,
        contact_frames: Mapping[str, str] | None = None,
        acceleration: JointAcceleration | None = None,
        tare: Tare | None = None,
    ) -> None:
        if not 0.0 < velocity_gain <= 1.0:
            raise ConfigError(f"velocity_gain must lie within (0, 1], got {velocity_gain}")
        self.robot, self.carried = robot, dict(carried or {})
        self.thresholds, self.velocity_gain = thresholds or TouchThresholds(), velocity_gain
        self.contact_frames = dict(contact_frames or {})
        self.acceleration, self.tare = acceleration or JointAcceleration(), tare
        self._model, self._data = robot.model, robot.model.createData()
        self._gravity: Array = np.array(robot.model.gravity.linear)
        self._frames = {name: robot.frame_id(name) for name in self.carried}
        _check_contact_frames(robot, self.contact_frames)

    def init(self, measurement: Measurement) -> WrenchState:
        frames = [self.contact_frames.get(sensor, sensor) for sensor in measurement.wrenches]
        moving = self.acceleration.init(measurement.time, measurement.v)
        tare = None if self.tare is None else TareState(measurement.time)
        return WrenchState(measurement.v, dict.fromkeys(frames, -np.inf), moving, tare)

    def step(self, measurement: Measurement, state: WrenchState) -> tuple[Estimate, WrenchState]:
        v = state.velocity + self.velocity_gain * (measurement.v - state.velocity)
        moving = self._move(measurement, state)
        loads = self._loads(state.tare)
        unexplained = {
            sensor: self._without(loads.get(sensor), sensor, reading)
            for sensor, reading in measurement.wrenches.items()
        }
        tare = state.tare
        if self.tare is not None and tare is not None and tare.found is None:
            pull = {sensor: self._rotation(sensor).T @ self._gravity for sensor in unexplained}
            tare = tare_step(self.tare, measurement.time, measurement.v, unexplained, pull, tare)
            unexplained = dict.fromkeys(unexplained, np.zeros(6))
        wrenches = dict(self._at_contact(sensor, wrench) for sensor, wrench in unexplained.items())
        above = {frame: self._above(frame, wrench, measurement.time, state) for frame, wrench in wrenches.items()}
        contacts = {frame: measurement.time - last <= self.thresholds.linger for frame, last in above.items()}
        estimate = Estimate(
            measurement.time, measurement.q, v, measurement.torque, measurement.torque_sent, wrenches, contacts
        )
        return estimate, WrenchState(v, above, moving, tare)

    # ------------------------------------------------------------------ inside

    def _move(self, measurement: Measurement, state: WrenchState) -> AccelerationState:
        """Present kinematics; velocities and accelerations only where a sensor carries a load."""
        if not self.carried and self.tare is None:
            pin.framesForwardKinematics(self._model, self._data, measurement.q)
            return state.acceleration
        a, moving = self.acceleration.step(measurement.time, measurement.v, state.acceleration)
        pin.forwardKinematics(self._model, self._data, measurement.q, measurement.v, a)
        pin.updateFramePlacements(self._model, self._data)
        return moving

    def _loads(self, tare: TareState | None) -> Mapping[str, CarriedMass]:
        if tare is None or tare.found is None:
            return self.carried
        return {sensor: self.carried.get(sensor, CarriedMass()).plus(found) for sensor, found in tare.found.items()}

    def _without(self, carried: CarriedMass | None, sensor: str, reading: Array) -> Array:
        """(6,) reading minus the effect of a load, both in the sensor's axes."""
        frame = self._frame(sensor)
        if carried is None:
            return reading
        local = pin.ReferenceFrame.LOCAL
        motion = pin.getFrameClassicalAcceleration(self._model, self._data, frame, local)
        spin = pin.getFrameVelocity(self._model, self._data, frame, local).angular
        gravity = self._rotation(sensor).T @ self._gravity
        return reading - carried.reading(SensorMotion(motion.linear - gravity, spin, motion.angular))

    def _at_contact(self, sensor: str, wrench: Array) -> tuple[str, Array]:
        """The contact frame, and the wrench (6,) there in world axes, for a wrench (6,) in the sensor's axes."""
        R_world_sensor = self._rotation(sensor)
        force, moment = R_world_sensor @ wrench[:3], R_world_sensor @ wrench[3:]
        touching = self.contact_frames.get(sensor, sensor)
        if touching != sensor:
            oMf = self._data.oMf
            lever = oMf[self._frame(sensor)].translation - oMf[self._frame(touching)].translation
            moment = moment + cross(lever, force)
        return touching, np.concatenate([force, moment])

    def _frame(self, name: str) -> int:
        if name not in self._frames:
            self._frames[name] = self.robot.frame_id(name)
        return self._frames[name]

    def _rotation(self, sensor: str) -> Array:
        """R_world_sensor (3, 3)."""
        return np.array(self._data.oMf[self._frame(sensor)].rotation)

    def _above(self, frame: str, wrench: Array, time: float, state: WrenchState) -> float:
        last = state.above.get(frame, -np.inf)
        touching = time - last <= self.thresholds.linger
        size = math.sqrt(wrench[:3].dot(wrench[:3]))
        return time if size > (self.thresholds.end if touching else self.thresholds.begin) else last


def _check_contact_frames(robot: Robot, frames: Mapping[str, str]) -> None:
    for sensor, touching in frames.items():
        if not robot.carries(sensor, touching):
            raise ConfigError(
                f"the sensor at frame {sensor!r} cannot feel what touches frame {touching!r}: that frame must be the"
                " sensor's own or hang on it"
            )
    if len(set(frames.values())) < len(frames):
        raise ConfigError(f"two sensors must not give the wrench of one contact frame, got {dict(frames)}")
