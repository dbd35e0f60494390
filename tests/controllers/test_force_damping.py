"""Damping along the force that is asked for: it takes energy, and nothing across; a late loop is suggested one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers import FrameTask, Stack
from pliant.entries import Believed
from pliant.errors import ConfigError
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.wiring.recipes import RECIPES

DAMPING = 150.0  # N·s/m


def damped(robot: Robot, v: np.ndarray, force: tuple[float, ...], damping: float = DAMPING) -> np.ndarray:
    """Torque at the target, (n,), where nothing but the damping acts."""
    position, _ = robot.placement(robot.home, "tool")
    tuning = ImpedanceTuning(np.full(3, 2500.0), np.full(3, 100.0), np.full(3, 0.06))
    stack = Stack(robot, [FrameTask("tool", tuning, label="ee")], 1e-3, force_damping=damping)
    zero = np.zeros(robot.n)
    estimate = Estimate(0.0, robot.home, v, zero, zero)
    task = TaskReference("tool", position, None, np.zeros(6), np.zeros(6), np.array([*force, 0.0, 0.0, 0.0]))
    return stack.step(estimate, Reference(0.0, (task,)), stack.init(estimate))[0].torque


def test_it_takes_the_power_of_a_damper_along_the_force_and_none_across() -> None:
    robot = Robot.load("panda", tool=Tool())
    J = pin.computeFrameJacobian(
        robot.model, robot.model.createData(), robot.home, robot.frame_id("tool"), pin.LOCAL_WORLD_ALIGNED
    )[:3]
    way = np.array([0.6, 0.0, 0.8])
    rng = np.random.default_rng(0)
    for _ in range(20):
        v = 0.1 * rng.normal(size=robot.n)
        power = float(damped(robot, v, tuple(20.0 * way)) @ v)
        assert power == pytest.approx(-DAMPING * (way @ J @ v) ** 2, rel=1e-9)
        across = v - np.linalg.pinv((way @ J)[None])[:, 0] * (way @ J @ v)
        assert np.abs(damped(robot, across, tuple(20.0 * way))).max() < 1e-9
        assert not damped(robot, v, (0.0, 0.0, 0.0)).any()
        assert not damped(robot, v, tuple(way), damping=0.0).any()


def test_what_no_damper_has_is_refused() -> None:
    robot = Robot.load("panda", tool=Tool())
    for value in (-1.0, np.inf, np.nan):
        with pytest.raises(ConfigError, match="force_damping"):
            damped(robot, np.zeros(robot.n), (0.0, 0.0, 1.0), damping=value)


@pytest.mark.parametrize("name", ["iiwa14", "panda", "ur5e"])
def test_a_late_loop_damps_its_contacts_with_what_it_bears(name: str) -> None:
    entry, robot = RECIPES["haptic"], Robot.load(name, tool=Tool())

    def suggested(late: float, arm: Robot = robot) -> float:
        believed = Believed(("tool",), 1e-3, presses="tool", computation_delay=late - 1e-3)
        return entry.suggest(arm, entry.default, believed).impedance.force_damping

    assert suggested(1e-3) == 0.0
    assert suggested(7e-3) == pytest.approx(2.0 * suggested(14e-3))
    mass = suggested(7e-3) * 7e-3 / 0.4  # kg
    assert 1.0 < mass < 20.0
    model = robot.model.copy()
    for index in range(1, model.njoints):
        model.inertias[index] = pin.Inertia(2.0 * model.inertias[index].mass, *inertia(model.inertias[index]))
    model.armature = 2.0 * np.array(model.armature)
    assert suggested(7e-3, replace(robot, model=model)) == pytest.approx(2.0 * suggested(7e-3))


def inertia(body: pin.Inertia) -> tuple[np.ndarray, np.ndarray]:
    return np.array(body.lever), 2.0 * np.array(body.inertia)
