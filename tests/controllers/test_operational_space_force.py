"""What the operational-space controller does along force and free axes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.axis_modes import AxisModes
from pliant.controllers.operational_space import OperationalSpace
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array, exp3

R = exp3(np.array([0.4, 0.2, -0.7]))
FORCE = ("motion", "motion", "force", "motion", "motion", "motion")


def task(robot: Robot, modes: tuple[str, ...], wrench: Array, away: float = 0.0) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    axes = AxisModes(modes, R)  # type: ignore[arg-type]
    return Reference(0.0, (TaskReference("flange", position + away, rotation, wrench=wrench, modes=axes),))


def wrench_of(
    robot: Robot, reference: Reference, felt: Array, touches: bool, ticks: int = 1, gain: float = 10.0
) -> tuple[Array, Array]:
    """Wrench (6,) of the task in the world, N and N·m, and joint torque (n,) after some ticks of 1 ms."""
    controller = OperationalSpace(robot, "flange", force_integral=gain, compensation="none", posture_stiffness=0.0)
    zero, state, command = np.zeros(robot.n), None, None
    for tick in range(ticks):
        estimate = Estimate(
            1e-3 * tick, robot.home, zero, zero, zero, wrenches={"flange": felt}, contacts={"flange": touches}
        )
        state = controller.init(estimate) if state is None else state
        command, state = controller.step(estimate, reference, state)
    assert command is not None
    return np.array(command.diagnostics["ee/wrench"]), command.torque


def test_it_presses_as_much_as_is_asked_and_the_sign_is_the_reactions(lwr4: Robot) -> None:
    asked = np.array([*(20.0 * R[:, 2]), 0, 0, 0])
    reference = task(lwr4, FORCE, asked)
    wrench, torque = wrench_of(lwr4, reference, asked, touches=True)
    np.testing.assert_allclose(wrench, -asked, atol=1e-9)  # the reaction is what the tool feels
    data = lwr4.model.createData()
    frame, axes = lwr4.frame_id("flange"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    J = np.array(pin.computeFrameJacobian(lwr4.model, data, lwr4.home, frame, axes))
    np.testing.assert_allclose(torque, J.T @ -asked, atol=1e-9)
    in_the_air, _ = wrench_of(lwr4, reference, np.zeros(6), touches=False)
    np.testing.assert_allclose(in_the_air, np.zeros(6), atol=1e-9)  # it moves until there is contact, and it is there


def test_what_is_missing_is_gathered_along_the_force_alone_and_bounded(lwr4: Robot) -> None:
    asked = np.array([*(20.0 * R[:, 2]), 0, 0, 0])
    felt = np.array([*(15.0 * R[:, 2] + 4.0 * R[:, 0]), 0, 0, 0])  # 5 N are missing, 4 N of friction beside
    reference = task(lwr4, FORCE, asked)
    wrench, _ = wrench_of(lwr4, reference, felt, touches=True, ticks=101)
    gathered = 10.0 * 0.1 * 5.0  # k_i t e
    np.testing.assert_allclose(wrench[:3], -(20.0 + gathered) * R[:, 2], atol=1e-6)
    long, _ = wrench_of(lwr4, reference, felt, touches=True, ticks=1500)
    assert 30.0 < np.linalg.norm(long[:3]) <= 20.0 + 20.0 * np.sqrt(3.0)
    without, _ = wrench_of(lwr4, reference, felt, touches=True, ticks=101, gain=1e-12)
    np.testing.assert_allclose(without[:3], -20.0 * R[:, 2], atol=1e-6)


@pytest.mark.parametrize("axis", range(6))
def test_a_free_axis_has_no_acceleration_asked_of_it(lwr4: Robot, axis: int) -> None:
    """Along it the arm falls freely, whatever the error; the other axes are controlled."""
    modes = tuple("free" if place == axis else "motion" for place in range(6))
    wrench, _ = wrench_of(lwr4, task(lwr4, modes, np.zeros(6), away=0.02), np.zeros(6), touches=False)
    told = np.concatenate([R.T @ wrench[:3], R.T @ wrench[3:]])
    assert told[axis] == pytest.approx(0.0, abs=1e-9)
    held, _ = wrench_of(lwr4, task(lwr4, ("motion",) * 6, np.zeros(6), away=0.02), np.zeros(6), touches=False)
    assert np.linalg.norm(held) > 1.0
    assert np.linalg.norm(wrench) > 1.0
