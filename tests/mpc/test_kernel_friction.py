"""A predicted contact that slides: the compiled node against its twin and finite differences.

Points stick (the arm at rest under load), slide, and touch with next to no normal force or less.
"""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _mpc
from tests.twins.mpc_robots import random_chain
from tests.twins.mpc_twin import AXES, Twin, node_and_twin, random_point

from .test_kernel_derivatives import check_node, difference

Vector = np.ndarray
STICKING, SLIDING = "sticking", "sliding"
NORMALS = (30.0, 0.2, 0.0, -15.0)  # N
CASES = [(dim, axes, normal) for dim in (3, 6) for axes in AXES for normal in NORMALS]


def point(node: _mpc.Node, twin: Twin, motion: str, normal: float, seed: int) -> tuple[Vector, Vector]:
    """A random state and torque; sticking: slower than 1 mm/s, the torque in balance but for 1e-3 N·m."""
    rng = np.random.default_rng(seed)
    x, u = random_point(node, twin.robot, seed)
    n = twin.model.nv
    x[2 * n + 2] = normal
    if motion == STICKING:
        x[n : 2 * n] *= 3e-4
        jacobian, _, _ = twin.kinematics(x[:n], x[n : 2 * n])
        u = twin.bias(x[:n], x[n : 2 * n]) - jacobian.T @ x[2 * n :] + 1e-3 * rng.normal(size=n)
    return x, u


@pytest.mark.parametrize(("dim", "axes", "normal"), CASES)
@pytest.mark.parametrize("motion", [STICKING, SLIDING])
def test_node_and_twin_agree(dim: int, axes: str, normal: float, motion: str) -> None:
    for seed, friction in ((1, 0.05), (2, 0.3), (3, 1.5)):
        robot = random_chain(7, seed)
        node, twin = node_and_twin(robot, "force_feedback", dim, axes, seed)
        x, u = point(node, twin, motion, normal, seed)
        without = node.calc(x, u)
        node.parameters.sliding_friction = friction
        got = node.calc(x, u)
        x_next, cost, _, rate = twin(x, u)
        for value, expected in ((got.x_next, x_next), (got.cost, cost), (got.force_rate, rate)):
            assert np.all(np.abs(value - expected) <= 1e-10 * np.max(np.abs(expected), initial=1.0))
        assert np.all(got.force_rate[:2] != without.force_rate[:2])
        np.testing.assert_array_equal(got.force_rate[2:], without.force_rate[2:])  # normal force and moments
        np.testing.assert_allclose(got.x_next[14:], x[14:] + twin.dt * got.force_rate, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("dim", "axes", "normal"), CASES)
def test_derivatives_while_sliding(dim: int, axes: str, normal: float) -> None:
    for seed, friction in ((4, 0.05), (5, 0.8)):
        node, twin = node_and_twin(random_chain(7, seed), "force_feedback", dim, axes, seed)
        node.parameters.sliding_friction = friction
        check_node(node, *point(node, twin, SLIDING, normal, seed))


@pytest.mark.parametrize(("dim", "axes", "normal"), CASES)
@pytest.mark.parametrize("motion", [STICKING, SLIDING])
@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_derivatives_of_the_tangential_force_rate(
    dim: int, axes: str, normal: float, motion: str, friction: float
) -> None:
    """By themselves, so that larger derivatives do not hide them; stiff, with axes of different stiffness.

    The law bends within 1 mm/s at rest: the step must be small against that.
    """
    robot = random_chain(7, 6)
    node, twin = node_and_twin(robot, "force_feedback", dim, axes, 6)
    node.parameters.stiffness[:, :2], node.parameters.damping[:, :2] = (1e4, 4e3), (60.0, 30.0)
    node.parameters.sliding_friction = friction
    x, u = point(node, twin, motion, normal, 6)
    result, step = node.calc_diff(x, u), 1e-7 if motion == STICKING else 1e-6
    by_x, by_u = (np.asarray(part)[14:16] / twin.dt for part in (result.fx, result.fu))
    by_x[:, 14:16] -= np.eye(2) / twin.dt
    # the second part is what rounding of λ̇ leaves, 1e-16 |λ̇| / step, over the tolerance
    scale = np.max(np.abs(by_x)) + 1e-9 * np.max(np.abs(result.force_rate)) / step
    for got, expected in (
        (by_x, difference(lambda z: node.calc(z, u).force_rate[:2], x, step)),
        (by_u, difference(lambda z: node.calc(x, z).force_rate[:2], u, step)),
    ):
        assert np.max(np.abs(got - expected)) <= 3e-6 * scale


