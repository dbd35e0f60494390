"""A round rod, or the wall of a round hole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest
from pliant.surfaces.round import RoundSurface


@dataclass(frozen=True)
class CylinderSurface(RoundSurface):
    """A cylinder without ends whose axis is the z axis of its frame; hollow, the inner wall of a pipe."""

    _shape: ClassVar[str] = "cylinder"

    def near(self, point: npt.ArrayLike) -> Nearest:
        axis = self.rotation[:, 2]
        offset = np.asarray(point, dtype=np.float64) - self.origin
        along = float(axis @ offset)
        radial = offset - along * axis
        length = float(np.linalg.norm(radial))
        outward = radial / length if length > 1e-12 else self.rotation[:, 0]
        place = self.origin + along * axis + self.radius * outward
        return Nearest(self._side * (length - self.radius), self._side * outward, place)

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        return self._side / self.radius, 0.0

    def top(self) -> Array:
        """The highest point over the origin (the lowest, in a pipe); +x of an upright cylinder."""
        axis = self.rotation[:, 2]
        up = np.array([0.0, 0.0, 1.0]) - axis * axis[2]
        length = float(np.linalg.norm(up))
        outward = up / length if length > 1e-6 else self.rotation[:, 0]
        return self.origin + self._side * self.radius * outward

    def first_axis(self, normal: Array) -> Array:
        """Along the axis."""
        return self.rotation[:, 2]

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        place = self.near(point)
        axis, n = self.rotation[:, 2], place.normal
        around = np.cross(axis, n)  # tangent across the axis
        across = np.cross(n, along)
        steps = uv[:, :1] * along + uv[:, 1:] * across  # in the tangent plane: it unrolls without distortion
        length, arc = steps @ axis, steps @ around
        angle = self._side * arc / self.radius
        outward = self._side * n
        sideways = self._side * around
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        radial = c * outward + s * sideways
        centre = place.point - self.radius * outward
        return centre + length[:, None] * axis + self.radius * radial, self._side * radial
