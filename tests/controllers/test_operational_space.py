"""The operational-space baseline: it tracks, and its posture does not disturb the task."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import ConfigError, RobotError, ShapeError, SignalError
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference, TaskReference
from pliant.spatial import Array, exp3

AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def command_at(controller: OperationalSpace, q: Array, v: Array, reference: Reference) -> Command:
    zero = np.zeros_like(q)
    estimate = Estimate(0.0, q, v, zero, zero)
    command, _ = controller.step(estimate, reference, controller.init(estimate))
    return command


def task_acceleration(robot: Robot, q: Array, v: Array, torque: Array) -> Array:
    """(6,) m/s² and rad/s² of the flange under a torque."""
    data = robot.model.createData()
    a = pin.aba(robot.model, data, q, v, torque)
    pin.forwardKinematics(robot.model, data, q, v, a)
    return np.array(pin.getFrameClassicalAcceleration(robot.model, data, robot.frame_id("flange"), AXES).vector)


def hold(robot: Robot, **motion: Array) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    return Reference(0.0, (TaskReference("flange", position, rotation, **motion),), posture=robot.home + 0.3)


def test_the_task_accelerates_as_asked(lwr4: Robot) -> None:
    controller = OperationalSpace(lwr4, "flange", singularity_damping=1e-6)
    q, v = lwr4.home + 0.02, np.array([0.3, -0.2, 0.4, 0.1, 0.2, -0.3, 0.1])
    acceleration = np.array([0.5, -0.3, 0.2, 0.4, -0.6, 0.1])
    moved = command_at(controller, q, v, hold(lwr4, acceleration=acceleration))
    still = command_at(controller, q, v, hold(lwr4))
    assert not moved.clamped.any()
    difference = task_acceleration(lwr4, q, v, moved.torque) - task_acceleration(lwr4, q, v, still.torque)
    assert difference == pytest.approx(acceleration, abs=1e-6)


def test_the_posture_does_not_disturb_the_task(lwr4: Robot) -> None:
    q, v = lwr4.home + 0.02, np.zeros(lwr4.n)
    accelerations, torques = [], []
    for stiffness in (0.0, 50.0):
        controller = OperationalSpace(lwr4, "flange", posture_stiffness=stiffness, singularity_damping=1e-6)
        torque = command_at(controller, q, v, hold(lwr4)).torque
        torques.append(torque)
        accelerations.append(task_acceleration(lwr4, q, v, torque))
    assert np.abs(torques[1] - torques[0]).max() > 0.1
    assert accelerations[1] == pytest.approx(accelerations[0], abs=1e-6)
    # Baseline: the same posture torque without the projection moves the flange.
    M = pin.crba(lwr4.model, lwr4.model.createData(), q)
    M = np.triu(M) + np.triu(M, 1).T
    plain = torques[0] + M @ (50.0 * (lwr4.home + 0.3 - q))
    assert np.abs(task_acceleration(lwr4, q, v, plain) - accelerations[0]).max() > 1.0


@pytest.mark.parametrize(("compensation", "terms"), [("none", 0), ("coriolis", 1), ("gravity+coriolis", 2)])
def test_compensation(lwr4: Robot, compensation: str, terms: int) -> None:
    q, v = lwr4.home, 0.5 * np.ones(lwr4.n)
    data = lwr4.model.createData()
    gravity = np.array(pin.computeGeneralizedGravity(lwr4.model, data, q))
    bias = np.array(pin.nonLinearEffects(lwr4.model, data, q, v))
    expected = [np.zeros(lwr4.n), bias - gravity, bias][terms]
    got = command_at(OperationalSpace(lwr4, "flange", compensation=compensation), q, v, hold(lwr4))
    bare = command_at(OperationalSpace(lwr4, "flange", compensation="none"), q, v, hold(lwr4))
    assert (got.torque + got.clamped) - (bare.torque + bare.clamped) == pytest.approx(expected, abs=1e-9)


def test_it_stays_within_the_limits_and_rejects_what_it_cannot_use(lwr4: Robot) -> None:
    q, v = np.array(lwr4.home), np.zeros(lwr4.n)
    far = command_at(OperationalSpace(lwr4, "flange", stiffness=4000.0), q + 0.5, v, hold(lwr4))
    assert np.all(np.abs(far.torque) <= lwr4.torque_limit)
    assert np.abs(far.clamped).max() > 0.0
    controller = OperationalSpace(lwr4, "flange")
    with pytest.raises(ShapeError, match="q must have 7 entries"):
        command_at(controller, np.zeros(6), v, hold(lwr4))
    with pytest.raises(SignalError, match="reference of frame 'flange' must be finite"):
        command_at(controller, q, v, hold(lwr4, acceleration=np.full(6, np.nan)))
    with pytest.raises(ConfigError, match="no task for frame 'flange'"):
        command_at(controller, q, v, Reference(0.0))
    with pytest.raises(RobotError, match="no frame 'hand'"):
        OperationalSpace(lwr4, "hand")
    with pytest.raises(ConfigError, match="stiffness must be finite and not negative, got -1"):
        OperationalSpace(lwr4, "flange", stiffness=-1.0)


@pytest.mark.parametrize("rotates", [True, False])
def test_the_arm_has_the_commanded_acceleration_while_it_moves(lwr4: Robot, rotates: bool) -> None:
    """Absolute: ẍ of the arm is ẍ_d + k x̃ + 2 ζ √k ẋ̃, at a velocity, off the target, whatever the posture does."""
    k, ratio = 300.0, 0.6
    controller = OperationalSpace(lwr4, "flange", k, ratio, singularity_damping=1e-7)
    q, v = lwr4.home + 0.02, np.array([0.3, -0.2, 0.4, 0.1, 0.2, -0.3, 0.1])
    position, rotation = lwr4.placement(q, "flange")
    error, turn = np.array([0.02, -0.01, 0.03]), np.array([0.03, 0.05, -0.02])
    velocity = np.array([0.1, 0.2, -0.3, 0.4, -0.1, 0.2])
    acceleration = np.array([0.5, -0.3, 0.2, 0.4, -0.6, 0.1])
    wanted_rotation = exp3(turn) @ rotation if rotates else None
    task = TaskReference("flange", position + error, wanted_rotation, velocity, acceleration)
    command = command_at(controller, q, v, Reference(0.0, (task,), posture=lwr4.home + 0.1))
    assert not command.clamped.any()
    J = pin.computeFrameJacobian(lwr4.model, lwr4.model.createData(), q, lwr4.frame_id("flange"), AXES)
    off = velocity - J @ v
    wanted = acceleration + k * np.concatenate([error, turn]) + 2.0 * ratio * np.sqrt(k) * off
    rows = 6 if rotates else 3
    got = task_acceleration(lwr4, q, v, command.torque)[:rows]
    np.testing.assert_allclose(got, wanted[:rows], rtol=1e-6, atol=1e-6)
