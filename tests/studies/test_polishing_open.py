"""What [FFMPC] says beside its tables: the short form of each row, and the metrics on signals with known answers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.runner import run_case
from pliant.studies.polishing import STUDY
from pliant.studies.polishing.cases_open import OPEN_CASES
from pliant.studies.polishing.measure_parts import of_circles, of_steps

SHORT = {"task": {"circle": 2.2}, "duration": 2.6}


def ran(case: str, label: str, controller: str, **changes: Any) -> Result:
    """A row's first draw, shortened."""
    config = next(one for one in STUDY.runs(case, 1) if (one.variant, one.controller) == (label, controller))
    return run_case(STUDY, merged(config, changes or SHORT))


def value(result: Result, name: str) -> float:
    assert result.failure is None, result.failure
    return next(metric.value for metric in result.metrics if metric.name == name)


def test_every_row_has_a_controller_and_names_of_its_own() -> None:
    for case in OPEN_CASES:
        runs = STUDY.runs(case.config.case, 1)
        assert len({(one.controller, one.variant, one.seed) for one in runs}) == len(runs)


def test_circles_are_counted_whole_and_one_by_one() -> None:
    """An error that grows by 1 N a circle: mean of ten is 5.5 N, deviation that of 1 … 10."""
    config = merged(STUDY.case("slow"), {"duration": 24.5})
    length, begin = 2.0 * math.pi / 3.0, 3.5
    time = np.arange(0.0, 24.5, 1e-3)
    error = np.where(time < begin - 1e-9, 99.0, 1.0 + np.floor((time - begin + 1e-9) / length))
    found = of_circles(config, time, error, np.column_stack([error, -error]))
    assert found["circles"] == (10.0, "1")
    for name in ("E_λ", "E_P"):
        assert found[f"{name} of a circle"][0] == pytest.approx(5.5, abs=0.01)
        assert found[f"{name} from circle to circle"][0] == pytest.approx(np.std(np.arange(10), ddof=1), abs=0.01)
    assert of_circles(config, time[:7000], error[:7000], np.zeros((7000, 2))) == {}  # one circle and a half
    assert of_circles(merged(config, {"task": {"pattern": "square"}}), time, error, np.zeros((len(time), 2))) == {}


def test_overshoot_is_that_of_the_worst_step_each_way() -> None:
    config = merged(STUDY.case("square"), {"duration": 7.0})
    time = np.arange(0.0, 7.0, 1e-3)
    wanted = np.where(time < 3.0 - 1e-9, 50.0, np.where(np.floor(time - 3.0 + 1e-9) % 2 == 0, 20.0, 50.0))
    force = wanted.copy()
    force[np.abs(time - 4.2) < 5e-3] += 4.0  # after the first step up
    force[np.abs(time - 5.2) < 5e-3] -= 3.0  # after the second one down
    force[np.abs(time - 1.0) < 5e-3] += 30.0  # before the steps: not counted
    found = of_steps(config, time, force, wanted)
    assert found == {"overshoot down": (pytest.approx(3.0), "N"), "overshoot up": (pytest.approx(4.0), "N")}


def test_the_stop_brings_the_tool_to_rest_on_the_table() -> None:
    """Position, velocity and acceleration of the reference go on without a jump; then it stands, pressed on."""
    config = merged(STUDY.case("stop"), {"duration": 8.0})
    source = STUDY.build(config).source
    while not hasattr(source, "phases"):
        source = source.inner
    circle, stop = source.phases[-2:]
    assert (circle.name, stop.name, stop.touches) == ("circle", "stop", True)
    before, after = circle.motion.at(circle.duration), stop.motion.at(0.0)
    for one, other in zip(before, after, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
    end = stop.motion.at(config.task.ease)
    np.testing.assert_allclose(np.concatenate([end.rate, end.acceleration]), 0.0, atol=1e-9)
    assert np.linalg.norm(end.value - after.value) < 0.5 * 0.21 * config.task.ease + 0.01  # m, of a path at 0.21 m/s
    with pytest.raises(ConfigError, match="ends a circle"):
        STUDY.build(merged(STUDY.case("square"), {"task": {"stop": 6.0}}))
    with pytest.raises(ConfigError, match="must increase"):
        STUDY.build(merged(STUDY.case("slow"), {"task": {"stop": 2.0}}))


@pytest.mark.study
def test_the_stop_holds_its_force() -> None:
    short = {"task": {"circle": 2.2, "stop": 2.8, "ease": 0.3}, "duration": 3.4}
    assert value(ran("stop", "", "offset-free-mpc", **short), "E_λ after the stop") < 1.0
    assert value(ran("stop", "", "classical-mpc", **short), "E_λ after the stop") > 1.0  # it does not feel the force


@pytest.mark.study
def test_the_modelled_torque_does_not_know_what_the_joint_sensors_say() -> None:
    """Without the drives' loop, which has those sensors too: the same run to the last digit; with them it differs."""
    force = {
        label: value(ran("sensor-mismatch", f"{label}, no PID", "torque-feedback-mpc"), "E_λ")
        for label in ("sensors agree", "sensors differ", "sensors agree, τ̂ of eq. 37", "sensors differ, τ̂ of eq. 37")
    }
    assert force["sensors differ, τ̂ of eq. 37"] == force["sensors agree, τ̂ of eq. 37"]
    assert abs(force["sensors differ"] - force["sensors agree"]) > 0.2
