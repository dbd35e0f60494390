"""The edge of a table: two flat faces that meet."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant._contact import Solid
from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest, SurfaceGeometry
from pliant.surfaces.hole import near_solid

_BESIDE = 0.05  # m from the edge, where patterns start
_ROUNDING = 1e-9  # rad
_ANGLES = (math.radians(10.0), math.radians(170.0))


@dataclass(frozen=True)
class EdgeSurface(SurfaceGeometry):
    """A wedge of material whose edge runs along x: one face is z = 0 where y < 0, the other comes down from it.

    The edge may be rounded; then the origin is where the two faces would meet. Inside of the material the normal jumps
    where both faces are equally near.

    Raises:
        ConfigError: on construction, when the angle is not from 10° to 170°, or the rounding is below zero.
    """

    angle: float = 0.5 * math.pi
    """rad, of the material between the faces"""
    rounding: float = 0.0
    """m, radius of the edge"""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not _ANGLES[0] <= self.angle <= _ANGLES[1]:
            raise ConfigError(f"the angle of an edge goes from 10 to 170 degrees, got {math.degrees(self.angle):g}")
        if not (math.isfinite(self.rounding) and self.rounding >= 0.0):
            raise ConfigError(f"the rounding of an edge must not be negative (m), got {self.rounding}")

    @property
    def solid(self) -> Solid:
        """In the surface's own axes."""
        return Solid.edge(self.angle, self.rounding)

    def near(self, point: npt.ArrayLike) -> Nearest:
        return near_solid(self, self.solid, point)

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        """1/rounding on the rounded edge, zero on the faces and where the edge is sharp."""
        way = self.across(point)
        return (1.0 / self.rounding if 0.0 < way < self._bend else 0.0), 0.0

    def top(self) -> Array:
        """On the first face, 5 cm from the edge."""
        return self.origin + self.rotation[:, 1] * (self._middle - _BESIDE)

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        """Both faces and the rounding, laid flat without distortion."""
        start = self.near(point)
        local, n = (start.point - self.origin) @ self.rotation, start.normal @ self.rotation
        first = along @ self.rotation
        steps = uv[:, :1] * first + uv[:, 1:] * np.cross(n, first)
        down = np.array([0.0, n[2], -n[1]])  # across the edge, in the tangent plane
        places, normals = self._at(self.across(point) + steps @ down)
        places[:, 0] = local[0] + steps[:, 0]
        return self.origin + places @ self.rotation.T, normals @ self.rotation.T

    @property
    def _middle(self) -> float:
        """m, y where the first face ends."""
        return -self.rounding * (1.0 + math.cos(self.angle)) / math.sin(self.angle)

    @property
    def _bend(self) -> float:
        """m, length of the rounded edge across it."""
        return self.rounding * (math.pi - self.angle)

    def across(self, point: npt.ArrayLike) -> float:
        """m on the surface, across the edge, from the end of the first face to the place nearest to a point (3,) m."""
        found = self.near(point)
        _, y, z = ((found.point - self.origin) @ self.rotation).tolist()
        _, across, up = (found.normal @ self.rotation).tolist()
        turned, last = math.atan2(across, up), math.pi - self.angle
        if turned < _ROUNDING:
            return min(y - self._middle, 0.0)
        if turned < last - _ROUNDING:
            return self.rounding * turned
        down = -math.cos(self.angle) * (y - self._middle) - math.sin(self.angle) * (z + self.rounding)
        return self._bend + max(down, 0.0)

    def _at(self, way: Array) -> tuple[Array, Array]:
        """Places and normals (k, 3), their x zero, at lengths (k,) m across the edge."""
        turned = np.clip(way / self.rounding, 0.0, math.pi - self.angle) if self.rounding > 0.0 else (
            np.where(way > 0.0, math.pi - self.angle, 0.0)
        )  # fmt: skip
        beyond, zero = np.maximum(way - self._bend, 0.0), np.zeros_like(way)
        normals = np.column_stack([zero, np.sin(turned), np.cos(turned)])
        places = np.array([0.0, self._middle, -self.rounding]) + self.rounding * normals
        places[:, 1] += np.minimum(way, 0.0) - math.cos(self.angle) * beyond
        places[:, 2] -= math.sin(self.angle) * beyond
        return places, normals
