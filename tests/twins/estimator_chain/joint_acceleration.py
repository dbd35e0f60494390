"""Joint accelerations out of joint velocities."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pliant.estimation.joint_acceleration import JointAcceleration
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class AccelerationState:
    """State of the filter."""

    time: float
    """s of the last sample"""
    first: Array
    """(n,) v after the first stage, rad/s"""
    second: Array
    """(n,) v after the second stage, rad/s"""


def init(time: float, v: Array) -> AccelerationState:
    """State of a robot that has moved with v (n,) for ever; time in s."""
    return AccelerationState(time, v, v)


def step(how: JointAcceleration, time: float, v: Array, state: AccelerationState) -> tuple[Array, AccelerationState]:
    """Acceleration (n,), rad/s², zero as long as no time has passed, and the next state."""
    period = time - state.time
    if period <= 0.0:
        return np.zeros_like(v), state
    gain = -math.expm1(-2.0 * math.pi * how.cutoff * period)
    first = state.first + gain * (v - state.first)
    second = state.second + gain * (first - state.second)
    return (second - state.second) / period, AccelerationState(time, first, second)
