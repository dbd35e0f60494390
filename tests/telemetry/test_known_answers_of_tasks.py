"""Every metric of a task against a value worked out by hand, on ten samples along a tilted normal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from pliant.spatial import rpy
from pliant.studies.task.measure import MEASURES, TaskSignals, measured, signals_of
from pliant.surfaces import PlaneSurface
from tests.telemetry.ten_samples import K, columns, ten_samples

NORMAL = np.array([0.0, -math.sin(0.3), math.cos(0.3)])
ALONG = np.array([0.0, math.cos(0.3), math.sin(0.3)])
TASK_ANSWERS: Mapping[str, float] = {
    # the path is run in samples 5 … 9, Σ k = 35; the tool touches from sample 2 on
    "force_error": (5.0 + 6.0 + 13.0 + 8.0 + 9.0) / 5.0,  # N: k, but 0 − 13 where contact is lost
    "force_error_max": 13.0,
    "force_peak": 29.0,
    "landing_peak": 23.0,  # samples 2 and 3
    "contact_lost": 20.0,
    "path_error": 7.0 * math.sqrt(1.0 + 4.0),  # mm: k along x, 2 k in the plane; what is along the normal is not beside
    "path_error_max": 9.0 * math.sqrt(5.0),
    "torque_share": 45.0,  # 9 of 20 N·m in joint 1, not 18 of 100
}


STEADY_ANSWERS: Mapping[str, float] = {"force_swing": 3.0 / math.sqrt(2.0), "force_line": 3.0}  # %


def test_how_steady_a_force_is() -> None:
    time = 1e-3 * np.arange(2000)
    wanted = np.full(2000, 20.0)
    force = wanted + np.where(time < 0.5, 7.0, 0.6) * np.sin(
        2.0 * math.pi * 25.0 * time
    )  # swings more while it settles
    here = TaskSignals(time, force, wanted, 0.0 * time, np.full(2000, True), np.zeros((2000, 2)))
    found = {metric.name: metric.value for metric in measured(here, {}) if metric.name in STEADY_ANSWERS}
    assert found == pytest.approx(STEADY_ANSWERS, rel=1e-6)
    ramp = replace(here, wanted=np.linspace(5.0, 20.0, 2000))
    assert not {metric.name for metric in measured(ramp, {})} & set(STEADY_ANSWERS)
    (asked,) = [metric for metric in measured(ramp, {"force_line": 2.0}) if metric.name == "force_line"]
    assert math.isnan(asked.value)
    assert asked.met is False


def test_metrics_of_a_task_along_a_tilted_normal() -> None:
    assert set(MEASURES) == {*TASK_ANSWERS, *STEADY_ANSWERS}
    pressed = np.where((K < 2) | (K == 7), 0.0, 20.0 + K)
    off = 1e-3 * (np.outer(K, [1.0, 0.0, 0.0]) + np.outer(2.0 * K, ALONG) + np.outer(5.0 * K, NORMAL))
    force = np.hstack([np.outer(pressed, NORMAL) + np.outer(3.0 * np.ones(10), ALONG), np.zeros((10, 3))])
    asked = np.where(K == 7, 13.0, 20.0)
    log = ten_samples(
        0.1,
        2,
        {"tool": columns(0.5, 0.1, 0.2) + off},
        {"tool": columns(0.5, 0.1, 0.2)},
        torque=columns(-2.0 * K, K),
        felt={"tool": force},
        asked={"tool": columns(0, 0, asked, 0, 0, 0)},
        phases=["press"] * 5 + ["follow"] * 5,
    )
    surface = PlaneSurface(np.zeros(3), rpy(0.3, 0.0, 0.0))
    found = measured(signals_of(log, "tool", surface, np.array([100.0, 20.0])), {"force_error": 1.5})
    assert {metric.name: metric.value for metric in found} == pytest.approx(TASK_ANSWERS, rel=1e-9)
    assert [metric.target for metric in found if metric.name == "force_error"] == [1.5]
