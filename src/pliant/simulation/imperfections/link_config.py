"""What the configurations of the chain's links share: values per joint."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

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
        fitted: the numbers are those of another robot: joints beyond them take the last one, and surplus values are
            ignored.

    Raises:
        ShapeError: another number of values than there are joints, and not `fitted`.
    """
    if fitted and isinstance(value, tuple):
        value = (*value[:n], *(value[-1],) * (n - len(value)))
    return as_vector(value, n, name)
