"""How many feasible problems with torque bounds and friction cone together converge within 30 SQP iterations.

Run: OMP_NUM_THREADS=1 PYTHONPATH=. python benchmarks/mpc_feasible.py [--problems 60] [--seed 1000]

For each model, node length and width of the torque bounds: converged, problems, answers on which bounds and cone act.
"""

from __future__ import annotations

import argparse

from tests.mpc.drawn_problems import tried

STEPS = (3e-3, 5e-3)
"""s"""
WIDTHS = ((-1.5, -0.5), (-0.5, 0.5), (0.5, 1.5))
"""decades of N·m between the torque bounds"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--problems", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1000)
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + options.problems)
    for kind in ("classical", "torque_feedback", "force_feedback"):
        for dt in STEPS:
            for width in WIDTHS:
                found = tried(kind, seeds, dt, width)
                low, high = (10.0**w for w in width)
                text = f"{found.converged:3d} of {found.problems}, both act in {found.both:3d}"
                print(f"{kind:16s} {1e3 * dt:g} ms, bounds {low:.2g} to {high:.2g} N·m apart: {text}", flush=True)


if __name__ == "__main__":
    main()
