"""The solver of the MPC core in a noisy closed loop with its own model as the plant."""

from __future__ import annotations

import time

import numpy as np

from pliant import _mpc
from pliant.mpc.chain import chain_from_robot
from pliant.robot import Robot

Vector = np.ndarray
DT, PERIOD, HORIZON = 3e-3, 2e-3, 5  # s, s, nodes
TOLERANCE, MAX_ITERATIONS = 1e-4, 8


class Loop:
    """A solver in a noisy closed loop with its own model as the plant."""

    def __init__(self, robot: Robot, frame: str, kind: str, dim: int, bounds: bool, seed: int, horizon: int) -> None:
        chain = chain_from_robot(robot, frame)
        model = _mpc.Model(kind, dim, "world", baumgarte=(0.0, 10.0))
        self.solver = _mpc.Solver(chain, model, horizon, DT, bounds=bounds)
        self.plant = _mpc.Node(chain, model, PERIOD)
        self.rng, self.n, self.kind = np.random.default_rng(seed), robot.n, kind
        self.home = robot.home.copy()
        self.rotation, self.start = chain.tool_placement(self.home)
        self.normal = min(dim, 3) - 1
        self.set_costs(dim)
        x0 = np.zeros(self.solver.nx)
        x0[: self.n] = self.home
        if kind == "force_feedback":
            x0[2 * self.n + self.normal] = 20.0
        self.solver.quasi_static(x0)
        if bounds:
            self.set_bounds(dim, self.solver.us[0])
        self.x = self.solver.xs[0]
        self.noise = np.concatenate([np.full(2 * self.n, 1e-3), np.full(len(x0) - 2 * self.n, 1e-2)])
        self.time = 0.0

    def set_costs(self, dim: int) -> None:
        """Circle phase of [FFMPC], 20 N."""
        p = self.solver.nodes
        p.state_reference[:, : self.n] = self.home
        p.state_weight[:, : self.n] = 0.02 * 10
        p.state_weight[:, self.n :] = 0.02 * 2
        p.torque_gravity_weight = 1e-4
        p.translation_reference = self.start
        p.translation_weight[:, :2] = {"classical": 60.0, "torque_feedback": 200.0}.get(self.kind, 150.0)
        p.velocity_weight = 0.05
        p.rotation_reference = self.rotation
        p.rotation_weight = 10.0 if self.kind == "torque_feedback" else 20.0
        if dim:
            p.force_reference[:, self.normal] = 20.0
            p.force_weight = 0.01 if self.kind == "force_feedback" else 1e-3
        p.force_rate_weight = 6e-7
        if self.kind == "torque_feedback":
            p.control_gravity_weight = 1e-9
        for name, scale in (("state", 1), ("translation", 1), ("velocity", 20), ("rotation", 1), ("force", 5)):
            getattr(p, f"{name}_weight")[-1] *= scale * DT

    def set_bounds(self, dim: int, rest: Vector) -> None:
        """A force of 40 N wanted beyond its bound of 25 N, and 30 N along the surface, which the friction cone forbids.

        Torques stay near rest, closely where the force can still be kept with them: a rigid contact that follows the
        circle with 4 N·m has no feasible plan.
        """
        p = self.solver.nodes
        margin = 4.0 if (self.kind, dim) == ("force_feedback", 1) else 20.0  # N·m
        p.torque_lower = rest - margin
        p.torque_upper = rest + margin
        p.force_reference[:, self.normal] = 40.0
        p.force_lower[:, self.normal] = 0.0
        p.force_upper[:, self.normal] = 25.0
        if dim >= 3:
            p.friction = 0.5
            p.force_reference[:, 0] = 30.0

    def active_bounds(self, solution: _mpc.Solution) -> tuple[bool, bool, bool]:
        """Whether the plan reaches a torque bound, a bound on the normal force, the friction cone, at any node."""
        p, margin = self.solver.nodes, 1e-3  # margin in N, N·m
        torques, forces = solution.us, solution.forces[1:]
        torque = np.any(torques >= p.torque_upper[:-1] - margin) or np.any(torques <= p.torque_lower[:-1] + margin)
        at_force = False
        if forces.shape[1]:
            i = self.normal
            at_force = np.any(forces[:, i] >= p.force_upper[1:-1, i] - margin)
            at_force |= np.any(forces[:, i] <= p.force_lower[1:-1, i] + margin)
        tangential = np.linalg.norm(forces[:, :2], axis=1)
        at_cone = forces.shape[1] >= 3 and np.any(p.friction[1:-1] * forces[:, 2] - tangential <= margin)
        return bool(torque), bool(at_force), bool(at_cone)

    def cycle(self) -> tuple[_mpc.Solution, float, float]:
        """One tick: solution, CPU and wall time of the solve in s."""
        for k in range(self.solver.horizon + 1):
            angle = 3.0 * (self.time + k * DT)  # rad, at 3 rad/s
            offset = 0.07 * np.array([1.0 - np.cos(angle), -np.sin(angle), 0.0])  # m
            self.solver.nodes.translation_reference[k] = self.start + offset
        measured = self.x + self.noise * self.rng.normal(size=len(self.x))
        wall, cpu = time.perf_counter(), time.thread_time()
        solution = self.solver.solve(measured, max_iterations=MAX_ITERATIONS, tolerance=TOLERANCE)
        cpu, wall = time.thread_time() - cpu, time.perf_counter() - wall
        self.x = self.plant.calc(self.x, solution.us[0]).x_next
        self.time += PERIOD
        return solution, cpu, wall
