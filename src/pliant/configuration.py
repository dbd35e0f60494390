"""Typed configurations: defaults in code, overridden by a TOML file, overridden by `--set key=value`."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, cast

from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo, field_validator

from pliant.errors import ConfigError, OutputError
from pliant.files import read_file
from pliant.overlay import overlaid
from pliant.quantity import unit_of
from pliant.toml_text import toml_sentence
from pliant.validation_text import shown, validation_sentence

MOST = 1e12
"""largest absolute value in a configuration, in any unit; beyond it sums and products overflow or lose their meaning"""
_NO_TRUTH_VALUE = frozenset((float, int, str, type(None)))
"""types of values that are none and hold none"""


class Config(BaseModel):
    """Base of all configurations: frozen; unknown keys are errors, defaults are checked too, numbers are finite and at
    most `MOST` in size.

    A field with a unit is a `pliant.quantity.quantity`, any other one a `Field(default, description=...)`; help texts
    and sliders are made from them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True)

    @field_validator("*", mode="before")
    @classmethod
    def _is_no_truth_value(cls, value: Any, info: ValidationInfo) -> Any:
        """A quantity is a number: Python would read true as 1."""
        if type(value) in _NO_TRUTH_VALUE:  # most fields of most configurations
            return value
        about = cls.model_fields.get(info.field_name or "")
        counts = about is not None and unit_of(about) != "" and about.annotation is not bool
        if counts and not isinstance(value, dict) and any(isinstance(number, bool) for number in _numbers(value)):
            raise ValueError("must be given in numbers, not as true or false")
        return value

    @field_validator("*")
    @classmethod
    def _is_of_this_world(cls, value: Any) -> Any:
        if isinstance(value, (str, BaseModel)):
            return value
        for path, number in _placed_numbers(value):
            if not abs(number) <= MOST:
                inside = f"{'.'.join(path)}: " if path else ""
                raise ValueError(f"{inside}a number of a configuration is at most {MOST:g} in size, got {number:g}")
        return value


def _numbers(value: Any) -> Iterator[float]:
    for _, number in _placed_numbers(value):
        yield number


def _placed_numbers(value: Any, above: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], float]]:
    """Each number with the keys of the tables that it stands in."""
    if isinstance(value, (int, float)):
        yield above, value
    elif isinstance(value, (tuple, list)):
        for entry in cast("Sequence[Any]", value):
            yield from _placed_numbers(entry, above)
    elif isinstance(value, dict):
        for key, entry in cast("dict[Any, Any]", value).items():
            yield from _placed_numbers(entry, (*above, str(key)))


C = TypeVar("C", bound=BaseModel)
_MOST_DEPTH, _MOST_BYTES = 32, 1e6


def read_toml(path: Path) -> dict[str, Any]:
    """Reads a TOML file.

    Raises:
        ConfigError: the file does not exist, cannot be read, is not TOML (duplicate keys included), is deeper than 32
            tables or larger than 1 MB.
    """
    if not path.exists():
        raise ConfigError(f"configuration file {path} does not exist")
    text = ""
    try:
        text = read_file(path, _MOST_BYTES).decode("utf-8-sig")
        values = tomllib.loads(text)
    except OutputError as error:
        raise ConfigError(f"configuration file {error}") from None
    except RecursionError:
        raise ConfigError(f"configuration file {path} is nested too deeply") from None
    except UnicodeDecodeError:
        raise ConfigError(f"configuration file {path} is not UTF-8 text: save it in that encoding") from None
    except ValueError as error:  # TOML's, or a number with more digits than Python reads
        raise ConfigError(f"configuration file {path} is not TOML: {toml_sentence(text, error)}") from error
    if _is_deep(values):
        raise ConfigError(f"configuration file {path} is nested more than {_MOST_DEPTH} tables deep")
    return values


def parse_assignments(assignments: Iterable[str]) -> dict[str, Any]:
    """Turns `plant.period=0.001` into nested dictionaries; values are TOML, bare words are strings. A part of a key
    that has dots of its own stands in double quotes; `my_file.py:MyController` needs none.

    Raises:
        ConfigError: no `=`, an empty key, or the same key twice.
    """
    tree: dict[str, Any] = {}
    for text in assignments:
        key, equals, value = text.partition("=")
        parts = _parts(key)
        if not equals or not all(parts):
            raise ConfigError(f"an override is written key=value, for example plant.period=0.001, got {shown(text)}")
        if len(parts) > _MOST_DEPTH:
            raise ConfigError(f"override {shown(text)} is nested more than {_MOST_DEPTH} tables deep")
        node = tree
        for part in parts[:-1]:
            node = node.setdefault(part, {})
            if not isinstance(node, dict):
                raise ConfigError(f"override {text!r}: {part!r} was already given a value")
        if parts[-1] in node:
            raise ConfigError(f"override {key.strip()!r} is given twice")
        node[parts[-1]] = _toml_value(value.strip())
    return tree


def _parts(key: str) -> list[str]:
    """Parts of a dotted key: dots within double quotes, and the dot of `file.py:Class`, do not separate."""
    # outside of quotes: an even number of quotes follows
    outside = r'(?=(?:[^"]*"[^"]*")*[^"]*$)' if '"' in key else ""
    return [part.strip().strip('"') for part in re.split(rf"\.(?!py:){outside}", key)]


def merged(config: C, changes: Mapping[str, Any]) -> C:
    """The configuration with some values replaced, checked again as a whole.

    Raises:
        ConfigError: an unknown key (with the valid ones) or a value that breaks a rule (with the rule).
    """
    if not changes:
        return config
    return validated(type(config), overlaid(type(config), config.model_dump(), changes))


def validated(kind: type[C], values: Mapping[str, Any]) -> C:
    """Builds a configuration; the first error in it becomes one sentence."""
    try:
        return kind.model_validate(dict(values))
    except ValidationError as error:
        raise ConfigError(validation_sentence(kind, error, values)) from None


def refuse_unknown_keys(kind: type[BaseModel], changes: Mapping[str, Any]) -> None:
    """Raises ConfigError, with the valid ones, for a key that a configuration does not have; values are not judged."""
    try:
        kind.model_validate(dict(changes))
    except ValidationError as error:
        if any(one["type"] == "extra_forbidden" for one in error.errors()):
            raise ConfigError(validation_sentence(kind, error, changes, "extra_forbidden")) from None


def _toml_value(text: str) -> Any:
    try:
        read = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return None if text.lower() in ("none", "null") else text
    except (RecursionError, ValueError) as error:  # ValueError: a number with more digits than Python reads
        raise ConfigError(f"a value cannot be read: {shown(text)} ({error})") from None
    if len(read) > 1:  # a line break and more assignments
        return text
    if _is_deep(read):
        raise ConfigError(f"a value is nested more than {_MOST_DEPTH} tables deep: {shown(text)}")
    return read["value"]


def _is_deep(values: Any) -> bool:
    level, depth = [values], 0
    while level:
        depth += 1
        if depth > _MOST_DEPTH:
            return True
        below: list[Any] = []
        for value in level:
            if isinstance(value, dict):
                below += cast("dict[str, Any]", value).values()
            elif isinstance(value, list):
                below += cast("list[Any]", value)
        level = below
    return False
