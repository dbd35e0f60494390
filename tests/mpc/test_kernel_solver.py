"""The stagewise SQP: against dense algebra, from large errors, over instruction sets, threads and budgets."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from pliant import _mpc
from tests.twins.mpc_robots import catalogue_chain, random_chain

from .kernel_problem import DT, HORIZON, nodes_like, noisy, polishing

Vector = np.ndarray
CASES = [
    ("force_feedback", 1),
    ("force_feedback", 3),
    ("force_feedback", 6),
    ("classical", 1),
    ("classical", 3),
    ("torque_feedback", 1),
    ("torque_feedback", 3),
    ("free", 0),
]


def dense_newton(
    nodes: list[_mpc.Node], xs: Vector, us: Vector, regularisation: float
) -> tuple[Vector, Vector, Vector]:
    """One SQP step by a dense KKT system: new xs, new us, and ∂u_0/∂x_0."""
    N, nx, nu = len(us), xs.shape[1], us.shape[1]
    size = N * (nx + nu)  # x_1 … x_N, u_0 … u_{N-1}; x_0 is fixed
    H, g = regularisation * np.eye(size), np.zeros(size)
    A, b, A0 = np.zeros((N * nx, size)), np.zeros(N * nx), np.zeros((N * nx, nx))
    H0 = np.zeros((size, nx))
    at_x, at_u = lambda k: slice((k - 1) * nx, k * nx), lambda k: slice(N * nx + k * nu, N * nx + (k + 1) * nu)
    for k, node in enumerate(nodes):
        r = node.calc_diff(xs[k], us[k] if k < N else np.zeros(nu))
        if k > 0:
            H[at_x(k), at_x(k)] += r.Lxx
            g[at_x(k)] += r.Lx
        if k == N:
            break
        H[at_u(k), at_u(k)] += r.Luu
        g[at_u(k)] += r.Lu
        row = slice(k * nx, (k + 1) * nx)
        A[row, at_x(k + 1)] = -np.eye(nx)
        A[row, at_u(k)] = r.fu
        b[row] = r.x_next - xs[k + 1]
        if k > 0:
            H[at_x(k), at_u(k)] += r.Lxu
            H[at_u(k), at_x(k)] += r.Lxu.T
            A[row, at_x(k)] = r.fx
        else:
            A0[row] = r.fx
            H0[at_u(0)] = r.Lxu.T
    scale = 1e3  # on the multipliers, for the conditioning of the dense system
    kkt = np.block([[H, scale * A.T], [scale * A, np.zeros((N * nx, N * nx))]])
    right = np.concatenate([np.column_stack([g, H0]), scale * np.column_stack([b, A0])])
    step = -np.linalg.solve(kkt, right)[:size]
    dx, du = step[: N * nx, 0].reshape(N, nx), step[N * nx :, 0].reshape(N, nu)
    return np.vstack([xs[:1], xs[1:] + dx]), us + du, step[at_u(0), 1:]


@pytest.mark.parametrize("dt", [DT, 5e-3])
@pytest.mark.parametrize(("kind", "dim"), CASES)
def test_one_step_equals_dense_kkt(kind: str, dim: int, dt: float) -> None:
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, kind, dim, dt=dt)
    x0 = noisy(x0, 7, np.random.default_rng(0))
    xs, us = solver.xs, solver.us
    xs[0] = x0
    expected_xs, expected_us, gain = dense_newton(nodes_like(solver, robot, kind, dim), xs, us, 1e-9)
    solution = solver.solve(x0, max_iterations=1, tolerance=1e-15)
    assert solution.iterations == 1
    scale = np.max(np.abs(expected_us - us))
    np.testing.assert_allclose(solution.us, expected_us, atol=1e-6 * scale)
    np.testing.assert_allclose(solution.xs, expected_xs, atol=1e-6 * np.max(np.abs(expected_xs - xs)))
    np.testing.assert_allclose(solution.feedback_gain, -gain, atol=1e-6 * np.max(np.abs(gain)))


@pytest.mark.parametrize("dt", [DT, 5e-3])
@pytest.mark.parametrize(("kind", "dim"), CASES)
def test_converged_means_stationary(kind: str, dim: int, dt: float) -> None:
    """At a converged solution the dense Newton step is almost nothing, and the plan is dynamically feasible."""
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, kind, dim, dt=dt)
    solution = solver.solve(noisy(x0, 7, np.random.default_rng(1)), max_iterations=50, tolerance=1e-9)
    assert solution.status == "converged"
    assert solution.kkt <= 1e-9
    xs, us, _ = dense_newton(nodes_like(solver, robot, kind, dim), solution.xs, solution.us, 1e-9)
    assert np.max(np.abs(xs[:, :14] - solution.xs[:, :14])) < 1e-5  # rad, rad/s
    if kind != "torque_feedback":  # there the weight of 1e-9 on w leaves w itself loose
        assert np.max(np.abs(us - solution.us)) < 1e-2  # N·m; a gradient of 1e-9 against a curvature of 3e-7
    assert solution.gap < 1e-8


@pytest.mark.parametrize(("kind", "dim"), CASES)
def test_noisy_loop_converges_within_eight_iterations(kind: str, dim: int) -> None:
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, kind, dim)
    rng = np.random.default_rng(2)
    statuses = [solver.solve(noisy(x0, 7, rng)).status for _ in range(1000)]
    assert statuses.count("converged") >= 999


@pytest.mark.parametrize(("kind", "dim"), [("force_feedback", 1), ("force_feedback", 3), ("classical", 1)])
def test_converges_from_large_start_errors(kind: str, dim: int) -> None:
    robot = catalogue_chain("iiwa14")
    rng = np.random.default_rng(3)
    converged = 0
    for _ in range(200):
        solver, x0 = polishing(robot, kind, dim)
        x0[:6] += rng.uniform(-0.2, 0.2, 6)
        solver.quasi_static(x0)
        converged += solver.solve(x0, max_iterations=50).status == "converged"
    assert converged >= 198


@pytest.mark.parametrize("name", ["lwr4", "leg3"])
@pytest.mark.parametrize(
    ("kind", "dim"), [("force_feedback", 1), ("force_feedback", 3), ("force_feedback", 6), ("torque_feedback", 1)]
)
def test_instruction_sets_agree(name: str, kind: str, dim: int) -> None:
    robot = catalogue_chain(name)
    n = robot.model.nv
    chosen = _mpc.instruction_set()
    torques = []
    try:
        for isa in _mpc.available_instruction_sets():
            _mpc.use_instruction_set(isa)
            solver, x0 = polishing(robot, kind, dim)
            rng = np.random.default_rng(4)
            torques.append(np.array([solver.solve(noisy(x0, n, rng)).us[0] for _ in range(50)]))
    finally:
        _mpc.use_instruction_set(chosen)
    for other in torques[1:]:
        assert np.max(np.abs(other - torques[0])) <= 1e-9 * np.max(np.abs(torques[0]))


def test_threads_do_not_disturb_each_other() -> None:
    robot = catalogue_chain("lwr4")

    def run(seed: int, results: dict[int, Vector]) -> None:
        solver, x0 = polishing(robot, "force_feedback", 3)
        rng = np.random.default_rng(seed)
        results[seed] = np.array([solver.solve(noisy(x0, 7, rng)).us[0] for _ in range(100)])

    alone: dict[int, Vector] = {}
    for seed in range(3):
        run(seed, alone)
    together: dict[int, Vector] = {}
    threads = [threading.Thread(target=run, args=(seed, together)) for seed in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(100.0)
    for seed in range(3):
        np.testing.assert_array_equal(together[seed], alone[seed])


def test_interpreter_runs_while_solving() -> None:
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, horizon=2000)
    solver.nodes.translation_reference += 0.3
    ticks = []
    worker = threading.Thread(target=lambda: solver.solve(x0, max_iterations=20, tolerance=1e-14))
    worker.start()
    while worker.is_alive():
        ticks.append(time.perf_counter())
        time.sleep(1e-4)
    worker.join(100.0)
    assert len(ticks) > 10


def test_statuses_are_honest() -> None:
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot)
    far = x0.copy()
    far[:7] += 0.2
    assert solver.solve(far, max_iterations=1, tolerance=1e-12).status == "max_iterations"
    solver, _ = polishing(robot)
    assert solver.solve(far, max_iterations=100, tolerance=1e-12, time_budget=0.0).status == "time_budget"
    solver, _ = polishing(robot)
    before = solver.us
    broken = x0.copy()
    broken[3] = np.nan
    solution = solver.solve(broken)
    assert solution.status == "nan"
    np.testing.assert_array_equal(solution.us, before)
    assert np.all(np.isfinite(solution.xs))


def test_shift_moves_the_plan_one_node() -> None:
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot)
    solution = solver.solve(x0)
    solver.shift()
    np.testing.assert_array_equal(solver.xs[:-1], solution.xs[1:])
    np.testing.assert_array_equal(solver.us[:-1], solution.us[1:])
    np.testing.assert_array_equal(solver.us[-1], solution.us[-1])


def test_feedback_gain_takes_most_of_a_disturbance() -> None:
    """From a converged plan, us[0] − K δ is near the solution at x0 + δ (Gauss–Newton: not to second order in δ)."""
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot)
    first = solver.solve(x0, max_iterations=50, tolerance=1e-9)
    change = 1e-4 * np.random.default_rng(5).normal(size=solver.nx)
    second = solver.solve(x0 + change, max_iterations=50, tolerance=1e-9)
    left = second.us[0] - (first.us[0] - first.feedback_gain @ change)
    assert np.linalg.norm(left) < 0.25 * np.linalg.norm(second.us[0] - first.us[0])


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 8])
def test_any_number_of_joints(n: int) -> None:
    robot = random_chain(n, 30 + n, prismatic=0.0)
    solver, x0 = polishing(robot, "force_feedback", 1)
    solution = solver.solve(x0, max_iterations=30)
    assert solution.status == "converged"
    assert solution.us.shape == (HORIZON, n)
