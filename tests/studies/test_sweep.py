"""Sweeps through the command line: processes, a cluster, killed workers, interruptions."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from rich.console import Console

from pliant.cli.study import resume_command
from pliant.errors import ConfigError, OutputError, RunFailedError
from pliant.experiments.open_pool import open_pool
from pliant.experiments.parquet import read_parquet, write_parquet
from tests.experiments.tasks import nap
from tests.studies.commands import content, environment, rows, start, study

pytestmark = pytest.mark.study
CASES = ("--case", "physics", "--case", "fine", "--case", "bug", "--seeds", "3")


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("alone")
    code, _, errors = study("toy", *CASES, "--out", folder)
    assert code == 0, errors
    return folder


def test_a_row_per_run_in_the_order_asked_for(alone: Path) -> None:
    found = rows(alone).to_pylist()
    assert [(row["case"], row["seed"]) for row in found] == [
        (c, s) for c in ("physics", "fine", "bug") for s in (0, 1, 2)
    ]
    assert [row["status"] for row in found] == ["failed"] * 3 + ["finished"] * 3 + ["crashed"] * 3
    assert found[0]["failure"].startswith("it fell over")
    assert "a bug in a run" in found[-1]["failure"]
    assert found[3]["E_λ [N]"] > 0.0
    assert found[0]["E_λ [N]"] is None


def test_two_processes_give_the_same_rows(alone: Path, tmp_path: Path) -> None:
    code, _, errors = study("toy", *CASES, "--jobs", 2, "--out", tmp_path)
    assert code == 0, errors
    assert content(tmp_path) == content(alone)


@contextmanager
def cluster(workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A dask scheduler and its workers, each a process of its own."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment()}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", address, "--no-dashboard"]
    worker = [
        sys.executable,
        "-m",
        "distributed.cli.dask_worker",
        address,
        "--nthreads",
        "1",
        "--no-nanny",
        "--no-dashboard",
    ]
    started = [subprocess.Popen(dask, **quiet), *(subprocess.Popen(worker, **quiet) for _ in range(workers))]
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        try:
            socket.create_connection(("127.0.0.1", int(address.rsplit(":", 1)[1])), timeout=1.0).close()
            break
        except OSError:
            time.sleep(0.1)
    try:
        yield address, started
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait(20)


def test_a_cluster_gives_the_same_rows_and_when_it_dies_they_are_kept(alone: Path, tmp_path: Path) -> None:
    with cluster(1) as (address, (scheduler, _)):
        code, _, errors = study("toy", *CASES, "--scheduler", address, "--out", tmp_path / "whole")
        assert code == 0, errors
        assert content(tmp_path / "whole") == content(alone)
        slow = ("toy", "--case", "slow", "--seeds", 400, "--scheduler", address, "--out")
        process = start(*slow, tmp_path / "stopped", start_new_session=True)
        _wait_for_rows(tmp_path / "stopped")
        _, errors = _interrupted(process)
        assert process.returncode == 130, errors
        assert len(errors.strip().splitlines()) == 1
        folder = tmp_path / "cut"
        process = start(*slow, folder)
        _wait_for_rows(folder)
        scheduler.kill()
        _, errors = process.communicate(timeout=90)
    assert process.returncode == 1, errors
    assert "the dask scheduler" in errors
    assert "is kept" in errors
    assert len(errors.strip().splitlines()) == 1
    assert 0 < rows(folder).num_rows < 400


def test_workers_that_stand_still_or_all_die_and_a_scheduler_without_any_are_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with cluster(1) as (address, (_, worker)), open_pool(1, address) as pool:
        answers = pool(nap, [0.2] * 200)
        next(answers)
        worker.send_signal(signal.SIGSTOP)
        monkeypatch.setattr("pliant.experiments.cluster._VERSION", 0.5)
        with pytest.raises(ConfigError, match=r"the workers of tcp.* do not answer"), open_pool(1, address):
            pass
        for name, seconds in (("_ALIVE", 0.5), ("_GONE", 2.0)):
            monkeypatch.setattr(f"pliant.experiments.cluster.{name}", seconds)
        worker.kill()
        with pytest.raises(RunFailedError, match=r"all workers of the dask scheduler .* went away.* is kept"):
            list(answers)
    with cluster(0) as (address, _):
        code, _, errors = study("toy", "--scheduler", address, "--out", tmp_path)
    assert code == 2, errors
    assert "has no workers" in errors
    assert not (tmp_path / "results.parquet").exists()


def test_a_killed_worker_costs_nothing_but_a_run_that_always_kills_fails(tmp_path: Path) -> None:
    mark = f"mark={tmp_path}"
    cases = ("--case", "slow", "--case", "dies-once", "--case", "dies", "--seeds", "1", "--set", mark)
    code, _, errors = study("toy", *cases, "--jobs", 2, "--out", tmp_path / "out")
    assert code == 0, errors
    assert "distributed" not in errors
    assert rows(tmp_path / "out")["status"].to_pylist() == ["finished", "finished", "lost"]
    assert "its process died" in rows(tmp_path / "out")["failure"].to_pylist()[-1]


def _interrupted(process: subprocess.Popen[str]) -> tuple[str, str]:
    """Ctrl-C, as a terminal sends it: to the workers too. The command ends soon: within 0.8 s on an idle machine."""
    os.killpg(process.pid, signal.SIGINT)
    return process.communicate(timeout=20)


def _wait_for_rows(folder: Path, count: int = 1) -> None:
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        if (folder / "results.parquet").exists() and pq.read_metadata(folder / "results.parquet").num_rows >= count:
            return
        time.sleep(0.05)


def test_a_killed_command_loses_the_running_runs_only_and_a_second_one_is_told_who_holds_the_folder(
    tmp_path: Path,
) -> None:
    process = start("toy", "--case", "slow", "--seeds", 10, "--jobs", 2, "--out", tmp_path)
    _wait_for_rows(tmp_path, 2)
    process.send_signal(signal.SIGSTOP)  # it shall not end before the second one has asked
    with pytest.raises(OutputError, match=rf"in use by process {process.pid} \(`pliant study toy"):
        resume_command(Console(), Console(), tmp_path, None, 1, None)
    process.kill()
    process.communicate(timeout=60)
    before = rows(tmp_path)["seed"].to_pylist()
    assert len(before) >= 2
    code, _, errors = study("--resume", tmp_path, "--jobs", 2)
    assert code == 0, errors
    assert rows(tmp_path)["seed"].to_pylist() == list(range(10))


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_interrupted_study_is_resumed_to_the_same_table(jobs: int, tmp_path: Path) -> None:
    cases = ("toy", "--case", "slow", "--seeds", "36")
    folder = tmp_path / "cut"
    process = start(*cases, "--jobs", jobs, "--out", folder, start_new_session=True)
    _wait_for_rows(folder)
    out, errors = _interrupted(process)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert f"--resume {folder}" in errors
    kept = rows(folder)
    assert 0 < kept.num_rows < 36
    assert (folder / "summary.json").exists()
    assert (folder / "report.md").exists()
    code, out, errors = study("--resume", folder)
    assert code == 0, errors
    assert "report" in out
    table = rows(folder)
    assert table["seed"].to_pylist() == list(range(36))
    assert set(table["status"].to_pylist()) == {"finished"}


def test_a_mistake_is_found_before_anything_runs(tmp_path: Path) -> None:
    code, _, errors = study("toy", "--set", "robot=missing.urdf", "--out", tmp_path)
    assert code == 2
    assert "missing.urdf" in errors
    assert not (tmp_path / "results.parquet").exists()


def test_an_interrupted_and_a_whole_study_hold_the_same_rows(alone: Path, tmp_path: Path) -> None:
    """A file from which rows are missing is filled up to the very table of an uninterrupted study."""
    table, about = read_parquet(alone / "results.parquet")
    write_parquet(tmp_path / "results.parquet", table.slice(2, 3), about)
    code, _, errors = study("--resume", tmp_path, "--jobs", 2)
    assert code == 0, errors
    assert content(tmp_path) == content(alone)
