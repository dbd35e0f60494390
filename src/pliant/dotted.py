"""Nested values under dotted keys, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.errors import ConfigError


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Turns `{"a.b": 1.0}` into `{"a": {"b": 1.0}}`; tables of the same name are merged.

    Raises:
        ConfigError: a key is given twice, or as a value and as a table.
    """
    tree: dict[str, Any] = {}
    for name, value in values.items():
        _put(tree, name.split("."), value, name)
    return tree


def _put(tree: dict[str, Any], keys: list[str], value: Any, name: str) -> None:
    first, *rest = keys
    if rest or isinstance(value, Mapping):
        node = tree.setdefault(first, {})
        if not isinstance(node, dict):
            raise ConfigError(f"{name!r} is given as a value and as a table")
        for key, inner in [(".".join(rest), value)] if rest else value.items():
            _put(node, key.split(".") if rest else [str(key)], inner, name)
        return
    if first in tree:
        raise ConfigError(f"{name!r} is given twice")
    tree[first] = value


def flat(values: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Nested values under dotted keys."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        found |= flat(value, f"{above}{key}.") if isinstance(value, Mapping) else {f"{above}{key}": value}  # pyright: ignore[reportUnknownArgumentType]
    return found
