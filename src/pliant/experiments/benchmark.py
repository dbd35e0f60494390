"""How long whole loops take: a tick and its parts, a run with log and metrics, many runs in processes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from contextlib import ExitStack
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
        many as there are runs ("rollout, …"), how many times faster these are ("gain of …"), and as a yardstick how
        many times faster so many processes of nothing but arithmetic are in the same minute. Run it with
        OMP_NUM_THREADS=1 on an idle machine.
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
    most = min(runs, os.cpu_count() or 1)
    taken: dict[int, float] = {}
    for jobs in dict.fromkeys((1, most)):
        begin = time.perf_counter()
        results_in_order(study_name, configs, jobs)
        taken[jobs] = time.perf_counter() - begin
        found[f"rollout, s a run with {jobs} job{'s' if jobs > 1 else ''}"] = taken[jobs] / runs
    if most > 1:
        found[f"gain of {most} jobs"] = taken[1] / taken[most]
        found[f"gain of {most} processes of arithmetic"] = gain_of_arithmetic(most)
    return found


def gain_of_arithmetic(processes: int, steps: int = 10_000_000) -> float:
    """How many times faster processes of nothing but arithmetic are than one that does the work of all: what the
    machine has for a rollout at all. Their start is not timed. Args: processes; steps: of each of them."""
    return _arithmetic(1, processes * steps) / _arithmetic(processes, steps)


_ARITHMETIC = """
import sys, time
print("ready", flush=True)
steps, x = int(sys.stdin.readline()), 0.4
begin = time.monotonic()
for _ in range(steps):
    x = 3.7 * x * (1.0 - x)
print(begin, time.monotonic())
"""


def _arithmetic(processes: int, steps: int) -> float:
    """s from the first begin to the last end, on the clock that all processes share."""
    call = [sys.executable, "-c", _ARITHMETIC]
    with ExitStack() as opened:
        children = [
            opened.enter_context(subprocess.Popen(call, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
            for _ in range(processes)
        ]
        pipes = [(child.stdin, child.stdout) for child in children if child.stdin and child.stdout]
        for _, said in pipes:
            said.readline()
        for asked, _ in pipes:
            asked.write(f"{steps}\n")
            asked.flush()
        times = [tuple(map(float, said.readline().split())) for _, said in pipes]
    return max(end for _, end in times) - min(begin for begin, _ in times)


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
