"""Parameters of one explicit contact, and the largest stable physics step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError
from pliant.simulation.surface import Surface
from pliant.simulation.surface_change import SurfaceChange
from pliant.spatial import Array

_CRITICAL_VELOCITY = 1e-3  # m/s, [HapFIC] sec. III


@dataclass(frozen=True)
class ContactMaterial:
    """Parameters of one contact, in the order of the compiled law."""

    stiffness: float
    """K, N/m, of every contact point"""
    damping: float
    """D, N s/m"""
    transition: float
    """w, m of penetration over which the force fades in"""
    mu_static: float
    mu_dynamic: float
    critical_velocity: float
    """v_c, m/s of sliding around which friction falls from static to dynamic"""
    tangential_stiffness: float
    """N/m of the bristle; 0 leaves a capped viscous friction, which creeps"""
    tangential_damping: float
    """N s/m of the bristle"""

    @classmethod
    def of(cls, surface: Surface, inverse_mass: float) -> ContactMaterial:
        """The material of a surface.

        The bristle is as stiff as the surface; its damping is the surface's, but at most critical for the sliding mass,
        since more would only require shorter steps.

        Args:
            surface: of the thing that is touched.
            inverse_mass: 1/kg, largest at the contact.
        """
        critical = 2.0 * float(np.sqrt(surface.stiffness / inverse_mass)) if inverse_mass > 0.0 else surface.damping
        moving = surface.friction if surface.friction_moving is None else surface.friction_moving
        return cls(
            stiffness=surface.stiffness,
            damping=surface.damping,
            transition=surface.transition,
            mu_static=surface.friction,
            mu_dynamic=moving,
            critical_velocity=_CRITICAL_VELOCITY,
            tangential_stiffness=surface.stiffness,
            tangential_damping=min(surface.damping, critical),
        )

    def row(self) -> Array:
        """(8,) for the compiled law."""
        return np.array(
            [
                self.stiffness,
                self.damping,
                self.transition,
                self.mu_static,
                self.mu_dynamic,
                self.critical_velocity,
                self.tangential_stiffness,
                self.tangential_damping,
            ]
        )


@dataclass(frozen=True)
class GradedMaterial:
    """The materials at the places of a line."""

    change: SurfaceChange
    materials: tuple[ContactMaterial, ...]
    """at each place"""

    def rows(self) -> tuple[Array, Array, Array]:
        """Materials (k, 8), line (2, 3) and places (k,) for the compiled law."""
        line = np.array([self.change.origin, self.change.direction])
        return np.stack([material.row() for material in self.materials]), line, np.array(self.change.places)


def require_stable_step(name: str, material: ContactMaterial, inverse_mass: float, dt: float) -> None:
    """Refuses a physics step at which a contact would gain energy: (K dt² + 2 D dt)/m must stay below 4.

    Args:
        name: of the contact, for the error.
        material: of the contact.
        inverse_mass: 1/kg, largest at the contact.
        dt: s.

    Raises:
        ConfigError: the step is too long; names the longest one that is stable.
    """
    K, D = material.stiffness, material.damping
    if inverse_mass * (K * dt**2 + 2.0 * D * dt) < 4.0:
        return
    longest = (np.sqrt(D**2 + 4.0 * K / inverse_mass) - D) / K
    raise ConfigError(
        f"contact {name!r}: a physics step of {dt:g} s is too long for K = {K:g} N/m and D = {D:g} N s/m on"
        f" {1.0 / inverse_mass:.3g} kg; it must be below {longest:.3g} s"
    )
