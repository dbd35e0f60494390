"""Random tasks, checked and then run: does `pliant task check` call something possible that a run shows it is not?

    python benchmarks/reach_checks.py               100 tasks; about an hour
    python benchmarks/reach_checks.py --tasks 10

Robots, surfaces, their places and tilts, patterns, sizes and forces are drawn. What the check calls possible is run on
a perfect arm with the true surface that the seed draws, with `offset-free-mpc`. A contradiction is a run that fails,
sends a joint its whole torque, or leaves the path by more than 20 mm. What the check refuses is counted, not run.
Exit code 1 if there was a contradiction.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.errors import PliantError
from pliant.experiments.runner import run_case
from pliant.studies.task.config import TaskCase
from pliant.studies.task.study import study_of
from pliant.studies.task.task_study import TaskStudy

FARTHEST = 20.0  # mm
PERFECT = {"sensing_delay": 0.0, "computation_delay": 0.0}


def drawn(seed: int) -> dict[str, Any]:
    """Changes of the task `wipe` that make another one."""
    rng = np.random.default_rng(seed)
    along, height, side = rng.uniform(0.35, 0.8), rng.uniform(0.0, 0.5), rng.uniform(-0.3, 0.3)
    roll, pitch = rng.uniform(-30.0, 30.0, 2).tolist()
    shape = str(rng.choice(["plane", "cylinder", "sphere"]))
    size = tuple(rng.uniform(0.03, 0.1, 2).tolist())
    return {
        "robot": str(rng.choice(["iiwa14", "panda", "ur5e"])),
        "seed": seed,
        "surface": {
            "shape": shape,
            "radius": float(rng.uniform(0.15, 0.4)),
            "pose": {"xyz": (along, side, height), "rpy": (roll + (90.0 if shape == "cylinder" else 0.0), pitch, 0.0)},
        },
        "path": {"pattern": str(rng.choice(["line", "circle", "square"])), "size": size, "speed": 0.08},
        "force": {"normal": float(rng.uniform(5.0, 30.0))},
        "timing": PERFECT,
        "truth": {"imperfections": "none"},
        "accept": {},
    }


def contradiction(study: TaskStudy, case: TaskCase) -> str | None:
    """What a run shows against a check that found the task possible; None if nothing."""
    result = run_case(study, case)
    if result.failure is not None:
        return result.failure
    found = {metric.name: metric.value for metric in result.metrics}
    if found["torque_share"] >= 100.0:
        return "a joint was sent its whole torque"
    if found["path_error_max"] > FARTHEST:
        return f"the tool was {found['path_error_max']:.1f} mm off its path"
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    asked = parser.parse_args()
    study = study_of("wipe")
    possible = wrong = 0
    for seed in range(asked.first, asked.first + asked.tasks):
        case = merged(study.case("wipe"), drawn(seed))
        told = f"task {seed}, {case.robot}, {case.path.pattern} on a {case.surface.shape}"
        try:
            reachable = study.check(case, 1).reachable
        except PliantError as error:
            print(f"{told}: {error}", flush=True)
            continue
        if not reachable:
            print(f"{told}: not possible", flush=True)
            continue
        possible += 1
        against = contradiction(study, case)
        wrong += against is not None
        print(f"{told}: possible; {against or 'and the run did it'}", flush=True)
    print(f"{asked.tasks} tasks, {possible} called possible and run, {wrong} of these contradicted")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
