"""Tests of MyController: python -m pytest FILE."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import pliant
from pliant.signals import Estimate, Reference, TaskReference

WHERE = f"{Path(__file__).with_name('my_controller.py')}:MyController"


def test_it_pulls_towards_its_reference_within_the_limits() -> None:
    robot = pliant.Robot.load("iiwa14")
    entry = pliant.find_controller(WHERE)
    controller = entry.build(robot, entry.default, 1e-3)  # period of control, s
    rest = np.zeros(robot.n)
    estimate = Estimate(0.0, robot.home, rest, rest, rest)
    here = robot.placement(robot.home, "flange")[0]

    def torque(offset: list[float]) -> np.ndarray:
        reference = Reference(0.0, (TaskReference("flange", here + np.array(offset)),))
        return controller.step(estimate, reference, controller.init(estimate))[0].torque

    still, pulled, far = torque([0.0, 0.0, 0.0]), torque([0.0, 0.0, 0.01]), torque([0.0, 0.0, 1e6])
    assert np.linalg.norm(pulled - still) > 0.1  # N·m
    assert np.all(np.abs(far) <= robot.torque_limit)


def test_it_runs_a_task_to_its_end() -> None:
    steps = [{"target": (0.0, 0.0, 0.25)}]  # m, of a leg's foot in the air; any study will do
    result = pliant.run("haptic", controller=WHERE, steps=steps, checks=[], duration=0.2)
    assert result.failure is None
