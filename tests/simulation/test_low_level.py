"""The drives' torque loop: equation (33) of [FFMPC] at a point, what it removes, and what the limit does to it."""

from __future__ import annotations

import numpy as np

from pliant.signals import Measurement
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig
from tests.simulation.scripted import Scripted, moving, readings

DT = 1e-3  # s


def motor_torques(config: Imperfections, desired: list[np.ndarray], measured: list[np.ndarray]) -> np.ndarray:
    """(k, n) what the drives ask of the motors, when the torque sensors say `measured` before each correction."""
    n = measured[0].size

    def script(tick: int, torque: np.ndarray) -> Measurement:
        felt = measured[min(tick, len(measured) - 1)]
        return Measurement(DT * tick, np.zeros(n), np.zeros(n), felt, felt, {})

    plant = Scripted(script, n)
    readings(config, plant, desired)
    return np.array(plant.received)


def test_the_equation_holds_at_a_point_where_every_term_counts() -> None:
    config = Imperfections(torque_loop=TorqueLoopConfig(gain_p=0.7, gain_i=10.0, gain_d=1e-3))
    said = [np.array([1.0, -2.0]), np.array([1.5, -1.0]), np.array([2.5, 0.0])]
    wanted = [np.array([1.0, -2.0]), np.array([3.0, 1.0]), np.array([4.0, 0.5])]
    motor = motor_torques(config, wanted, said)[-1]
    error = np.array([2.5 - 4.0, 0.0 - 0.5])
    integral = DT * (error + np.array([1.5 - 3.0, -1.0 - 1.0]))
    rate = np.array([2.5 - 1.5, 0.0 + 1.0]) / DT
    expected = np.array([4.0, 0.5]) - 0.7 * error - 10.0 * integral - 1e-3 * rate
    assert np.allclose(motor, expected, rtol=1e-13)


def test_without_gains_it_is_plain_feed_forward() -> None:
    motor = motor_torques(Imperfections(), [np.array([4.0, 0.5])], [np.zeros(2), np.array([100.0, -3.0])])
    assert np.array_equal(motor[-1], [4.0, 0.5])


def settled_torque_error(loop: TorqueLoopConfig, seconds: float) -> float:
    """Largest |τ̂ − τ_d| at the end, with gain 0.8…1.2 and bias ±2 N·m."""
    config = Imperfections(torque_loop=loop, actuation=ActuationConfig(gain=(0.8, 1.2), bias=(-2.0, 2.0)))
    desired = np.array([20.0, -30.0, 15.0, 5.0, -2.0, 1.0])
    log = readings(config, moving(6, np.zeros(6)), [desired] * round(seconds / DT), seed=5)
    return float(np.abs(log[-1].torque - desired).max())


def test_the_integral_removes_bias_and_gain_error_and_without_the_loop_they_stay() -> None:
    with_pid = settled_torque_error(TorqueLoopConfig(gain_p=0.7, gain_i=10.0, gain_d=1e-5), 5.0)
    without = settled_torque_error(TorqueLoopConfig(), 5.0)
    assert with_pid < 1e-6
    assert without > 1.0


def test_a_saturated_motor_does_not_wind_the_integral_up() -> None:
    loop = TorqueLoopConfig(gain_p=0.1, gain_i=10.0)
    strong = Imperfections(torque_loop=loop)
    weak = Imperfections(torque_loop=loop, actuation=ActuationConfig(peak_torque=10.0))
    long = 5000  # corrections in which the sensors say 5 N·m less than is asked
    said = [np.array([10.0])] * (long + 1) + [np.array([5.0])]
    wanted = [np.array([15.0])] * long + [np.array([5.0])] * 2
    limited = motor_torques(weak, wanted, said)
    assert (limited[1:long] == 10.0).all()
    assert abs(limited[-1, 0] - 5.0) < 0.25  # one sample's worth of integral, not five seconds'
    assert motor_torques(strong, wanted, said)[-1, 0] > 100.0  # baseline: without a limit it winds up
