"""How long whole loops take: a tick and its parts, a run with log and metrics, many runs in processes."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from typing import Any

from pliant.configuration import merged
from pliant.experiments.base import CaseConfig, Study
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case, run_info, run_length
from pliant.experiments.sweep import results_in_order
from pliant.telemetry.recorder import Recorder

CASES = {
    "polishing": ("polishing", "tables-2-3-4-delayed", "offset-free-mpc"),
    "stack": ("stack", "figure8-plain", "stack"),
    "haptic": ("haptic", "floor", "haptic"),
}
"""name → study, case, controller"""
PARTS = ("plant", "estimator", "source", "controller")
_US = 1e6  # µs per s


class _Timed:
    """A part of a loop; sums the CPU time of its steps, and is the part in everything else."""

    def __init__(self, part: Any) -> None:
        self.part, self.taken = part, 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.part, name)

    def step(self, *inputs: Any) -> Any:
        begin = time.thread_time()
        answer = self.part.step(*inputs)
        self.taken += time.thread_time() - begin
        return answer


def run(seconds: float = 2.0, runs: int = 2) -> dict[str, dict[str, float]]:
    """Times the loop of each of `CASES`.

    Args:
        seconds: simulated, of the loop whose ticks are timed.
        runs: of each case, for the time of many.

    Returns:
        Case → mean CPU time of a tick and of its parts in µs ("tick", "plant", …); CPU time in s of a loop per
        simulated second ("loop") and of a whole run ("run"); wall time in s per run of many in one process and in as
        many as there are runs ("rollout, …"). Run it with OMP_NUM_THREADS=1 on an idle machine.
    """
    return {name: _case(*case, seconds, runs) for name, case in CASES.items()}


def _case(study_name: str, case: str, controller: str, seconds: float, runs: int) -> dict[str, float]:
    study = get_study(study_name)
    config = merged(study.case(case), {"controller": controller})
    found = _loop(study, config, seconds)
    begin = time.process_time()
    run_case(study, config, figures=False)
    found["run"] = time.process_time() - begin
    configs = [merged(config, {"seed": config.seed + k}) for k in range(runs)]
    for jobs in dict.fromkeys((1, min(runs, os.cpu_count() or 1))):
        begin = time.perf_counter()
        results_in_order(study_name, configs, jobs)
        found[f"rollout, s a run with {jobs} job{'s' if jobs > 1 else ''}"] = (time.perf_counter() - begin) / runs
    return found


def _loop(study: Study[Any], config: CaseConfig, seconds: float) -> dict[str, float]:
    wired = study.build(config)
    parts: dict[str, Any] = {name: _Timed(getattr(wired, name)) for name in PARTS}
    timed, period = replace(wired, **parts), wired.plant.period
    ticks = round(min(seconds, run_length(config, wired)) / period)
    with Recorder(None, run_info(study, config, wired), channels=wired.channels) as recorder:
        begin = time.thread_time()
        ticks = max(timed.run(range(ticks), [recorder]).ticks, 1)
        taken = time.thread_time() - begin
    found = {"tick": _US * taken / ticks}
    found |= {name: _US * part.taken / ticks for name, part in parts.items()}
    return found | {"loop": taken / (ticks * period)}
