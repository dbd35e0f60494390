"""Errors of pydantic as one plain sentence: the key as it stands in the file, the rule, and what was got."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any, cast

from pydantic import BaseModel, ValidationError

from pliant.errors import options
from pliant.overlay import models_in

_LONGEST_VALUE, _LONGEST_KEY = 60, 200  # characters
_RULES = {
    "greater_than": "must be above {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be below {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "too_short": "must have at least {min_length} {entries}",
    "too_long": "must have at most {max_length} {entries}",
    "string_too_short": "must be at least {min_length} long",
    "string_too_long": "must be at most {max_length} long",
    "finite_number": "must be a finite number",
    "int_from_float": "must be a whole number",
}
_KINDS = {
    "float": "a number",
    "int": "a whole number",
    "bool": "true or false",
    "string": "text",
    "tuple": "a list",
    "list": "a list",
    "dict": "a table",
    "model": "a table",
}
"""begin of pydantic's type of an error, for values of another type"""

Location = tuple[int | str, ...]


def validation_sentence(kind: type[BaseModel], error: ValidationError, values: Any, rule: str = "value_error") -> str:
    """The first error in a configuration, or the first of one kind where there is one.

    Args:
        kind: of the configuration.
        error: what pydantic found.
        values: what was to be read. Entries of lists are called by their name, or by their number from 1.
        rule: pydantic's name of the errors that are told first; by default what a rule of ours says.
    """
    found = [(tuple(one["loc"]), cast("dict[str, Any]", one)) for one in error.errors()]
    first = next((one for one in found if one[1]["type"] == rule), found[0])
    while (depth := _member_at(first[0], first[1], values)) is not None:
        place = first[0][:depth]
        forms = [one for one in found if one[0][:depth] == place and len(one[0]) > depth]
        node, models = _at(values, place), _models_at(kind, place)
        chosen = _form(forms, depth, node, models)
        if chosen is None:
            return _of_no_form(place, values, node, models, [one for loc, one in forms if len(loc) == depth + 1])
        found = [(loc[:depth] + loc[depth + 1 :], one) for loc, one in forms if loc[depth] == chosen]
        first = next((one for one in found if one[1]["type"] == rule), found[0])
    return _sentence(kind, *first, values)


def shown(value: Any, longest: int = _LONGEST_VALUE) -> str:
    """A value for a message, shortened if it is long."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        text = repr(value)
    except ValueError:  # a number with more digits than Python writes
        return f"a number with more than {sys.get_int_max_str_digits()} digits"
    return text if len(text) <= longest else f"{text[:longest]}…"


def _sentence(kind: type[BaseModel], location: Location, error: Mapping[str, Any], values: Any) -> str:
    got, where = error.get("input"), key_path(location, values)
    if error["type"] == "extra_forbidden":
        models = _models_at(kind, location[:-1])
        names = list(models[0].model_fields) if models else []
        return f"unknown key {shown(where, _LONGEST_KEY)}; {options(names, str(location[-1]))}"
    if error["type"] == "missing" and location:
        if isinstance(location[-1], int):
            return f"{key_path(location[:-1], values)}: entry {location[-1] + 1} is missing, got {shown(got)}"
        return f"{where} is missing"
    text = _rule(error)
    told = error["type"] == "value_error" and (isinstance(got, Mapping) or ", got " in text or shown(got) in text)
    said = text if told else f"{text}, got {shown(got)}"
    return f"{where}: {said}" if where else said


def key_path(location: Location, values: Any) -> str:
    """A dotted key as a user writes it: entries of lists by their name, or by their number from 1."""
    node, parts = values, list[str]()
    for part in location:
        below = _below(node, part)
        named = below.get("name") if isinstance(below, Mapping) and isinstance(part, int) else None  # pyright: ignore[reportUnknownVariableType, reportUnknownMemberType]
        name = named if isinstance(named, str) and named else part + 1 if isinstance(part, int) else part
        parts.append(str(name))
        node = below
    return ".".join(parts)


def _rule(error: Mapping[str, Any]) -> str:
    """The rule that a value breaks, in plain words."""
    kind, about = str(error["type"]), cast("Mapping[str, Any]", error.get("ctx") or {})
    if kind in _RULES:
        limit = about.get("min_length", about.get("max_length"))
        return _RULES[kind].format(**{**about, "entries": "entry" if limit == 1 else "entries"})
    if kind == "value_error":
        return str(error["msg"]).removeprefix("Value error, ")
    expected = _expected(error)
    if kind == "tuple_type" and isinstance(error.get("input"), Mapping):
        return f"must be {expected}: a table in its place changes, by name, entries that there are already"
    return f"must be {expected}"


def _expected(error: Mapping[str, Any]) -> str:
    """What a value must be, such as `a number`."""
    kind, got = str(error["type"]), error.get("input")
    if kind == "literal_error":
        text = str(error["ctx"]["expected"])
        close = options(re.findall(r"'([^']*)'", text), got).partition(" (")[2] if isinstance(got, str) else ""
        return f"{text} ({close}" if close else text
    word = _KINDS.get(kind.split("_", maxsplit=1)[0])
    return word or str(error["msg"]).removeprefix("Input should be ")


def _member_at(location: Location, error: Mapping[str, Any], values: Any) -> int | None:
    """Place of the first part that is no key: pydantic's name of one of several forms. None: all are keys."""
    node = values
    for depth, part in enumerate(location):
        last = depth == len(location) - 1
        known = isinstance(part, int) or (isinstance(node, Mapping) and part in node)
        if not known and not (last and error["type"] == "missing"):
            return depth
        node = _below(node, part)
    return None


