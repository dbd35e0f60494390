"""Values that change along an axis of a surface."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, field_validator

from pliant.configuration import Config

_Knot = tuple[float, Annotated[float, Field(ge=0.0)]]


class AlongSurface(Config):
    """A value at places along an axis of the surface's frame: on straight lines between them, constant beyond."""

    along: Literal["x", "y", "z"] = Field(default="x", description="axis of the surface's own frame")
    values: tuple[_Knot, ...] = Field(min_length=2, description="m along it, rising, and the value there")

    @field_validator("values")
    @classmethod
    def _rises(cls, value: tuple[_Knot, ...]) -> tuple[_Knot, ...]:
        places = [place for place, _ in value]
        if any(later <= before for before, later in pairwise(places)):
            raise ValueError(f"the places of a value that changes along a surface must rise, got {places} m")
        return value

    @property
    def places(self) -> tuple[float, ...]:
        """m."""
        return tuple(place for place, _ in self.values)

    @property
    def numbers(self) -> tuple[float, ...]:
        """The value at each place."""
        return tuple(value for _, value in self.values)
