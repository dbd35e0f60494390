"""What is sent from a solution, and when a solution may be sent at all."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pliant.mpc import ClassicalMpc, ForceFeedbackMpc, TorqueFeedbackMpc
from pliant.mpc.controller import MpcController
from pliant.signals import Estimate, Reference, TaskReference
from tests.twins.mpc_step.plan import Plan, plan_of, torque_from, usable

from .problems import polishing_arm


def _solution(**changes: Any) -> Any:
    rng = np.random.default_rng(0)
    values = {
        "status": "converged",
        "xs": rng.normal(size=(6, 18)),
        "us": rng.normal(size=(5, 6)),
        "feedback_gain": rng.normal(size=(6, 18)),
        "gap": 1e-9,
    }
    return SimpleNamespace(**(values | changes))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, True),
        ({"status": "max_iterations"}, True),
        ({"status": "time_budget"}, True),
        ({"status": "line_search"}, True),
        ({"status": "nan"}, False),
        ({"status": "not_positive_definite"}, False),
        ({"us": np.full((5, 6), np.nan)}, False),
        ({"gap": 1.0}, True),
        ({"gap": 100.0}, False),
        ({"gap": np.nan}, False),
    ],
)
def test_a_solution_is_used_if_it_is_finite_and_follows_the_dynamics(changes: dict[str, Any], expected: bool) -> None:
    assert usable(_solution(**changes), ForceFeedbackMpc()) is expected


def test_the_plan_runs_along_the_horizon_and_ends() -> None:
    config, solution = ClassicalMpc(), _solution()
    plan = plan_of(solution, 1.0, 6, config)
    for step in range(5):
        for within in (0.0, 0.0029):
            torque = torque_from(plan, 1.0 + 0.003 * step + within, None, config)
            np.testing.assert_array_equal(torque, solution.us[step])
    assert torque_from(plan, 1.0 + 0.015, None, config) is None


def test_feedback_uses_the_gain_of_the_first_node() -> None:
    config, solution = ForceFeedbackMpc(between="riccati"), _solution()
    plan = plan_of(solution, 0.0, 6, config)
    x = solution.xs[0] + 0.01
    expected = solution.us[0] - solution.feedback_gain @ np.full(18, 0.01)
    np.testing.assert_allclose(torque_from(plan, 0.001, x, config), expected)
    np.testing.assert_array_equal(torque_from(plan, 0.001, None, config), solution.us[0])
    np.testing.assert_array_equal(torque_from(plan, 0.004, x, config), solution.us[1])


def test_torque_feedback_interpolates_between_measured_and_predicted_torque() -> None:
    solution = _solution()
    for period, share in ((2e-3, 2.0 / 3.0), (3e-3, 1.0), (6e-3, 1.0)):
        plan: Plan = plan_of(solution, 0.0, 6, TorqueFeedbackMpc(period=period))
        tau = solution.xs[:, 12:]
        np.testing.assert_allclose(plan.torques[0], tau[0] + share * (tau[1] - tau[0]))


@pytest.mark.parametrize(("deadline", "missed"), [(None, 0.0), (1e-9, 1.0), (10.0, 0.0)])
def test_deadlines_are_told_only_where_one_is_set(deadline: float | None, missed: float) -> None:
    robot = polishing_arm()
    controller = MpcController(robot, ForceFeedbackMpc(deadline=deadline, time_budget=5e-3))
    zero, (position, R) = np.zeros(6), robot.placement(robot.home, "tool")
    estimate = Estimate(0.0, robot.home, zero, zero, zero, {"tool": np.zeros(6)})
    reference = Reference(0.0, (TaskReference("tool", position, R),), phase="track")
    command, _ = controller.step(estimate, reference, controller.init(estimate))
    assert command.diagnostics["mpc/deadline_missed"] == missed
