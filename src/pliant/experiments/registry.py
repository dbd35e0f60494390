"""The studies there are, by name."""

from __future__ import annotations

import importlib
from typing import Any

from pliant.errors import ConfigError, options
from pliant.experiments.base import Study

_MODULES = {
    "stack": "pliant.studies.stack",
    "polishing": "pliant.studies.polishing",
    "haptic": "pliant.studies.haptic",
}
"""name → module with a `STUDY`; imported when it is asked for"""


def study_names() -> list[str]:
    return list(_MODULES)


def get_study(name: str) -> Study[Any]:
    """A study by name.

    Raises:
        ConfigError: there is none of that name.
    """
    if name not in _MODULES:
        raise ConfigError(f"no study named {name!r}; {options(_MODULES, name)}")
    study: Study[Any] = importlib.import_module(_MODULES[name]).STUDY
    return study
