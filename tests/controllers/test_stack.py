"""The stack: torques, limits, errors, state that goes in and comes out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers import FractalImpedance, FrameTask, Stack
from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.registry import build_stack
from pliant.errors import ConfigError, RobotError, ShapeError, SignalError
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import exp3

PERIOD = 1e-3


def estimate(q: np.ndarray, t: float = 0.0) -> Estimate:
    zero = np.zeros_like(q)
    return Estimate(t, q, zero, zero, zero)


def reference(robot: Robot, shift: float = 0.01) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    elbow, _ = robot.placement(robot.home, "elbow")
    turned = exp3([0.1, -0.05, 0.2]) @ rotation
    return Reference(0.0, (TaskReference("flange", position + shift, turned), TaskReference("elbow", elbow - shift)))


@pytest.fixture
def stack(lwr4: Robot) -> Stack:
    return build_stack(lwr4, STIFF_STACK, PERIOD)


def test_torque_is_the_sum_of_jacobian_transposed_times_wrench(lwr4: Robot, stack: Stack) -> None:
    q = lwr4.home + 0.05
    command, _ = stack.step(estimate(q), reference(lwr4), stack.init(estimate(q)))
    data = lwr4.model.createData()
    torque = np.zeros(lwr4.n)
    for frame, label in (("flange", "ee"), ("elbow", "elbow")):
        J = pin.computeFrameJacobian(lwr4.model, data, q, lwr4.frame_id(frame), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        torque += J.T @ np.asarray(command.diagnostics[f"{label}/wrench"])
    assert command.torque + command.clamped == pytest.approx(torque, abs=1e-9)
    assert np.abs(torque).max() > 10.0


def test_gravity_compensation_adds_the_models_gravity(lwr4: Robot, stack: Stack) -> None:
    compensated = build_stack(lwr4, STIFF_STACK.model_copy(update={"gravity_compensation": True}), PERIOD)
    now = estimate(lwr4.home + 0.05)
    plain, _ = stack.step(now, reference(lwr4, 0.001), stack.init(now))
    helped, _ = compensated.step(now, reference(lwr4, 0.001), compensated.init(now))
    gravity = pin.computeGeneralizedGravity(lwr4.model, lwr4.model.createData(), now.q)
    wanted = [c.torque + c.clamped for c in (plain, helped)]
    assert wanted[1] - wanted[0] == pytest.approx(gravity, abs=1e-9)


def test_torque_is_clamped_and_what_is_taken_is_visible(lwr4: Robot) -> None:
    strong = ImpedanceTuning(np.full(3, 5e4), np.full(3, 5e3), np.full(3, 0.2))
    controller = FractalImpedance(lwr4, FrameTask("flange", strong), PERIOD)
    now = estimate(lwr4.home)
    command, _ = controller.step(now, reference(lwr4, 0.1), controller.init(now))
    assert np.all(np.abs(command.torque) <= lwr4.torque_limit)
    assert np.abs(command.clamped).max() > 100.0


def test_state_goes_in_and_comes_out(lwr4: Robot, stack: Stack) -> None:
    state = stack.init(estimate(lwr4.home))
    rng = np.random.default_rng(0)
    for k in range(50):
        before = state
        now = estimate(lwr4.home + 0.02 * np.sin(0.3 * k) + 1e-4 * rng.standard_normal(lwr4.n), k * PERIOD)
        first, state = stack.step(now, reference(lwr4), before)
        again, _ = stack.step(now, reference(lwr4), before)
        assert np.array_equal(first.torque, again.torque)
        assert all(np.array_equal(first.diagnostics[name], again.diagnostics[name]) for name in first.diagnostics)


def test_commands_keep_their_numbers(lwr4: Robot, stack: Stack) -> None:
    state = stack.init(estimate(lwr4.home))
    first, state = stack.step(estimate(lwr4.home), reference(lwr4), state)
    kept = first.torque.copy(), dict(first.diagnostics)
    stack.step(estimate(lwr4.home + 0.1), reference(lwr4), state)
    assert np.array_equal(first.torque, kept[0])
    assert np.array_equal(first.diagnostics["ee/force"], kept[1]["ee/force"])


def test_order_of_the_references_does_not_matter(lwr4: Robot, stack: Stack) -> None:
    now, there = estimate(lwr4.home), reference(lwr4)
    one, _ = stack.step(now, there, stack.init(now))
    other, _ = stack.step(now, replace(there, tasks=there.tasks[::-1]), stack.init(now))
    assert np.array_equal(one.torque, other.torque)


def test_without_a_rotation_in_the_reference_the_orientation_is_free(lwr4: Robot, stack: Stack) -> None:
    now, there = estimate(lwr4.home), reference(lwr4)
    free = replace(there, tasks=(replace(there.tasks[0], rotation=None), there.tasks[1]))
    held, state = stack.step(now, there, stack.init(now))
    command, state = stack.step(now, free, state)
    assert np.abs(np.asarray(held.diagnostics["ee/wrench"])[3:]).max() > 1.0
    assert not np.asarray(command.diagnostics["ee/wrench"])[3:].any()
    # Letting go is booked as a change of the parameters, not as motion.
    released = float(held.diagnostics["ee/energy_stored"]) - float(command.diagnostics["ee/energy_stored"])
    assert released > 0.1
    assert command.diagnostics["ee/energy_tuning"] == pytest.approx(-released)
    assert np.asarray(command.diagnostics["ee/storage_margin"]) == pytest.approx(np.zeros(6), abs=1e-12)


def test_an_error_that_passes_half_a_turn_books_no_work(lwr4: Robot) -> None:
    tuning = ImpedanceTuning(np.array([0.0] * 3 + [20.0] * 3), np.array([0.0] * 3 + [5.0] * 3), np.full(6, 0.5))
    controller = FractalImpedance(lwr4, FrameTask("flange", tuning, "ee"), PERIOD)
    now = estimate(lwr4.home)
    position, rotation = lwr4.placement(lwr4.home, "flange")
    state = controller.init(now)
    margins = []
    for angle in np.linspace(3.0, 3.3, 40):
        there = Reference(0.0, (TaskReference("flange", position, exp3([0.0, 0.0, angle]) @ rotation),))
        command, state = controller.step(now, there, state)
        margins.append(float(command.diagnostics["ee/energy_dissipated"]))
    assert np.asarray(command.diagnostics["ee/error"])[5] < -2.9
    assert np.abs(margins).max() < 0.1


def test_diagnostics_are_a_mapping_with_units(stack: Stack, lwr4: Robot) -> None:
    now = estimate(lwr4.home)
    command, _ = stack.step(now, reference(lwr4), stack.init(now))
    channels = command.diagnostics
    assert set(channels) == set(stack.channels)
    assert {"ee/force", "elbow/phase", "energy/supplied", "energy/clamped"} <= set(channels)
    for name, channel in stack.channels.items():
        assert np.shape(channels[name]) == ((channel.size,) if channel.size else ())
        assert channel.unit
    with pytest.raises(KeyError):
        channels["ee/nothing"]


# ------------------------------------------------------------------ bad input


def test_a_frame_the_robot_does_not_have(lwr4: Robot) -> None:
    tuning = ImpedanceTuning(np.full(3, 100.0), np.full(3, 10.0), np.full(3, 0.1))
    with pytest.raises(RobotError, match=r"no frame 'flang'.*did you mean 'flange'"):
        Stack(lwr4, [FrameTask("flang", tuning)], PERIOD)


def test_tasks_period_and_labels_are_checked(lwr4: Robot) -> None:
    tuning = ImpedanceTuning(np.full(3, 100.0), np.full(3, 10.0), np.full(3, 0.1))
    task = FrameTask("flange", tuning)
    with pytest.raises(ConfigError, match="different labels, got \\['flange', 'flange'\\]"):
        Stack(lwr4, [task, task], PERIOD)
    with pytest.raises(ConfigError, match="one or more tasks"):
        Stack(lwr4, [], PERIOD)
    with pytest.raises(ConfigError, match="above zero, got 0"):
        Stack(lwr4, [task], 0.0)
    with pytest.raises(ConfigError, match="without a slash"):
        FrameTask("flange", tuning, "a/b")
    with pytest.raises(ShapeError, match="3 axes, or 6"):
        FrameTask("flange", ImpedanceTuning(np.ones(4), np.ones(4), np.ones(4)))


def test_a_reference_without_the_frame(stack: Stack, lwr4: Robot) -> None:
    now, there = estimate(lwr4.home), reference(lwr4)
    with pytest.raises(ConfigError, match="no task for frame 'elbow'; valid: 'flange'"):
        stack.step(now, replace(there, tasks=there.tasks[:1]), stack.init(now))


def test_a_tuning_of_other_axes(stack: Stack, lwr4: Robot) -> None:
    now, there = estimate(lwr4.home), reference(lwr4)
    short = ImpedanceTuning(np.full(3, 100.0), np.full(3, 10.0), np.full(3, 0.1))
    with pytest.raises(ShapeError, match="'ee' has 6 axes, its new tuning 3"):
        stack.step(now, replace(there, tasks=(replace(there.tasks[0], tuning=short), there.tasks[1])), stack.init(now))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_signals_that_are_not_finite(stack: Stack, lwr4: Robot, bad: float) -> None:
    there, state = reference(lwr4), stack.init(estimate(lwr4.home))
    q = lwr4.home.copy()
    q[3] = bad
    with pytest.raises(SignalError, match="measured position must be finite"):
        stack.step(estimate(q), there, state)
    lost = replace(there, tasks=(there.tasks[0], replace(there.tasks[1], position=np.array([0.0, bad, 0.0]))))
    with pytest.raises(SignalError, match="reference of frame 'elbow'"):
        stack.step(estimate(lwr4.home), lost, state)


def test_a_robot_with_other_joints(stack: Stack, lwr4: Robot) -> None:
    with pytest.raises(ShapeError, match="7 entries for robot 'lwr4', got shape \\(6,\\)"):
        stack.init(estimate(np.zeros(6)))
    with pytest.raises(ShapeError, match="q must be an array of 7 entries for robot 'lwr4'"):
        stack.step(estimate(np.zeros(6)), reference(lwr4), stack.init(estimate(lwr4.home)))


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"position": np.zeros(4)}, "position of frame 'flange' must be an array of 3 entries"),
        ({"position": [0.1, 0.2, 0.3]}, r"must be an array of 3 entries, got \[0.1, 0.2, 0.3\]"),
        ({"rotation": np.eye(4)}, r"rotation of frame 'flange' must be an array of shape \(3, 3\)"),
    ],
)
def test_a_reference_of_another_shape(stack: Stack, lwr4: Robot, change: dict[str, object], rule: str) -> None:
    now, there = estimate(lwr4.home), reference(lwr4)
    bent = replace(there, tasks=(replace(there.tasks[0], **change), there.tasks[1]))
    with pytest.raises(ShapeError, match=rule):
        stack.step(now, bent, stack.init(now))
