"""Time of the MPC core per node and per solve, beside one pinocchio call from Python as a yardstick.

    python -m benchmarks.mpc_kernel [--robot lwr4] [--cycles 3000] [--json FILE]

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

from benchmarks.mpc_kernel_loop import DT, HORIZON, Loop
from pliant import _mpc
from pliant.robot import Robot
from pliant.stopwatch import percentiles

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
