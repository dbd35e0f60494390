"""Errors known from other implementations of the force-feedback model, each with a test that would catch it."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _mpc
from tests.twins.mpc_robots import random_chain
from tests.twins.mpc_twin import node_and_twin, random_point

STEP = 1e-6


@pytest.mark.parametrize("axes", ["world", "surface"])
def test_acceleration_by_force_uses_the_contact_axes(axes: str) -> None:
    """∂v̇/∂λ = M⁻¹Jᵀ with J in the contact's axes; J in local axes (the baseline) is far off."""
    robot = random_chain(7, 40)
    node, twin = node_and_twin(robot, "force_feedback", 1, axes, 1)
    x, u = random_point(node, robot, 1)
    n, q, v = 7, x[:7], x[7:14]
    by_force = node.calc_diff(x, u).fx[n : 2 * n, 2 * n] / twin.dt
    jacobian, _, _ = twin.kinematics(q, v)
    np.testing.assert_allclose(by_force, np.linalg.solve(twin.mass(q), jacobian[0]), rtol=1e-9)
    twin.axes = "local"
    local, _, _ = twin.kinematics(q, v)
    wrong = np.linalg.solve(twin.mass(q), local[0])
    assert np.max(np.abs(wrong - by_force)) > 0.1 * np.max(np.abs(by_force))


def test_cost_gradient_with_different_cost_and_contact_frames() -> None:
    """L_x of the placement costs belongs to the tool frame, also when the contact is elsewhere on the link."""
    robot = random_chain(7, 41)
    node, _ = node_and_twin(robot, "force_feedback", 3, "world", 2)
    x, u = random_point(node, robot, 2)
    tool, contact = robot.chain.tool_placement(x[:7])[1], robot.chain.contact_placement(x[:7])[1]
    assert np.linalg.norm(tool - contact) > 0.01
    got = node.calc_diff(x, u).Lx
    unit = np.eye(len(x))
    costs = [(node.calc(x + STEP * e, u).cost - node.calc(x - STEP * e, u).cost) / (2 * STEP) for e in unit]
    np.testing.assert_allclose(got, costs, atol=1e-6 * np.max(np.abs(costs)))


@pytest.mark.parametrize(
    ("weight", "rows"), [("force_rate_weight", slice(0, 14)), ("torque_gravity_weight", slice(0, 7))]
)
def test_cross_terms_of_the_hessian_are_there(weight: str, rows: slice) -> None:
    """L_xu and L_xλ of the force-rate cost and of the gravity regularisation, against JᵀJ of the one residual."""
    robot = random_chain(7, 42)
    node, twin = node_and_twin(robot, "force_feedback", 1, "world", 3)
    p = node.parameters
    for name in [name for name in dir(p) if name.endswith("_weight") and name != weight]:
        setattr(p, name, 0.0)
    x, u = random_point(node, robot, 3)

    def residual(z: np.ndarray) -> np.ndarray:
        q, v, force, torque = z[:7], z[7:14], z[14:15], z[15:]
        jacobian, speed, drift = twin.kinematics(q, v)
        if weight == "torque_gravity_weight":
            return torque - (twin.bias(q, 0 * v) - jacobian.T @ force)
        acceleration = np.linalg.solve(twin.mass(q), torque - twin.bias(q, v) + jacobian.T @ force)
        return -p.stiffness[0] * speed - p.damping[0] * (jacobian @ acceleration + drift)

    z = np.concatenate([x, u])
    jacobian = np.array([(residual(z + STEP * e) - residual(z - STEP * e)) / (2 * STEP) for e in np.eye(len(z))]).T
    expected = twin.dt * jacobian.T @ (getattr(p, weight)[0][:, None] * jacobian)
    result = node.calc_diff(x, u)
    scale = np.max(np.abs(expected))
    np.testing.assert_allclose(result.Lxu, expected[:15, 15:], atol=1e-6 * scale)
    np.testing.assert_allclose(result.Lxx[:14, 14], expected[:14, 14], atol=1e-6 * scale)
    assert np.max(np.abs(expected[rows, 14])) > 0
    assert np.max(np.abs(expected[:15, 15:])) > 0


def test_contact_off_leaves_no_stale_force_rate() -> None:
    """λ̇ = 0, and the robot moves as in free motion; with the contact on, neither holds."""
    robot = random_chain(7, 43)
    node, _ = node_and_twin(robot, "force_feedback", 3, "world", 4)
    free, _ = node_and_twin(robot, "free", 0, "world", 4)
    x, u = random_point(node, robot, 4)
    on = node.calc_diff(x, u)
    assert np.min(np.abs(on.force_rate)) > 1.0
    node.parameters.contact_active = False
    off = node.calc_diff(x, u)
    np.testing.assert_array_equal(off.force_rate, 0.0)
    np.testing.assert_array_equal(off.x_next[14:], x[14:])
    expected = free.calc(x[:14], u).x_next
    np.testing.assert_allclose(off.x_next[:14], expected, rtol=1e-12)
    assert np.max(np.abs(on.x_next[:14] - expected)) > 1e-3
    np.testing.assert_array_equal(off.fx[14:, :14], 0.0)


def test_wrong_names_are_refused() -> None:
    robot = random_chain(7, 44)
    node, _ = node_and_twin(robot, "force_feedback", 1, "world", 5)
    with pytest.raises(AttributeError):
        node.parameters.f_des = 1.0  # type: ignore[attr-defined]
    with pytest.raises(TypeError):
        _mpc.Model("force_feedback", 1, reference="world")  # type: ignore[call-arg]
