"""The polishing study on the imperfect robot in reduced form: few tilts and seeds, the first second of the circle."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from pliant.cli.paper_tables import paper_tables
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.runner import run_case
from pliant.experiments.summarise import summarised
from pliant.simulation import Imperfections
from pliant.studies.polishing import STUDY
from pliant.studies.polishing.cases import CASES
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import ALL, STOCK, TILTS
from pliant.telemetry.summary import Metric

DRAWS = ((0.1, 900), (-0.1, 902))  # tilt in rad, seed; ten seeds of seven tilts are `pliant study polishing`
BEST = "offset-free-mpc"


def config_of(controller: str, tilt: float, seed: int, pid: bool, delay: float, **changes: Any) -> PolishingConfig:
    imperfections = Imperfections.p3(pid=pid, computation_delay=delay).model_dump()
    fixed = {
        "controller": controller,
        "seed": seed,
        "duration": 4.0,
        "table": {"tilt": tilt},
        "imperfections": imperfections,
    }
    return merged(merged(STUDY.case("ablation"), fixed), changes)


@cache
def results(controller: str, pid: bool, delay: float) -> tuple[Result, ...]:
    return tuple(run_case(STUDY, config_of(controller, tilt, seed, pid, delay)) for tilt, seed in DRAWS)


def value(result: Result, name: str) -> float:
    assert result.failure is None, result.failure
    return next(metric.value for metric in result.metrics if metric.name == name)


def mean(runs: tuple[Result, ...], name: str) -> float:
    return float(np.mean([value(run, name) for run in runs]))


@pytest.mark.study
@pytest.mark.parametrize("pid", [True, False])
def test_offset_free_control_holds_its_targets_through_5_ms(pid: bool) -> None:
    runs = results(BEST, pid, 5e-3)
    assert mean(runs, "E_λ") <= (0.5 if pid else 0.6)
    assert mean(runs, "E_P") <= (0.5 if pid else 0.6)
    assert max(value(run, "λ_max") for run in runs) <= 58.0
    assert max(value(run, "t_break") for run in runs) == 0.0
    assert max(value(run, "first contact peak") for run in runs) <= 30.0


@pytest.mark.study
@pytest.mark.parametrize("pid", [True, False])
def test_without_delay_the_three_come_out_in_the_papers_order(pid: bool) -> None:
    """Force feedback tracks the force best, and no stock controller comes near the compensated one at 5 ms."""
    force = {name: mean(results(name, pid, 0.0), "E_λ") for name in STOCK}
    assert force["force-feedback-mpc"] < 0.6 * min(force["classical-mpc"], force["torque-feedback-mpc"])
    assert mean(results(BEST, pid, 5e-3), "E_λ") < 0.5 * force["force-feedback-mpc"]
    if pid:
        assert force["force-feedback-mpc"] <= 4.0


@pytest.mark.study
@pytest.mark.parametrize(
    ("part", "changes"),
    [
        ("delay prediction", {"compensation": {"sensing_delay": 0.0, "computation_delay": 0.0}}),
        ("disturbance", {"compensation": {"disturbance": False}}),
    ],
)
def test_each_part_is_needed(part: str, changes: dict[str, Any]) -> None:
    """Baselines: without it the same run fails or tracks three times worse."""
    tilt, seed = DRAWS[0]
    result = run_case(STUDY, config_of(BEST, tilt, seed, False, 5e-3, control=changes))
    whole = results(BEST, False, 5e-3)[0]
    worse = [value(result, name) / value(whole, name) for name in ("E_λ", "E_P")] if result.failure is None else []
    assert result.failure is not None or max(worse) > 3.0, part


@pytest.mark.study
def test_one_tuning_covers_soft_and_stiff_tables() -> None:
    for stiffness in (3e3, 1e5):
        changes = {"table": {"stiffness": stiffness}}
        assert value(run_case(STUDY, config_of(BEST, 0.1, 900, False, 5e-3, **changes)), "E_λ") <= 1.5


@pytest.mark.study
def test_the_same_seed_gives_the_same_row_and_another_one_another() -> None:
    first = results(BEST, True, 5e-3)[0]
    again = run_case(STUDY, config_of(BEST, *DRAWS[0], True, 5e-3))
    assert first.metrics == again.metrics
    tilt, seed = DRAWS[0]
    assert value(first, "E_λ") != value(run_case(STUDY, config_of(BEST, tilt, seed + 1, True, 5e-3)), "E_λ")


@pytest.mark.study
def test_a_robot_that_runs_away_is_stopped_and_counted() -> None:
    """Most stock runs with 5 ms do; the run ends early, is a failed one, and has no metrics that could look good."""
    result = run_case(STUDY, config_of("force-feedback-mpc", 0.1, 900, False, 5e-3))
    assert result.failure is not None
    assert "times its speed limit" in result.failure
    assert result.metrics == ()


def test_the_tables_have_the_runs_that_the_study_promises() -> None:
    stock = STUDY.runs("tables-2-3-4")
    assert len(stock) == len(TILTS) * 10 * len(STOCK) * 2 == 420
    assert all(run.imperfections.computation_delay == 0.0 for run in stock)
    delayed = STUDY.runs("tables-2-3-4-delayed")
    assert len([run for run in delayed if run.controller == BEST]) == 140
    assert all(run.imperfections.computation_delay == 5e-3 for run in delayed)
    for case in CASES:
        runs = STUDY.runs(case, 2)
        assert len({run.model_dump_json() for run in runs}) == len(runs), case
        alike = {run.model_copy(update={"seed": 0, "table": runs[0].table}).model_dump_json(): run for run in runs}
        for run in alike.values():
            run.parameters()  # a row's configuration is possible, whatever the seed and the tilt


def test_what_is_tuned_on_is_not_in_the_tables() -> None:
    seen = {run.seed for case in CASES for run in STUDY.runs(case)}
    for controller in ALL:
        tuning = STUDY.search(controller)
        assert seen.isdisjoint(run.seed for run in tuning.runs)
        merged(tuning.runs[0], tuning.changes(tuning.start)).parameters()
    with pytest.raises(ConfigError, match="no controller"):
        STUDY.search("clasical-mpc")


def test_the_controller_is_told_the_delays_of_its_robot_and_their_error() -> None:
    told = config_of(BEST, 0.0, 0, False, 3e-3, delay_error=1e-3).parameters().compensation
    assert (told.sensing_delay, told.computation_delay) == pytest.approx((1e-3, 4e-3))
    chosen = {"control": {"compensation": {"computation_delay": 2e-3}}}
    assert config_of(BEST, 0.0, 0, False, 3e-3, **chosen).parameters().compensation.computation_delay == 2e-3


def test_the_report_shows_ours_beside_the_papers_and_counts_failures() -> None:
    def fake(controller: str, variant: str, seed: int, force: float | None) -> Result:
        config = merged(STUDY.case("tables-2-3-4"), {"controller": controller, "variant": variant, "seed": seed})
        if force is None:
            return Result(config, (), "stopped")
        metrics = (Metric("E_λ", force, "N"), Metric("E_τ", 0.5 * force, "N·m"))
        return Result(config, STUDY.cases["tables-2-3-4"].beside(config, metrics))

    runs = [fake("force-feedback-mpc", "PID", seed, force) for seed, force in enumerate((2.0, 4.0, None))]
    runs += [fake("force-feedback-mpc", "no PID", seed, force) for seed, force in enumerate((7.0, 6.0, 5.0))]
    text = paper_tables(STUDY, summarised(STUDY, runs))
    assert "| E_λ, N, mean | 3.00 ± 1.4 (2.04) |" in text  # of the two that ended, n − 1
    assert "| runs that means and worst are of | 2 |" in text
    assert "| failed, one-sided 95 % bound | 1 of 3: ≤ 86 % |" in text
    assert (
        "| ΔE_λ, N, mean | 3.50 ± 2.1, n = 2 (8.51) |" in text
    )  # Table IV: pairs of which both ended: 7 − 2 and 6 − 4
