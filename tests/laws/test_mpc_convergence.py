"""The predictive controllers' solver converges from far starts, and the full Hessian is why it does so quickly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant.mpc.config import MpcConfig
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, TorqueFeedbackMpc
from tests.mpc.problems import polishing_arm, posed, start_state

STARTS = 150
SPREAD = 0.2  # rad


@pytest.mark.parametrize("phase", ["track", "circle"])
@pytest.mark.parametrize("settings", [ForceFeedbackMpc(), ClassicalMpc(), TorqueFeedbackMpc()], ids=lambda c: c.kind)
def test_it_converges_from_start_errors_of_a_fifth_of_a_radian(settings: MpcConfig, phase: str) -> None:
    robot = polishing_arm()
    problem, _, solver = posed(robot, settings, np.zeros(3), 30.0, phase)
    converged = 0
    for seed in range(STARTS):
        rng = np.random.default_rng(seed)
        x0 = start_state(problem, robot, rng, spread=0.0)
        x0[: robot.n] += rng.uniform(-SPREAD, SPREAD, robot.n)
        solver.reset()
        solver.quasi_static(x0)
        converged += solver.solve(x0, max_iterations=100, tolerance=1e-4).status == "converged"
    assert converged >= 0.99 * STARTS


def test_without_the_cross_terms_of_the_hessian_it_needs_more_steps() -> None:
    """Baseline: the same problem, solver and starts, with L_xu dropped as public implementations do."""
    crocoddyl_bridge = pytest.importorskip("pliant.mpc.crocoddyl.bridge", exc_type=Exception)
    mim_solvers = pytest.importorskip("mim_solvers")

    class WithoutCrossTerms(crocoddyl_bridge.NodeAction):
        def calcDiff(self, data: Any, x: Any, u: Any = None) -> None:
            super().calcDiff(data, x, u)
            data.Lxu = np.zeros_like(data.Lxu)

    robot = polishing_arm()
    problem, chain, solver = posed(robot, ForceFeedbackMpc(), np.zeros(3), 30.0)
    steps = {crocoddyl_bridge.NodeAction: 0, WithoutCrossTerms: 0}
    original = crocoddyl_bridge.NodeAction
    for seed in range(5):
        x0 = start_state(problem, robot, np.random.default_rng(seed))
        solver.quasi_static(x0)
        for action in steps:
            crocoddyl_bridge.NodeAction = action
            try:
                shooting = crocoddyl_bridge.shooting_problem(problem, solver.nodes, x0, chain)
            finally:
                crocoddyl_bridge.NodeAction = original
            sqp = mim_solvers.SolverSQP(shooting)
            sqp.termination_tolerance, sqp.use_filter_line_search = 1e-4, True
            sqp.solve(list(solver.xs), list(solver.us), 100, False, 1e-9)
            steps[action] += sqp.iter
    assert steps[WithoutCrossTerms] > 1.3 * steps[original]
