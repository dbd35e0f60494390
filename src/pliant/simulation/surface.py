"""Contact properties of a surface, in physical units."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pliant.errors import ConfigError
from pliant.simulation.surface_change import SurfaceChange


@dataclass(frozen=True)
class Surface:
    """Contact properties of a surface.

    Raises:
        ConfigError: on construction, when a value is negative, not finite, or the stiffness is zero.
    """

    stiffness: float = 1e4
    """N/m of penetration"""
    damping: float = 1e2
    """N s/m of penetration speed"""
    friction: float = 0.5
    """Coulomb coefficient; at rest where the contact law distinguishes"""
    friction_moving: float | None = None
    """Coulomb coefficient while sliding; None: the same"""
    transition: float = 1e-3
    """m of penetration over which the force of an explicit contact fades in, [HapFIC] sec. III; below it the contact
    is softer than its stiffness"""
    change: SurfaceChange | None = None
    """stiffness and damping along a line, in place of the two above; of a thing that cannot move, with the explicit
    law"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.stiffness) and self.stiffness > 0.0):
            raise ConfigError(f"contact stiffness must be above zero (N/m), got {self.stiffness}")
        for name in ("damping", "friction", "friction_moving", "transition"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value >= 0.0):
                raise ConfigError(f"contact {name} must not be negative, got {value}")

    def at_places(self) -> tuple[Surface, ...]:
        """The surface at each place of its change, or itself alone."""
        if self.change is None:
            return (self,)
        pairs = zip(self.change.stiffness, self.change.damping, strict=True)
        return tuple(replace(self, stiffness=K, damping=D, change=None) for K, D in pairs)
