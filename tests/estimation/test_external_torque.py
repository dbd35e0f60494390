"""External torque and contact force from joint torques: against the simulator's truth, with baselines."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant import loop
from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import ConfigError, RobotError
from pliant.estimation import DirectEstimator, ExternalTorqueEstimator
from pliant.estimation.external_torque import contact_force
from pliant.interfaces import ReferenceSource
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, Measurement, Reference, TaskReference
from pliant.simulation import MujocoPlant, Push, Scene, Surface, table

PERIOD = 1e-3


class Sway(ReferenceSource[None]):
    """Swings the tool sideways and holds it at an offset of its height."""

    def __init__(self, robot: Robot, frame: str, amplitude: float, lower: float = 0.0, rate: float = 6.0) -> None:
        self.position, self.rotation = robot.placement(robot.home, frame)
        self.frame, self.posture = frame, robot.home
        self.amplitude, self.lower, self.rate = amplitude, lower, rate

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        moved = np.array([0.0, self.amplitude * (1.0 - np.cos(self.rate * estimate.time)), -self.lower])
        return Reference(
            estimate.time, (TaskReference(self.frame, self.position + moved, self.rotation),), self.posture
        ), None


def run(plant, estimator, source, robot, frame, ticks: int):
    seen = []
    controller = OperationalSpace(robot, frame)
    assert loop.run(plant, estimator, source, controller, range(ticks), [seen.append]).failure is None
    return seen


def test_contact_force_is_the_one_that_acts() -> None:
    robot = Robot.load("iiwa14", tool=Tool()).with_contact("tool", 0.015)
    height = robot.placement(robot.home, "tool")[0][2] - 0.015
    plant = MujocoPlant(robot, Scene((table((0.6, 0.0, height), surface=Surface(1e4, 500.0, 0.3)),)))
    estimator = ExternalTorqueEstimator(DirectEstimator(), robot, PERIOD, frame="tool", cutoff=30.0)
    ticks = run(plant, estimator, Sway(robot, "tool", 0.03, lower=0.02), robot, "tool", 700)[300:]
    true = np.array([tick.truth.wrenches["tool"][:3] for tick in ticks])
    found = np.array([tick.estimate.wrenches["tool"][:3] for tick in ticks])
    assert np.mean(true[:, 2]) > 10.0
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.02 * np.mean(true[:, 2])
    # what a force at the ball's centre cannot be: the moment of friction about it
    assert max(np.max(np.abs(tick.estimate.disturbance)) for tick in ticks) < 0.2


def test_a_push_on_the_arm_is_its_jacobian_transpose(lwr4: Robot) -> None:
    push = Push("flange", (15.0, -5.0, 10.0), 0.2, 1.0)
    plant = MujocoPlant(lwr4, pushes=[push])
    estimator = ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD)
    ticks = run(plant, estimator, Sway(lwr4, "flange", 0.0), lwr4, "flange", 700)
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    q, data = ticks[-1].truth.q, lwr4.model.createData()
    J = pin.computeFrameJacobian(lwr4.model, data, q, lwr4.frame_id("flange"), axes)[:3]
    np.testing.assert_allclose(ticks[-1].estimate.disturbance, J.T @ np.array(push.force), atol=0.05)
    assert np.max(np.abs(ticks[150].estimate.disturbance)) < 1e-2


def test_a_fast_motion_is_no_external_torque_only_if_both_sides_are_equally_late(lwr4: Robot) -> None:
    peaks = {}
    for aligned in (True, False):
        estimator = ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD, aligned=aligned)
        ticks = run(MujocoPlant(lwr4), estimator, Sway(lwr4, "flange", 0.1, rate=12.0), lwr4, "flange", 500)
        peaks[aligned] = max(np.max(np.abs(tick.estimate.disturbance)) for tick in ticks[100:])
    assert peaks[True] < 0.25 * peaks[False]  # baseline: the printed form


def test_a_direction_that_no_joint_feels_gets_no_force() -> None:
    J = np.array([[1.0, 0.5, 0.2], [0.0, 1.0, 0.3], [1e-4, 0.0, 0.0]])
    force = np.array([3.0, -2.0, 0.0])
    found = contact_force(J, J.T @ force + 1e-3)
    np.testing.assert_allclose(found, force, atol=5e-3)
    assert np.abs(np.linalg.solve(J.T, J.T @ force + 1e-3)[2]) > 5.0  # baseline: plain inversion


def test_bad_input_is_named(lwr4: Robot) -> None:
    with pytest.raises(ConfigError, match="half the sampling rate"):
        ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD, cutoff=600.0)
    with pytest.raises(RobotError, match="no frame"):
        ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD, frame="tol")
    with pytest.raises(ConfigError, match=r"3 \(force\) or 6"):
        ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD, frame="flange", dimension=1)


def test_the_first_reading_needs_no_past(lwr4: Robot) -> None:
    """An arm that stands without torque: all of its weight is external, from the first step on, without a transient."""
    zero = np.zeros(lwr4.n)
    estimator = ExternalTorqueEstimator(DirectEstimator(), lwr4, PERIOD)
    state = estimator.init(Measurement(0.0, lwr4.home, zero, zero, zero))
    seen = []
    for tick in range(5):
        estimate, state = estimator.step(Measurement(tick * PERIOD, lwr4.home, zero, zero, zero), state)
        seen.append(estimate.disturbance)
    np.testing.assert_allclose(seen, np.tile(seen[0], (5, 1)), atol=1e-9)
    assert np.max(np.abs(seen[0])) > 1.0
