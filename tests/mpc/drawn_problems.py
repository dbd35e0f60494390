"""Drawn problems with torque bounds and friction cone together, each with a trajectory that shows it feasible."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pliant import _mpc
from tests.twins.mpc_robots import catalogue_chain

from .kernel_problem import DT, nodes_like, noisy, polishing

Vector = np.ndarray


class Condensed:
    """The same problem in the controls alone: roll-out, cost, predicted forces, and their gradients."""

    def __init__(self, nodes: list[_mpc.Node], x0: Vector) -> None:
        self.nodes, self.x0, self.N = nodes, x0, len(nodes) - 1

    def evaluate(self, z: Vector) -> tuple[float, Vector, Vector, Vector]:
        """Cost, gradient (N n,), forces (N + 1, m), their Jacobian ((N + 1) m, N n)."""
        us = z.reshape(self.N, -1)
        n, x = us.shape[1], self.x0
        sensitivity = np.zeros((len(x), z.size))  # ∂x_k/∂z
        cost, gradient, forces, rows = 0.0, np.zeros(z.size), [], []
        for k, node in enumerate(self.nodes):
            u = us[k] if k < self.N else np.zeros(n)
            r = node.calc_diff(x, u)
            own = slice(k * n, (k + 1) * n)
            cost += r.cost
            gradient += r.Lx @ sensitivity
            forces.append(r.force)
            row = r.force_x @ sensitivity if k < self.N else np.zeros((len(r.force), z.size))
            if k == self.N and len(x) > 2 * n and len(r.force):
                row = sensitivity[2 * n :]
            if k < self.N:
                gradient[own] += r.Lu
                row[:, own] += r.force_u
                sensitivity = r.fx @ sensitivity
                sensitivity[:, own] += r.fu
                x = r.x_next
            rows.append(row)
        return cost, gradient, np.array(forces), np.vstack(rows)


WIDTH = (0.5, 1.5)
"""decades of N·m between the torque bounds"""


def torque_and_cone(
    kind: str, seed: int, dt: float = DT, width: tuple[float, float] = WIDTH
) -> tuple[_mpc.Solver, Vector, Vector, Vector, float, Callable[[Vector], tuple]]:
    """A drawn problem with torque bounds and cone, and a trajectory of its own that keeps both.

    The trajectory solves an easier problem (less force, a narrower cone); the torque bounds are drawn round it, `width`
    decades of N·m apart, and the problem then wants more force and leaves the cone.
    """
    robot, rng = catalogue_chain("lwr4"), np.random.default_rng([seed, 12])
    mu, normal, angle = rng.uniform(0.2, 0.6), rng.uniform(40.0, 80.0), rng.uniform(0.0, 2.0 * np.pi)
    direction, tangential = np.array([np.cos(angle), np.sin(angle)]), rng.uniform(0.5, 1.5) * mu * normal
    easy, x0 = polishing(robot, kind, 3, bounds=True, dt=dt)
    x0 = noisy(x0, robot.model.nv, rng)
    easy.nodes.friction = 0.7 * mu
    easy.nodes.force_reference[:, 2] = rng.uniform(20.0, 35.0)
    easy.nodes.force_reference[:, :2] = 6.0 * mu * direction
    found = easy.solve(x0, max_iterations=200, tolerance=1e-6)
    assert found.status == "converged"
    apart, below = 10.0 ** rng.uniform(*width, found.us.shape), rng.uniform(0.0, 1.0, found.us.shape)
    solver, _ = polishing(robot, kind, 3, bounds=True, dt=dt)
    solver.nodes.force_reference[:, 2] = normal
    solver.nodes.force_reference[:, :2] = tangential * direction
    problem = Condensed(nodes_like(solver, robot, kind, 3), x0)
    solver.nodes.torque_lower[:-1] = found.us - apart * below - 1e-3
    solver.nodes.torque_upper[:-1] = found.us + apart * (1.0 - below) + 1e-3
    solver.nodes.friction = mu
    return solver, x0, found.us, problem.evaluate(found.us.ravel())[2], mu, problem.evaluate


CHOSEN = {"classical": slice(0, 5), "torque_feedback": slice(1, 5), "force_feedback": slice(1, None)}
"""nodes whose force is not measured"""


def cone_margin(forces: Vector, mu: float, kind: str) -> float:
    chosen = forces[CHOSEN[kind]]
    return float(np.min(mu * chosen[:, 2] - np.linalg.norm(chosen[:, :2], axis=1)))


@dataclass
class Tried:
    """What came of so many drawn problems."""

    problems: int
    converged: int = 0
    both: int = 0
    """answers on which torque bounds and cone are both active"""


def tried(kind: str, seeds: range, dt: float = DT, width: tuple[float, float] = WIDTH) -> Tried:
    """Solves drawn problems in at most 30 iterations; what converged must keep every bound and cost less than the
    trajectory that shows that there is a way.
    """
    found = Tried(len(seeds))
    for seed in seeds:
        solver, x0, feasible, forces, mu, evaluate = torque_and_cone(kind, seed, dt, width)
        assert cone_margin(forces, mu, kind) >= 0.0
        lower, upper = solver.nodes.torque_lower[:-1], solver.nodes.torque_upper[:-1]
        assert np.all((lower < feasible) & (feasible < upper))
        s = solver.solve(x0, max_iterations=30)
        if s.status != "converged":
            continue
        found.converged += 1
        assert s.violation <= 1e-4
        cost, _, reached, _ = evaluate(s.us.ravel())
        margin = cone_margin(reached, mu, kind)
        assert margin >= -1e-3
        assert cost < evaluate(feasible.ravel())[0]
        found.both += margin < 1e-3 and bool(np.any((s.us < lower + 1e-4) | (s.us > upper - 1e-4)))
    return found
