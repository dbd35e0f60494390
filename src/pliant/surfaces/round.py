"""Common base of cylinder and sphere: a radius, and the side of the material."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from pliant.errors import ConfigError
from pliant.surfaces.geometry import SurfaceGeometry


@dataclass(frozen=True)
class RoundSurface(SurfaceGeometry):
    """A surface with one radius.

    Raises:
        ConfigError: on construction, when the radius is not above zero.
    """

    radius: float = 0.1
    """m"""
    hollow: bool = False
    """the material is outside"""
    _shape: ClassVar[str]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (math.isfinite(self.radius) and self.radius > 0.0):
            raise ConfigError(f"the radius of a {self._shape} must be above zero (m), got {self.radius}")

    @property
    def _side(self) -> float:
        return -1.0 if self.hollow else 1.0
