"""Frozen values with some of their fields changed, as fast as a loop of a thousand ticks a second wants it."""

from __future__ import annotations

from typing import Any, TypeVar

_Value = TypeVar("_Value")
_set = object.__setattr__


def changed(value: _Value, **fields: Any) -> _Value:
    """`dataclasses.replace` at half its time, for a dataclass with slots of its own class alone.

    Nothing is checked again: not for classes that check their fields (`__post_init__`).

    Raises:
        AttributeError: a field that the value does not have.
    """
    kind = type(value)
    new = object.__new__(kind)
    names: tuple[str, ...] = kind.__slots__  # type: ignore[attr-defined]
    for name in names:
        _set(new, name, fields.pop(name) if name in fields else getattr(value, name))
    if fields:
        raise AttributeError(f"{kind.__name__} has no field {', '.join(sorted(fields))}")
    return new
