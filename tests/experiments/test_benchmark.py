"""The benchmark of whole loops: what it says of times that are known."""

from __future__ import annotations

import math

import pytest

from pliant.experiments import benchmark


def test_every_case_gets_every_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "CASES", {"short": ("haptic", "parameters", "haptic")})
    (row,) = benchmark.run(seconds=0.05, runs=1).values()
    assert list(row) == ["tick", *benchmark.PARTS, "loop", "run", "rollout, s a run with 1 job"]
    assert all(math.isfinite(value) and value > 0.0 for value in row.values())
    assert sum(row[part] for part in benchmark.PARTS) < row["tick"]  # the recorder and the guard take some, too
    assert row["loop"] == pytest.approx(1e-6 * row["tick"] / 1e-3)  # a tick each ms


def test_a_rollout_in_processes_has_its_gain_and_that_of_the_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "CASES", {"short": ("haptic", "parameters", "haptic")})
    monkeypatch.setattr(benchmark, "results_in_order", lambda *_: None)
    monkeypatch.setattr(benchmark.os, "cpu_count", lambda: 2)
    asked: list[int] = []
    monkeypatch.setattr(benchmark, "gain_of_arithmetic", lambda processes: asked.append(processes) or 1.5)
    (row,) = benchmark.run(seconds=0.05, runs=3).values()
    one, two = row["rollout, s a run with 1 job"], row["rollout, s a run with 2 jobs"]
    assert row["gain of 2 jobs"] == pytest.approx(one / two)
    assert row["gain of 2 processes of arithmetic"] == 1.5
    assert asked == [2]


def test_the_gain_is_the_time_of_one_process_over_that_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    spans = {(1, 60): 3.0, (2, 30): 1.6}  # as much work for one as for two together
    monkeypatch.setattr(benchmark, "_arithmetic", lambda processes, steps: spans[processes, steps])
    assert benchmark.gain_of_arithmetic(2, 30) == pytest.approx(3.0 / 1.6)
    monkeypatch.undo()
    assert 0.0 < benchmark._arithmetic(1, 1000) < benchmark._arithmetic(1, 1_000_000)
    assert math.isfinite(benchmark.gain_of_arithmetic(2, 1000))
