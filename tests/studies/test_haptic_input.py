"""What the haptic study does with input that breaks a rule, and what it warns of before it runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.controllers.profiles import Shape
from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.studies.haptic import STUDY
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.draws import drawn
from pliant.studies.haptic.safety import reachable_force
from pliant.studies.haptic.script import user_settings
from pliant.studies.haptic.steps_config import Step
from pliant.telemetry.recorder import Recorder
from tests.laws.impedance_strategies import profile_of

FLOOR = STUDY.case("floor")


def changed(**changes: Any) -> HapticCaseConfig:
    return merged(FLOOR, changes)


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"impedance": {"stiffness": (-1.0, 6000.0, 12000.0)}}, "must be at least 0"),
        ({"impedance": {"stiffness": (float("nan"), 6000.0, 12000.0)}}, "finite"),
        ({"impedance": {"force_max": (float("inf"), 150.0, 300.0)}}, "finite"),
        ({"impedance": {"stiffness": (0.0, 6000.0, 12000.0)}}, "stiffness 0 needs force_max 0"),
        ({"impedance": {"range": (0.0, 0.025, 0.025)}}, "range"),
        ({"exploration": {"gain": -45.0}}, "must be above 0"),
        ({"exploration": {"gian": 45.0}}, "did you mean 'gain'"),
        ({"steps": ({"time": 0.5, "target": (0.1, 0.0, 0.0)},)}, "first step must be at time 0"),
        ({"steps": ({"target": (0.1, 0.0, 0.0)}, {"time": 0.0})}, "times of the steps must increase"),
    ],
)
def test_impossible_values_are_refused_with_their_rule(changes: dict[str, Any], rule: str) -> None:
    with pytest.raises(ConfigError, match=rule):
        changed(**changes)


def test_frame_without_force_signal_is_refused() -> None:
    with pytest.raises(ConfigError, match="no force signal"):
        STUDY.build(changed(sensor=False))
    STUDY.build(changed(sensor=False, controller="haptic-hold"))


def test_tuned_study_warns_of_nothing() -> None:
    assert STUDY.build(FLOOR).warnings == ()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"impedance": {"stiffness": (6000.0, 6000.0, 3e5)}}, ["ω T_s", "safe: stiffness ≤"]),
        ({"hardware": {"bandwidth": 2.0}}, ["the actuators' 13 rad/s", "safe: stiffness ≤"]),
        ({"hardware": {"bandwidth": 5.0}, "exploration": {"gain": 100.0}}, ["exploration.gain ≤ 15.7"]),
        ({"impedance": {"stiffness": (500.0, 500.0, 500.0), "range": (0.001, 0.001, 0.001)}}, ["knee", "safe"]),
        ({"steps": ({"target": (0.1, 0.0, 0.01), "force": (0.0, 0.0, 400.0)},)}, ["exceed F_max", "|F_d| ≤ 300"]),
        ({"steps": ({"target": (0.9, 0.0, 0.1)},)}, ["out of reach", "safe: ["]),
    ],
)
def test_unsafe_values_are_warned_of_with_a_safe_one(changes: dict[str, Any], words: list[str]) -> None:
    found = " | ".join(STUDY.build(changed(**changes)).warnings)
    for word in words:
        assert word in found


def test_unreachable_force_is_warned_of_with_the_range_it_needs() -> None:
    (warning,) = STUDY.build(STUDY.case("ball-unreachable")).warnings
    assert "60 N along z are out of reach, 32.3 N is all" in warning
    wider = merged(STUDY.case("ball-unreachable"), {"impedance": {"range": (0.025, 0.025, 0.0551)}})
    assert "range z ≥ 0.055 m" in warning
    assert STUDY.build(wider).warnings == ()


def run(config: HapticCaseConfig) -> dict[str, Array]:
    wired, recorder = STUDY.build(config), Recorder(None)
    outcome = loop.run(
        wired.plant, wired.estimator, wired.source, wired.controller, range(round(config.duration * 1e3)), [recorder]
    )
    recorder.close(outcome.failure)
    assert outcome.failure is None
    log = recorder.log()
    return {name: log[name] for name in log.channels}


def test_what_is_clamped_is_reported() -> None:
    """A target out of reach and a force beyond F_max: brought back, and by how much is in the log."""
    wild = Step(target=(0.9, 0.0, 0.1), force=(0.0, 0.0, 400.0))
    log = run(changed(duration=0.3, steps=(wild.model_dump(),), checks=()))
    assert np.linalg.norm(log["planner/foot/clamped"][-1]) == pytest.approx(np.hypot(0.9, 0.4) - 0.625, abs=1e-9)
    assert log["exploration/foot/clamped"][-1][2] == pytest.approx(100.0)
    assert log["reference/foot/wrench"][-1][2] == pytest.approx(300.0)


def test_bound_that_shrinks_holds_in_the_same_tick() -> None:
    steps = [
        {"target": (0.05, 0.0, 0.017), "force": (0.0, 0.0, 100.0)},
        {"time": 0.6, "range": (0.025, 0.025, 0.002)},
    ]
    log = run(changed(duration=0.9, steps=steps, checks=()))
    offset, bound = log["exploration/foot/offset"], log["reference/foot/range"]
    assert np.max(np.abs(offset[:590])) > 0.003  # it had gone farther
    assert np.all(np.abs(offset) <= bound)
    assert np.all(np.abs(log["foot/force"]) <= log["reference/foot/force_max"])


def test_draws_depend_on_the_seed_alone() -> None:
    config = STUDY.case("random")
    first, again, other = (drawn(config.model_copy(update={"seed": seed})) for seed in (3, 3, 4))
    assert first == again
    assert first.environment != other.environment
    online = drawn(STUDY.case("online"))
    times = [time for time, _ in user_settings(online, online.exploration)]
    assert len(times) == 52  # the start, fifty changes, and quiet
    assert times == sorted(times)


@pytest.mark.parametrize("shape", [shape for shape in Shape if "printed" not in shape.value])
def test_reachable_force_is_where_surface_and_profile_are_equal(shape: Shape) -> None:
    """Not of profiles as printed: they jump, past the force at which they would meet the surface."""
    soft, hard, bound = 1e3, 1e6, 0.025
    leg = profile_of(12e3, 300.0, bound, shape=shape)
    assert reachable_force(0.01, soft, leg, bound) == pytest.approx(32.3, abs=0.01)  # two springs in series
    assert reachable_force(-0.03, hard, leg, bound) == 0.0  # the surface is out of reach
    stiffens = profile_of(2e3, 150.0, bound, shape=shape)
    most = reachable_force(0.0, 1e5, stiffens, bound)
    assert most == pytest.approx(float(stiffens.magnitude(np.array([bound - most / 1e5]))[0]), rel=1e-9)
    assert most > 1.4 * bound * 1e5 * 2e3 / (1e5 + 2e3)  # what a linear impedance reaches
    assert most <= 150.0
