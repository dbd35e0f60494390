"""The run that a user means on the command line, and where it writes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pliant.experiments.base import Study
from pliant.experiments.choice import Choice, chosen
from pliant.experiments.config import assigned


def resolve(target: str, case: str | None, overrides: Mapping[str, Any], assignments: Sequence[str]) -> Choice:
    """The run that a user means on the command line. Raises ConfigError."""
    return chosen(target, case, overrides, assigned(assignments), ("an option", "--set"))


def default_folder(study: Study[Any], case: str) -> Path:
    """Where a run writes if nobody says."""
    return study_folder(study.name) / case


def study_folder(name: str) -> Path:
    """Where a study, or a task by the path of its file, writes if nobody says."""
    return Path("pliant-out") / Path(name).stem
