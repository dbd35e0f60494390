"""A ball, or a round bowl."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest, SurfaceGeometry


@dataclass(frozen=True)
class SphereSurface(SurfaceGeometry):
    """A sphere about the origin of its frame.

    Raises:
        ConfigError: on construction, when the radius is not above zero.
    """

    radius: float = 0.1
    """m"""
    hollow: bool = False
    """the material is outside: a bowl"""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (math.isfinite(self.radius) and self.radius > 0.0):
            raise ConfigError(f"the radius of a sphere must be above zero (m), got {self.radius}")

    @property
    def _side(self) -> float:
        return -1.0 if self.hollow else 1.0

    def near(self, point: npt.ArrayLike) -> Nearest:
        offset = np.asarray(point, dtype=np.float64) - self.origin
        length = float(np.linalg.norm(offset))
        outward = offset / length if length > 1e-12 else self.rotation[:, 2]
        return Nearest(self._side * (length - self.radius), self._side * outward, self.origin + self.radius * outward)

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        return self._side / self.radius, self._side / self.radius

    def top(self) -> Array:
        return self.origin + np.array([0.0, 0.0, self._side * self.radius])

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        place = self.near(point)
        outward = self._side * place.normal
        across = np.cross(place.normal, along)
        steps = uv[:, :1] * along + uv[:, 1:] * across
        length = np.linalg.norm(steps, axis=1, keepdims=True)
        direction = np.divide(steps, length, out=np.zeros_like(steps), where=length > 1e-15)
        angle = length / self.radius
        radial = np.cos(angle) * outward + np.sin(angle) * direction
        return self.origin + self.radius * radial, self._side * radial
