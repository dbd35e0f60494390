"""Each moment of a task stays within its F_max at any angle, near π too, and stays conjugate to the rotation."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.controllers import FrameTask, Law, Stack
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import exp3
from tests.rotations import left_jacobian_inverse


def largest_share(robot: Robot, law: Law, trials: int) -> tuple[float, float]:
    """Largest |m_i|/F_max,i over random errors and gains, and the largest |m − J_l⁻¹ h| in N·m."""
    rng = np.random.default_rng(4)
    position, rotation = robot.placement(robot.home, "flange")
    zero = np.zeros(robot.n)
    worst = off = 0.0
    for _ in range(trials):
        bound = 10.0 ** rng.uniform(0.5, 2.0, 3)
        stiffness = bound * rng.uniform(0.5, 20.0, 3)
        linear, angular = np.full(3, 100.0), bound
        tuning = ImpedanceTuning(
            np.concatenate([np.full(3, 1000.0), stiffness]),
            np.concatenate([linear, angular]),
            np.concatenate([np.full(3, 0.1), rng.uniform(0.1, 2.0, 3)]),
        )
        stack = Stack(robot, [FrameTask("flange", tuning, "ee")], 1e-3, law=law)
        axis = rng.standard_normal(3)
        angle = rng.choice([rng.uniform(0.0, np.pi), np.pi - 10.0 ** rng.uniform(-9, -1)])
        target = exp3(angle * axis / np.linalg.norm(axis)) @ rotation
        estimate = Estimate(0.0, robot.home, zero, zero, zero)
        reference = Reference(0.0, (TaskReference("flange", position, target),))
        command, _ = stack.step(estimate, reference, stack.init(estimate))
        moment = np.asarray(command.diagnostics["ee/wrench"])[3:]
        error, h = (np.asarray(command.diagnostics[f"ee/{name}"])[3:] for name in ("error", "force"))
        worst = max(worst, float(np.max(np.abs(moment) / bound)))
        off = max(off, float(np.abs(moment - left_jacobian_inverse(error) @ h).max()))
    return worst, off


def test_no_moment_exceeds_its_bound(lwr4: Robot) -> None:
    worst, off = largest_share(lwr4, Law.CAPPED, 300)
    assert worst <= 1.0 + 1e-12
    assert off < 1e-6


def test_without_the_bound_moments_are_up_to_several_times_as_large(lwr4: Robot) -> None:
    """Baseline: the same profiles where nothing shrinks the vector."""
    worst, _ = largest_share(lwr4, Law.SPRING, 300)
    assert worst > 2.0


@pytest.mark.parametrize("angle", [0.1, 1.0])
def test_equal_gains_about_the_axis_of_the_error_are_not_touched(lwr4: Robot, angle: float) -> None:
    tuning = ImpedanceTuning(np.full(6, 100.0), np.full(6, 50.0), np.full(6, 1.0))
    stack = Stack(lwr4, [FrameTask("flange", tuning, "ee")], 1e-3)
    position, rotation = lwr4.placement(lwr4.home, "flange")
    zero = np.zeros(lwr4.n)
    estimate = Estimate(0.0, lwr4.home, zero, zero, zero)
    reference = Reference(0.0, (TaskReference("flange", position, exp3([0.0, 0.0, angle]) @ rotation),))
    command, _ = stack.step(estimate, reference, stack.init(estimate))
    assert command.diagnostics["ee/moment_scale"] == 1.0
