"""Bounds on torque and force and the friction cone, against independent solvers on the condensed problem."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from pliant import _mpc
from tests.twins.mpc_robots import catalogue_chain

from .drawn_problems import Condensed, tried
from .kernel_problem import DT, nodes_like, noisy, polishing

Vector = np.ndarray


def reference(problem: Condensed, start: Vector, bounds: list[tuple[float, float]], constraints: list[dict]) -> Vector:
    """SLSQP on the condensed problem, costs scaled so that its tolerance means something, from off the solution.

    Close to rounding SLSQP may go on for ever: then the tolerance is a hundred times larger, still far below what is
    compared.
    """
    scale = 1e3  # the cost of a torque is of order 1e-7
    start = start + np.random.default_rng(9).normal(size=start.size)  # 1 N·m away
    for tolerance in (1e-14, 1e-12):
        result = minimize(
            lambda z: scale * problem.evaluate(z)[0],
            start,
            jac=lambda z: scale * problem.evaluate(z)[1],
            bounds=bounds,
            constraints=constraints,
            method="SLSQP",
            options={"maxiter": 500, "ftol": tolerance},
        )
        if result.success:
            break
    assert result.success, result.message
    return result.x


def bounded(kind: str, dim: int) -> tuple[_mpc.Solver, Vector, Vector]:
    """A solver pushed hard off its rest, so that bounds bite: 60 N wanted, from 15 N."""
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, kind, dim, bounds=True)
    solver.nodes.force_reference[:, min(dim, 3) - 1] = 60.0
    free, _ = polishing(robot, kind, dim)
    free.nodes.force_reference[:, min(dim, 3) - 1] = 60.0
    unbounded = free.solve(x0, max_iterations=50, tolerance=1e-7)
    assert unbounded.status == "converged"
    return solver, x0, unbounded.us


@pytest.mark.parametrize(
    ("kind", "dim"), [("force_feedback", 1), ("force_feedback", 3), ("classical", 1), ("torque_feedback", 1)]
)
def test_torque_bounds(kind: str, dim: int) -> None:
    robot = catalogue_chain("lwr4")
    solver, x0, unbounded = bounded(kind, dim)
    rest = solver.us  # of the force that is there; the bounds leave 60 % of the way to what is wanted
    part = rest + 0.6 * (unbounded - rest)
    lower, upper = np.minimum(rest, part) - 1e-3, np.maximum(rest, part) + 1e-3
    assert np.max(np.maximum(unbounded - upper, lower - unbounded)) > 1e-2  # baseline: without the bound it breaks
    solver.nodes.torque_lower[:-1] = lower
    solver.nodes.torque_upper[:-1] = upper
    solution = solver.solve(x0, max_iterations=100, tolerance=1e-7)
    assert solution.status == "converged"
    assert np.all(solution.us <= upper + 1e-6)
    assert np.all(solution.us >= lower - 1e-6)
    assert solution.violation <= 1e-6
    problem = Condensed(nodes_like(solver, robot, kind, dim), x0)
    limits = list(zip(lower.ravel(), upper.ravel(), strict=True))
    expected = reference(problem, solution.us.ravel(), limits, [])
    best, got = problem.evaluate(expected)[0], problem.evaluate(solution.us.ravel())[0]
    assert abs(got - best) <= 1e-6 * abs(best)


@pytest.mark.parametrize(
    ("kind", "dim"), [("force_feedback", 1), ("force_feedback", 3), ("classical", 1), ("classical", 3)]
)
def test_force_bounds(kind: str, dim: int) -> None:
    robot = catalogue_chain("lwr4")
    solver, x0, _ = bounded(kind, dim)
    normal, highest = min(dim, 3) - 1, 25.0
    problem = Condensed(nodes_like(solver, robot, kind, dim), x0)
    free, _ = polishing(robot, kind, dim)
    free.nodes.force_reference[:, normal] = 60.0
    assert np.max(free.solve(x0, max_iterations=50).forces[:, normal]) > highest + 1.0  # baseline
    solver.nodes.force_lower[:, normal] = 0.0
    solver.nodes.force_upper[:, normal] = highest
    solution = solver.solve(x0, max_iterations=100, tolerance=1e-7)
    assert solution.status == "converged"
    _, _, forces, _ = problem.evaluate(solution.us.ravel())
    chosen = slice(1, None) if kind == "force_feedback" else slice(0, 5)
    m = max(dim, 1)
    assert np.all(forces[chosen, normal] <= highest + 1e-5)
    assert np.all(forces[chosen, normal] >= -1e-5)
    rows = np.arange(6)[chosen] * m + normal
    constraint = {
        "type": "ineq",
        "fun": lambda z: highest - problem.evaluate(z)[2].ravel()[rows],
        "jac": lambda z: -problem.evaluate(z)[3][rows],
    }
    expected = reference(problem, solution.us.ravel(), [(None, None)] * 35, [constraint])
    best, got = problem.evaluate(expected)[0], problem.evaluate(solution.us.ravel())[0]
    assert abs(got - best) <= 1e-6 * abs(best)


@pytest.mark.parametrize("kind", ["force_feedback", "classical"])
def test_friction_cone(kind: str) -> None:
    robot = catalogue_chain("lwr4")
    mu = 0.3
    solver, x0, _ = bounded(kind, 3)
    solver.nodes.force_reference[:, 0] = 30.0  # a tangential force that the cone forbids
    free, _ = polishing(robot, kind, 3)
    free.nodes.force_reference[:] = solver.nodes.force_reference
    problem = Condensed(nodes_like(solver, robot, kind, 3), x0)
    chosen = slice(1, None) if kind == "force_feedback" else slice(0, 5)

    def margin(forces: Vector) -> Vector:
        return mu * forces[chosen, 2] - np.linalg.norm(forces[chosen, :2], axis=1)

    unbounded = free.solve(x0, max_iterations=50)
    assert np.min(margin(problem.evaluate(unbounded.us.ravel())[2])) < -1.0  # baseline
    solver.nodes.friction = mu
    solution = solver.solve(x0, max_iterations=100, tolerance=1e-7)
    assert solution.status == "converged"
    assert np.min(margin(problem.evaluate(solution.us.ravel())[2])) >= -1e-5

    def margin_gradient(z: Vector) -> Vector:
        _, _, forces, rows = problem.evaluate(z)
        by_controls = rows.reshape(6, 3, -1)[chosen]
        tangential = forces[chosen, :2] / np.linalg.norm(forces[chosen, :2], axis=1, keepdims=True)
        return mu * by_controls[:, 2] - np.einsum("ki,kiz->kz", tangential, by_controls[:, :2])

    constraint = {"type": "ineq", "fun": lambda z: margin(problem.evaluate(z)[2]), "jac": margin_gradient}
    expected = reference(problem, solution.us.ravel(), [(None, None)] * 35, [constraint])
    best, got = problem.evaluate(expected)[0], problem.evaluate(solution.us.ravel())[0]
    assert abs(got - best) <= 1e-6 * abs(best)


def test_bounds_that_do_not_bite_change_nothing() -> None:
    robot = catalogue_chain("lwr4")
    for kind, dim in (("force_feedback", 3), ("classical", 3)):
        plain, x0 = polishing(robot, kind, dim)
        solver, _ = polishing(robot, kind, dim, bounds=True)
        solver.nodes.torque_lower = -1e3
        solver.nodes.torque_upper = 1e3
        solver.nodes.force_lower = -1e3
        solver.nodes.force_upper = 1e3
        solver.nodes.friction = 1e3
        a, b = plain.solve(x0), solver.solve(x0)
        np.testing.assert_allclose(b.us, a.us, rtol=1e-12)
        assert a.iterations == b.iterations


def test_bounded_noisy_loop_converges() -> None:
    robot = catalogue_chain("lwr4")
    solver, x0, unbounded = bounded("force_feedback", 3)
    solver.nodes.torque_upper = np.min(unbounded, axis=0) + 0.6 * np.ptp(unbounded, axis=0) + 1e-2
    solver.nodes.force_lower[:, 2] = 0.0
    solver.nodes.force_upper[:, 2] = 25.0
    solver.nodes.friction = 0.5
    rng = np.random.default_rng(6)
    solutions = [solver.solve(noisy(x0, robot.model.nv, rng)) for _ in range(500)]
    assert sum(s.status == "converged" for s in solutions) >= 495
    assert max(s.violation for s in solutions if s.status == "converged") <= 1e-4


@pytest.mark.parametrize("kind", ["classical", "torque_feedback"])
def test_bounded_noisy_loop_with_a_rigid_contact_converges(kind: str) -> None:
    """The force bound is active, its multiplier small beside the penalty: the active set must settle even so."""
    robot = catalogue_chain("lwr4")
    solver, x0, _ = bounded(kind, 3)
    n, rest = robot.model.nv, solver.us[0]
    solver.nodes.torque_lower, solver.nodes.torque_upper = rest - 20.0, rest + 20.0
    solver.nodes.force_lower[:, 2], solver.nodes.force_upper[:, 2] = 0.0, 25.0
    rng = np.random.default_rng(7)
    solutions = [solver.solve(noisy(x0, n, rng), max_iterations=8) for _ in range(300)]
    assert sum(s.status == "converged" for s in solutions) >= 297
    assert np.mean([np.any(s.forces[1:, 2] >= 25.0 - 1e-3) for s in solutions]) > 0.9
    assert np.mean([s.iterations for s in solutions]) < 2.5


@pytest.mark.parametrize(
    ("kind", "dim"), [("force_feedback", 1), ("classical", 1), ("classical", 3), ("torque_feedback", 1)]
)
def test_contradictory_bounds_end_with_an_honest_status(kind: str, dim: int) -> None:
    """Joint torques of 1 N·m cannot hold the arm on a surface that gives 25 N; a force state cannot jump to 60 N."""
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, kind, dim, bounds=True)
    normal = min(dim, 3) - 1
    solver.nodes.torque_lower, solver.nodes.torque_upper = -1.0, 1.0
    solver.nodes.force_lower[:, normal], solver.nodes.force_upper[:, normal] = (
        (60.0, 80.0) if kind == "force_feedback" else (0.0, 25.0)
    )
    rng = np.random.default_rng(8)
    for _ in range(10):
        solution = solver.solve(noisy(x0, robot.model.nv, rng))
        assert solution.status in ("max_iterations", "line_search", "not_positive_definite")
        assert solution.violation > 1e-2
        assert solution.kkt >= (1.0 - 1e-6) * solution.violation
        for values in (solution.us, solution.xs, solution.forces, solution.feedback_gain):
            assert np.all(np.isfinite(values))
    solver.nodes.torque_lower, solver.nodes.torque_upper = -1e3, 1e3  # once they can be kept, it recovers
    solver.nodes.force_lower[:, normal] = 0.0
    solver.reset()
    solver.quasi_static(x0)
    assert solver.solve(x0, max_iterations=50).status == "converged"


@pytest.mark.parametrize("dt", [DT, 5e-3])
@pytest.mark.parametrize("kind", ["classical", "torque_feedback", "force_feedback"])
def test_torque_bounds_and_cone_together(kind: str, dt: float) -> None:
    """Both bite in many of the problems; each is feasible, shown by a trajectory that is not the solver's answer."""
    found = tried(kind, range(60 if dt == DT else 50), dt)
    assert found.converged >= 0.92 * found.problems
    assert found.both >= 0.25 * found.problems
