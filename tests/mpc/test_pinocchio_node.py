"""The Python models: derivatives by finite differences, on arms and on a tree with a free base."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError
from pliant.mpc.crocoddyl.node import PinocchioNode
from pliant.mpc.make_problem import problem_from_model, problem_from_robot
from pliant.mpc.problem import MpcProblem
from pliant.spatial import Array

from .problems import AXES, KINDS, config, polishing_arm, random_state, randomise

CASES = [
    (kind, dimension, axes)
    for kind, dimension, axes in itertools.product(KINDS, (1, 3, 6), AXES)
    if not (kind == "naive_viscoelastic" and dimension == 6)
    and not (kind == "free" and (dimension, axes) != (1, "world"))
]


def _plus(model: pin.Model, x: Array, dx: Array) -> Array:
    q = pin.integrate(model, x[: model.nq], dx[: model.nv])
    return np.concatenate([q, x[model.nq :] + dx[model.nv :]])


def _minus(model: pin.Model, x_1: Array, x_0: Array) -> Array:
    dq = pin.difference(model, x_0[: model.nq], x_1[: model.nq])
    return np.concatenate([dq, x_1[model.nq :] - x_0[model.nq :]])


def _worst(analytic: Array, numeric: Array) -> float:
    return float(np.max(np.abs(analytic - numeric)) / (1.0 + np.max(np.abs(numeric))))


def _errors(problem: MpcProblem, terminal: bool, active: bool = True) -> dict[str, float]:
    rng = np.random.default_rng(7)
    node = PinocchioNode(problem, terminal=terminal)
    randomise(node.parameters, problem.model, rng)
    problem.write_constants(node.parameters)
    node.parameters.contact_active[...] = active
    x = random_state(problem.model, node.nx - problem.model.nq - problem.model.nv, rng)
    u = 5.0 * rng.normal(size=node.nu)
    values = node.evaluate(x, u)
    h = 1e-6
    fx, Lx = np.full_like(values.fx, np.nan), np.full_like(values.Lx, np.nan)
    fu, Lu = np.full_like(values.fu, np.nan), np.full_like(values.Lu, np.nan)
    for i, step in enumerate(h * np.eye(node.ndx)):
        ahead, behind = (node.evaluate(_plus(problem.model, x, sign * step), u) for sign in (1.0, -1.0))
        fx[:, i] = _minus(problem.model, ahead.x_next, behind.x_next) / (2 * h)
        Lx[i] = (ahead.cost - behind.cost) / (2 * h)
    for i, step in enumerate(h * np.eye(node.nu)):
        ahead, behind = (node.evaluate(x, u + sign * step) for sign in (1.0, -1.0))
        fu[:, i] = _minus(problem.model, ahead.x_next, behind.x_next) / (2 * h)
        Lu[i] = (ahead.cost - behind.cost) / (2 * h)
    pairs = {"fx": (values.fx, fx), "fu": (values.fu, fu), "Lx": (values.Lx, Lx), "Lu": (values.Lu, Lu)}
    return {name: _worst(*pair) for name, pair in pairs.items()}


@pytest.mark.parametrize(("kind", "dimension", "axes"), CASES)
@pytest.mark.parametrize("terminal", [False, True])
def test_derivatives_match_finite_differences(kind: str, dimension: int, axes: str, terminal: bool) -> None:
    # Central differences with h = 1e-6: truncation 1e-12 × third derivative, rounding 1e-16/h × value.
    errors = _errors(problem_from_robot(polishing_arm(), config(kind, dimension, axes)), terminal)
    assert max(errors.values()) < 3e-6, errors


@pytest.mark.parametrize(("dimension", "axes"), list(itertools.product((3, 6), AXES)))
@pytest.mark.parametrize("friction", [0.05, 0.7])
def test_derivatives_of_a_contact_that_slides(dimension: int, axes: str, friction: float) -> None:
    robot = polishing_arm()
    sliding = problem_from_robot(robot, config("force_feedback", dimension, axes, friction=friction))
    errors = _errors(sliding, terminal=False)
    assert max(errors.values()) < 3e-6, errors


@pytest.mark.parametrize("kind", ["force_feedback", "classical", "torque_feedback", "free"])
def test_derivatives_on_a_tree_with_a_free_base(kind: str) -> None:
    model = pin.buildSampleModelHumanoid()
    frame = pin.Frame(
        "tool", model.njoints - 1, 0, pin.SE3(pin.exp3(np.array([0.1, 0.4, -0.3])), np.full(3, 0.1)), pin.OP_FRAME
    )
    model.addFrame(frame)
    problem = problem_from_model(model, config(kind, 3, "world"), pin.neutral(model))
    assert problem.nu == model.nv - 6
    errors = _errors(problem, terminal=False)
    assert max(errors.values()) < 3e-6, errors


def test_without_contact_the_force_neither_acts_nor_moves() -> None:
    problem = problem_from_robot(polishing_arm(), config("force_feedback", 1))
    node = PinocchioNode(problem)
    rng = np.random.default_rng(1)
    randomise(node.parameters, problem.model, rng)
    node.parameters.contact_active[...] = False
    x, u = random_state(problem.model, 1, rng), rng.normal(size=6)
    values = node.evaluate(x, u)
    other = node.evaluate(x + np.eye(13)[12] * 10.0, u)
    np.testing.assert_array_equal(values.force_rate, 0.0)
    np.testing.assert_allclose(other.acceleration, values.acceleration)
    assert other.cost == pytest.approx(values.cost)
    assert max(_errors(problem, terminal=False, active=False).values()) < 3e-6


def test_rigid_contact_does_not_accelerate_into_the_wall() -> None:
    problem = problem_from_robot(
        polishing_arm(), config("classical", 1, contact={"baumgarte": (0.0, 0.0), "dimension": 1})
    )
    node, rng = PinocchioNode(problem), np.random.default_rng(3)
    x, u = random_state(problem.model, 0, rng), rng.normal(size=6)
    values = node.evaluate(x, u)
    n, data = problem.model.nv, problem.model.createData()
    pin.forwardKinematics(problem.model, data, x[:n], x[n:], values.acceleration)
    frame = problem.model.getFrameId("tool")
    assert pin.getFrameClassicalAcceleration(problem.model, data, frame, pin.LOCAL_WORLD_ALIGNED).linear[
        2
    ] == pytest.approx(0.0, abs=1e-9)
    torque = pin.rnea(problem.model, data, x[:n], x[n:], values.acceleration)
    J = pin.computeFrameJacobian(problem.model, data, x[:n], frame, pin.LOCAL_WORLD_ALIGNED)
    np.testing.assert_allclose(torque - J[2] * values.force[0], u, atol=1e-9)


def test_what_only_the_kernel_has_is_said() -> None:
    exponential = config("force_feedback", 1, contact={"integrator": "exponential"})
    with pytest.raises(ConfigError, match="'euler' only"):
        PinocchioNode(problem_from_robot(polishing_arm(), exponential))
    springy = config("classical", 6, contact={"dimension": 6, "baumgarte": (5.0, 10.0)})
    with pytest.raises(ConfigError, match="dimension 1 or 3"):
        PinocchioNode(problem_from_robot(polishing_arm(), springy))
