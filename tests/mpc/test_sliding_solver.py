"""The solver over a predicted contact that slides: it converges, and claims no solution where there is none."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _mpc
from pliant.configuration import merged
from pliant.entries import Believed
from pliant.mpc.defaults import ForceFeedbackMpc
from pliant.mpc.noisy_loop import BenchCase, NoisyLoop
from pliant.mpc.registry import CONTROLLERS
from pliant.robot import Robot, Tool
from tests.twins.mpc_robots import catalogue_chain

from .kernel_problem import Vector, noisy, polishing
from .test_kernel_derivatives import difference


def sliding_solver(
    dim: int, speed: float, friction: float, *, tangential_costs: bool = False
) -> tuple[_mpc.Solver, Vector]:
    """The polishing problem on a stiff contact, moving along x at `speed` m/s, from a state that does."""
    robot = catalogue_chain("lwr4")
    solver, x0 = polishing(robot, "force_feedback", dim)
    p, n, q = solver.nodes, robot.model.nv, robot.home
    p.stiffness[:, :2], p.damping[:, :2] = 1e4, 60.0
    p.sliding_friction = friction
    if not tangential_costs:
        p.force_weight[:, :2] = p.force_rate_weight[:, :2] = 0.0
    p.translation_reference[:, 0] += speed * solver.dt * np.arange(solver.horizon + 1)
    p.velocity_reference[:, 0] = speed
    jacobian = difference(lambda at: robot.chain.contact_placement(at)[1], q)
    x0[n : 2 * n] = np.linalg.pinv(jacobian) @ [speed, 0.0, 0.0]
    if speed:
        x0[2 * n] = -0.25 * x0[2 * n + 2]
    solver.quasi_static(x0)
    return solver, x0


@pytest.mark.parametrize("dim", [3, 6])
@pytest.mark.parametrize("speed", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("tangential_costs", [False, True])
def test_warm_noisy_loop_converges_as_without_friction(dim: int, speed: float, tangential_costs: bool) -> None:
    """KKT 1e-4 within eight iterations, by the measure of the models without friction; the measured force is that of
    μ = 0.25, what the model believes is that, less and more."""
    iterations = {}
    for friction in (np.inf, 0.25, 0.15, 0.4):
        solver, x0 = sliding_solver(dim, speed, friction, tangential_costs=tangential_costs)
        solver.solve(x0, max_iterations=50)  # the first plan is no near state
        rng = np.random.default_rng(12)
        solutions = [solver.solve(noisy(x0, 7, rng)) for _ in range(1000)]
        assert sum(s.kkt <= 1e-4 and s.iterations <= 8 for s in solutions) >= 999, friction
        iterations[friction] = np.mean([s.iterations for s in solutions])
    assert max(iterations.values()) < iterations[np.inf] + 1.0


@pytest.mark.parametrize("press", [True, False])
@pytest.mark.parametrize("friction", [0.25, 0.6])
def test_what_the_docs_recommend_converges_and_the_default_costs_do_not(press: bool, friction: float) -> None:
    """K_t = 1e3, B_t = 10, force costs on the normal only, as the benchmark moves. Baseline: costs on all axes."""
    robot = Robot.load("iiwa14", tool=Tool())
    reached = {}
    for activation in ((0.0, 0.0, 1.0), (1.0,)):
        own = {name: {"activation": activation} for name in ("force", "force_rate")}
        contact = {"dimension": 3, "friction": friction, "stiffness": (1e3,), "damping": (10.0, 10.0, 100.0)}
        settings = merged(ForceFeedbackMpc(), {"contact": contact, "costs": own})
        assert bool(CONTROLLERS["force-feedback-mpc"].advise(robot, settings, Believed(("flange",), 1e-3))) == (
            activation == (1.0,)
        )
        loop, solutions = NoisyLoop(BenchCase("", settings, robot, press=press)), []
        for _ in range(500):
            x = loop.next_state()
            loop.solver.shift()
            solutions.append(loop.solver.solve(x, max_iterations=8, tolerance=1e-4))
            loop.follow(solutions[-1].xs)
        reached[activation] = sum(s.kkt <= 1e-4 for s in solutions[20:]) / 480
    assert reached[0.0, 0.0, 1.0] >= 0.999
    assert reached[(1.0,)] < 0.95


def test_it_converges_through_a_reversal() -> None:
    """The reference turns back within the horizon: the force goes from one limit to the other."""
    solver, x0 = sliding_solver(3, 0.2, 0.25)
    turned = 0.2 * np.array([1.0, 0.5, 0.0, -0.5, -1.0, -1.0])
    solver.nodes.velocity_reference[:, 0], solver.nodes.velocity_weight[:, 0] = turned, 1e3
    solver.nodes.translation_weight[:, 0] = 0.0
    rng = np.random.default_rng(13)
    solutions = [solver.solve(noisy(x0, 7, rng)) for _ in range(200)]
    assert all(s.status == "converged" and s.iterations <= 8 for s in solutions)
    tangential = solutions[-1].xs[:, 14]
    assert tangential[0] < -3.0
    assert tangential[-1] > 3.0


def test_a_force_that_friction_cannot_carry_ends_with_an_honest_status() -> None:
    """15 N wanted along the surface where the limit is 6 N: no solution is claimed. Baseline: 5 N are reached."""
    for wanted, reachable in ((5.0, True), (15.0, False)):
        solver, x0 = sliding_solver(3, 0.0, 0.3, tangential_costs=True)
        x0[16] = 20.0
        solver.nodes.force_reference[:, 0] = wanted
        solver.quasi_static(x0)
        solver.solve(x0, max_iterations=50)
        rng = np.random.default_rng(14)
        solutions = [solver.solve(noisy(x0, 7, rng)) for _ in range(100)]
        assert sum(s.status == "converged" for s in solutions) >= 99 or not reachable
        assert all((s.kkt <= 1e-4) == (s.status == "converged") for s in solutions)
        assert all(np.all(np.isfinite(s.us)) and np.all(np.isfinite(s.xs)) for s in solutions)


def test_the_plan_keeps_what_the_contact_can_carry() -> None:
    """Baseline: a contact that sticks predicts forces far outside, from the same state."""
    peaks = {}
    for friction in (0.25, np.inf):
        solver, x0 = sliding_solver(3, 0.2, friction)
        solution = solver.solve(x0)
        peaks[friction] = np.max(np.abs(solution.xs[:, 14]) / solution.xs[:, 16])
    assert peaks[0.25] < 0.26
    assert peaks[np.inf] > 0.5
