"""Derivatives of the compiled nodes against central differences, for every model, dimension, axes and several robots.

The kernel's outputs are filled with NaN before every call. A central difference with step h errs by h² f'''/6 and by
2 ε |f|/(2h); with h = 1e-5 and values scaled by their largest entry both stay below 1e-6 for these smooth functions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant import _mpc
from tests.twins.mpc_robots import TestChain, catalogue_chain, random_chain
from tests.twins.mpc_twin import AXES, KINDS, node_and_twin, random_point, randomise

Vector = np.ndarray
STEP = 1e-5
TOLERANCE = 1e-6

CASES = [
    (kind, dim, axes)
    for kind in KINDS
    for dim in ((0,) if kind == "free" else (1, 3, 6))
    for axes in (AXES if kind != "free" else ("world",))
]


def difference(f: Callable[[Vector], Vector], z: Vector, step: float = STEP) -> Vector:
    """(len f, len z) Jacobian by central differences."""
    columns = [(f(z + step * e) - f(z - step * e)) / (2 * step) for e in np.eye(len(z))]
    return np.array(columns).T


def assert_close(got: Vector, expected: Vector, value: Vector | float, what: str) -> None:
    assert np.all(np.isfinite(got)), what
    scale = max(1.0, np.max(np.abs(expected), initial=0.0), np.max(np.abs(value), initial=0.0))
    assert np.max(np.abs(got - expected), initial=0.0) <= TOLERANCE * scale, what


def check_node(node: _mpc.Node, x: Vector, u: Vector, *, terminal: bool = False) -> None:
    result = node.calc_diff(x, u)
    for got, by, field in (
        (result.Lx, "x", "cost"),
        (result.Lu, "u", "cost"),
        (result.fx, "x", "x_next"),
        (result.fu, "u", "x_next"),
        (result.force_x, "x", "force"),
        (result.force_u, "u", "force"),
    ):
        if terminal and field != "cost":
            continue
        if by == "x":
            expected = difference(lambda z, name=field: np.asarray(getattr(node.calc(z, u), name)), x)
        else:
            expected = difference(lambda z, name=field: np.asarray(getattr(node.calc(x, z), name)), u)
        assert_close(got, expected, getattr(result, field), f"∂{field}/∂{by}")


def gauss_newton(twin: Callable[[Vector, Vector], Vector], x: Vector, u: Vector) -> Vector:
    """J^T J of stacked weighted residuals r(x, u) by central differences."""
    z = np.concatenate([x, u])
    jacobian = difference(lambda s: twin(s[: len(x)], s[len(x) :]), z)
    return jacobian.T @ jacobian


@pytest.mark.parametrize("name", ["lwr4", "iiwa14"])
@pytest.mark.parametrize(("kind", "dim", "axes"), CASES)
def test_catalogue_robots(name: str, kind: str, dim: int, axes: str) -> None:
    robot = catalogue_chain(name)
    node, _ = node_and_twin(robot, kind, dim, axes, 3)
    check_node(node, *random_point(node, robot, 3))


@given(seed=st.integers(0, 10_000), n=st.integers(5, 8), case=st.sampled_from(CASES))
def test_random_chains(seed: int, n: int, case: tuple[str, int, str]) -> None:
    kind, dim, axes = case
    rigid = kind in ("classical", "torque_feedback")
    robot = random_chain(n, seed)
    node, _ = node_and_twin(robot, kind, min(dim, 3) if rigid else dim, axes, seed, dt=(3e-3, 5e-3)[seed % 2])
    check_node(node, *random_point(node, robot, seed))


@given(seed=st.integers(0, 10_000), n=st.integers(3, 4), case=st.sampled_from(CASES))
def test_chains_of_few_joints(seed: int, n: int, case: tuple[str, int, str]) -> None:
    kind, dim, axes = case
    rigid = kind in ("classical", "torque_feedback")
    robot = random_chain(n, seed)
    node, _ = node_and_twin(robot, kind, min(dim, 1) if rigid else dim, axes, seed)
    check_node(node, *random_point(node, robot, seed))


@pytest.mark.parametrize("n", [4, 7])
@pytest.mark.parametrize("dim", [1, 3, 6])
@pytest.mark.parametrize("axes", AXES)
def test_exponential_integrator(dim: int, axes: str, n: int) -> None:
    robot = random_chain(n, 11)
    node = _mpc.Node(robot.chain, _mpc.Model("force_feedback", dim, axes, integrator="exponential"), 3e-3)
    randomise(node.parameters, 2)
    node.freeze(robot.home)
    check_node(node, *random_point(node, robot, 2))


@pytest.mark.parametrize("kind", KINDS)
def test_terminal_node(kind: str) -> None:
    robot = random_chain(7, 12)
    node = _mpc.Node(robot.chain, _mpc.Model(kind, 0 if kind == "free" else 3), 3e-3, terminal=True)
    randomise(node.parameters, 4)
    check_node(node, *random_point(node, robot, 4), terminal=True)


def residuals(robot: TestChain, kind: str, dim: int, axes: str, seed: int) -> Callable[[Vector, Vector], Vector]:
    """Stacked sqrt(dt w) r of a node, one entry per weight, from costs with a single weight switched on."""
    node, _ = node_and_twin(robot, kind, dim, axes, seed)
    p = node.parameters
    names = [name for name in dir(p) if name.endswith("_weight")]
    weights = {name: getattr(p, name).copy() for name in names}
    entries = [(name, i) for name in names for i in range(weights[name].shape[1])]

    def one(name: str, i: int, x: Vector, u: Vector) -> float:
        for other in names:
            getattr(p, other)[...] = 0.0
        getattr(p, name)[0, i] = weights[name][0, i]
        return node.calc(x, u).cost

    def stacked(x: Vector, u: Vector) -> Vector:
        values = [one(name, i, x, u) for name, i in entries]
        return np.sqrt(2.0 * np.maximum(values, 0.0))

    return stacked


@pytest.mark.parametrize(("kind", "dim", "axes"), CASES)
def test_hessian_is_gauss_newton_with_all_cross_terms(kind: str, dim: int, axes: str) -> None:
    """Σ ∂r/∂(x,u)ᵀ w ∂r/∂(x,u), every residual taken as the root of its own cost (its sign drops out of the square)."""
    robot = random_chain(7, 21, prismatic=0.2)
    node, _ = node_and_twin(robot, kind, dim, axes, 5)
    x, u = random_point(node, robot, 5)
    result = node.calc_diff(x, u)
    got = np.block([[result.Lxx, result.Lxu], [result.Lxu.T, result.Luu]])
    stacked = residuals(robot, kind, dim, axes, 5)
    assert np.all(stacked(x, u)[stacked(x, u) > 0] > 1e-6)  # away from the root's kink
    expected = gauss_newton(stacked, x, u)
    scale = np.max(np.abs(expected))
    assert np.max(np.abs(got - expected)) <= 1e-5 * scale
    cross = expected[: node.nx, node.nx :]
    assert np.max(np.abs(cross)) > 0  # there is something that a Hessian without cross terms would miss
