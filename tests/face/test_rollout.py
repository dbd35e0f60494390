"""Many runs of one case: each is the single run, whatever the number of processes."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import pliant
from pliant.errors import ConfigError

CHANGES: list[dict[str, Any]] = [{"duration": 1.3}, {"duration": 1.3, "controller": "haptic-hold"}]


def numbers(metrics: Any) -> dict[str, bytes]:
    return {metric.name: np.float64(metric.value).tobytes() for metric in metrics}


@pytest.fixture(scope="module")
def alone() -> pliant.Rollout:
    return pliant.rollout("haptic", case="floor-noise", seeds=2, changes=CHANGES)


def test_a_run_is_the_single_run_bit_for_bit(alone: pliant.Rollout) -> None:
    for place, run in enumerate(alone.runs):
        change, seed = CHANGES[place // 2], alone.seeds[place % 2]
        single = pliant.run("haptic", case="floor-noise", seed=seed, **change)
        assert numbers(run.metrics) == numbers(single.metrics.values())
        assert run.failure == single.failure
    found = [numbers(run.metrics) for run in alone.runs]
    assert all(found[0] != other for other in found[1:])  # baseline: another seed or controller is noticed


def test_the_number_of_processes_changes_nothing(alone: pliant.Rollout) -> None:
    together = pliant.rollout("haptic", case="floor-noise", seeds=2, changes=CHANGES, jobs=2)
    assert [numbers(run.metrics) for run in together.runs] == [numbers(run.metrics) for run in alone.runs]
    assert [run.config for run in together.runs] == [run.config for run in alone.runs]


ALONE = """
import json, pliant
from pliant.experiments.workers import start_method
many = pliant.rollout("haptic", case="floor-noise", seeds=2, changes=CHANGES, jobs=2)
print(start_method(), json.dumps([{m.name: m.value.hex() for m in run.metrics} for run in many.runs]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere processes are spawned")
def test_a_fork_that_has_what_was_worked_out_before_changes_nothing(alone: pliant.Rollout) -> None:
    command = [sys.executable, "-c", ALONE.replace("CHANGES", repr(CHANGES))]
    method, _, forked = subprocess.run(command, capture_output=True, text=True, check=True).stdout.partition(" ")
    assert method == "fork"  # baseline: within pytest's processes the other tests spawn
    assert json.loads(forked) == [{m.name: float(m.value).hex() for m in run.metrics} for run in alone.runs]


def test_values_and_rows_stand_where_they_should(alone: pliant.Rollout) -> None:
    name = alone.runs[0].metrics[0].name
    values = alone.values(name)
    assert values.shape == (2, 2)
    for place, run in enumerate(alone.runs):
        assert values[place // 2, place % 2] == run.metrics[0].value
    columns = alone.columns()
    rows = list(zip(*(columns[key] for key in ("change", "controller", "seed", "metric", "value")), strict=True))
    assert (1, "haptic-hold", alone.seeds[1], name, values[1, 1]) in rows
    assert len(rows) == sum(len(run.metrics) for run in alone.runs)
    with pytest.raises(ConfigError, match="no run has a metric 'grip'; there are "):
        alone.values("grip")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seeds": 0}, "needs at least one seed"),
        ({"seeds": [3, 3]}, "each once"),
        ({"changes": []}, "takes a list of changes"),
        ({"changes": {"duration": 1.0}}, "takes a list of changes"),
        ({"changes": [{}, {"duratoin": 1.0}]}, "did you mean 'duration'"),
        ({"changes": [{"case": "floor"}]}, "'case' says which run it is"),
        ({"changes": [{"controller": "haptik"}]}, "did you mean 'haptic'"),
        ({"changes": [{"seed": 3}]}, "give the seeds as `seeds`"),
        ({"jobs": 0}, "takes 1 to"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        pliant.rollout("haptic", **options)
