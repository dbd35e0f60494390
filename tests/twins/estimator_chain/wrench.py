"""Contact wrenches from force/torque sensors, and whether the frames touch anything."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.estimation.carried_mass import CarriedMass
from pliant.estimation.joint_acceleration import JointAcceleration
from pliant.estimation.tare import Tare
from pliant.estimation.wrench import TouchThresholds
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array, cross
from tests.twins.estimator_chain import joint_acceleration
from tests.twins.estimator_chain.carried_mass import SensorMotion, both, reading
from tests.twins.estimator_chain.joint_acceleration import AccelerationState
from tests.twins.estimator_chain.tare import TareState, tare_step


@dataclass(frozen=True, slots=True)
class WrenchState:
    """State of the estimator."""

    velocity: Array
    """(n,) filtered, rad/s"""
    above: Mapping[str, float]
    """frame → s when its force was last above `TouchThresholds.end`; −∞: it does not touch"""
    acceleration: AccelerationState
    tare: TareState | None
    """None: nobody tares"""


class WrenchTwin(Estimator[WrenchState]):
    """Passes joint signals on, turns sensor readings into contact wrenches in world axes, and says what touches."""

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
        self.robot, self.carried = robot, dict(carried or {})
        self.thresholds, self.velocity_gain = thresholds or TouchThresholds(), velocity_gain
        self.contact_frames = dict(contact_frames or {})
        self.acceleration, self.tare = acceleration or JointAcceleration(), tare
        self._model, self._data = robot.model, robot.model.createData()
        self._gravity: Array = np.array(robot.model.gravity.linear)
        self._frames = {name: robot.frame_id(name) for name in self.carried}

    def init(self, measurement: Measurement) -> WrenchState:
        frames = [self.contact_frames.get(sensor, sensor) for sensor in measurement.wrenches]
        moving = joint_acceleration.init(measurement.time, measurement.v)
        tare = None if self.tare is None else TareState(measurement.time)
        return WrenchState(measurement.v, dict.fromkeys(frames, -np.inf), moving, tare)

    def step(self, measurement: Measurement, state: WrenchState) -> tuple[Estimate, WrenchState]:
        v = state.velocity + self.velocity_gain * (measurement.v - state.velocity)
        moving = self._move(measurement, state)
        loads = self._loads(state.tare)
        unexplained = {
            sensor: self._without(loads.get(sensor), sensor, felt) for sensor, felt in measurement.wrenches.items()
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
        """Kinematics of now; velocities and accelerations only where a sensor carries something."""
        if not self.carried and self.tare is None:
            pin.framesForwardKinematics(self._model, self._data, measurement.q)
            return state.acceleration
        a, moving = joint_acceleration.step(self.acceleration, measurement.time, measurement.v, state.acceleration)
        pin.forwardKinematics(self._model, self._data, measurement.q, measurement.v, a)
        pin.updateFramePlacements(self._model, self._data)
        return moving

    def _loads(self, tare: TareState | None) -> Mapping[str, CarriedMass]:
        if tare is None or tare.found is None:
            return self.carried
        return {sensor: both(self.carried.get(sensor, CarriedMass()), found) for sensor, found in tare.found.items()}

    def _without(self, carried: CarriedMass | None, sensor: str, felt: Array) -> Array:
        """(6,) what a load does not explain of a reading (6,), both in the sensor's axes."""
        frame = self._frame(sensor)
        if carried is None:
            return felt
        local = pin.ReferenceFrame.LOCAL
        motion = pin.getFrameClassicalAcceleration(self._model, self._data, frame, local)
        spin = pin.getFrameVelocity(self._model, self._data, frame, local).angular
        gravity = self._rotation(sensor).T @ self._gravity
        return felt - reading(carried, SensorMotion(motion.linear - gravity, spin, motion.angular))

    def _at_contact(self, sensor: str, wrench: Array) -> tuple[str, Array]:
        """The frame that touches, and the wrench (6,) there in world axes, of one (6,) in the sensor's."""
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
