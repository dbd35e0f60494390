"""What a run gives does not depend on how many processes make the sweep: its log is the same, bit for bit."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from pliant.experiments.open_pool import open_pool
from pliant.experiments.registry import get_study, study_names
from pliant.experiments.results import Request
from pliant.experiments.sweep import asked_runs, sweep
from tests.regression import metrics as regression

SHORT = {
    "haptic": ("floor-noise", ("duration=0.1", "checks=[]")),
    "polishing": (
        "slow",
        ("duration=0.06", "task.reach=0.01", "task.touch=0.02", "task.pressed=0.03", "task.circle=0.04"),
    ),
}


def _made(study: str, jobs: int, folder: Path) -> tuple[dict[str, str], list[str]]:
    """Name of each log → digest; what came out of each run."""
    case, changes = SHORT[study]
    asked = asked_runs(Request(study, (case,), 1, (*changes, "seed=1")))[:2]  # of a seed that is not drawn
    folder.mkdir()
    with open_pool(jobs) as pool:
        found = {
            repr(run.result.config): repr(run.result.metrics)
            for run in sweep(study, asked, folder, pool=pool, logs=True)
        }
    logs = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.mcap"))}
    return logs, [found[repr(config)] for config in asked]


@pytest.mark.study
@pytest.mark.parametrize("study", SHORT)
def test_one_and_two_processes_leave_the_same_logs(study: str, tmp_path: Path) -> None:
    one, two = (_made(study, jobs, tmp_path / str(jobs)) for jobs in (1, 2))
    assert len(one[0]) == 2
    assert one == two
    assert len(set(one[0].values())) == 2  # baseline: another row leaves another log


def test_the_regression_command_runs_every_case_of_every_study() -> None:
    studies = [get_study(name) for name in study_names()]
    ours = [study for study in studies if type(study).__module__.startswith("pliant.")]  # other tests bring their own
    names = {study.name for study in ours}
    covered = {(study, case) for study, case, _, _ in regression.rows() if study in names}  # there are tasks, too
    assert covered == {(study.name, case) for study in ours for case in study.cases}
    assert len(ours) == 3