def test_infinite_friction_is_no_friction() -> None:
    """Bit for bit, and a friction that the force never reaches comes close."""
    robot = random_chain(7, 8)
    node, twin = node_and_twin(robot, "force_feedback", 3, "world", 8)
    x, u = point(node, twin, SLIDING, 20.0, 8)
    untouched = node.calc_diff(x, u)
    node.parameters.sliding_friction = 0.3
    assert np.max(np.abs(node.calc_diff(x, u).fx - untouched.fx)) > 0.1
    node.parameters.sliding_friction = np.inf
    infinite = node.calc_diff(x, u)
    node.parameters.sliding_friction = 1e12
    huge = node.calc_diff(x, u)
    for name in ("cost", "x_next", "force_rate", "fx", "fu", "Lx", "Lu", "Lxx", "Lxu", "Luu"):
        np.testing.assert_array_equal(getattr(infinite, name), getattr(untouched, name))
        np.testing.assert_allclose(getattr(huge, name), getattr(untouched, name), rtol=1e-7, atol=1e-7)


def test_without_contact_friction_does_nothing() -> None:
    node, twin = node_and_twin(random_chain(7, 9), "force_feedback", 3, "world", 9, active=False)
    x, u = point(node, twin, SLIDING, 20.0, 9)
    expected = node.calc_diff(x, u)
    node.parameters.sliding_friction = 0.3
    got = node.calc_diff(x, u)
    for name in ("cost", "x_next", "force_rate", "fx", "fu", "Lxx"):
        np.testing.assert_array_equal(getattr(got, name), getattr(expected, name))


@pytest.mark.parametrize(
    ("kind", "dim", "integrator", "friction", "message"),
    [
        ("force_feedback", 3, "euler", 0.0, r"sliding_friction must be positive \(infinite: none\), but node 0 has 0"),
        ("force_feedback", 3, "euler", np.nan, r"sliding_friction must be positive"),
        ("force_feedback", 1, "euler", 0.3, r"contact_dim 3 or 6, but node 0 has 0.3"),
        ("classical", 3, "euler", 0.3, r"needs kind 'force_feedback'"),
        ("force_feedback", 3, "exponential", 0.3, r"needs integrator 'euler'"),
    ],
)
def test_where_it_does_not_belong_it_is_refused(
    kind: str, dim: int, integrator: str, friction: float, message: str
) -> None:
    robot = random_chain(7, 10)
    node = _mpc.Node(robot.chain, _mpc.Model(kind, dim, integrator=integrator), 3e-3)
    node.parameters.sliding_friction = friction
    with pytest.raises(ValueError, match=message):
        node.calc(np.zeros(node.nx), np.zeros(7))


@pytest.mark.parametrize("isa", _mpc.available_instruction_sets())
def test_instruction_sets_agree(isa: str) -> None:
    robot, chosen = random_chain(7, 11), _mpc.instruction_set()
    for dim in (3, 6):
        results = []
        for name in (chosen, isa):
            _mpc.use_instruction_set(name)
            try:
                node, twin = node_and_twin(robot, "force_feedback", dim, "local", 11)
            finally:
                _mpc.use_instruction_set(chosen)
            node.parameters.sliding_friction = 0.3
            results.append(node.calc_diff(*point(node, twin, SLIDING, 20.0, 11)))
        for field in ("x_next", "fx", "fu", "Lx", "Lu", "Lxx", "Lxu", "Luu"):
            a, b = (np.asarray(getattr(result, field)) for result in results)
            assert np.max(np.abs(a - b)) <= 1e-9 * np.max(np.abs(a), initial=1.0)
