"""Rows of the stack and the haptic study for what their papers print or show: short forms."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.controllers.profiles import linear_range
from pliant.experiments.base import Result
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.references.retuned import Retuned


def value(result: Result, name: str) -> float:
    assert result.failure is None, result.failure
    return next(metric.value for metric in result.metrics if metric.name == name)


@pytest.mark.study
def test_x_0_and_x_b_change_within_their_rules_and_the_force_keeps_its_bound() -> None:
    study = get_study("stack")
    config = next(one for one in study.runs("calibration", 1) if one.variant)
    source = study.build(config).source
    while not isinstance(source, Retuned):
        source = source.inner
    ranges = np.array([change.tuning.range for change in source.changes if change.frame == "flange"])
    assert (np.ptp(ranges, axis=0) > 0.0).all()
    for change in source.changes:
        one = change.tuning
        assert (linear_range(one) < one.range).all()
        assert (one.stiffness * linear_range(one) <= one.force_max * (1.0 + 1e-9)).all()
    short = merged(config, {"duration": 3.2, "path": {"ramp": 0.5}})
    assert value(run_case(study, short), "|h| over F_max") <= 1.0 + 1e-9


def test_without_ranges_the_draws_are_those_of_before() -> None:
    study = get_study("stack")
    config = next(one for one in study.runs("calibration", 1) if not one.variant)
    source = study.build(config).source
    while not isinstance(source, Retuned):
        source = source.inner
    assert len({tuple(change.tuning.range) for change in source.changes}) == 2  # one for each frame, as it was


@pytest.mark.study
def test_the_planner_as_printed_runs_away_and_its_corrected_reading_does_not() -> None:
    study = get_study("haptic")
    force = {
        kind: value(
            run_case(study, merged(study.case("target-sequence"), {"planner": {"kind": kind}, "duration": 4.9})),
            "largest force over F_d",
        )
        for kind in ("superposition", "attractor", "printed")
    }
    assert max(force["superposition"], force["attractor"]) < 15.0 < 50.0 < force["printed"]


@pytest.mark.study
def test_a_stream_of_targets_that_is_late_presses_as_one_that_is_not() -> None:
    """The same force 0.5 s later; the printed exploration loses more of it."""
    study = get_study("haptic")
    runs = {(one.controller, one.variant): one for one in study.runs("target-stream", 1)}
    name = "largest force error"
    kept = [("haptic", ""), ("haptic", "0.5 s late"), ("haptic-paper", "")]
    force = {key: value(run_case(study, runs[key]), name) for key in kept}
    assert force["haptic", "0.5 s late"] == pytest.approx(force["haptic", ""], rel=0.05)
    assert force["haptic-paper", ""] > 2.0 * force["haptic", ""]


def test_the_stream_says_ten_targets_a_second_from_its_delay_on() -> None:
    for one in get_study("haptic").runs("target-stream", 1):
        late = float(one.variant.split()[0]) if one.variant else 0.0
        times = np.array([step.time for step in one.steps[1:]])
        np.testing.assert_allclose(np.diff(times), 0.1, atol=1e-9)
        assert times[0] == pytest.approx(1.5 + late)
