"""What a whole sweep may change: nothing that tells its rows apart."""

from __future__ import annotations

import pytest

from pliant.errors import ConfigError
from pliant.experiments.registry import study_names
from pliant.experiments.results import Request
from pliant.experiments.sweep import asked_runs


@pytest.mark.parametrize(
    ("study", "case", "change", "count"),
    [
        ("polishing", "horizon", "control.horizon=3", "336 of its 336"),
        ("polishing", "tables-2-3-4", "table.tilt=0.1", "of its"),
        ("polishing", "force-weight", "control.costs.force.weight=1.0", "of its"),
    ],
)
def test_a_key_that_rows_set_is_refused(study: str, case: str, change: str, count: str) -> None:
    key = change.partition("=")[0]
    with pytest.raises(ConfigError, match=f"'{key}' cannot be set for the whole case '{case}'") as error:
        asked_runs(Request(study, (case,), None, (change,)))
    assert count in str(error.value)


def test_other_keys_change_every_row_and_leave_what_tells_them_apart() -> None:
    plain = asked_runs(Request("polishing", ("horizon",), 1))
    changed = asked_runs(Request("polishing", ("horizon",), 1, ("table.stiffness=5e3", "control.max_iterations=2")))
    assert len(changed) == len(plain)
    for before, after in zip(plain, changed, strict=True):
        assert after.table.stiffness == 5e3
        assert after.control == before.control | {"max_iterations": 2}
        assert (after.variant, after.seed) == (before.variant, before.seed)


def test_rows_are_made_of_the_changed_case() -> None:
    """What follows from the case's own values follows from the changed ones: ten times the weight that was set."""
    change = "control.costs.torque.weight=0.3"
    asked = asked_runs(Request("polishing", ("force-weight",), 1, (change,)))
    assert {run.control["costs"]["torque"]["weight"] for run in asked} == {0.3}
    shifted = asked_runs(Request("haptic", ("random",), 3, ("seed=5",)))
    assert [run.seed for run in shifted] == [5, 6, 7] * 2


@pytest.mark.parametrize(
    ("study", "case", "change"),
    [
        ("haptic", "random", "controller=stack"),  # the printed exploration is a row
        ("polishing", "tables-2-3-4", "imperfections.torque_loop.gain_p=0.5"),
        ("polishing", "robustness", "imperfections.computation_delay=0.005"),  # the value it has: rows set it again
        ("stack", "balance", "control.tasks.elbow.translation.force_max=80.0"),
        ("stack", "figure8-wall", "wall.x=0.05"),
        ("haptic", "parameters", "environment.floor.material.stiffness=1e5"),
    ],
)
def test_what_any_row_sets_is_refused_whatever_its_value(study: str, case: str, change: str) -> None:
    with pytest.raises(ConfigError, match=f"'{change.partition('=')[0]}' cannot be set for the whole case '{case}'"):
        asked_runs(Request(study, (case,), 1, (change,)))


@pytest.mark.parametrize("name", study_names())
def test_every_row_of_every_study_has_a_name_of_its_own(name: str) -> None:
    assert asked_runs(Request(name, (), 2))
