"""A flat face with a round hole in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant._contact import Solid
from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest, SurfaceGeometry

_BESIDE = 0.02  # m from the mouth, where patterns start
_FLAT = 1e-9  # m


@dataclass(frozen=True)
class HoleSurface(SurfaceGeometry):
    """A half-space with a blind hole along −z of its face; the origin is the middle of the mouth, in the face.

    The mouth is bevelled by 45°, the bottom is flat. Near the rims, inside of the material, the normal jumps where two
    faces are as near as each other; outside it does so at the corner of wall and bottom and, over the axis, at as many
    places.

    Raises:
        ConfigError: on construction, when a size is not valid, or the bevel is as deep as the hole.
    """

    radius: float = 0.01
    """m"""
    depth: float = 0.03
    """m, from the face to the bottom"""
    chamfer: float = 0.0
    """m, of the mouth's bevel, along the face and along the axis"""

    def __post_init__(self) -> None:
        super().__post_init__()
        sizes = (self.radius, self.depth, self.chamfer)
        if not (all(map(math.isfinite, sizes)) and self.radius > 0.0 and 0.0 <= self.chamfer < self.depth):
            raise ConfigError(
                f"a hole needs a radius above zero and a bevel from zero to less than its depth (m), got radius"
                f" {self.radius}, depth {self.depth}, chamfer {self.chamfer}"
            )

    @property
    def solid(self) -> Solid:
        """In the surface's own axes."""
        return Solid.hole(self.radius, self.depth, self.chamfer)

    def near(self, point: npt.ArrayLike) -> Nearest:
        return near_solid(self, self.solid, point)

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        """Of the face, bevel, wall or bottom on which the nearest place lies; of two at a rim, the upper one's."""
        x, y, z = ((self.near(point).point - self.origin) @ self.rotation).tolist()
        if z > -_FLAT or z < -self.depth + _FLAT:
            return 0.0, 0.0
        radius = math.hypot(x, y)
        return (-math.sqrt(0.5) / radius if z > -self.chamfer - _FLAT and self.chamfer > 0.0 else -1.0 / radius), 0.0

    def top(self) -> Array:
        """Beside the mouth, in the face."""
        return self.origin + (self.radius + self.chamfer + _BESIDE) * self.rotation[:, 0]

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        """Of the face, as if the hole were closed."""
        n = self.rotation[:, 2]
        return point + uv[:, :1] * along + uv[:, 1:] * np.cross(n, along), np.tile(n, (len(uv), 1))


def near_solid(surface: SurfaceGeometry, solid: Solid, point: npt.ArrayLike) -> Nearest:
    """Distance, normal and place for a point (3,) m. Args: solid: the surface's, in its own axes."""
    local = (np.asarray(point, dtype=np.float64) - surface.origin) @ surface.rotation
    distance, place, normal = solid.nearest(local[None])
    return Nearest(float(distance[0]), surface.rotation @ normal[0], surface.origin + surface.rotation @ place[0])
