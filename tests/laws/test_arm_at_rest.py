"""A redundant arm with nothing that damps it, against its own weight: the attractors alone bring it to rest."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers import Law
from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.registry import build_stack
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array

PERIOD = 1e-3


def joint_speeds(robot: Robot, law: Law, seconds: float, seed: int) -> Array:
    """(ticks, n) rad/s after a start 0.1 rad away from home; gravity acts, two substeps per period."""
    stack = build_stack(robot, STIFF_STACK.model_copy(update={"law": law}), PERIOD)
    position, rotation = robot.placement(robot.home, "flange")
    elbow, _ = robot.placement(robot.home, "elbow")
    reference = Reference(0.0, (TaskReference("flange", position, rotation), TaskReference("elbow", elbow)))
    data, zero = robot.model.createData(), np.zeros(robot.n)
    q, v = robot.home + 0.1 * np.random.default_rng(seed).standard_normal(robot.n), zero
    state, speeds = stack.init(Estimate(0.0, q, v, zero, zero)), []
    for tick in range(round(seconds / PERIOD)):
        command, state = stack.step(Estimate(tick * PERIOD, q, v, zero, zero), reference, state)
        for _ in range(2):
            v = v + pin.aba(robot.model, data, q, v, command.torque) * PERIOD / 2
            q = q + v * PERIOD / 2
        speeds.append(v)
    return np.array(speeds)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_arm_comes_to_rest_and_stays(lwr4: Robot, seed: int) -> None:
    speeds = np.abs(joint_speeds(lwr4, Law.CAPPED, 4.0, seed)).max(axis=1)
    assert speeds[:500].max() > 0.5
    assert speeds[-2000:].max() < 0.02


def test_plain_springs_run_away(lwr4: Robot) -> None:
    """Baseline."""
    speeds = np.abs(joint_speeds(lwr4, Law.SPRING, 4.0, 0)).max(axis=1)
    assert speeds[-1000:].max() > 10.0
    assert speeds[-1000:].max() > 2.0 * speeds[:1000].max()
