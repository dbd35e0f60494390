"""What the configurations of the chain's links share: frozen values with a unit, a range and a description on each."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field

from pliant.spatial import Array, as_vector

NotNegative = Annotated[float, Field(ge=0.0)]

PerJoint = NotNegative | tuple[NotNegative, ...]
"""one number for all joints, or one for each; not negative"""


def per_joint(value: float | tuple[float, ...], n: int, name: str, *, fitted: bool) -> Array:
    """A value for each joint, (n,).

    Args:
        value: one number for all joints, or one for each from the base outwards.
        n: number of joints.
        name: of the value, for the error.
        fitted: the numbers are those of another robot: joints beyond them take the last one, and what is too many is
            left out.

    Raises:
        ShapeError: another number of values than there are joints, and not `fitted`.
    """
    if fitted and isinstance(value, tuple):
        value = (*value[:n], *(value[-1],) * (n - len(value)))
    return as_vector(value, n, name)


def _in_order(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"a range goes from low to high, got {value}")
    return value


Range = Annotated[tuple[float, float], AfterValidator(_in_order)]
"""lowest and highest value"""


def quantity(default: Any, unit: str, description: str, **limits: Any) -> Any:
    """A field with a unit. Args: default; unit; description; limits: pydantic's `ge`, `gt`, `le`, `lt`."""
    return Field(default, description=f"{description} [{unit}]", json_schema_extra={"unit": unit}, **limits)
