"""Many runs: one after the other, in parallel processes, or on a cluster."""

from __future__ import annotations

import gc
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.configuration import merged
from pliant.errors import ConfigError, PliantError, told
from pliant.experiments.base import CaseConfig, Result, check_windows
from pliant.experiments.config import assigned
from pliant.experiments.open_pool import open_pool
from pliant.experiments.pool import Lost, Pool, in_this_process
from pliant.experiments.registry import get_study, study_of_run
from pliant.experiments.results import Request, Run, key
from pliant.experiments.row_keys import refuse_same_names
from pliant.experiments.runner import run_case

MOST_SEEDS = 100_000
"""largest number of seeds per case; more is taken for a typing error"""


@dataclass(frozen=True)
class Job:
    """One run, as it is sent to another process."""

    study: str
    config: CaseConfig
    folder: Path | None = None
    """where log and figures go; None: metrics only"""
    logs: bool = False
    """keep the log even if the study would not keep it"""


def asked_runs(request: Request) -> list[CaseConfig]:
    """Every run of a request, each once.

    Raises:
        ConfigError: an unknown study, case or key, a value that breaks a rule, or a key that rows set themselves.
    """
    study = get_study(request.study)
    if request.seeds is not None and not 1 <= request.seeds <= MOST_SEEDS:
        raise ConfigError(f"a sweep takes 1 to {MOST_SEEDS} seeds per case, got {request.seeds}")
    changes = assigned(request.assignments)
    cases = request.cases or tuple(study.cases)
    runs: list[CaseConfig] = []
    for case in cases:
        if request.controllers:
            runs += compared(study.case(case), request.controllers, request.seeds or 1, changes)
        else:
            runs += study.runs(case, request.seeds, changes)
    found = list({key(config): config for config in runs}.values())
    refuse_same_names(found)
    for config in found:
        check_windows(config)
    return found


def compared(
    config: CaseConfig, controllers: Sequence[str], seeds: int, changes: Mapping[str, Any] | None = None
) -> list[CaseConfig]:
    """A case with each controller, with the same changes and seeds, beginning with the case's own seed."""
    changed = [merged(config, {**(changes or {}), "controller": name}) for name in controllers]
    return [merged(made, {"seed": made.seed + seed}) for made in changed for seed in range(seeds)]


def check_buildable(study_name: str, config: CaseConfig) -> None:
    """Wires a run without running it, so that errors are found before a sweep begins.

    Raises:
        PliantError: it cannot be wired.
    """
    study_of_run(study_name, config).build(config)


def sweep(
    study_name: str,
    configs: Sequence[CaseConfig],
    folder: Path | None = None,
    *,
    pool: Pool = in_this_process,
    logs: bool = False,
) -> Iterator[Run]:
    """Runs configurations and yields each run as it ends; the failure of one run does not stop the others.

    Args:
        study_name: the study that the configurations belong to.
        configs: what to run.
        folder: where logs and figures go; None: metrics only.
        pool: where they are run; results do not depend on it.
        logs: keep the log of every run; otherwise only of those that the study shows.
    """
    folder = None if folder is None else folder.resolve()  # workers may have another working directory
    tasks = [Job(study_name, config, folder, logs) for config in configs]
    for index, outcome in pool(run_task, tasks):
        yield Run(Result(configs[index], (), outcome.reason), "lost", 0.0) if isinstance(outcome, Lost) else outcome


def results_in_order(study_name: str, configs: Sequence[CaseConfig], jobs: int = 1) -> list[Result]:
    """Runs configurations without logs, several at the same time, and returns their results in their order.

    Args:
        study_name: the study that the configurations belong to.
        configs: what to run; what is there twice is run once.
        jobs: processes on this machine; one means this very process. Results do not depend on it.

    Raises:
        ConfigError: fewer than one job.
    """
    different = list({key(config): config for config in configs}.values())
    with open_pool(jobs if jobs < 1 else min(jobs, len(different))) as pool:
        made = {key(run.result.config): run.result for run in sweep(study_name, different, pool=pool)}
    return [made[key(config)] for config in configs]


def run_task(task: Job) -> Run:
    """One run, in this process. An exception makes it a failed run with a reason and does not stop the sweep."""
    started = time.perf_counter()
    try:
        result = _run(task)
        status = "finished" if result.failure is None else "failed"
    except (Exception, SystemExit) as error:
        result, status = Result(task.config, (), _sentence(error)), "crashed"
    gc.collect(1)  # a log in a cycle of objects would wait for the next search, and the command makes them rare
    return Run(result, status, time.perf_counter() - started)


def _run(task: Job) -> Result:
    study = study_of_run(task.study, task.config)
    shown = study.shows(task.config)
    visible = task.folder is not None and task.folder.is_dir()  # not on a machine without access to the folder
    folder = task.folder if visible and (shown or task.logs) else None
    return run_case(study, task.config, folder, figures=shown)


def _sentence(error: BaseException) -> str:
    if isinstance(error, PliantError):
        return str(error)
    where = traceback.extract_tb(error.__traceback__)[-1]
    name, _, text = told(error).partition(": ")
    return f"{name} in {Path(where.filename).name}, line {where.lineno}: {text}"