def _form(
    forms: Sequence[tuple[Location, Mapping[str, Any]]], depth: int, node: Any, models: Sequence[type[BaseModel]]
) -> int | str | None:
    """The one of several forms that a value was meant to have, as pydantic calls it; None: of none."""
    names = list(dict.fromkeys(loc[depth] for loc, _ in forms))
    if len(names) == 1:
        return names[0]
    if isinstance(node, Mapping):
        fitting = {name: _shared(name, cast("Mapping[Any, Any]", node), models) for name in names}
        best = max(fitting, key=lambda name: fitting[name])
        if fitting[best]:
            return best
        broken = [loc[depth] for loc, one in forms if one["type"] == "value_error"]
        return broken[0] if broken and not node else None
    inside = [loc for loc, one in forms if len(loc) > depth + 1 or not _is_of_another_type(one)]
    return max(inside, key=len)[depth] if inside else None


def _shared(name: int | str, node: Mapping[Any, Any], models: Sequence[type[BaseModel]]) -> int:
    """How many keys of a table a form has."""
    of = [model for model in models if re.search(rf"\b{model.__name__}\b", str(name))]
    return max((len(set(node) & set(model.model_fields)) for model in of), default=0)


def _is_of_another_type(error: Mapping[str, Any]) -> bool:
    return str(error["type"]).endswith(("_type", "_parsing")) or error["type"] == "literal_error"


def _of_no_form(
    place: Location,
    values: Any,
    node: Any,
    models: Sequence[type[BaseModel]],
    errors: Sequence[Mapping[str, Any]],
) -> str:
    """The sentence where a value has none of several forms."""
    where = key_path(place, values)
    keys = list(dict.fromkeys(name for model in models for name in model.model_fields))
    if isinstance(node, Mapping) and keys:
        unknown = next(iter(cast("Mapping[Any, Any]", node)), None)
        if unknown is None:
            return f"{where}: an empty table; {options(keys)}"
        return f"unknown key {shown(f'{where}.{unknown}', _LONGEST_KEY)}; {options(keys, str(unknown))}"
    forms = [_expected(error) for error in errors]
    table = f"a table with {', '.join(keys)}" if keys else "a table"
    plain = list(dict.fromkeys(table if form == "a table" else form for form in forms))
    return f"{where}: must be {' or '.join(plain)}, got {shown(node)}"


def _models_at(kind: type[BaseModel], location: Location) -> list[type[BaseModel]]:
    """The configurations that a value at a place can be."""
    models = [kind]
    for part in location:
        fields = [
            field for model in models for name, field in model.model_fields.items() if part in (name, field.alias)
        ]
        below = [model for field in fields for model in models_in(field.annotation)]
        models = below if fields else models  # else a place in a list, or a name in a table
    return list(dict.fromkeys(models))


def _at(values: Any, location: Location) -> Any:
    for part in location:
        values = _below(values, part)
    return values


def _below(node: Any, part: int | str) -> Any:
    if isinstance(node, Mapping):
        return cast("Mapping[Any, Any]", node).get(part)
    if isinstance(node, list | tuple) and isinstance(part, int) and part < len(cast("Sequence[Any]", node)):
        return node[part]
    return None
