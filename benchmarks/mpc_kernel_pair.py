"""Solves and nodes of this build's MPC kernel beside another build's, cycle by cycle in one run.

    python -m benchmarks.mpc_kernel_pair OTHER/_mpc.cpython-311-x86_64-linux-gnu.so [--robot leg3] [--rounds 5]

Both builds run the loops of `benchmarks/mpc_kernel.py` in processes of their own that take turns, so that what else the
machine does meets both. Printed are medians over the rounds of the ratios other / this within each round, of the solve
(fifth percentile of a round's cycles) and of a node with derivatives, and how far the two closed loops end apart.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys

import numpy as np

KINDS = [("force_feedback", 1), ("force_feedback", 3), ("force_feedback", 6), ("classical", 1), ("torque_feedback", 1)]


def serve(module: str, robot_name: str, cycles: int) -> None:
    """One build: measures the cases that come in on standard input."""
    spec = importlib.util.spec_from_file_location("pliant._mpc", module)
    assert spec is not None
    assert spec.loader is not None
    kernel = importlib.util.module_from_spec(spec)
    import pliant

    sys.modules["pliant._mpc"] = kernel
    spec.loader.exec_module(kernel)
    pliant._mpc = kernel  # type: ignore[attr-defined]
    from benchmarks.mpc_kernel_loop import HORIZON, Loop
    from pliant.robot import Robot

    robot = Robot.load(robot_name)
    frame = [f.name for f in robot.model.frames if f.parentJoint == robot.model.njoints - 1][-1]
    for line in sys.stdin:
        isa, kind, dim, bounds = json.loads(line)
        kernel.use_instruction_set(isa)
        loop = Loop(robot, frame, kind, dim, bounds, seed=0, horizon=HORIZON)
        seconds = [loop.cycle()[1] for _ in range(cycles)]  # CPU time
        node = min(loop.plant.benchmark(loop.x, loop.solver.us[0], 300, derivatives=True) for _ in range(9))
        print(json.dumps([float(np.percentile(seconds, 5)), node, loop.x.tolist()]), flush=True)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", help="path of the other build's pliant/_mpc*.so")
    parser.add_argument("--robot", default="lwr4")
    parser.add_argument("--cycles", type=int, default=300, help="solves per round")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        serve(arguments.other, arguments.robot, arguments.cycles)
        return
    from pliant import _mpc

    command = [sys.executable, "-m", "benchmarks.mpc_kernel_pair", "--serve", "--robot", arguments.robot]
    command += ["--cycles", str(arguments.cycles)]
    builds = [
        subprocess.Popen([*command, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for path in (arguments.other, _mpc.__file__)
    ]
    print(f"{arguments.robot}: other / this, and how far the loops end apart")
    print("| instruction set | model | bounds | solve | node | apart |\n|---|---|---|---:|---:|---:|")
    for isa in _mpc.available_instruction_sets():
        for kind, dim, bounds in [*((*case, False) for case in KINDS), ("force_feedback", 1, True)]:
            ratios = []
            for _ in range(arguments.rounds):
                answers = []
                for build in builds:
                    assert build.stdin is not None
                    assert build.stdout is not None
                    build.stdin.write(json.dumps([isa, kind, dim, bounds]) + "\n")
                    build.stdin.flush()
                    answers.append(json.loads(build.stdout.readline()))
                other, this = answers
                ratios.append([other[0] / this[0], other[1] / this[1]])
            solve, node = np.median(ratios, axis=0)
            apart = np.max(np.abs(np.subtract(other[2], this[2])))
            print(f"| {isa} | {kind} {dim} | {bounds} | {solve:.2f} | {node:.2f} | {apart:.0e} |", flush=True)
    for build in builds:
        build.communicate()


if __name__ == "__main__":
    main()
