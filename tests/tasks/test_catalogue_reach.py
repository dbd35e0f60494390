"""Every task of the catalogue can be done by its robot, except those that say that they leave its reach."""

from __future__ import annotations

import pytest

from pliant.studies.task.study import study_of
from pliant.tasks.files import catalogue


@pytest.mark.study
@pytest.mark.parametrize("name", catalogue())
def test_the_check_of_a_task_that_ships_agrees_with_the_task(name: str) -> None:
    """As believed and in one drawn world. A task that says check = "off" and is possible would fail here, too."""
    study = study_of(name)
    case = study.case(name)
    found = study.check(case, 1)
    assert found.reachable == (case.check == "on"), next((one.failure for one in found.surfaces if one.failure), "")
