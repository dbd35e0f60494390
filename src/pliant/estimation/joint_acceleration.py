"""Joint accelerations from joint velocities."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError
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


@dataclass(frozen=True)
class JointAcceleration:
    """Differences of v after two equal first-order stages.

    Its error, for a sampling period T and α = 1 − e^{−2π f_c T}: it is delayed by 2 T (1 − α)/α + T/2, so the relative
    error of an oscillation of ω rad/s is ω times that, 0.8 % at 1 Hz with 200 Hz and 1 ms; white noise σ_v on v becomes
    σ_v √(2 α³/(2 − α)³) / T on the acceleration, 0.6 rad/s² for 1e-3 rad/s. If the inertial force of a heavy tool is
    compensated too late, a force controller oscillates: lower the cutoff only as far as the noise of v requires.

    Raises:
        ConfigError: on construction, when the cutoff is not above zero.
    """

    cutoff: float = 200.0
    """f_c of each stage, Hz"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.cutoff) and self.cutoff > 0.0):
            raise ConfigError(f"the cutoff of joint accelerations must be above 0 Hz, got {self.cutoff} Hz")

    def init(self, time: float, v: Array) -> AccelerationState:
        """State of a robot that has moved with constant v (n,); time in s."""
        return AccelerationState(time, v, v)

    def step(self, time: float, v: Array, state: AccelerationState) -> tuple[Array, AccelerationState]:
        """Acceleration (n,), rad/s², zero as long as no time has passed, and the next state.

        Args:
            time: of the sample, s.
            v: (n,) rad/s.
            state: of the sample before.
        """
        period = time - state.time
        if period <= 0.0:
            return np.zeros_like(v), state
        gain = -math.expm1(-2.0 * math.pi * self.cutoff * period)
        first = state.first + gain * (v - state.first)
        second = state.second + gain * (first - state.second)
        return (second - state.second) / period, AccelerationState(time, first, second)
