"""A plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.spatial import Array, as_vector, frame_with_z_along
from pliant.surfaces.geometry import Nearest, SurfaceGeometry


@dataclass(frozen=True)
class PlaneSurface(SurfaceGeometry):
    """A half-space; its z axis is the outward normal."""

    @staticmethod
    def facing(normal: npt.ArrayLike, through: npt.ArrayLike = 0.0) -> PlaneSurface:
        """The plane through a point (3,) m with an outward normal (3,) of any length above zero.

        Raises:
            ConfigError: a normal without length.
        """
        direction = as_vector(normal, 3, "normal")
        if float(np.linalg.norm(direction)) < 1e-9:
            raise ConfigError(f"normal must have a length above zero, got {direction.tolist()}")
        return PlaneSurface(as_vector(through, 3, "the point of the plane"), frame_with_z_along(direction))

    def near(self, point: npt.ArrayLike) -> Nearest:
        p, n = np.asarray(point, dtype=np.float64), self.rotation[:, 2]
        distance = float(n @ (p - self.origin))
        return Nearest(distance, n, p - distance * n)

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        return 0.0, 0.0

    def top(self) -> Array:
        return self.origin

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        n = self.rotation[:, 2]
        across = np.cross(n, along)
        return point + uv[:, :1] * along + uv[:, 1:] * across, np.tile(n, (len(uv), 1))
