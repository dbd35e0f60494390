"""Contact wrenches: readings turned to world axes, the tool's weight taken out, contact with hysteresis."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, RobotError
from pliant.estimation import Butterworth, CarriedMass, FilteredEstimator, TouchThresholds, WrenchEstimator
from pliant.robot import Robot
from pliant.signals import Measurement

PERIOD = 1e-3


def measurement(robot: Robot, q, reading, tick: int = 0) -> Measurement:
    zero = np.zeros(robot.n)
    return Measurement(tick * PERIOD, np.asarray(q, float), zero, zero, zero, {"flange": np.asarray(reading, float)})


def last(estimator, measurements):
    state = estimator.init(measurements[0])
    for m in measurements:
        estimate, state = estimator.step(m, state)
    return estimate


def test_contact_wrench_survives_rotation_and_weight(lwr4: Robot) -> None:
    random = np.random.default_rng(0)
    mass, center = 0.7, np.array([0.02, -0.01, 0.09])
    estimator = WrenchEstimator(lwr4, {"flange": CarriedMass(mass, tuple(center))})
    bare = WrenchEstimator(lwr4)
    for _ in range(10):
        q = random.uniform(lwr4.position_lower, lwr4.position_upper)
        contact = random.normal(size=6) * 10.0
        R = lwr4.placement(q, "flange")[1]
        weight = R.T @ np.array([0.0, 0.0, -9.81 * mass])
        reading = np.concatenate([R.T @ contact[:3] + weight, R.T @ contact[3:] + np.cross(center, weight)])
        m = measurement(lwr4, q, reading)
        np.testing.assert_allclose(last(estimator, [m]).wrenches["flange"], contact, atol=1e-9)
        error = np.linalg.norm(last(bare, [m]).wrenches["flange"][:3] - contact[:3])
        assert error == pytest.approx(9.81 * mass, rel=1e-9)  # baseline: nothing compensated


def test_weight_is_that_of_pinocchio(lwr4: Robot) -> None:
    """The compensation of a carried mass equals the change in pinocchio's gravity torque."""
    mass, center = 1.3, np.array([0.0, 0.03, 0.1])
    q = np.array(lwr4.home)
    estimator = WrenchEstimator(lwr4, {"flange": CarriedMass(mass, tuple(center))})
    compensation = -last(estimator, [measurement(lwr4, q, np.zeros(6))]).wrenches["flange"]
    heavier, frame = lwr4.model.copy(), lwr4.frame_id("flange")
    carrier = lwr4.model.frames[frame]
    heavier.appendBodyToJoint(carrier.parentJoint, pin.Inertia(mass, center, np.zeros((3, 3))), carrier.placement)
    J = pin.computeFrameJacobian(lwr4.model, lwr4.model.createData(), q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    gravity = [pin.computeGeneralizedGravity(model, model.createData(), q) for model in (heavier, lwr4.model)]
    np.testing.assert_allclose(J.T @ compensation, gravity[1] - gravity[0], atol=1e-9)


def test_contact_has_hysteresis_and_lingers(lwr4: Robot) -> None:
    estimator = WrenchEstimator(lwr4, thresholds=TouchThresholds(1.0, 0.5, 5e-3))
    forces = [0.8] * 5 + [1.2] + [0.7] * 30 + [0.3] * 3 + [0.7] * 3 + [0.3] * 12 + [0.8] * 3
    state, seen = None, []
    for tick, force in enumerate(forces):
        m = measurement(lwr4, lwr4.home, [0, 0, force, 0, 0, 0], tick)
        state = estimator.init(m) if state is None else state
        estimate, state = estimator.step(m, state)
        seen.append(estimate.contacts["flange"])
    assert not any(seen[:5])
    assert all(seen[5:42])  # 0.7 N keeps it, and 3 ms below 0.5 N too
    assert not any(seen[-6:])  # 0.8 N does not begin it again


def test_butterworth_takes_ripple_out_of_a_wrench(lwr4: Robot) -> None:
    def spread(estimator) -> float:
        t = np.arange(600)
        forces = 20.0 + 3.0 * np.sin(2 * np.pi * 35.0 * t * PERIOD)
        state, out = None, []
        for tick, force in zip(t, forces, strict=True):
            m = measurement(lwr4, lwr4.home, [0, 0, force, 0, 0, 0], int(tick))
            state = estimator.init(m) if state is None else state
            estimate, state = estimator.step(m, state)
            out.append(np.linalg.norm(estimate.wrenches["flange"][:3]))
        return float(np.std(out[300:]))

    plain = WrenchEstimator(lwr4)
    assert spread(plain) == pytest.approx(3.0 / np.sqrt(2), rel=0.01)
    assert spread(FilteredEstimator(plain, wrench=Butterworth(8.0, PERIOD))) < 0.15


def test_bad_input_is_named(lwr4: Robot) -> None:
    with pytest.raises(RobotError, match="no frame 'flang'"):
        WrenchEstimator(lwr4, {"flang": CarriedMass(1.0)})
    with pytest.raises(ConfigError, match="velocity_gain"):
        WrenchEstimator(lwr4, velocity_gain=0.0)
    with pytest.raises(ConfigError, match="end <= begin"):
        TouchThresholds(0.5, 1.0)
