"""The drives' torque loop: equation (33) of [FFMPC] at a point, what it removes, and what the limit does to it."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.simulation.imperfections.actuation import Actuation, ActuationConfig
from pliant.simulation.imperfections.torque_loop import TorqueLoop, TorqueLoopConfig

DT = 1e-3  # s
NO_LIMIT = np.full(2, np.inf)


def test_the_equation_holds_at_a_point_where_every_term_counts() -> None:
    loop = TorqueLoop(TorqueLoopConfig(gain_p=0.7, gain_i=10.0, gain_d=1e-3), NO_LIMIT)
    state = loop.init(np.array([1.0, -2.0]))
    _, state = loop.step(np.array([3.0, 1.0]), np.array([1.5, -1.0]), state)
    motor, _ = loop.step(np.array([4.0, 0.5]), np.array([2.5, 0.0]), state)
    error = np.array([2.5 - 4.0, 0.0 - 0.5])
    integral = DT * (error + np.array([1.5 - 3.0, -1.0 - 1.0]))
    rate = np.array([2.5 - 1.5, 0.0 + 1.0]) / DT
    expected = np.array([4.0, 0.5]) - 0.7 * error - 10.0 * integral - 1e-3 * rate
    assert np.allclose(motor, expected, rtol=1e-13)


def test_without_gains_it_is_plain_feed_forward() -> None:
    loop = TorqueLoop(TorqueLoopConfig(), NO_LIMIT)
    motor, _ = loop.step(np.array([4.0, 0.5]), np.array([100.0, -3.0]), loop.init(np.zeros(2)))
    assert np.array_equal(motor, [4.0, 0.5])


def settled_torque_error(loop_config: TorqueLoopConfig, seconds: float) -> float:
    """Largest |τ̂ − τ_d| at the end, with gain 0.8…1.2 and bias ±2 N·m."""
    actuation = Actuation(ActuationConfig(gain=(0.8, 1.2), bias=(-2.0, 2.0)), DT, 6)
    loop = TorqueLoop(loop_config, actuation.limit)
    desired = np.array([20.0, -30.0, 15.0, 5.0, -2.0, 1.0])
    actuator = actuation.init(np.zeros(6), seed=5)
    measured = np.zeros(6)
    state = loop.init(measured)
    for _ in range(round(seconds / DT)):
        motor, state = loop.step(desired, measured, state)
        measured, actuator = actuation.step(motor, np.zeros(6), actuator)
    return float(np.abs(measured - desired).max())


def test_the_integral_removes_bias_and_gain_error_and_without_the_loop_they_stay() -> None:
    with_pid = settled_torque_error(TorqueLoopConfig(gain_p=0.7, gain_i=10.0, gain_d=1e-5), 5.0)
    without = settled_torque_error(TorqueLoopConfig(), 5.0)
    assert with_pid < 1e-6
    assert without > 1.0


def test_a_saturated_motor_does_not_wind_the_integral_up() -> None:
    limit = np.array([10.0])
    loop = TorqueLoop(TorqueLoopConfig(gain_p=0.1, gain_i=10.0), limit)
    state = loop.init(np.zeros(1))
    for _ in range(5000):  # 30 N·m are asked of a motor that can give 10
        motor, state = loop.step(np.array([30.0]), np.array([10.0]), state)
        assert motor[0] == 10.0
    motor, state = loop.step(np.array([5.0]), np.array([5.0]), state)
    assert motor[0] == pytest.approx(5.0 + 10.0 * -state.error_integral[0])
    assert abs(motor[0] - 5.0) < 0.25  # one sample's worth of integral, not five seconds'
