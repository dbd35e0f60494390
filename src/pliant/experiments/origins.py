"""Every value of a run with its unit and origin."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from pliant.entries import ControllerConfig
from pliant.experiments.choice import Choice
from pliant.quantity import assumed_of, unit_of
from pliant.rules import Rule, Suggestion, rule_of
from pliant.wiring.registry import find_controller

_LONGEST = 60  # characters
DEFAULT = "default"
SUGGESTED = "suggested"
"""origin of what follows from robot and task"""
_UNKNOWN = object()
_CONTROL = "control"
"""table of a configuration that changes the controller's parameters"""


@dataclass(frozen=True)
class Origin:
    """One value of a run."""

    key: str
    """dotted key, as for `--set`"""
    value: Any
    unit: str
    origin: str
    """a file, an option, the case, "default", "assumed" with what of, or "suggested" (for this robot and task)"""
    rule: Rule | None = None
    """of what is suggested, or of a default that the rule leaves as it is"""

    @property
    def shown(self) -> str:
        """The value as `--set` takes it, shortened if it is long."""
        text = json.dumps(to_jsonable_python(self.value), ensure_ascii=False)
        return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def origins(choice: Choice, parameters: ControllerConfig | None) -> list[Origin]:
    """Every value of a run, with the derived parameters of the controller and what its study suggests.

    Args:
        choice: the requested run.
        parameters: of the controller, as it was built; None: not known.
    """
    config = choice.config
    found = [
        _origin(choice, path, value, about, default, choice.base)
        for path, value, about, default in leaves(config)
        if path[0] != _CONTROL
    ]
    found = _with_suggestions(found, choice.study.suggested(config))
    if parameters is None:
        return found
    above = (_CONTROL, config.controller) if config.control_by_name else (_CONTROL,)
    entry = find_controller(config.controller)
    for path, value, about, usual in leaves(parameters, entry.default):
        row = _origin(choice, (*above, *path), value, about, usual, SUGGESTED)
        rule = rule_of(entry.rules, ".".join(path))
        told = row.origin == SUGGESTED or (row.origin == DEFAULT and rule is not None and not rule.of_many)
        found.append(replace(row, rule=rule if told else None))
    return found


def _with_suggestions(found: list[Origin], suggested: Mapping[str, Suggestion]) -> list[Origin]:
    """The rows, those that say nothing replaced by what is suggested for them."""
    given = {row.key: row for row in found if row.value is not None or row.key not in suggested}
    rows = {key: Origin(key, one.value, one.unit, SUGGESTED, one.rule) for key, one in suggested.items()}
    return list((given | {key: row for key, row in rows.items() if key not in given}).values())


def _origin(choice: Choice, path: tuple[str, ...], value: Any, about: FieldInfo, default: Any, else_: str) -> Origin:
    key, unit = ".".join(path), unit_of(about)
    for name, values in reversed(choice.layers):
        if _gives(values, path):
            return Origin(key, value, unit, name)
    assumed = assumed_of(about)
    usual = f"assumed: {assumed}" if assumed else DEFAULT
    return Origin(key, value, unit, usual if value == default else else_)


def _gives(values: Any, path: tuple[str, ...]) -> bool:
    for part in path:
        if not isinstance(values, Mapping):
            return True  # a whole table was replaced
        if part not in values:
            return False
        values = values[part]
    return True


def leaves(
    config: BaseModel, default: BaseModel | None = None, above: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Any, FieldInfo, Any]]:
    """Key, value, field and default of everything in a configuration.

    Args:
        config: whose values.
        default: whose values are the defaults; None: those of the fields.
        above: parts of the key in front of it.
    """
    for name, about in type(config).model_fields.items():
        path, value = (*above, name), getattr(config, name)
        usual = getattr(default, name, _UNKNOWN) if default is not None else _default(about)
        if isinstance(value, BaseModel):
            yield from leaves(value, usual if type(usual) is type(value) else None, path)
        elif isinstance(value, Mapping) and any(isinstance(inner, BaseModel) for inner in value.values()):
            for key, inner in value.items():
                if isinstance(inner, BaseModel):
                    yield from leaves(inner, None, (*path, str(key)))
        else:
            yield path, value, about, usual


def _default(about: FieldInfo) -> Any:
    return _UNKNOWN if about.is_required() else about.get_default(call_default_factory=True, validated_data={})
