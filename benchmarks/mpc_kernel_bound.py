"""An iteration of the MPC kernel beside its arithmetic bound: the operations it needs at the core's peak rate.

    python -m benchmarks.mpc_kernel_bound [--robot lwr4] [--rounds 9]

An iteration is a pass over N + 1 nodes with derivatives, a backward and a forward sweep and the test of optimality.
Its operations are counted here from the formulas, in the robot's own sizes: additions, multiplications, divisions and
square roots are one each, a symmetric matrix is counted once, nothing is counted for filled-up joints and lanes. The
peak is that of independent multiply-adds (`peak.cpp`, compiled here) with the same instruction set. The time is (time
of 3 iterations − time of 1) / 2 from one start, so that what a solve costs beside drops out; of times the least and of
peaks the largest over the rounds, which take turns.
"""

from __future__ import annotations

import argparse
import ctypes
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.mpc_kernel_loop import HORIZON, Loop
from pliant import _mpc
from pliant.robot import Robot

CROSS, DOT, ADD, TURN = 9, 5, 3, 15  # of 3-vectors; a product of a 3×3 matrix and a vector
CROSS_MOTION = 3 * CROSS + ADD  # m × m' and m ×* f of spatial vectors
INERTIA_TIMES = ADD + CROSS + ADD + CROSS + TURN + ADD  # of a motion
SPATIAL, SPATIAL_DOT = 2 * ADD, 2 * DOT + 1  # an addition, or a running sum per joint; a product


def node_operations(n: int, m: int) -> dict[str, int]:
    """Of one running node of force feedback with n joints and m contact components in axes that stand still."""
    x, pairs, half = 2 * n + m, n * n, n * (n + 1) // 2
    placement = 60 + 3 * TURN + 2 * TURN + 4 * ADD  # sine and cosine, rotations, origin
    axes = CROSS + 2 * ADD + SPATIAL
    velocities = 2 * SPATIAL + CROSS_MOTION
    residuals = 4 * (CROSS + ADD) + 3 * DOT + 12 + 36
    inertia = 6 * TURN + 6 * DOT + 12 + 10
    dynamics = inertia + 2 * INERTIA_TIMES + CROSS_MOTION + 2 * SPATIAL
    bias = INERTIA_TIMES + 4 * SPATIAL + SPATIAL_DOT + 2
    coupling = 65
    coupled = 2 * CROSS + TURN + 2 * ADD
    outer = (INERTIA_TIMES + coupled + CROSS_MOTION + 2 * SPATIAL) + (INERTIA_TIMES + coupled + 2 * SPATIAL)
    accelerations = 4 * SPATIAL + 2 * CROSS_MOTION + SPATIAL
    inner = 2 * CROSS + TURN + 3 * ADD
    derivatives = accelerations + (INERTIA_TIMES + 3 * SPATIAL) + coupling + outer + inner
    load = 4 * CROSS + 6 * ADD + 2 * CROSS + SPATIAL_DOT + 10
    contact = 8 * CROSS + 2 * CROSS_MOTION + 14 * ADD + 15 * m
    per_joint = placement + axes + velocities + residuals + dynamics + bias + derivatives + load + contact
    rows = half * SPATIAL_DOT + (pairs - half) * (SPATIAL_DOT + DOT + 1)  # lane j ≥ i, lane j < i
    gravity_rows = half * SPATIAL_DOT + (pairs - half) * DOT + pairs * (SPATIAL_DOT + 1)
    return {
        "kinematics, dynamics and their derivatives, per joint": n * per_joint,
        "mass matrix, its inverse, acceleration": half * SPATIAL_DOT + n**3 + 2 * pairs,
        "derivatives, per pair of joints": 2 * rows + gravity_rows,
        "tangent": 4 * n**3 + 2 * pairs * m + m * 6 * pairs,
        "cost: tool": 2 * half * (12 + 6) + half * 12 + pairs * 12,
        "cost: torque about gravity": half * 2 * n + 6 * pairs + 2 * pairs * m + 2 * n * m * m,
        "cost: force rate": m * (x * (x + 1) + 2 * n * x + 2 * half),
        "scalars": 400,
    }


