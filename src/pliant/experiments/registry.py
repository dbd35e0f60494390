"""The studies by name."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from pliant.configuration import validated
from pliant.errors import ConfigError, options
from pliant.experiments.base import CaseConfig, Study
from pliant.tasks.files import catalogue
from pliant.tasks.task import Task

_MODULES = {
    "stack": "pliant.studies.stack",
    "polishing": "pliant.studies.polishing",
    "haptic": "pliant.studies.haptic",
}
"""name → module with a `STUDY`; imported on first use"""
_TASKS = "pliant.studies.task.study"
"""module of the studies that are made of task files"""


def study_names() -> list[str]:
    return list(_MODULES)


def run_of(name: str, values: Mapping[str, Any]) -> tuple[Study[Any], CaseConfig]:
    """A study, or a task whose file need not be there any more, and one of its runs from all of its values.

    Raises:
        ConfigError: a value that is missing, unknown or breaks a rule.
    """
    if name in _MODULES:
        study = get_study(name)
        return study, validated(study.config_type, values)
    task: tuple[Study[Any], CaseConfig] = importlib.import_module(_TASKS).whole(name, values)
    return task


def study_of_run(name: str, config: CaseConfig) -> Study[Any]:
    """The study of one run; a task is fully defined by its configuration, without its file.

    Raises:
        ConfigError: the
    configuration is not of a task.
    """
    if name in _MODULES:
        return get_study(name)
    task: Study[Any] = importlib.import_module(_TASKS).holding(name, config)
    return task


def study_of_task(task: Task, name: str = "task") -> Study[Any]:
    """The study of a task given as a value; its case has the given name."""
    found: Study[Any] = importlib.import_module(_TASKS).of_value(task, name)
    return found


def get_study(name: str) -> Study[Any]:
    """A study by name; a task file, by its path or its name in the catalogue, is one too.

    Raises:
        ConfigError: there is none of that name, or the file holds no task.
    """
    if name not in _MODULES:
        if not name.endswith(".toml") and name not in catalogue():
            raise ConfigError(f"no study or task named {name!r}; {options([*_MODULES, *catalogue()], name)}")
        task_study: Study[Any] = importlib.import_module(_TASKS).study_of(name)
        return task_study
    study: Study[Any] = importlib.import_module(_MODULES[name]).STUDY
    return study
