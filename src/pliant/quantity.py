"""Fields of a configuration that hold a physical quantity: text, unit, bounds, usual range."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field
from pydantic.fields import FieldInfo


def quantity(
    default: Any,
    unit: str,
    text: str,
    *,
    shown: tuple[float, float] | None = None,
    assumed: str = "",
    **limits: Any,
) -> Any:
    """A field with a unit. Help texts, tables of values and sliders are made from it.

    Args:
        default: its value where none is given; `...`: one must be given.
        unit: such as "N/m"; "1" for a ratio.
        text: what it is, without the unit.
        shown: lowest and highest value of its slider on the live page; other values are allowed elsewhere.
        assumed: what a default stands for that no file of a robot says, and how to find the true value.
        limits: bounds of a value, pydantic's `ge`, `gt`, `le`, `lt`, `min_length`.
    """
    extra: dict[str, Any] = {"unit": unit}
    if shown is not None:
        extra["minimum"], extra["maximum"] = shown
    if assumed:
        extra["assumed"] = assumed
    return Field(default, description=text, json_schema_extra=extra, **limits)


def unit_of(about: FieldInfo) -> str:
    """Unit of a field; "" if it holds no quantity."""
    return _extra(about, "unit")


def assumed_of(about: FieldInfo) -> str:
    """What the default of a field assumes of a robot; "" if it assumes nothing."""
    return _extra(about, "assumed")


def _extra(about: FieldInfo, key: str) -> str:
    extra = about.json_schema_extra
    return str(extra.get(key, "")) if isinstance(extra, dict) else ""


def in_order(value: tuple[float, float]) -> tuple[float, float]:
    """Validator of a range (lowest, highest). Raises ValueError if the order is reversed."""
    if value[0] > value[1]:
        raise ValueError("a range goes from low to high, [lowest, highest]")
    return value


Range = Annotated[tuple[float, float], AfterValidator(in_order)]
"""lowest and highest value"""
