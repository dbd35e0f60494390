"""Which runs the full haptic study makes, and what it concludes from several of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.experiments.base import Result
from pliant.studies.haptic import STUDY, benchmark
from pliant.studies.haptic.delays import DELAYS, PLACES, SURFACES, largest_stable
from pliant.studies.haptic.parameters import PARAMETERS
from pliant.telemetry.summary import Metric

DELAY = STUDY.cases["delay"]


def ran(config, rms: float = 0.01, speed: float = 0.0, peak: float = 30.0, share: float = 0.1) -> Result:
    metrics = (
        Metric("force, rms", rms, "N"),
        Metric("speed at the end", speed, "m/s"),
        Metric("peak force", peak, "N"),
        Metric("|W| over F_max", share, "1"),
    )
    return Result(config, metrics)


@pytest.mark.parametrize("bad", [{"rms": 5.0}, {"speed": 1.0}, {"peak": 2e4}, {"rms": float("nan")}])
def test_largest_stable_delay_ends_at_the_first_run_that_is_not(bad: dict[str, float]) -> None:
    """Also where later runs look quiet again: a leg that has swung away presses steadily with nothing."""
    results = []
    for config in STUDY.runs("delay")[1:]:
        late = config.hardware.force_delay > 0.0105 or config.hardware.command_delay > 0.0025
        results.append(ran(config, **bad) if late and not config.variant.endswith(" 50 ms") else ran(config))
    largest = largest_stable(DELAY, results)
    assert largest["rigid, 1e6 N/m", "force signal"] == 8.0
    assert largest["rigid, 1e6 N/m", "command"] == 2.0
    assert largest["soft, 1e3 N/m", "both"] == 2.0


def test_failed_run_is_not_stable() -> None:
    results = [Result(config, (), "diverged") for config in STUDY.runs("delay")[1:]]
    assert set(largest_stable(DELAY, results).values()) == {0.0}


def test_runs_of_the_full_study() -> None:
    assert len(STUDY.runs("delay")) == 1 + len(DELAYS) * len(PLACES) * len(SURFACES)
    assert len(STUDY.runs("parameters")) == 1 + 2 * sum(len(parameter.values) for parameter in PARAMETERS)
    assert [run.controller for run in STUDY.runs("ball")] == ["haptic", "haptic-paper"]
    assert len({run.seed for run in STUDY.runs("random")}) == 20
    assert len(STUDY.runs("random", seeds=2)) == 4
    assert {run.exploration.reset for run in STUDY.runs("online", seeds=1)} == {True, False}


def test_figures_of_several_runs(tmp_path: Path) -> None:
    delays = [ran(config) for config in STUDY.runs("delay")]
    up_down = (Metric("up", 0.1, "s"), Metric("down", np.inf, "s"), Metric("peak force", 20.0, "N"))
    parameters = [Result(config, up_down) for config in STUDY.runs("parameters")]
    drawn = STUDY.summary_figures([*delays, *parameters], tmp_path)
    assert [path.name for path in drawn] == ["delay.png", "parameters.png"]
    assert all(path.stat().st_size > 10_000 for path in drawn)
    assert STUDY.summary_figures([Result(STUDY.case("ball"), ())], tmp_path) == []


def test_step_is_timed_with_everything_in_it() -> None:
    result = benchmark.run(200)
    assert set(result["cpu"]) == {"median", "p90", "p99", "max"}
    assert 0.0 < result["cpu"]["median"] <= result["cpu"]["max"]
