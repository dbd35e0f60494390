"""The bound on torque steps: it holds, it pays for what it lets out, and gives way where it cannot pay."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.controllers import FrameTask, Stack
from pliant.controllers.step_limit import DEFAULT_SHARE, StepLimit
from pliant.interfaces import Controller
from pliant.robot import Robot
from pliant.signals import Command, Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array


class Asks(Controller[int]):
    """Asks for one torque, and says what may be spent."""

    def __init__(self, torque: Array, spendable: float | None) -> None:
        self.torque, self.spendable, self.told = torque, spendable, np.zeros_like(torque)

    def init(self, estimate: Estimate) -> int:
        return 0

    def step(self, estimate: Estimate, reference: Reference, state: int) -> tuple[Command, int]:
        channels = {} if self.spendable is None else {"energy/spendable": self.spendable}
        return Command(0.0, self.torque, np.zeros_like(self.torque), channels), state + 1

    def kept_back(self, state: int, torque: Array) -> int:
        self.told = torque
        return state


def estimate(robot: Robot, q: Array, sent: float = 0.0) -> Estimate:
    zero = np.zeros(robot.n)
    return Estimate(0.0, q, zero, zero, np.full(robot.n, sent))


def second_step(robot: Robot, spendable: float | None) -> tuple[Command, Asks]:
    """The joints moved by 0.01 rad, and the torque that brakes them is still wanted."""
    asks = Asks(-robot.torque_limit, spendable)
    limit = StepLimit(asks, robot)
    state = limit.init(estimate(robot, robot.home))
    _, state = limit.step(estimate(robot, robot.home), Reference(0.0, ()), state)
    command, _ = limit.step(estimate(robot, robot.home + 0.01), Reference(0.0, ()), state)
    return command, asks


def test_the_bound_holds_and_the_controller_is_told(lwr4: Robot) -> None:
    command, asks = second_step(lwr4, None)
    np.testing.assert_allclose(command.torque, -2 * DEFAULT_SHARE * lwr4.torque_limit)
    np.testing.assert_allclose(asks.told, -(1 - 2 * DEFAULT_SHARE) * lwr4.torque_limit)
    np.testing.assert_allclose(command.clamped, asks.told)
    assert command.diagnostics["step_limit/exceeded"] == 0.0


def test_it_gives_way_where_nothing_may_be_spent(lwr4: Robot) -> None:
    command, _ = second_step(lwr4, 0.0)
    np.testing.assert_allclose(command.torque, -lwr4.torque_limit)
    wanted = (1 - DEFAULT_SHARE) / DEFAULT_SHARE - 1
    assert command.diagnostics["step_limit/exceeded"] == pytest.approx(wanted)
    richer, _ = second_step(lwr4, 1e6)
    np.testing.assert_allclose(richer.torque, -2 * DEFAULT_SHARE * lwr4.torque_limit)


def test_a_robot_that_does_not_say_what_it_holds_starts_from_nothing(lwr4: Robot) -> None:
    limit = StepLimit(Asks(lwr4.torque_limit, None), lwr4)
    first = estimate(lwr4, lwr4.home, np.nan)
    command, _ = limit.step(first, Reference(0.0, ()), limit.init(first))
    np.testing.assert_allclose(command.torque, DEFAULT_SHARE * lwr4.torque_limit)


def steps_of_a_stiffness_that_jumps(robot: Robot, controller: Controller[object]) -> Array:
    """(ticks,) largest change of a torque over its limit: an arm held still 5 cm off its target, soft, then stiff."""
    position, _ = robot.placement(robot.home, "flange")
    torques, state = [], controller.init(estimate(robot, robot.home))
    for tick in range(40):
        stiffness = 500.0 if tick < 20 else 20000.0
        tuning = ImpedanceTuning(np.full(3, stiffness), np.full(3, 150.0), np.full(3, 0.1))
        target = TaskReference("flange", position + np.array([0.03, 0.03, 0.03]), tuning=tuning)
        command, state = controller.step(estimate(robot, robot.home), Reference(0.0, (target,)), state)
        torques.append(command.torque)
    return np.max(np.abs(np.diff(torques, axis=0)) / robot.torque_limit, axis=1)


def test_a_stiffness_that_jumps_under_a_standing_error_becomes_a_ramp(lwr4: Robot) -> None:
    tuning = ImpedanceTuning(np.full(3, 500.0), np.full(3, 150.0), np.full(3, 0.1))
    stack = Stack(lwr4, [FrameTask("flange", tuning)], 1e-3)
    assert steps_of_a_stiffness_that_jumps(lwr4, stack).max() > 0.2  # baseline
    assert steps_of_a_stiffness_that_jumps(lwr4, StepLimit(stack, lwr4)).max() <= DEFAULT_SHARE * (1 + 1e-9)


def test_what_was_held_back_is_booked_with_its_sign(lwr4: Robot) -> None:
    """J: the torque that was not sent, times the way that the joints went meanwhile, joint by joint."""
    asks = Asks(-lwr4.torque_limit, None)
    limit, way = StepLimit(asks, lwr4, 0.25), np.array([0.01, -0.02, 0.03, 0.0, 0.005, -0.001, 0.002])
    first, second = estimate(lwr4, lwr4.home), estimate(lwr4, lwr4.home + way)
    command, state = limit.step(first, Reference(0.0, ()), limit.init(first))
    assert command.diagnostics["energy/step_limit"] == 0.0
    command, state = limit.step(second, Reference(0.0, ()), state)
    booked = float(np.sum(-0.75 * lwr4.torque_limit * way))
    assert command.diagnostics["energy/step_limit"] == pytest.approx(booked, rel=1e-12)
    back = estimate(lwr4, lwr4.home)
    command, _ = limit.step(back, Reference(0.0, ()), state)
    assert command.diagnostics["energy/step_limit"] == pytest.approx(booked / 3.0, rel=1e-12)  # −0.5 on the way back
