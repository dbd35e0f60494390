"""The momentum observer as a part: what passes through, what it refuses. Its laws are in tests/laws."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, RobotError, SignalError
from pliant.estimation import DirectEstimator, MomentumObserver
from pliant.robot import Robot
from pliant.signals import Measurement


def at(robot: Robot, time: float) -> Measurement:
    zero = np.zeros(robot.n)
    return Measurement(time, robot.home, zero, zero, zero)


def test_a_state_can_be_stepped_twice(lwr4: Robot) -> None:
    """State goes in and comes out: the same state and measurement give the same estimate."""
    observer = MomentumObserver(DirectEstimator(), lwr4)
    state = observer.init(at(lwr4, 0.0))
    first, _ = observer.step(at(lwr4, 0.001), state)
    second, _ = observer.step(at(lwr4, 0.001), state)
    assert np.any(first.disturbance != 0.0)  # nothing holds the arm, and yet it stands
    np.testing.assert_array_equal(first.disturbance, second.disturbance)


def test_compensated_gravity_is_explained(lwr4: Robot) -> None:
    """An arm that stands without any torque is explained by its own gravity compensation, not by a disturbance."""
    found = {}
    for compensation in ("none", "gravity", "gravity+coriolis"):
        observer = MomentumObserver(DirectEstimator(), lwr4, compensation=compensation)
        state = observer.init(at(lwr4, 0.0))
        for tick in range(300):
            estimate, state = observer.step(at(lwr4, tick * 1e-3), state)
        found[compensation] = np.max(np.abs(estimate.disturbance))
    assert found["gravity"] < 1e-12
    assert found["gravity+coriolis"] < 1e-12
    assert found["none"] > 1.0


def test_bad_input_is_named(lwr4: Robot) -> None:
    inner = DirectEstimator()
    with pytest.raises(ConfigError, match="gain"):
        MomentumObserver(inner, lwr4, gain=0.0)
    with pytest.raises(ConfigError, match="did you mean 'normal'"):
        MomentumObserver(inner, lwr4, contact="norma")
    with pytest.raises(ConfigError, match="normal must have a length"):
        MomentumObserver(inner, lwr4, normal=(0, 0, 0))
    with pytest.raises(RobotError, match="no frame 'tol'"):
        MomentumObserver(inner, lwr4, frames=["tol"])
    observer = MomentumObserver(inner, lwr4)
    with pytest.raises(SignalError, match="in order"):
        observer.step(at(lwr4, 0.0), observer.init(at(lwr4, 1.0)))


@pytest.mark.parametrize("compensation", ["none", "gravity", "gravity+coriolis"])
def test_one_step_is_the_equation_with_the_mean_of_both_ends(lwr4: Robot, compensation: str) -> None:
    """d = Δp/T − τ − (β₀ + β₁)/2 within 1 − exp(−gain T), written out from the model, at two states far apart."""
    period, gain = 2e-3, 40.0
    q = [lwr4.home, lwr4.home + np.linspace(0.1, -0.2, 7)]
    v = [np.linspace(-0.5, 0.8, 7), np.linspace(0.9, -0.4, 7)]
    torque = np.linspace(3.0, -5.0, 7)
    model = lwr4.model

    def momentum_and_bias(q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        data = model.createData()
        upper = np.triu(pin.crba(model, data, q))
        C = np.array(pin.computeCoriolisMatrix(model, data, q, v))
        gravity = np.array(pin.computeGeneralizedGravity(model, data, q))
        bias = C.T @ v
        if compensation == "none":
            bias = bias - gravity
        elif compensation == "gravity+coriolis":
            bias = bias + C @ v
        return (upper + np.triu(upper, 1).T) @ v, bias

    observer = MomentumObserver(DirectEstimator(), lwr4, gain=gain, compensation=compensation)
    seen = [Measurement(period * i, q[i], v[i], np.zeros(7), torque) for i in range(2)]
    state = observer.init(seen[0])
    _, state = observer.step(seen[0], state)
    found, _ = observer.step(seen[1], state)
    (p_0, b_0), (p_1, b_1) = (momentum_and_bias(q[i], v[i]) for i in range(2))
    unexplained = (p_1 - p_0) / period - torque - 0.5 * (b_0 + b_1)
    np.testing.assert_allclose(found.disturbance, (1.0 - np.exp(-gain * period)) * unexplained, rtol=1e-9)
