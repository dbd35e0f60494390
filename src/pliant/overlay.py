"""Nested values over others: what a file inherits, a variant changes and an option sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from pliant.errors import ConfigError, options


def overlaid(kind: type[BaseModel] | None, base: Any, changes: Mapping[str, Any]) -> dict[str, Any]:
    """The values with some replaced.

    Tables are merged key by key; a table of plain numbers, or one of several forms, is one value. A table in place of a
    list of tables changes those that it names: `phase.circle.duration`; one that says its own name is added at the end.

    Args:
        kind: what the values are of, as far as it is known.
        base: a table; anything else counts as an empty one.
        changes: what replaces them.

    Raises:
        ConfigError: a name that no table of a list has.
    """
    result = dict(base) if isinstance(base, Mapping) else {}
    for key, value in changes.items():
        field = None if kind is None else kind.model_fields.get(key)
        annotation = None if field is None else field.annotation
        nested = isinstance(value, Mapping) and isinstance(result.get(key), Mapping) and not _is_numbers(annotation)
        models = [] if _is_table(annotation) else models_in(annotation)
        nested = nested and len(models) < 2
        empty = bool(models) and result.get(key) in ((), [])
        if isinstance(value, Mapping) and (empty or _named(result.get(key))):
            result[key] = _by_name(models[0] if models else None, key, result[key], value)
            continue
        result[key] = overlaid(models[0] if models else None, result[key], value) if nested else value
    return result


def _named(base: Any) -> list[str]:
    """Of a list of tables each one's name, or its number where it has none; empty for anything else."""
    if not isinstance(base, list | tuple) or not all(isinstance(one, Mapping) for one in base):
        return []
    return [str(one.get("name") or index) for index, one in enumerate(base, start=1)]


def _by_name(
    kind: type[BaseModel] | None, key: str, base: Sequence[Mapping[str, Any]], changes: Mapping[str, Any]
) -> list[Any]:
    """A list of tables with some of them changed. Raises ConfigError: a name that none of them has."""
    names, result = _named(base), list[Any](base)
    for name, value in changes.items():
        if name not in names and isinstance(value, Mapping) and value.get("name") == name:
            result.append(value)
            continue
        if name not in names:
            there = options(names, name) if names else f"there is no [[{key}]] at all"
            raise ConfigError(f"{key} has nothing called {name!r}; {there}")
        place = names.index(name)
        result[place] = overlaid(kind, result[place], value) if isinstance(value, Mapping) else value
    return result


def _is_table(annotation: Any) -> bool:
    return get_origin(annotation) is dict or any(_is_table(option) for option in get_args(annotation))


def _is_numbers(annotation: Any) -> bool:
    """Whether a field is a table of numbers, `dict[str, float]`, or nothing."""
    if get_origin(annotation) is dict:
        return get_args(annotation)[1] in (float, int)
    return any(_is_numbers(option) for option in get_args(annotation))


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """The configurations among the forms that a field can take."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    found: list[type[BaseModel]] = []
    for argument in getattr(annotation, "__args__", ()):
        found += models_in(argument)
    return found
