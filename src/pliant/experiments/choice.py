"""Resolves the name of a study or a file, a case and changes to the configuration of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.configuration import merged, read_toml
from pliant.errors import ConfigError, options
from pliant.experiments.base import CaseConfig, Study
from pliant.experiments.registry import get_study, study_of_task
from pliant.experiments.repeat import from_config, from_log, is_whole
from pliant.tasks.task import Task

Layer = tuple[str, Mapping[str, Any]]
"""origin of values as text, and the values, nested"""


@dataclass(frozen=True)
class Choice:
    """One requested run."""

    study: Study[Any]
    config: CaseConfig
    base: str
    """origin, as text, of values that no layer gives and that differ from the defaults"""
    layers: tuple[Layer, ...]
    """changes of the case in order; the last one wins"""


def chosen(
    target: str | Task,
    case: str | None,
    overrides: Mapping[str, Any],
    changes: Mapping[str, Any],
    names: tuple[str, str] = ("overrides", "changes"),
) -> Choice:
    """The study and the checked configuration: the case's defaults, then the file, then overrides, then changes.

    Args:
        target: name of a study or of a task of the catalogue, path of a task file, path of a TOML file with
            `study = …` and any of its values, or the `config.toml` or log of a run, which is then repeated; or a
            task that is a value.
        case: of the study; None: the file's, or the study's first.
        overrides: those that are None count as not given.
        changes: nested.
        names: origin of the last two, as text.

    Raises:
        ConfigError: an unknown study, case or key, or a value that breaks a rule.
        OutputError: a file that ends in `.mcap` is not a log.
    """
    over = ((names[0], _given(overrides)), (names[1], changes))
    if isinstance(target, Task):
        study = study_of_task(target)
        return _laid(study, study.case(case or next(iter(study.cases))), "the task", over)
    if target.endswith(".mcap"):
        return _repeated(target, case, from_log(Path(target)), over)
    values: dict[str, Any] = {}
    name = target
    if target.endswith(".toml") and "study" in (found := read_toml(Path(target))):
        if is_whole(found):
            return _repeated(target, case, from_config(Path(target), found), over)
        name, values = str(found.pop("study")), found
    study = get_study(name)
    from_file = values.pop("case", None)
    if not isinstance(from_file, str | None):
        raise ConfigError(f"{target}: 'case' is a name, got {from_file!r}; {options(study.cases)}")
    base = study.case(case or from_file or next(iter(study.cases)))
    return _laid(study, base, f"case {base.case}", ((target, values), *over))


def _repeated(target: str, case: str | None, run: tuple[Study[Any], CaseConfig], over: tuple[Layer, ...]) -> Choice:
    study, config = run
    if case not in (None, config.case):
        raise ConfigError(f"{target} holds one run, of case {config.case!r}; --case {case} is another")
    return _laid(study, config, target, over)


def _laid(study: Study[Any], config: CaseConfig, base: str, layers: tuple[Layer, ...]) -> Choice:
    for _, values in layers:
        config = merged(config, values)
    return Choice(study, config, base, layers)


def _given(overrides: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in overrides.items() if value is not None}
