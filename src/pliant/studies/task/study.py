"""Task files as studies: the kind of study that a file asks for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.configuration import validated
from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.list_study import ListStudy
from pliant.studies.task.path_study import PathStudy
from pliant.studies.task.task_study import TaskStudy
from pliant.tasks.files import TaskFile, changed, read_task
from pliant.tasks.task import Task


def whole(name: str, values: Mapping[str, Any]) -> tuple[TaskStudy, TaskCase]:
    """A task without its file. Args: name: of the task; values: all of one run. Raises ConfigError."""
    case = validated(TaskCase, values)
    return _kind(name, {case.case: case}), case


def holding(name: str, case: CaseConfig) -> TaskStudy:
    """The study of one run of a task. Raises ConfigError: it is no task's."""
    if not isinstance(case, TaskCase):
        raise ConfigError(f"{name!r} is no study, and {type(case).__name__} is not the configuration of a task")
    return _kind(name, {case.case: case})


def of_value(task: Task, name: str) -> TaskStudy:
    """The study of a task that is a value."""
    return _kind(name, {name: case_of(task, name)})


def study_of(name: str) -> TaskStudy:
    """The study of a task file, or of a task of the catalogue.

    Raises:
        ConfigError: there is none, or it is no task.
    """
    found: TaskFile = read_task(name)
    tasks: dict[str, Task] = {found.name: found.task}
    for variant, changes in found.variants.items():
        if variant in tasks:
            raise ConfigError(f"{found.path}: a variant cannot have the name of its file, {variant!r}")
        tasks[variant] = changed(found.path, found.task, changes)
    return _kind(name, {key: case_of(task, key) for key, task in tasks.items()})


def _kind(name: str, cases: Mapping[str, TaskCase]) -> TaskStudy:
    """Of a path on a surface, or of a list of phases. Raises ConfigError where variants mix the two."""
    lists = {key: bool(case.phase) for key, case in cases.items()}
    if len(set(lists.values())) > 1:
        odd = next(key for key, is_list in lists.items() if is_list is not next(iter(lists.values())))
        raise ConfigError(f"{name}: its variant {odd!r} is of another kind: all have [[phase]], or none has")
    return (ListStudy if any(lists.values()) else PathStudy)(name, cases)
