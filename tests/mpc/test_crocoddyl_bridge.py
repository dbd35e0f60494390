"""The kernel and its solver against mim-solvers and crocoddyl on the same problem."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, MissingExtraError
from pliant.mpc.config import Bounds, Contact, MpcConfig
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, TorqueFeedbackMpc
from pliant.mpc.make_problem import problem_from_model
from pliant.mpc.nodes import copy_nodes
from pliant.spatial import Array

from .problems import config, polishing_arm, posed, random_posture, randomise, start_state

crocoddyl = pytest.importorskip("crocoddyl")
mim_solvers = pytest.importorskip("mim_solvers")

from pliant.mpc.crocoddyl.bridge import shooting_problem  # noqa: E402

OFFSET = np.array([0.01, 0.01, 0.0])  # m
REGULARISATION = 1e-9
THREE = [ForceFeedbackMpc(), ClassicalMpc(), TorqueFeedbackMpc()]
SLIDING = ForceFeedbackMpc(contact=Contact(dimension=3, friction=0.3, stiffness=(1e3,), damping=(20.0,)))


def _mim(problem: Any, xs: Array, us: Array, iterations: int, tolerance: float) -> Any:
    solver = mim_solvers.SolverSQP(problem)
    solver.termination_tolerance = tolerance
    solver.use_filter_line_search = True
    solver.filter_size = 8
    solver.reg_min = REGULARISATION
    solver.solve(list(xs), list(us), iterations, False, REGULARISATION)
    return solver


@pytest.mark.parametrize("settings", [*THREE, SLIDING], ids=[*(c.kind for c in THREE), "sliding"])
@pytest.mark.parametrize("nodes_from", ["kernel", "pinocchio"])
def test_mim_solvers_takes_the_same_iterations_to_the_same_torques(settings: MpcConfig, nodes_from: str) -> None:
    robot = polishing_arm()
    problem, chain, solver = posed(robot, settings, OFFSET, 30.0)
    for seed in range(3):
        x0 = start_state(problem, robot, np.random.default_rng(seed))
        solver.quasi_static(x0)
        xs, us = solver.xs, solver.us
        other = shooting_problem(problem, solver.nodes, x0, chain if nodes_from == "kernel" else None)
        ours = solver.solve(x0, xs, us, max_iterations=4, tolerance=1e-13)
        theirs = _mim(other, xs, us, 4, 1e-13)
        assert ours.iterations == theirs.iter == 4
        # torque feedback has w-weights of 1e-9: a rounding error of the gradient moves w by a billion times as much
        tolerance = 1e-8 if settings.kind != "torque_feedback" else 1e-6
        np.testing.assert_allclose(np.array(theirs.us.tolist()), ours.us, atol=tolerance, rtol=1e-9)
        assert other.calc(list(ours.xs), list(ours.us)) == pytest.approx(ours.cost, rel=1e-9)


@pytest.mark.parametrize("settings", THREE, ids=lambda c: c.kind)
def test_it_stops_as_soon_as_the_same_residual_is_seen(settings: MpcConfig) -> None:
    """The kernel looks at the residual right after a step, mim-solvers before the next one: at most one step apart."""
    robot = polishing_arm()
    problem, chain, solver = posed(robot, settings, OFFSET, 30.0)
    for seed in range(5):
        x0 = start_state(problem, robot, np.random.default_rng(seed))
        solver.quasi_static(x0)
        xs, us = solver.xs, solver.us
        ours = solver.solve(x0, xs, us, max_iterations=20, tolerance=1e-4)
        theirs = _mim(shooting_problem(problem, solver.nodes, x0, chain), xs, us, 20, 1e-4)
        assert ours.status == "converged"
        assert theirs.iter - 1 <= ours.iterations <= theirs.iter


def test_fddp_finds_the_same_optimum() -> None:
    robot = polishing_arm()
    problem, chain, solver = posed(robot, ClassicalMpc(), OFFSET, 30.0)
    x0 = start_state(problem, robot, np.random.default_rng(0))
    solver.quasi_static(x0)
    xs, us = solver.xs, solver.us
    ours = solver.solve(x0, xs, us, max_iterations=20, tolerance=1e-7)
    fddp = crocoddyl.SolverFDDP(shooting_problem(problem, solver.nodes, x0, chain))
    fddp.th_stop = 1e-14
    assert fddp.solve(list(xs), list(us), 50, False, REGULARISATION)
    np.testing.assert_allclose(np.array(fddp.us.tolist()), ours.us, atol=1e-4)


def test_bounded_problem_agrees_with_csqp() -> None:
    robot = polishing_arm()
    settings = ForceFeedbackMpc(bounds=Bounds(torque=True))
    problem, chain, solver = posed(robot, settings, np.array([0.05, 0.0, 0.0]), 30.0)
    solver.nodes.torque_upper[:, 1] = -20.0  # N·m, active: free it wants more
    x0 = start_state(problem, robot, np.random.default_rng(0))
    solver.quasi_static(x0)
    xs, us = solver.xs, solver.us
    ours = solver.solve(x0, xs, us, max_iterations=30, tolerance=1e-6)
    csqp = mim_solvers.SolverCSQP(shooting_problem(problem, solver.nodes, x0, chain, constraints=True))
    csqp.termination_tolerance, csqp.eps_abs, csqp.eps_rel, csqp.max_qp_iters = 1e-6, 1e-10, 0.0, 20_000
    csqp.use_filter_line_search = True
    csqp.solve(list(xs), list(us), 30, False, REGULARISATION)
    theirs = np.array(csqp.us.tolist())
    assert ours.us[:, 1].max() <= -20.0 + 1e-4
    assert np.any(np.abs(ours.us[:, 1] + 20.0) < 1e-3), "the bound should be active"
    np.testing.assert_allclose(theirs, ours.us, rtol=1e-4, atol=5e-3)  # what the inner ADMM of CSQP is good for


def test_a_tree_with_a_free_base_is_solved() -> None:
    model = pin.buildSampleModelHumanoid()
    model.addFrame(pin.Frame("tool", model.njoints - 1, 0, pin.SE3.Identity(), pin.OP_FRAME))
    settings = config("force_feedback", 3, "world", horizon=3)
    rng = np.random.default_rng(0)
    problem = problem_from_model(model, settings, pin.neutral(model))
    nodes = problem.nodes()
    randomise(nodes, model, rng)
    nodes.velocity_reference[...], nodes.force_reference[...] = 0.0, 0.0
    x0 = np.concatenate([random_posture(model, rng), np.zeros(model.nv + 3)])
    nodes.state_reference[:, : model.nq] = x0[: model.nq]
    shooting = shooting_problem(problem, nodes, x0)
    xs, us = np.tile(x0, (4, 1)), np.zeros((3, problem.nu))
    solver = _mim(shooting, xs, us, 20, 1e-5)
    assert solver.KKT <= 1e-5
    assert np.all(np.isfinite(np.array(solver.us.tolist())))
    state = shooting.runningModels[0].state
    dx = rng.normal(size=state.ndx)
    np.testing.assert_allclose(state.diff(x0, state.integrate(x0, dx)), dx, atol=1e-9)


def test_nodes_are_copied_not_shared() -> None:
    robot = polishing_arm()
    problem, chain, solver = posed(robot, ForceFeedbackMpc(), OFFSET, 30.0)
    x0 = start_state(problem, robot, np.random.default_rng(0))
    shooting = shooting_problem(problem, solver.nodes, x0, chain)
    before = shooting.calc(list(solver.xs), list(solver.us))
    nodes = problem.nodes()
    copy_nodes(solver.nodes, nodes)
    solver.nodes.force_reference[...] = 1e3
    assert shooting.calc(list(solver.xs), list(solver.us)) == before
    assert nodes.force_reference.max() == pytest.approx(30.0)


def test_friction_cone_is_refused() -> None:
    settings = config("force_feedback", 3, bounds={"friction": 0.5}, phases={"circle": {"contact": True}})
    problem, _, solver = posed(polishing_arm(), settings, OFFSET, 0.0)
    with pytest.raises(ConfigError, match="no friction cone"):
        shooting_problem(problem, solver.nodes, np.zeros(15), constraints=True)


def test_force_bounds_on_a_rigid_contact_are_refused() -> None:
    settings = config("classical", 1, bounds={"force_max": 80.0}, phases={"circle": {"contact": True}})
    problem, _, solver = posed(polishing_arm(), settings, OFFSET, 0.0)
    with pytest.raises(ConfigError, match="only where it is a state"):
        shooting_problem(problem, solver.nodes, np.zeros(12), constraints=True)


def test_without_the_extra_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "crocoddyl", None)
    monkeypatch.delitem(sys.modules, "pliant.mpc.crocoddyl.bridge")
    with pytest.raises(MissingExtraError, match=r"pip install 'pliant\[crocoddyl\]'"):
        importlib.import_module("pliant.mpc.crocoddyl.bridge")
