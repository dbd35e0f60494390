"""Which metrics move as the physics step is halved: a line per metric, those that move by more than 2 % marked.

Run: OMP_NUM_THREADS=1 python benchmarks/half_step.py STUDY CASE [CONTROLLER]

A metric that is zero to its resolution (below 1e-6 of its unit in both runs) did not move.
"""

from __future__ import annotations

import sys

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case

MOST, NOTHING = 0.02, 1e-6


def main(study_name: str, case: str, controller: str | None = None) -> None:
    study = get_study(study_name)
    config = study.case(case)
    if controller is not None:
        config = merged(config, {"controller": controller})
    step = config.model_dump()["physics_step"]
    runs = [run_case(study, merged(config, {"physics_step": size})) for size in (step, step / 2.0)]
    whole, half = ({metric.name: metric for metric in run.metrics} for run in runs)
    print(f"{study_name} {case} {config.controller}, physics step {step:g} s and half of it")
    for name, metric in whole.items():
        a, b = metric.value, half[name].value
        size = max(abs(a), abs(b))
        moved = 0.0 if size < NOTHING else abs(b - a) / size
        print(f"{name:40s} {a:12.5g} {b:12.5g} {metric.unit:8s} {100 * moved:6.2f} %{' *' if moved > MOST else ''}")


if __name__ == "__main__":
    main(*sys.argv[1:])
