"""The torque loop in the robot's drives: feed-forward plus PID on the torque error ([FFMPC] eq. 33)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.spatial import Array, clamp


class TorqueLoopConfig(Config):
    """Gains of the loop. With all gains 0 the desired torque goes straight to the motors."""

    period: float = quantity(1e-3, "s", "between two corrections", gt=0.0, le=0.1)
    gain_p: float = quantity(0.0, "1", "K_P", ge=0.0, le=100.0)
    gain_i: float = quantity(0.0, "1/s", "K_I; a gain of 0.01 per sample of 1 ms is 10 /s", ge=0.0, le=1e4)
    gain_d: float = quantity(0.0, "s", "K_D, on the rate of the measured torque", ge=0.0, le=1.0)


@dataclass(frozen=True, slots=True)
class TorqueLoopState:
    """What the loop remembers."""

    error_integral: Array
    """(n,) N·m s, measured minus desired"""
    measured_before: Array
    """(n,) N·m"""


class TorqueLoop:
    """`τ_m = τ_d − K_P (τ̂ − τ_d) − K_I ∫(τ̂ − τ_d) − K_D dτ̂/dt`.

    The printed equation has τ̂ in its last term where its rate is meant. Where the motor cannot give more, the
    integral waits, so that it does not wind up.

    Args:
        config: gains and period.
        limit: (n,) largest motor torque, N·m; infinite where there is none.
    """

    def __init__(self, config: TorqueLoopConfig, limit: Array) -> None:
        self.config = config
        self._limit = limit

    def init(self, measured: Array) -> TorqueLoopState:
        """State before the first step. Args: measured torque (n,), N·m."""
        return TorqueLoopState(np.zeros_like(measured), measured)

    def step(self, desired: Array, measured: Array, state: TorqueLoopState) -> tuple[Array, TorqueLoopState]:
        """The motor torque (n,), N·m, within the limit, and the next state.

        Args:
            desired: (n,) N·m.
            measured: (n,) what the torque sensors say, N·m.
            state: of the step before.
        """
        gains, dt = self.config, self.config.period
        error = measured - desired
        integral = state.error_integral + dt * error
        rate = (measured - state.measured_before) / dt
        motor = desired - gains.gain_p * error - gains.gain_i * integral - gains.gain_d * rate
        within = clamp(motor, -self._limit, self._limit)
        winding_up = (motor - within) * error < 0.0  # the integral would push further beyond the limit
        integral = np.where(winding_up, state.error_integral, integral)
        return within, TorqueLoopState(integral, measured)
