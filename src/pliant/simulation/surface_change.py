"""Contact properties that change along a straight line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from pliant.errors import ConfigError


@dataclass(frozen=True)
class SurfaceChange:
    """Stiffness and damping of a contact along a straight line in the world: linear between its places, as at the first
    and the last one beyond them, and the same across the line.

    Raises:
        ConfigError: on construction, when the places do not rise, the lists differ in length, a stiffness is not above
            zero, a damping is negative, or the direction is not a unit vector.
    """

    origin: tuple[float, float, float]
    """m, a point of the line"""
    direction: tuple[float, float, float]
    """unit vector"""
    places: tuple[float, ...]
    """m along the line from its origin, rising"""
    stiffness: tuple[float, ...]
    """N/m at each place"""
    damping: tuple[float, ...]
    """N·s/m at each place"""

    def __post_init__(self) -> None:
        if not 1 <= len(self.places) == len(self.stiffness) == len(self.damping):
            raise ConfigError(
                "a changing surface needs a stiffness and a damping at each place, got"
                f" {len(self.places)}, {len(self.stiffness)} and {len(self.damping)} values"
            )
        if not all(map(math.isfinite, self.places)) or any(b <= a for a, b in pairwise(self.places)):
            raise ConfigError(f"the places of a changing surface must rise (m), got {list(self.places)}")
        if not all(math.isfinite(value) and value > 0.0 for value in self.stiffness):
            raise ConfigError(f"contact stiffness must be above zero (N/m), got {list(self.stiffness)}")
        if not all(math.isfinite(value) and value >= 0.0 for value in self.damping):
            raise ConfigError(f"contact damping must not be negative (N·s/m), got {list(self.damping)}")
        if abs(math.hypot(*self.direction) - 1.0) > 1e-9:
            raise ConfigError(f"the direction of a changing surface must be a unit vector, got {list(self.direction)}")
