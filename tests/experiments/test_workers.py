"""Processes that do tasks: what a process that dies costs, and what comes back."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from pliant.errors import ConfigError, RunFailedError
from pliant.experiments import workers
from pliant.experiments.open_pool import open_pool
from pliant.experiments.pool import Lost, in_this_process
from tests.experiments.tasks import odd, work


def test_several_tasks_that_kill_their_process_cost_only_themselves() -> None:
    tasks = [-1, 0, -1, 1, 2]
    with open_pool(2) as pool:
        made = dict(pool(work, tasks))
        again = dict(pool(work, [6, 7]))  # the same pool goes on
    assert set(made) == set(range(len(tasks)))
    assert {index for index, answer in made.items() if isinstance(answer, Lost)} == {0, 2}
    assert "3 times in a row (SIGKILL)" in str(made[0])
    assert again == {0: work(6), 1: work(7)}


def test_the_answers_do_not_depend_on_the_number_of_processes() -> None:
    tasks = list(range(12))
    here = dict(in_this_process(work, tasks))
    for jobs in (1, 2):
        with open_pool(jobs) as pool:
            assert dict(pool(work, tasks)) == here


def test_what_a_task_may_do_wrong(tmp_path: Path) -> None:
    with open_pool(2) as pool:
        made = dict(pool(odd, ["raises", "exits", "cannot be sent", "fine", str(tmp_path / "mark")]))
    assert made[0] == Lost("the worker could not run it: ValueError: no")
    assert "exit code 7" in str(made[1])
    assert "could not run it" in str(made[2])
    assert made[3] is None
    assert made[4] is None  # it killed its process once, and was done again


def test_processes_that_cannot_start_are_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "_serve", sys.exit)  # ends before it says that it is there
    with open_pool(2) as pool, pytest.raises(RunFailedError, match="no process for the runs can be started"):
        dict(pool(work, [1]))


SCRIPT = """
    import sys, threading, types
    from pliant.experiments.open_pool import open_pool
    from pliant.experiments.workers import start_method
    from tests.experiments import tasks

    def answers():
        with open_pool(2) as pool:
            print(start_method(), sorted({answer for _, answer in pool(tasks.recall, range(4))}))

    if __name__ == "__main__":
        tasks.known.append("worked out before")
        answers()
        end = threading.Event()
        other = threading.Thread(target=end.wait)
        other.start()
        answers()
        end.set()
        other.join()
        answers()
        sys.modules["torch"] = types.ModuleType("torch")
        answers()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere processes are spawned")
def test_processes_are_forks_that_know_what_was_worked_out_only_where_that_is_safe(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(SCRIPT))
    command = [sys.executable, "-W", "error", str(script)]
    root = str(Path(__file__).parents[2])
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": root}, check=False)
    assert done.returncode == 0, done.stderr
    forked, spawned = "fork ['worked out before']", "spawn ['what the module says']"
    assert done.stdout.splitlines() == [forked, spawned, forked, spawned]


@pytest.mark.parametrize("jobs", [0, -1, 10**23])
def test_a_number_of_jobs_that_cannot_be_meant_is_refused(jobs: int) -> None:
    with pytest.raises(ConfigError, match="jobs"), open_pool(jobs):
        pass
