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


def test_another_controller_makes_rows_the_same_and_each_is_run_once() -> None:
    found = asked_runs(Request("haptic", ("random",), 2, ("controller=stack",)))
    assert [(run.controller, run.seed) for run in found] == [("stack", 0), ("stack", 1)]


def test_rows_that_would_have_the_same_name_are_refused() -> None:
    with pytest.raises(ConfigError, match="two different runs of case 'slow' would have the same name"):
        asked_runs(Request("polishing", ("slow",), 1, ("controller=haptic",)))


@pytest.mark.parametrize("name", study_names())
def test_every_row_of_every_study_has_a_name_of_its_own(name: str) -> None:
    assert asked_runs(Request(name, (), 2))
