"""The cases of the polishing study are variants of one timed task; the study's own numbers change that task."""

from __future__ import annotations

from typing import Any

import pytest

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.studies.task.config import TaskCase
from pliant.studies.task.study import study_of
from pliant.studies.task.world import imperfections_of

FILE = "tables-2-3-4"


def leaves(value: Any, above: str = "") -> dict[str, Any]:
    """Key → number, text or nothing, of nested tables and rows."""
    rows = dict(enumerate(value)) if isinstance(value, list | tuple) else value
    if not isinstance(rows, dict):
        return {above: value}
    return {key: leaf for name, inner in rows.items() for key, leaf in leaves(inner, f"{above}.{name}").items()}


def told(case: TaskCase) -> dict[str, Any]:
    """All that a run of a task depends on."""
    values = case.model_dump(exclude={"description", "accept", "case", "duration"})
    values["truth"]["imperfections"] = imperfections_of(case).model_dump()
    return leaves(values)


def test_every_case_of_the_polishing_study_is_a_variant_of_a_task_file() -> None:
    """Value by value; another tilt would be noticed. What the runs do stands in `short_runs.json`."""
    ours, theirs = study_of(FILE), get_study("polishing")
    assert set(ours.cases) == set(theirs.cases)
    for name in ours.cases:
        mine, yours = told(ours.case(name)), told(theirs.case(name).as_task())
        numbers = [key for key, value in mine.items() if isinstance(value, float | int)]
        assert {key: mine[key] for key in numbers} == pytest.approx({key: yours.get(key) for key in numbers}), name
        assert mine.keys() == yours.keys(), name
        assert all(mine[key] == yours[key] for key in mine.keys() - set(numbers)), name
    assert told(ours.case("slow")) != told(ours.case("slow-tilted"))


def test_the_studys_numbers_change_its_task() -> None:
    """The table believed too high, contact that is looked for, a late belief: in the words of the file."""
    study = get_study("polishing")
    changes = {"table": {"height_error": 5e-3}, "task": {"found": True}, "delay_error": 1e-3}
    case = merged(study.case("slow"), changes).as_task()
    reach, track = case.phase[:2]
    assert case.start == study.case("slow").as_task().start
    assert reach.begin == pytest.approx((0.65, 0.0, 0.13))
    assert track.via == (pytest.approx((0.65, 0.0, 0.03)),)
    assert track.target == pytest.approx((0.65, 0.0, 0.01))
    assert track.duration is None
    assert case.timing.computation_delay == 1e-3
    assert imperfections_of(case).computation_delay == 0.0
