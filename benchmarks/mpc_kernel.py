"""Time of the MPC core per node and per solve, beside one pinocchio call from Python as a yardstick.

    python benchmarks/mpc_kernel.py [--robot lwr4] [--cycles 3000] [--json FILE]

Every row is a noisy closed loop: the model itself, stepped by 2 ms, is the plant; the tool follows a circle and
presses; each cycle solves from a noisy measurement, warm-started, to KKT 1e-4 with at most 8 iterations. Times are CPU
time of the calling thread around `Solver.solve`, conversions to and from NumPy included.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.mpc.chain import chain_from_robot
from pliant.robot import Robot
from pliant.stopwatch import percentiles

Vector = np.ndarray
DT, PERIOD, HORIZON = 3e-3, 2e-3, 5  # s, s, nodes
TOLERANCE, MAX_ITERATIONS = 1e-4, 8
CASES = [
    ("force_feedback", 1, False),
    ("force_feedback", 1, True),
    ("force_feedback", 3, False),
    ("force_feedback", 3, True),
    ("force_feedback", 6, False),
    ("classical", 1, False),
    ("classical", 1, True),
    ("classical", 3, False),
    ("classical", 3, True),
    ("torque_feedback", 1, False),
    ("torque_feedback", 1, True),
    ("torque_feedback", 3, False),
    ("torque_feedback", 3, True),
    ("free", 0, False),
]


def yardstick(robot: Robot, calls: int = 5000) -> float:
    """Median CPU time in µs of one `pinocchio.computeABADerivatives` from Python."""
    data, n = robot.model.createData(), robot.n
    q, v, tau = robot.home.copy(), np.ones(n), np.ones(n)
    seconds = []
    for _ in range(calls):
        start = time.thread_time()
        pin.computeABADerivatives(robot.model, data, q, v, tau)
        seconds.append(time.thread_time() - start)
    return 1e6 * float(np.median(seconds))


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


def solve_times(loop: Loop, cycles: int, pause: float = 0.0) -> dict[str, Any]:
    """Percentiles over the cycles, the first 5 % left out as a warm-up."""
    cpu, wall, solutions, active = [], [], [], []
    for _ in range(cycles):
        solution, c, w = loop.cycle()
        active.append(loop.active_bounds(solution))
        cpu.append(c)
        wall.append(w)
        solutions.append(solution)
        if pause:
            time.sleep(pause)
    kept = slice(cycles // 20, None)
    return {
        "cpu": percentiles(1e6 * np.array(cpu[kept])),
        "wall": percentiles(1e6 * np.array(wall[kept])),
        "iterations": float(np.mean([s.iterations for s in solutions])),
        "evaluations": float(np.mean([s.evaluations for s in solutions])),
        "factorisations": float(np.mean([s.qp_iterations for s in solutions])),
        "converged": float(np.mean([s.status == "converged" for s in solutions])),
        "active": dict(zip(("torque", "force", "cone"), np.mean(active, axis=0).tolist(), strict=True)),
        "worst_violation": max((s.violation for s in solutions if s.status == "converged"), default=float("nan")),
    }


def node_times(loop: Loop) -> dict[str, float]:
    """µs per node, without and with derivatives: the least of nine runs, free of what else the machine does."""
    x, u = loop.x, loop.solver.us[0]
    values = [loop.plant.benchmark(x, u, 2000, derivatives=False) for _ in range(9)]
    derivatives = [loop.plant.benchmark(x, u, 2000, derivatives=True) for _ in range(9)]
    return {"calc_us": 1e6 * min(values), "calc_diff_us": 1e6 * min(derivatives)}


def measure(
    robot: Robot,
    frame: str,
    *,
    cycles: int = 3000,
    horizon: int = HORIZON,
    pause: float = 0.0,
    isas: list[str] | None = None,
    cases: list[tuple[str, int, bool]] | None = None,
) -> Iterator[dict[str, Any]]:
    """One row per instruction set and case, as it is ready.

    Args:
        robot: a serial robot of up to 8 joints.
        frame: its contact frame.
        cycles: solves per row.
        horizon: running nodes.
        pause: sleep between solves, s (2e-3 shows cold caches).
        isas: instruction sets; all available ones if None.
        cases: (kind, contact dimension, bounds); `CASES` if None.
    """
    chosen = _mpc.instruction_set()
    try:
        for isa in isas or _mpc.available_instruction_sets():
            _mpc.use_instruction_set(isa)
            for kind, dim, bounds in cases or CASES:
                unit = yardstick(robot)
                loop = Loop(robot, frame, kind, dim, bounds, seed=0, horizon=horizon)
                row: dict[str, Any] = {"isa": isa, "kind": kind, "dim": dim, "bounds": bounds, "yardstick_us": unit}
                row |= solve_times(loop, cycles, pause) | node_times(loop)
                row["yardsticks"] = row["cpu"]["median"] / unit
                yield row
    finally:
        _mpc.use_instruction_set(chosen)


HEADING = (
    "isa      model             dim bounds   median     p90     p99   yardst.  iter  fact.  conv.%  node  diff [µs]"
    "   torque, force, cone at bound %"
)


def line(row: dict[str, Any]) -> str:
    """One row of the table under `HEADING`."""
    cpu = row["cpu"]
    case = f"{row['isa']:8} {row['kind']:18}{row['dim']:2} {row['bounds']!s:6}"
    times = f"{cpu['median']:9.1f}{cpu['p90']:8.1f}{cpu['p99']:8.1f}{row['yardsticks']:9.2f}"
    work = f"{row['iterations']:7.2f}{row['factorisations']:6.2f}{100 * row['converged']:8.2f}"
    shares = "".join(f"{100 * share:5.0f}" for share in row["active"].values()) if row["bounds"] else ""
    return f"{case}{times}{work}{row['calc_us']:6.2f}{row['calc_diff_us']:6.2f}      {shares}"


def main(print_line: Callable[[str], None] = print) -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="lwr4")
    parser.add_argument("--frame", default=None, help="contact frame; the last on the last link if left out")
    parser.add_argument("--cycles", type=int, default=3000)
    parser.add_argument("--horizon", type=int, default=HORIZON)
    parser.add_argument("--pause", type=float, default=0.0, help="s between solves")
    parser.add_argument("--isa", action="append", help="only this instruction set")
    parser.add_argument("--json", default=None)
    arguments = parser.parse_args()
    robot = Robot.load(arguments.robot)
    on_last_link = [f.name for f in robot.model.frames if f.parentJoint == robot.model.njoints - 1]
    frame = arguments.frame or on_last_link[-1]
    rows = []
    print_line(f"{robot.name}, {robot.n} joints, N = {arguments.horizon}, dt = {DT} s, CPU µs per solve")
    print_line(HEADING)
    options = {
        "cycles": arguments.cycles,
        "horizon": arguments.horizon,
        "pause": arguments.pause,
        "isas": arguments.isa,
    }
    for row in measure(robot, frame, **options):
        rows.append(row)
        print_line(line(row))
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(rows, file, indent=2)


if __name__ == "__main__":
    main()
