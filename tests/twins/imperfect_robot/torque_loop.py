"""The torque loop in Python: the twin of cpp/plant/imperfect_robot.cpp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig
from pliant.spatial import Array, clamp


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
