"""Frozen values that are made and copied fast enough for a control loop of 1 kHz."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, TypeVar, dataclass_transform

_Value = TypeVar("_Value")


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def quick(kind: type[_Value]) -> type[_Value]:
    """`dataclass(frozen=True, slots=True)` whose values are made in little more than half the time: a frozen dataclass
    writes each field by `object.__setattr__`, which looks the field up; here each is written by its slot. For values
    of a control loop, of which each tick makes some dozens. All fields are arguments, none by keyword alone."""
    made = dataclass(frozen=True, slots=True)(kind)
    init: Any = made.__init__
    every: Any = fields(made)  # pyright: ignore[reportArgumentType] (a dataclass by now)
    defaults = dict(zip([one.name for one in reversed(every)], reversed(init.__defaults__ or ())))  # noqa: B905
    names: dict[str, Any] = {}
    lines: list[str] = []
    for one in every:
        names[f"set_{one.name}"] = getattr(made, one.name).__set__
        value = one.name
        if one.default_factory is not MISSING:
            names[f"make_{one.name}"] = one.default_factory
            value = f"make_{one.name}() if {one.name} is absent else {one.name}"
            names["absent"] = defaults[one.name]  # the same for each field with a factory
        lines.append(f"set_{one.name}(self, {value})")
    if hasattr(made, "__post_init__"):
        lines.append("self.__post_init__()")
    parameters = ", ".join(["self", *(one.name for one in every)])
    exec(f"def __init__({parameters}):\n  " + "\n  ".join(lines), names)
    written = names["__init__"]
    for name in ("__module__", "__qualname__", "__defaults__", "__annotations__"):
        setattr(written, name, getattr(init, name))
    setattr(made, "__init__", written)  # noqa: B010 (to pyright, a method is no attribute)
    return made


def changed(value: _Value, **fields: Any) -> _Value:
    """`dataclasses.replace` in two thirds of the time, for a dataclass whose slots are all of its own class. It skips
    `__post_init__`: do not use it for classes that check their fields.

    Raises:
        AttributeError: a field that the value does not have.
    """
    kind = type(value)
    known = _KNOWN.get(kind)
    if known is None:
        known = _KNOWN[kind] = _copier(kind)
    copy, writers = known
    new = copy(value)
    for name, part in fields.items():
        write = writers.get(name)
        if write is None:
            raise AttributeError(f"{kind.__name__} has no field {name}")
        write(new, part)
    return new


_KNOWN: dict[type, tuple[Callable[[Any], Any], dict[str, Callable[[Any, Any], None]]]] = {}
"""class → what copies its values, and what writes each field"""


def _copier(kind: type) -> tuple[Callable[[Any], Any], dict[str, Callable[[Any, Any], None]]]:
    slots: tuple[str, ...] = kind.__slots__  # type: ignore[attr-defined]
    writers = {name: getattr(kind, name).__set__ for name in slots}
    names: dict[str, Any] = {"make": object.__new__, "kind": kind, **{f"set_{n}": w for n, w in writers.items()}}
    lines = [f"set_{name}(new, value.{name})" for name in slots]
    exec("def copy(value):\n  new = make(kind)\n  " + "\n  ".join([*lines, "return new"]), names)
    return names["copy"], writers
