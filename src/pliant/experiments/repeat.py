"""A run's whole configuration as a file, and the run that such a file or a log repeats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import tomli_w

from pliant import __version__
from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig, Study
from pliant.experiments.registry import run_of
from pliant.telemetry.log import Log
from pliant.telemetry.output import write_text

FILE = "config.toml"
_WHOLE, _NONE = "complete", "none"


def write_config(study: Study[Any], config: CaseConfig, folder: Path) -> Path:
    """Writes every value of a run into `config.toml`, from which `pliant run` makes the same run again.

    Args:
        study: of the run.
        config: of the run.
        folder: where the file goes; it exists.

    Raises:
        OutputError: it cannot be written.
    """
    values = config.model_dump(mode="json")
    none = sorted(".".join(path) for path in _nones(values))
    head = {"study": study.name, _WHOLE: __version__, _NONE: none}
    text = tomli_w.dumps(head | _without(values))
    write_text(folder / FILE, "# every value of one run; `pliant run` on this file makes it again\n" + text)
    return folder / FILE


def is_whole(values: Mapping[str, Any]) -> bool:
    """Whether what was read from a TOML file is the whole configuration of a run."""
    return _WHOLE in values


def from_config(path: Path, values: Mapping[str, Any]) -> tuple[Study[Any], CaseConfig]:
    """The run that `config.toml` describes. Args: path: for messages; values: what is in it. Raises ConfigError."""
    rest = dict(values)
    study, version, none = rest.pop("study", None), rest.pop(_WHOLE), rest.pop(_NONE, [])
    if not isinstance(none, list) or not all(isinstance(key, str) for key in none):
        raise ConfigError(f"{path}: {_NONE!r} is a list of keys without a value, got {none!r}")
    for key in none:
        _set_none(path, rest, key.split("."))
    return _run_of(path, study, version, rest)


def from_log(path: Path) -> tuple[Study[Any], CaseConfig]:
    """The run that a log holds. Raises ConfigError; OutputError: it is no log."""
    info = Log.open(path).info
    if not info.config:
        raise ConfigError(f"{path} does not hold the configuration of its run, so that it cannot be repeated")
    return _run_of(path, info.study, info.version, info.config)


def _run_of(path: Path, study: Any, version: Any, values: Mapping[str, Any]) -> tuple[Study[Any], CaseConfig]:
    if not isinstance(study, str):
        raise ConfigError(f"{path}: study is a name, got {study!r}")
    try:
        return run_of(study, values)
    except ConfigError as error:
        other = "" if version == __version__ else f"; it was written by pliant {version}, this is pliant {__version__}"
        raise ConfigError(f"{path} cannot be repeated: {error}{other}") from None


def _nones(values: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, value in values.items():
        if value is None:
            yield (*above, key)
        elif isinstance(value, Mapping):
            yield from _nones(value, (*above, key))


def _without(value: Any) -> Any:
    """The same without values that are None: TOML has no null."""
    if isinstance(value, Mapping):
        return {key: _without(inner) for key, inner in value.items() if inner is not None}
    return [_without(inner) for inner in value] if isinstance(value, list | tuple) else value


def _set_none(path: Path, values: dict[str, Any], keys: list[str]) -> None:
    node = values
    for key in keys[:-1]:
        node = node.setdefault(key, {})
        if not isinstance(node, dict):
            raise ConfigError(f"{path}: {_NONE!r} names {'.'.join(keys)!r}, but {key!r} is no table")
    node[keys[-1]] = None
