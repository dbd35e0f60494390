"""A polishing-like problem on the compiled solver, for its tests and its benchmark."""

from __future__ import annotations

import numpy as np

from pliant import _mpc
from tests.twins.mpc_robots import TestChain

Vector = np.ndarray
DT = 3e-3  # s
HORIZON = 5


def polishing(
    robot: TestChain,
    kind: str = "force_feedback",
    dim: int = 1,
    *,
    axes: str = "world",
    bounds: bool = False,
    horizon: int = HORIZON,
    dt: float = DT,
) -> tuple[_mpc.Solver, Vector]:
    """Solver with the weights of [FFMPC]'s circle phase pressing 20 N at the robot's home; state at rest there."""
    model = _mpc.Model(kind, dim, axes, baumgarte=(0.0, 10.0))
    solver = _mpc.Solver(robot.chain, model, horizon, dt, bounds=bounds)
    n, p = robot.model.nv, solver.nodes
    rotation, translation = robot.chain.tool_placement(robot.home)
    p.state_reference[:, :n] = robot.home
    p.state_weight[:, :n] = 0.02 * 10
    p.state_weight[:, n:] = 0.02 * 2
    p.torque_gravity_weight = 1e-4
    p.translation_reference = translation
    p.translation_weight[:, :2] = {"classical": 60.0, "torque_feedback": 200.0}.get(kind, 150.0)
    p.velocity_weight = 0.05
    p.rotation_reference = rotation
    p.rotation_weight = 10.0 if kind == "torque_feedback" else 20.0
    normal = min(dim, 3) - 1
    if dim:
        p.force_reference[:, normal] = 20.0
        p.force_weight = 0.01 if kind == "force_feedback" else 1e-3
    p.force_rate_weight = 6e-7
    if kind == "torque_feedback":
        p.control_gravity_weight = 1e-9
    for name, scale in (("state", 1.0), ("translation", 1.0), ("velocity", 20.0), ("rotation", 1.0), ("force", 5.0)):
        getattr(p, f"{name}_weight")[-1] *= scale * dt
    x0 = np.zeros(solver.nx)
    x0[:n] = robot.home
    if kind == "force_feedback":
        x0[2 * n + normal] = 15.0
    solver.quasi_static(x0)
    return solver, (solver.xs[0] if kind == "torque_feedback" else x0)


def noisy(x0: Vector, n: int, rng: np.random.Generator) -> Vector:
    """A measurement: 1e-3 on position and velocity, 0.02 on force or torque."""
    noise = np.concatenate([np.full(2 * n, 1e-3), np.full(len(x0) - 2 * n, 0.02)])
    return x0 + noise * rng.normal(size=len(x0))


def nodes_like(solver: _mpc.Solver, robot: TestChain, kind: str, dim: int) -> list[_mpc.Node]:
    """Single nodes with the solver's parameters."""
    fields = [name for name in dir(solver.nodes) if not name.startswith("_") and name not in ("count", "copy_node")]
    nodes = []
    for k in range(solver.horizon + 1):
        model = _mpc.Model(kind, dim, baumgarte=(0.0, 10.0))
        node = _mpc.Node(robot.chain, model, solver.dt, terminal=k == solver.horizon)
        for name in fields:
            getattr(node.parameters, name)[0] = getattr(solver.nodes, name)[k]
        nodes.append(node)
    return nodes
