"""Several planes, each where it is the nearest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.surfaces.geometry import Nearest, SurfaceGeometry
from pliant.surfaces.plane import PlaneSurface


@dataclass(frozen=True)
class FacetSurface(SurfaceGeometry):
    """Planes that are pressed one after the other: a point belongs to the one that is nearest to it.

    It is a belief about normals, not a solid: between two planes the normal jumps.
    """

    facets: tuple[PlaneSurface, ...] = ()

    @staticmethod
    def of(facets: Sequence[PlaneSurface]) -> SurfaceGeometry:
        """One plane as it is; several together. Raises ConfigError for none."""
        if not facets:
            raise ConfigError("a surface of planes needs one plane at least")
        first = facets[0]
        return first if len(facets) == 1 else FacetSurface(first.origin, first.rotation, tuple(facets))

    def near(self, point: npt.ArrayLike) -> Nearest:
        return min((facet.near(point) for facet in self.facets), key=lambda found: abs(found.distance))

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        return 0.0, 0.0

    def top(self) -> Array:
        return self.facets[0].top()

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        at = np.asarray(point, dtype=np.float64)
        nearest = min(self.facets, key=lambda facet: abs(facet.near(at).distance))
        return nearest.chart(at, along, uv)
