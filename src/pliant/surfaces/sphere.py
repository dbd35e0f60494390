"""A ball, or a round bowl."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest
from pliant.surfaces.round import RoundSurface


@dataclass(frozen=True)
class SphereSurface(RoundSurface):
    """A sphere about the origin of its frame; hollow, a bowl."""

    _shape: ClassVar[str] = "sphere"

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
