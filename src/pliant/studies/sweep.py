"""Many runs: one after the other, or side by side in processes of dask.distributed."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from pliant.errors import ConfigError
from pliant.studies.base import CaseConfig, Result
from pliant.studies.registry import get_study
from pliant.studies.runner import run_case


def sweep(
    study_name: str, configs: Sequence[CaseConfig], folder: Path, *, jobs: int = 1, logs: bool = False
) -> Iterator[Result]:
    """Runs configurations and yields each result as it ends; the order is that of completion when `jobs` > 1.

    Args:
        study_name: the study that the configurations belong to.
        configs: what to run.
        folder: where logs and figures go.
        jobs: processes; results do not depend on it.
        logs: keep the log of every run; otherwise only of those that the study shows.

    Raises:
        ConfigError: fewer than one job.
    """
    if jobs < 1:
        raise ConfigError(f"a sweep needs at least one job, got {jobs}")
    if jobs == 1 or len(configs) < 2:
        for config in configs:
            yield run_one(study_name, config, folder, logs)
        return
    yield from _in_processes(study_name, configs, folder, jobs, logs)


def run_one(study_name: str, config: CaseConfig, folder: Path, logs: bool) -> Result:
    """One run, in whatever process this is."""
    study = get_study(study_name)
    shown = study.shows(config)
    return run_case(study, config, folder if shown or logs else None, figures=shown)


def _in_processes(
    study_name: str, configs: Sequence[CaseConfig], folder: Path, jobs: int, logs: bool
) -> Iterator[Result]:
    from distributed import Client, LocalCluster, as_completed

    os.environ.setdefault("OMP_NUM_THREADS", "1")  # inherited by the workers: one thread each
    with (
        LocalCluster(n_workers=min(jobs, len(configs)), threads_per_worker=1, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        futures = [client.submit(run_one, study_name, config, folder, logs, pure=False) for config in configs]
        for future in as_completed(futures):
            yield future.result()
            future.release()
