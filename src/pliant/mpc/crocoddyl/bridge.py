"""The same problems as crocoddyl shooting problems, for mim-solvers and crocoddyl's solvers (`pliant[crocoddyl]`).

For interoperability, for robots that the kernel cannot take (branched, more than 8 joints, free base), and for
cross-checks. Models run in Python: leave the number of threads of a shooting problem at one. Copy results with
`solver.us.tolist()`: single elements of a solver's vectors may dangle.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pinocchio as pin  # before crocoddyl, which needs its converters

from pliant import _mpc
from pliant.errors import ConfigError, MissingExtraError
from pliant.mpc.crocoddyl.node import NodeValues, PinocchioNode
from pliant.mpc.kernel import kernel_model
from pliant.mpc.nodes import NodeParameters, copy_nodes
from pliant.mpc.problem import MpcProblem
from pliant.spatial import Array

try:
    crocoddyl: Any = importlib.import_module("crocoddyl")
except ImportError as error:
    raise MissingExtraError("the bridge needs crocoddyl and mim-solvers: pip install 'pliant[crocoddyl]'") from error


def shooting_problem(
    problem: MpcProblem, nodes: NodeParameters, x0: Array, chain: _mpc.Chain | None = None, *, constraints: bool = False
) -> Any:
    """The problem as crocoddyl sees it.

    Args:
        problem: bound to a robot or model.
        nodes: parameters of the N + 1 nodes; they are copied.
        x0: (nx,) measured state.
        chain: evaluate the nodes with the kernel; None: with pinocchio in Python, for any tree.
        constraints: torque and force bounds as inequality constraints, for SolverCSQP.

    Returns:
        A `crocoddyl.ShootingProblem` of the same cost, dynamics and derivatives.

    Raises:
        ConfigError: bounds that the bridge does not support (friction cone; force bounds where the force is no state).
    """
    bounds = problem.config.bounds
    if constraints and bounds.friction is not None:
        raise ConfigError("the crocoddyl bridge has torque and force bounds, but no friction cone")
    if constraints and bounds.force_max is not None and not problem.config.predictive_model.force_state:
        raise ConfigError(
            "the crocoddyl bridge bounds the force only where it is a state (kind 'force_feedback'), got kind"
            f" {problem.config.kind!r} with force_max = {bounds.force_max:g} N: leave force_max out"
        )
    count = problem.config.horizon + 1
    actions: list[Any] = []
    for index in range(count):
        terminal = index == count - 1
        node = (
            _kernel_node(problem, chain, terminal) if chain is not None else PinocchioNode(problem, terminal=terminal)
        )
        copy_nodes(nodes, node.parameters, slice(index, index + 1))
        actions.append(NodeAction(problem, node, terminal=terminal, constrained=constraints))
    return crocoddyl.ShootingProblem(np.array(x0), actions[:-1], actions[-1])


def _kernel_node(problem: MpcProblem, chain: _mpc.Chain, terminal: bool) -> _mpc.Node:
    return _mpc.Node(chain, kernel_model(problem), problem.config.dt, terminal=terminal)


class NodeAction(crocoddyl.ActionModelAbstract):
    """One node of the kernel or of pinocchio as a crocoddyl action model."""

    def __init__(
        self, problem: MpcProblem, node: _mpc.Node | PinocchioNode, *, terminal: bool, constrained: bool
    ) -> None:
        self.node, self.terminal = node, terminal
        self._bounds = _Bounds(problem, node, terminal) if constrained else None
        ng = self._bounds.count if self._bounds else 0
        crocoddyl.ActionModelAbstract.__init__(
            self, _state(problem, node), problem.nu, 1, ng, 0, ng if terminal else 0, 0
        )
        if self._bounds:
            self.g_lb, self.g_ub = self._bounds.lower, self._bounds.upper
        self._no_control = np.zeros(problem.nu)

    def calc(self, data: Any, x: Array, u: Array | None = None) -> None:
        values = self._evaluate(x, u, derivatives=False)
        data.cost = values.cost
        if not self.terminal:
            data.xnext = values.x_next
        if self._bounds:
            data.g = self._bounds.values(x, self._no_control if u is None else u)

    def calcDiff(self, data: Any, x: Array, u: Array | None = None) -> None:
        values = self._evaluate(x, u, derivatives=True)
        data.Lx, data.Lxx = values.Lx, values.Lxx
        if not self.terminal:
            data.Fx, data.Fu = values.fx, values.fu
            data.Lu, data.Luu, data.Lxu = values.Lu, values.Luu, values.Lxu
        if self._bounds:
            data.Gx, data.Gu = self._bounds.by_x, self._bounds.by_u

    def _evaluate(self, x: Array, u: Array | None, *, derivatives: bool) -> _mpc.NodeResult | NodeValues:
        control = self._no_control if u is None else u
        if isinstance(self.node, PinocchioNode):
            return self.node.evaluate(np.array(x), np.array(control))
        return self.node.calc_diff(x, control) if derivatives else self.node.calc(x, control)


class _Bounds:
    """Torque bounds on u, and force bounds where the force is a state, as g_lb ≤ g ≤ g_ub."""

    def __init__(self, problem: MpcProblem, node: _mpc.Node | PinocchioNode, terminal: bool) -> None:
        p, nu, m = node.parameters, problem.nu, problem.m
        forces = problem.config.predictive_model.force_state and bool(p.contact_active[0])
        ndx = 2 * problem.model.nv + problem.config.predictive_model.extra(m, nu)
        rows_u = 0 if terminal else nu
        rows_x = m if forces else 0
        self.count = rows_u + rows_x
        self._rows_u, self._first_force = rows_u, problem.model.nq + problem.model.nv
        self.lower = np.concatenate([p.torque_lower[0][:rows_u], p.force_lower[0][:rows_x]])
        self.upper = np.concatenate([p.torque_upper[0][:rows_u], p.force_upper[0][:rows_x]])
        self.by_x, self.by_u = np.zeros((self.count, ndx)), np.zeros((self.count, nu))
        self.by_u[:rows_u] = np.eye(nu)[:rows_u]
        self.by_x[rows_u:, ndx - m :] = np.eye(m)[:rows_x]

    def values(self, x: Array, u: Array) -> Array:
        """(count,) g."""
        force = x[self._first_force :]
        return np.concatenate([u[: self._rows_u], force[: self.count - self._rows_u]])


def _state(problem: MpcProblem, node: _mpc.Node | PinocchioNode) -> Any:
    return crocoddyl.StateVector(node.nx) if problem.model.nq == problem.model.nv else ManifoldState(problem, node.nx)


class ManifoldState(crocoddyl.StateAbstract):
    """State (q, v, e) of a robot with a free base: q moves on its group, v and e are vectors."""

    def __init__(self, problem: MpcProblem, nx: int) -> None:
        self._model = problem.model
        self._nq, self._nv = self._model.nq, self._model.nv
        crocoddyl.StateAbstract.__init__(self, nx, nx - self._nq + self._nv)

    def zero(self) -> Array:
        return np.concatenate([pin.neutral(self._model), np.zeros(self.nx - self._nq)])

    def rand(self) -> Array:
        return np.concatenate(
            [pin.randomConfiguration(self._model), np.random.default_rng().normal(size=self.nx - self._nq)]
        )

    def diff(self, x0: Array, x1: Array) -> Array:
        nq = self._nq
        return np.concatenate([pin.difference(self._model, x0[:nq], x1[:nq]), x1[nq:] - x0[nq:]])

    def integrate(self, x: Array, dx: Array) -> Array:
        nq, nv = self._nq, self._nv
        return np.concatenate([pin.integrate(self._model, x[:nq], dx[:nv]), x[nq:] + dx[nv:]])

    def Jdiff(self, x0: Array, x1: Array, firstsecond: Any = None) -> Any:
        first, second = pin.dDifference(self._model, x0[: self._nq], x1[: self._nq])
        return _chosen(self._with_vectors(first, -1.0), self._with_vectors(second, 1.0), firstsecond)

    def Jintegrate(self, x: Array, dx: Array, firstsecond: Any = None) -> Any:
        first, second = pin.dIntegrate(self._model, x[: self._nq], dx[: self._nv])
        return _chosen(self._with_vectors(first, 1.0), self._with_vectors(second, 1.0), firstsecond)

    def JintegrateTransport(self, x: Array, dx: Array, Jin: Array, firstsecond: Any) -> Array:
        q, step, nv = x[: self._nq], dx[: self._nv], self._nv
        argument = pin.ARG0 if str(firstsecond) == "first" else pin.ARG1
        return np.vstack([pin.dIntegrateTransport(self._model, q, step, Jin[:nv], argument), Jin[nv:]])

    def _with_vectors(self, block: Array, sign: float) -> Array:
        J = sign * np.eye(self.ndx)
        J[: self._nv, : self._nv] = block
        return J


def _chosen(first: Array, second: Array, firstsecond: Any) -> Any:
    which = str(firstsecond).rsplit(".", 1)[-1]
    if which == "first":
        return first
    return second if which == "second" else [first, second]
