"""Gains of the estimators that follow from the noise that is assumed of the sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pliant.estimation.momentum_observer import GAIN
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.rules import Rule, Suggestion

_USUAL = 1e-3  # rad and rad/s; [FFMPC] sec. VI-B
_MEMORY = 0.3  # s, with that noise
_LONGEST = 3.0  # s
_DEPTH = 2.3e-5  # m, of the depth after the joint state filter, with that noise and memory
_FEW = 4.0  # standard deviations
_LEAST_FORCE = 0.1  # N
_SHARE = 0.01  # of a torque limit

_OF_MEMORY = Rule(
    "estimation.joint_memory",
    "0.3 noise_position / noise_velocity, 3 s at most, where the controller needs positions without noise",
    "the stationary Kalman filter's is noise_position / noise_velocity; a third of it, since a bias of v adds up",
)
_OF_OBSERVER = Rule(
    "estimation.observer_gain",
    "30 rad/s, less where its noise k M noise_velocity would exceed 1 % of a joint's torque limit at home",
    "De Luca et al., IROS 2006; ten times slower than usual drives",
)
RULES = (_OF_MEMORY, _OF_OBSERVER)


@dataclass(frozen=True)
class Noise:
    """Standard deviations of white noise of the sensors."""

    position: float = _USUAL
    """rad, of the joint positions"""
    velocity: float = _USUAL
    """rad/s, of the joint velocities"""
    force: float = 0.01
    """N, of the force sensor"""

    def joint_memory(self) -> float:
        """s, of the joint state filter; 0 where positions have no noise."""
        if self.position == 0.0:
            return 0.0
        return _LONGEST if self.velocity == 0.0 else min(_MEMORY * (self.position / self.velocity), _LONGEST)

    def observer_gain(self, robot: Robot) -> float:
        """rad/s, of the momentum observer."""
        M = np.diag(mass_matrix(robot.model, robot.model.createData(), robot.home))
        heard = M * self.velocity
        limits = robot.torque_limit[heard > 0.0] / heard[heard > 0.0]
        return float(min(GAIN, _SHARE * np.min(limits, initial=np.inf)))

    def least_force(self, cutoff: float, period: float) -> float:
        """N: change of the force that counts, after a Butterworth filter. Args: cutoff: Hz; period: s."""
        passed = min(1.0, 2.22 * cutoff * period)  # share of the variance: noise bandwidth 1.11 f_c
        return max(_LEAST_FORCE, _FEW * self.force * math.sqrt(passed))

    def depth(self, memory: float) -> float:
        """m: noise of a depth whose joint positions were filtered. Args: memory: s, of that filter."""
        shorter = math.sqrt(_MEMORY / memory) if memory > 0.0 else math.inf
        return min(_DEPTH * shorter, 0.5 * _USUAL) * (self.position / _USUAL)


def suited_to_noise(noise: Noise, robot: Robot) -> dict[str, Suggestion]:
    """Key → gain of an estimator that suits the noise and the robot."""
    values = {_OF_MEMORY: (noise.joint_memory(), "s"), _OF_OBSERVER: (noise.observer_gain(robot), "rad/s")}
    return {rule.keys: Suggestion(value, unit, rule) for rule, (value, unit) in values.items()}
