"""The studies there are, by name."""

from __future__ import annotations

import importlib
from typing import Any

from pliant.errors import ConfigError, options
from pliant.experiments.base import Study
from pliant.tasks.files import catalogue

_MODULES = {
    "stack": "pliant.studies.stack",
    "polishing": "pliant.studies.polishing",
    "haptic": "pliant.studies.haptic",
}
"""name → module with a `STUDY`; imported when it is asked for"""


def study_names() -> list[str]:
    return list(_MODULES)


def get_study(name: str) -> Study[Any]:
    """A study by name; a task file, by its path or its name in the catalogue, is one too.

    Raises:
        ConfigError: there is none of that name, or the file holds no task.
    """
    if name not in _MODULES:
        if not name.endswith(".toml") and name not in catalogue():
            raise ConfigError(f"no study or task named {name!r}; {options([*_MODULES, *catalogue()], name)}")
        task_study: Study[Any] = importlib.import_module("pliant.studies.task.study").study_of(name)
        return task_study
    study: Study[Any] = importlib.import_module(_MODULES[name]).STUDY
    return study
