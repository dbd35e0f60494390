"""The momentum observer as a part: what passes through, what it refuses. Its laws are in tests/laws."""

from __future__ import annotations

import numpy as np
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
