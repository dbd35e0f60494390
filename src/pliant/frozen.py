"""Copies of frozen values with some fields changed, fast enough for a control loop of 1 kHz."""

from __future__ import annotations

from typing import Any, TypeVar

_Value = TypeVar("_Value")
_set = object.__setattr__


def changed(value: _Value, **fields: Any) -> _Value:
    """`dataclasses.replace` in half the time, for a dataclass whose slots are all of its own class. It skips
    `__post_init__`: do not use it for classes that check their fields.

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
