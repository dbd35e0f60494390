"""A tare is a key of every study and task in which a force is felt; it takes a load that nobody named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.estimation import WrenchEstimator
from pliant.experiments.registry import get_study
from pliant.loop import run
from pliant.signals import Tick
from pliant.studies.task.study import study_of

UNKNOWN = {
    "truth": {"tool_mass": 0.5, "imperfections": "none", "tilt": 0.0, "shift": 0.0},
    "sensor": {"frame": "flange"},
}


def started(case: Any, seconds: float = 0.05) -> tuple[np.ndarray, str | None]:
    """Believed force at the end of a short start in free air (3,) N, and why it stopped early."""
    built, found = study_of("wipe").build(case), list[np.ndarray]()

    def watch(tick: Tick) -> None:
        found.append(tick.estimate.wrenches["tool"][:3])
        assert tick.truth is not None
        assert not tick.truth.wrenches["tool"].any()

    parts = (built.plant, built.estimator, built.source, built.controller)
    outcome = run(*parts, range(round(seconds / case.simulation.period)), [watch], built.robot)
    return found[-1] if found else np.full(3, np.nan), outcome.failure


def test_a_sensor_at_the_flange_takes_off_the_tool_that_is_known() -> None:
    case = merged(study_of("wipe").case("wipe"), {**UNKNOWN, "tool": {"mass": 1.5}})
    known, failure = started(merged(case, {"truth": {"tool_mass": 0.0}}))
    assert np.linalg.norm(known) < 0.1
    assert failure is None
    with pytest.raises(ConfigError, match=r"sensor\.frame='elbow'; .*flange"):
        study_of("wipe").build(merged(case, {"sensor": {"frame": "elbow"}}))


def test_an_unknown_half_kilogram_is_said_and_a_tare_takes_it() -> None:
    case = merged(study_of("wipe").case("wipe"), UNKNOWN)
    _, failure = started(case)
    assert failure is not None
    assert "estimation.tare=weight" in failure
    light, failure = started(merged(case, {"estimation": {"tare": "weight"}}))
    assert np.linalg.norm(light) < 0.1 * 0.5 * 9.81  # the arm gives a little while it tares
    assert failure is None


@pytest.mark.parametrize(
    ("study", "case", "changes"),
    [
        ("haptic", "floor", {}),
        ("polishing", "ideal", {}),
        ("stack", "figure8-wall", {"controller": "haptic"}),
        ("wipe", "wipe", {}),
        ("floor", "floor", {}),
    ],
)
def test_the_key_reaches_whatever_feels(study: str, case: str, changes: dict[str, Any]) -> None:
    found = study_of(study) if study in ("wipe", "floor") else get_study(study)
    for kind in (None, "bias"):
        built = found.build(merged(found.case(case), {**changes, "estimation": {"tare": kind}}))
        part: Any = built.estimator
        while not isinstance(part, WrenchEstimator):
            part = part.inner
        assert (None if part.tare is None else part.tare.kind) == kind
