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
