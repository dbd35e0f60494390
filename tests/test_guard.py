"""The guard's own rules, signal by signal, each beside one that passes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant.controllers.step_limit import StepLimit
from pliant.environment import Environment
from pliant.errors import RunFailedError, ShapeError
from pliant.guard import Fault, Guard, Watched
from pliant.interfaces import Controller
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Preview, Reference, TaskReference
from tests.guarded_leg import PERIOD, command, reading, started


def all_late(guard: Guard, watched: Watched) -> None:
    for tick in range(1, 100):
        late = reading(3.0 * tick * PERIOD)
        assert guard.measurement(late, watched) is Fault.LATE
        guard.settled(command(), Fault.LATE, late, watched)


def test_readings_that_are_late_again_and_again_end_the_run() -> None:
    guard, watched = started()
    with pytest.raises(RunFailedError, match="measurements came late"):
        all_late(guard, watched)


def test_a_reading_after_a_fault_is_on_time_if_no_more_was_lost() -> None:
    guard, watched = started()
    bad = replace(reading(PERIOD), q=np.full(3, np.nan))
    assert guard.measurement(bad, watched) is Fault.NOT_FINITE
    guard.settled(command(), Fault.NOT_FINITE, bad, watched)
    assert guard.measurement(reading(10.0), watched) is Fault.LATE
    assert guard.measurement(reading(10.0 + 2.0 * PERIOD), watched) is Fault.LATE  # a second one
    assert guard.measurement(reading(10.0 + 3.0 * PERIOD), watched) is Fault.NONE
    guard, watched = started()
    assert guard.measurement(bad, watched) is Fault.NOT_FINITE
    assert guard.measurement(reading(2.0 * PERIOD), watched) is Fault.NONE


def test_a_late_reading_after_a_fault_that_was_not_the_sensors_is_late() -> None:
    guard, watched = started()
    assert guard.measurement(reading(PERIOD), watched) is Fault.NONE
    guard.settled(command(), Fault.REFERENCE, reading(PERIOD), watched)
    assert guard.measurement(reading(3.0 * PERIOD), watched) is Fault.LATE


def test_a_noisy_sensor_that_stands_still_is_frozen_at_its_third_equal_reading() -> None:
    guard, watched = started(frozenset({"q"}))
    faults = [guard.measurement(reading(tick * PERIOD), watched) for tick in (1, 2, 3)]
    assert faults == [Fault.NONE, Fault.FROZEN, Fault.FROZEN]
    assert guard.measurement(reading(4 * PERIOD, q=0.2), watched) is Fault.NONE
    guard, watched = started()  # the control: a perfect sensor may stand still
    assert [guard.measurement(reading(tick * PERIOD), watched) for tick in (1, 2, 3)] == [Fault.NONE] * 3


@pytest.mark.parametrize(
    "changed",
    [
        {"position": np.zeros(2)},
        {"wrench": np.zeros(3)},
        {"velocity": np.full(6, np.inf)},
        {"rotation": np.full((3, 3), np.nan)},
    ],
)
def test_a_reference_of_another_size_or_not_finite_is_found(changed: dict[str, np.ndarray]) -> None:
    guard, watched = started()
    task = TaskReference("foot", np.zeros(3), np.eye(3))
    assert guard.reference(Reference(0.0, (task,)), watched) is Fault.NONE
    assert guard.reference(Reference(0.0, (replace(task, **changed),)), watched) is Fault.REFERENCE


def test_a_wrench_of_another_size_is_found() -> None:
    guard, watched = started()
    bad = replace(reading(PERIOD), wrenches={"foot": np.zeros(5)})
    assert guard.measurement(bad, watched) is Fault.SHAPE
    with pytest.raises(ShapeError, match="q must have shape"):
        guard.init(replace(reading(0.0), q=np.zeros(4)))


def test_what_was_clamped_is_finite_too() -> None:
    guard, watched = started()
    sent, fault = guard.command(replace(command(), clamped=np.full(3, np.nan)), watched)
    assert fault is Fault.NONE
    assert np.isfinite(sent.clamped).all()
    sent, fault = guard.command(command(1e6), watched)
    assert fault is Fault.BEYOND_LIMIT
    np.testing.assert_allclose(sent.torque + sent.clamped, 1e6)


BELIEVED = Environment(1e4, 10.0, 100.0, np.inf)


@pytest.mark.parametrize(
    "changed",
    [
        {"environments": {"foot": replace(BELIEVED, stiffness=np.nan)}},
        {"environments": {"foot": replace(BELIEVED, damping=np.inf)}},
        {"environments": {"foot": replace(BELIEVED, damping_std=np.nan)}},
        {"time": np.nan},
        {"time": 0.0},
        {"time": -1.0},
        {"v": np.zeros(4)},
        {"v": np.zeros(3, complex)},
        {"v": np.zeros(3, object)},
        {"v": [0.0, 0.0, 0.0]},
        {"disturbance": np.full(3, np.nan)},
        {"wrenches": {"foot": np.zeros(3)}},
        {"wrenches": {"foot": np.full(6, np.nan)}},
    ],
)
def test_an_estimate_that_is_not_sound_is_found(changed: dict[str, Any]) -> None:
    guard, watched = started()
    sound = Estimate(0.0, *[np.zeros(3)] * 4, environments={"foot": BELIEVED})
    assert guard.estimate(sound, watched) is Fault.NONE
    assert guard.estimate(replace(sound, **{"time": PERIOD, **changed}), watched) is Fault.ESTIMATE
    assert guard.estimate(replace(sound, time=2.0 * PERIOD), watched) is Fault.NONE


@pytest.mark.parametrize("kind", [complex, object, "U8"])
def test_arrays_that_are_not_of_real_numbers_are_found(kind: Any) -> None:
    guard, watched = started()
    odd = np.zeros(3).astype(kind)
    assert guard.measurement(replace(reading(PERIOD), v=odd), watched) is Fault.SHAPE
    assert guard.command(replace(command(), torque=odd), watched)[1] is Fault.COMMAND
    assert guard.reference(Reference(0.0, posture=odd), watched) is Fault.REFERENCE


def test_times_and_previews_are_looked_at_too() -> None:
    guard, watched = started()
    nodes = Preview(np.zeros(4), np.zeros((4, 3)), np.zeros((4, 3, 3)), np.zeros((4, 6)), np.zeros((4, 6)))
    assert guard.reference(Reference(0.0, preview=nodes), watched) is Fault.NONE
    for changed in ({"velocity": np.zeros((3, 6))}, {"wrench": np.full((4, 6), np.inf)}, {"time": None}):
        spoilt: Any = replace(nodes, **changed)
        assert guard.reference(Reference(0.0, preview=spoilt), watched) is Fault.REFERENCE
    assert guard.reference(Reference(np.nan), watched) is Fault.REFERENCE
    assert guard.reference(Reference(0.0, posture=np.zeros(4)), watched) is Fault.REFERENCE
    assert guard.command(replace(command(), time=np.nan), watched)[1] is Fault.COMMAND


def test_diagnostics_are_for_the_log_alone() -> None:
    guard, watched = started()
    told = replace(command(), diagnostics={"residual": np.nan})
    assert guard.command(told, watched) == (told, Fault.NONE)


class Steady(Controller[None]):
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, reference: Reference, state: None) -> tuple[Command, None]:
        return command(), None


@pytest.mark.parametrize("sent", [np.nan, np.inf, 1e6, -1e6])
def test_a_step_limit_does_not_believe_what_is_said_to_have_been_sent(sent: float) -> None:
    robot = Robot.load("leg3")
    limited = StepLimit(Steady(), robot, 0.1)
    estimate = Estimate(0.0, np.zeros(3), np.zeros(3), np.zeros(3), np.full(3, sent))
    state = limited.init(estimate)
    for _ in range(3):
        answer, state = limited.step(estimate, Reference(0.0), state)
        assert np.isfinite(answer.torque).all()
        assert (np.abs(answer.torque) <= robot.torque_limit).all()


def test_a_command_may_be_as_large_as_the_limit() -> None:
    """Baseline: a thousandth more is taken away."""
    guard, watched = started()
    limit = Robot.load("leg3").torque_limit
    asked = Command(0.0, limit * np.array([1.0, -1.0, 1.0]), np.zeros(3))
    sent, fault = guard.command(asked, watched)
    assert (sent, fault) == (asked, Fault.NONE)
    beyond, _ = guard.command(replace(asked, torque=1.001 * asked.torque), watched)
    np.testing.assert_allclose(np.abs(beyond.torque), limit)
    np.testing.assert_allclose(beyond.clamped, 0.001 * asked.torque, rtol=1e-9)
