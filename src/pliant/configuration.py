"""Typed configurations: defaults in code, overridden by a TOML file, overridden by `--set key=value`."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError

from pliant.errors import ConfigError, options


class Config(BaseModel):
    """Frozen values with a meaning: unknown keys are errors, defaults are checked too, every number is finite.

    A field says what it means in `description` and its unit, and where it helps a sensible range, in
    `json_schema_extra={"unit": ..., "minimum": ..., "maximum": ...}`: help texts and sliders are made from them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True)


C = TypeVar("C", bound=BaseModel)


def read_toml(path: Path) -> dict[str, Any]:
    """Reads a TOML file.

    Raises:
        ConfigError: the file does not exist, cannot be read, or is not TOML (duplicate keys included).
    """
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except FileNotFoundError:
        raise ConfigError(f"configuration file {path} does not exist") from None
    except OSError as error:
        raise ConfigError(f"configuration file {path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"configuration file {path} is not TOML: {error}") from error


def parse_assignments(assignments: Iterable[str]) -> dict[str, Any]:
    """Turns `plant.period=0.001` into nested dictionaries; values are TOML, bare words are strings.

    Raises:
        ConfigError: no `=`, an empty key, or the same key twice.
    """
    tree: dict[str, Any] = {}
    for text in assignments:
        key, equals, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not equals or not all(parts):
            raise ConfigError(f"an override is written key=value, for example plant.period=0.001, got {text!r}")
        node = tree
        for part in parts[:-1]:
            node = node.setdefault(part, {})
            if not isinstance(node, dict):
                raise ConfigError(f"override {text!r}: {part!r} was already given a value")
        if parts[-1] in node:
            raise ConfigError(f"override {key.strip()!r} is given twice")
        node[parts[-1]] = _toml_value(value.strip())
    return tree


def merged(config: C, changes: Mapping[str, Any]) -> C:
    """The configuration with some values replaced, checked again as a whole.

    Raises:
        ConfigError: an unknown key (with the valid ones) or a value that breaks a rule (with the rule).
    """
    if not changes:
        return config
    return validated(type(config), overlaid(type(config), config.model_dump(), changes))


def validated(kind: type[C], values: Mapping[str, Any]) -> C:
    """Builds a configuration; the first thing wrong with it becomes one clear sentence."""
    try:
        return kind.model_validate(dict(values))
    except ValidationError as error:
        raise ConfigError(_sentence(kind, error)) from None


def overlaid(kind: type[BaseModel] | None, base: Any, changes: Mapping[str, Any]) -> dict[str, Any]:
    """The values with some replaced.

    Tables are merged key by key; a table of plain numbers, or one of several forms, is one value.

    Args:
        kind: what the values are of, as far as it is known.
        base: a table; anything else counts as an empty one.
        changes: what replaces them.
    """
    result = dict(base) if isinstance(base, Mapping) else {}
    for key, value in changes.items():
        field = None if kind is None else kind.model_fields.get(key)
        annotation = None if field is None else field.annotation
        nested = isinstance(value, Mapping) and isinstance(result.get(key), Mapping) and not _is_numbers(annotation)
        models = [] if _is_table(annotation) else _models_in(annotation)
        nested = nested and len(models) < 2
        result[key] = overlaid(models[0] if models else None, result[key], value) if nested else value
    return result


def _is_table(annotation: Any) -> bool:
    return get_origin(annotation) is dict or any(_is_table(option) for option in get_args(annotation))


def _is_numbers(annotation: Any) -> bool:
    """Whether a field is a table of numbers, `dict[str, float]`, or nothing."""
    if get_origin(annotation) is dict:
        return get_args(annotation)[1] in (float, int)
    return any(_is_numbers(option) for option in get_args(annotation))


def _toml_value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        if text.lower() in ("none", "null"):
            return None
        return text


def _sentence(kind: type[BaseModel], error: ValidationError) -> str:
    found = error.errors()
    # where one of several forms is allowed, each complains: a rule that is broken says most
    first = next((one for one in found if one["type"] == "value_error"), found[0])
    where = ".".join(str(part) for part in first["loc"])
    got = first.get("input")
    if first["type"] == "extra_forbidden":
        return f"unknown key {where!r}; {options(_keys_beside(kind, first['loc']), str(first['loc'][-1]))}"
    return f"{where or kind.__name__}: {first['msg'].removeprefix('Value error, ')}, got {got!r}"


def _keys_beside(kind: type[BaseModel], location: Sequence[int | str]) -> list[str]:
    fields = kind.model_fields
    for part in location[:-1]:
        field = fields.get(str(part))
        if field is None:
            continue  # a discriminator or a list index
        nested = _models_in(field.annotation)
        if not nested:
            return []
        fields = nested[0].model_fields
    return list(fields)


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    found: list[type[BaseModel]] = []
    for argument in getattr(annotation, "__args__", ()):
        found += _models_in(argument)
    return found
