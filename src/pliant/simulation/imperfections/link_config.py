"""What the configurations of the chain's links share: frozen values with a unit, a range and a description on each."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field

NotNegative = Annotated[float, Field(ge=0.0)]

PerJoint = NotNegative | tuple[NotNegative, ...]
"""one number for all joints, or one for each; not negative"""


def _in_order(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"a range goes from low to high, got {value}")
    return value


Range = Annotated[tuple[float, float], AfterValidator(_in_order)]
"""lowest and highest value"""


def quantity(default: Any, unit: str, description: str, **limits: Any) -> Any:
    """A field with a unit. Args: default; unit; description; limits: pydantic's `ge`, `gt`, `le`, `lt`."""
    return Field(default, description=f"{description} [{unit}]", json_schema_extra={"unit": unit}, **limits)
