"""The torque loop in the robot's drives: feed-forward plus PID on the torque error ([FFMPC] eq. 33;
cpp/plant/imperfect_robot.cpp).

    τ_m = τ_d − K_P (τ̂ − τ_d) − K_I ∫(τ̂ − τ_d) − K_D dτ̂/dt

The printed equation has τ̂ in its last term where its rate is meant. When the motor is saturated, the integral is held
(anti-windup).
"""

from __future__ import annotations

from pliant.configuration import Config
from pliant.quantity import quantity


class TorqueLoopConfig(Config):
    """Gains of the loop. With all gains 0 the desired torque goes straight to the motors."""

    period: float = quantity(1e-3, "s", "between two corrections", gt=0.0, le=0.1)
    gain_p: float = quantity(0.0, "1", "K_P", ge=0.0, le=100.0)
    gain_i: float = quantity(0.0, "1/s", "K_I; a gain of 0.01 per sample of 1 ms is 10 /s", ge=0.0, le=1e4)
    gain_d: float = quantity(0.0, "s", "K_D, on the rate of the measured torque", ge=0.0, le=1.0)
