"""What a user means by a study's name or a file, a case, and changes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pliant.errors import ConfigError, options
from pliant.experiments.base import CaseConfig, Study
from pliant.experiments.config import merged, read_toml
from pliant.experiments.registry import get_study


def chosen(
    target: str, case: str | None, overrides: Mapping[str, Any], changes: Mapping[str, Any]
) -> tuple[Study[Any], CaseConfig]:
    """The study and the checked configuration: the case's defaults, then the file, then overrides, then changes.

    Args:
        target: name of a study or of a task of the catalogue, path of a task file, or path of a TOML file with
            `study = …` and any of its values.
        case: of the study; None: the file's, or the study's first.
        overrides: those that are None count as not given.
        changes: nested.

    Raises:
        ConfigError: an unknown study, case or key, or a value that breaks a rule.
    """
    values: dict[str, Any] = {}
    if target.endswith(".toml") and "study" in (found := read_toml(Path(target))):
        target, values = str(found.pop("study")), found
    study = get_study(target)
    from_file = values.pop("case", None)
    if not isinstance(from_file, str | None):
        raise ConfigError(f"{target}: 'case' is a name, got {from_file!r}; {options(study.cases)}")
    return study, configured(study, case or from_file, [values, _given(overrides), changes])


def configured(study: Study[Any], case: str | None, layers: list[Mapping[str, Any]]) -> CaseConfig:
    """A case of a study (None: its first) with layers of nested changes, the last of which wins. Raises ConfigError."""
    config: CaseConfig = study.case(case or next(iter(study.cases)))
    for layer in layers:
        config = merged(config, layer)
    return config


def _given(overrides: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in overrides.items() if value is not None}
