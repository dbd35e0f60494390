"""The compiled nodes against their Python twin: every model, contact dimension, axes, on several robots."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant import _mpc

from .mpc_robots import TestChain, catalogue_chain, random_chain
from .mpc_twin import AXES, KINDS, node_and_twin, random_point

CASES = [
    (kind, dim, axes)
    for kind in KINDS
    for dim in ((0,) if kind == "free" else (1, 3, 6))
    for axes in (AXES if kind != "free" else ("world",))
]


def assert_same(robot: TestChain, kind: str, dim: int, axes: str, seed: int, active: bool = True) -> None:
    node, twin = node_and_twin(robot, kind, dim, axes, seed, active=active)
    x, u = random_point(node, robot, seed)
    got = node.calc(x, u)
    x_next, cost, force, rate = twin(x, u)
    for value, expected in ((got.x_next, x_next), (got.cost, cost), (got.force, force), (got.force_rate, rate)):
        scale = np.max(np.abs(expected), initial=1.0)
        assert np.all(np.abs(value - expected) <= 1e-10 * scale), (kind, dim, axes)


@pytest.mark.parametrize("name", ["lwr4", "iiwa14"])
@pytest.mark.parametrize(("kind", "dim", "axes"), CASES)
def test_catalogue_robots(name: str, kind: str, dim: int, axes: str) -> None:
    assert_same(catalogue_chain(name), kind, dim, axes, seed=3)


@pytest.mark.parametrize(("kind", "dim", "axes"), [case for case in CASES if case[1] <= 1])
def test_three_joints(kind: str, dim: int, axes: str) -> None:
    assert_same(catalogue_chain("leg3"), kind, dim, axes, seed=4)


@given(seed=st.integers(0, 10_000), n=st.integers(2, 4), case=st.sampled_from(CASES))
def test_chains_of_few_joints(seed: int, n: int, case: tuple[str, int, str]) -> None:
    kind, dim, axes = case
    rigid = kind in ("classical", "torque_feedback")  # one joint cannot keep three components rigid
    assert_same(random_chain(n, seed), kind, min(dim, 1) if rigid else dim, axes, seed)


@given(seed=st.integers(0, 10_000), n=st.integers(6, 8), case=st.sampled_from(CASES))
def test_random_chains(seed: int, n: int, case: tuple[str, int, str]) -> None:
    kind, dim, axes = case
    rigid = kind in ("classical", "torque_feedback")
    # A rigid contact of full dimension on a random chain may be close to singular: leave a joint to spare.
    assert_same(random_chain(n, seed), kind, min(dim, 3) if rigid else dim, axes, seed)


@given(seed=st.integers(0, 10_000), n=st.integers(1, 8))
def test_mass_matrix_and_placements(seed: int, n: int) -> None:
    robot = random_chain(n, seed)
    data = robot.model.createData()
    expected = pin.crba(robot.model, data, robot.home, pin.Convention.WORLD)
    np.testing.assert_allclose(robot.chain.mass_matrix(robot.home), expected, atol=1e-11)
    pin.framesForwardKinematics(robot.model, data, robot.home)
    for name, got in (
        ("tool", robot.chain.tool_placement(robot.home)),
        ("contact", robot.chain.contact_placement(robot.home)),
    ):
        placement = data.oMf[robot.model.getFrameId(name)]
        np.testing.assert_allclose(got[0], placement.rotation, atol=1e-13)
        np.testing.assert_allclose(got[1], placement.translation, atol=1e-13)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "free"])
def test_contact_off(kind: str) -> None:
    robot = random_chain(7, 5)
    assert_same(robot, kind, 3, "world", seed=6, active=False)


@given(angle=st.floats(-1e4, 1e4))
def test_joint_angles_of_any_size(angle: float) -> None:
    """The kernel's own sine and cosine, through the placement of a one-joint chain."""
    robot = random_chain(1, 1, prismatic=0.0)
    rotation, _ = robot.chain.tool_placement([angle])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.array([angle]))
    np.testing.assert_allclose(rotation, data.oMf[robot.model.getFrameId("tool")].rotation, atol=1e-14)


@pytest.mark.parametrize("isa", _mpc.available_instruction_sets())
def test_instruction_sets_agree(isa: str) -> None:
    robot = random_chain(7, 8)
    chosen = _mpc.instruction_set()
    for kind, dim, axes in CASES:
        reference, _ = node_and_twin(robot, kind, dim, axes, 9)
        x, u = random_point(reference, robot, 9)
        try:
            _mpc.use_instruction_set(isa)
            node, _ = node_and_twin(robot, kind, dim, axes, 9)
        finally:
            _mpc.use_instruction_set(chosen)
        a, b = reference.calc_diff(x, u), node.calc_diff(x, u)
        for name in ("x_next", "fx", "fu", "Lx", "Lu", "Lxx", "Lxu", "Luu", "force_x", "force_u"):
            expected = getattr(a, name)
            scale = np.max(np.abs(expected), initial=1.0)
            assert np.all(np.abs(getattr(b, name) - expected) <= 1e-9 * scale), (kind, dim, axes, name)
