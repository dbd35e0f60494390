"""The run that the command line asks for, and its output folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pliant.experiments.base import Study
from pliant.experiments.choice import Choice, chosen
from pliant.experiments.config import assigned


def resolve(target: str, case: str | None, overrides: Mapping[str, Any], assignments: Sequence[str]) -> Choice:
    """The run that the command line asks for. Raises ConfigError."""
    return chosen(target, case, overrides, assigned(assignments), ("an option", "--set"))


def default_folder(study: Study[Any], case: str) -> Path:
    """Default output folder of a run."""
    return study_folder(study.name) / case


def study_folder(name: str) -> Path:
    """Default output folder of a study, or of a task that is given by the path of its file."""
    return Path("pliant-out") / Path(name).stem
