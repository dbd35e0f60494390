"""Delay prediction: what it says about 5 ms ahead against what the simulator does, in free space and in contact."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import loop
from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import ConfigError, RobotError, ShapeError
from pliant.estimation import DelayPredictor, MomentumObserver, SoftContact, WrenchEstimator
from pliant.interfaces import ReferenceSource
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, Reference, TaskReference
from pliant.simulation import ForceSensor, JointEffects, MujocoPlant, Scene, Surface, table

PERIOD, DELAY = 1e-3, 5  # s, periods


class Pump(ReferenceSource[None]):
    """Moves the tool up and down about `lower` below its height at home."""

    def __init__(self, robot: Robot, lower: float) -> None:
        self.position, self.rotation = robot.placement(robot.home, "tool")
        self.posture, self.lower = robot.home, lower

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        depth = self.lower + 0.01 * np.sin(25.0 * estimate.time)
        task = TaskReference("tool", self.position - [0.0, 0.0, depth], self.rotation)
        return Reference(estimate.time, (task,), self.posture), None


def errors(lower: float, contact: SoftContact | None, damping: float = 0.0, friction: float = 0.0):
    """Rms error of v (rad/s) and of the normal force (N) 5 ms ahead: predicted, and with the present taken for it."""
    robot = Robot.load("iiwa14", locked={"A7": 0.0}, tool=Tool()).with_contact("tool", 0.015)
    height = robot.placement(robot.home, "tool")[0][2] - 0.015
    scene = Scene((table((0.6, 0.0, height), surface=Surface(1e4, 300.0, friction)),))
    plant = MujocoPlant(robot, scene, sensors=[ForceSensor("tool")], joints=JointEffects(damping=damping))
    estimator = MomentumObserver(WrenchEstimator(robot), robot, gain=60.0)
    ticks = []
    loop.run(plant, estimator, Pump(robot, lower), OperationalSpace(robot, "tool"), range(500), [ticks.append])
    predictor, rows = DelayPredictor(robot, contact), []
    for k in range(250, 490, 3):
        then, now = ticks[k + DELAY].estimate, ticks[k].estimate
        guess = predictor.predict(now, [tick.command.torque for tick in ticks[k : k + DELAY]], PERIOD)
        assert guess.time == pytest.approx(then.time)
        force = [e.wrenches["tool"][2] for e in (guess, now, then)]
        v = [np.linalg.norm(e.v - then.v) for e in (guess, now)]
        rows.append([v[0], v[1], force[0] - force[2], force[1] - force[2]])
    return np.sqrt(np.mean(np.square(rows), axis=0))


def test_free_space_is_predicted() -> None:
    v, v_stale, *_ = errors(-0.05, None)
    assert v < 0.01 * v_stale  # control arm: no prediction
    v_damped, v_stale, *_ = errors(-0.05, None, damping=0.5)
    assert v < v_damped < 0.35 * v_stale  # the observed disturbance lags


def test_contact_is_predicted() -> None:
    v, v_stale, force, force_stale = errors(0.02, SoftContact("tool", 1e4, 300.0))
    assert force < 0.15 * force_stale
    assert v < 0.05 * v_stale
    *_, softer, _ = errors(0.02, SoftContact("tool", 3e3, 300.0))
    assert softer > 3.0 * force  # control arm: another stiffness


def test_contact_needs_its_model() -> None:
    """Control arm: without the soft contact the force stays where it was."""
    *_, force, force_stale = errors(0.02, None)
    assert force == pytest.approx(force_stale)


def test_nothing_under_way_changes_nothing(lwr4: Robot) -> None:
    zero = np.zeros(lwr4.n)
    estimate = Estimate(0.0, lwr4.home, zero, zero, zero)
    assert DelayPredictor(lwr4).predict(estimate, [], PERIOD) is estimate


def test_bad_input_is_named(lwr4: Robot) -> None:
    with pytest.raises(RobotError, match="no frame"):
        DelayPredictor(lwr4, SoftContact("tol", 1e4, 1e2))
    with pytest.raises(ConfigError, match="stiffness > 0"):
        DelayPredictor(lwr4, SoftContact("flange", 0.0, 1e2))
    with pytest.raises(ConfigError, match="step"):
        DelayPredictor(lwr4, step=0.0)
    zero = np.zeros(lwr4.n)
    with pytest.raises(ShapeError, match="under way"):
        DelayPredictor(lwr4).predict(Estimate(0.0, lwr4.home, zero, zero, zero), [np.zeros(2)], PERIOD)