def recursion_operations(n: int, m: int) -> dict[str, int]:
    """Of one stage of the recursion, with z = n + m rates and x = 2n + m states."""
    x, z = 2 * n + m, n + m
    return {
        "gradient at the gap": 2 * x * x,
        "GᵀP, GᵀPE, GᵀPG": 3 * n * x + m * x + 2 * z * n + z * (3 * n + m),
        "GᵀP ∂x⁺/∂x": 2 * z * z * x,
        "Q_uu, Q_ux, Q_x, Q_u": 2 * z * z * n + z * n * (n + 1) + 2 * z * n * x + 2 * z * (x + n),
        "factor and control law": n**3 // 3 + n * n * x + 2 * n * x,
        "P and p": x * (x + 1) // 2 * (4 * z + 2 * n + 2) + 2 * n * x,
        "forward sweep": 2 * x * x + 2 * n * x + n * n + 2 * z * (x + n),
        "optimality": 2 * z * (x + n),
    }


def iteration_operations(n: int, m: int, horizon: int) -> int:
    """Of one iteration; the terminal node is left out, which has a fifth of a running one's."""
    return horizon * (sum(node_operations(n, m).values()) + sum(recursion_operations(n, m).values()))


def peak(isa: str, folder: Path) -> Callable[[], float]:
    """A measurement, in operations per second, of independent multiply-adds on vectors of the instruction set."""
    width, flags = {"sse2": (2, ""), "neon": (2, ""), "avx2": (4, "-mavx2 -mfma"), "avx512": (8, "-mavx512f")}[isa]
    library = folder / f"{isa}.so"
    source = Path(__file__).with_name("peak.cpp")
    command = ["c++", "-O2", "-ffp-contract=fast", f"-DWIDTH={width}", *flags.split(), "-shared", "-fPIC"]
    subprocess.run([*command, "-o", str(library), str(source)], check=True)
    loop = ctypes.CDLL(str(library))
    loop.multiply_add.argtypes = [ctypes.c_int, ctypes.c_double, ctypes.c_double]
    repetitions = 5_000

    def measure() -> float:
        seconds = []
        for _ in range(60):
            start = time.perf_counter()
            loop.multiply_add(repetitions, 0.999, 1e-3)
            seconds.append(time.perf_counter() - start)
        return repetitions * loop.operations() / min(seconds)

    return measure


def solve_seconds(robot: Robot, dim: int) -> Callable[[], list[float]]:
    """A measurement of solves of 1 and of 3 iterations from a start off the plan, in seconds."""
    frame = [f.name for f in robot.model.frames if f.parentJoint == robot.model.njoints - 1][-1]
    loop = Loop(robot, frame, "force_feedback", dim, False, seed=0, horizon=HORIZON)
    xs, us = loop.solver.xs, loop.solver.us
    start = xs[0] + 0.02 * np.random.default_rng(1).normal(size=xs.shape[1])

    def least(iterations: int) -> float:
        seconds = []
        for _ in range(60):
            loop.solver.xs, loop.solver.us = xs, us
            solution = loop.solver.solve(start, max_iterations=iterations, tolerance=1e-300)
            assert solution.iterations == iterations == solution.evaluations - 1, "no step is shortened"
            seconds.append(solution.solve_time)
        return min(seconds)

    return lambda: [least(1), least(3)]


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="lwr4")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    robot = Robot.load(arguments.robot)
    for dim in (1, 3):
        for title, parts in (("node", node_operations(robot.n, dim)), ("stage", recursion_operations(robot.n, dim))):
            print(f"{title}, {dim}-D contact: {sum(parts.values())} operations")
            for name, count in parts.items():
                print(f"    {count:6d} {name}")
    chosen = _mpc.instruction_set()
    with TemporaryDirectory() as folder:
        for isa in _mpc.available_instruction_sets():
            _mpc.use_instruction_set(isa)
            rate = peak(isa, Path(folder))
            for dim in (1, 3):
                operations, seconds = iteration_operations(robot.n, dim, HORIZON), solve_seconds(robot, dim)
                pairs = [(seconds(), rate()) for _ in range(arguments.rounds)]
                one, three = np.min([s for s, _ in pairs], axis=0)
                iteration, fastest = (three - one) / 2, max(r for _, r in pairs)
                print(
                    f"{isa}, {dim}-D contact: {1e6 * iteration:.1f} µs an iteration, {1e-3 * operations:.0f}e3 "
                    f"operations, peak {1e-9 * fastest:.1f}e9/s: {iteration * fastest / operations:.1f} times the bound"
                )
    _mpc.use_instruction_set(chosen)


if __name__ == "__main__":
    main()
