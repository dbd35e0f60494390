"""The surface of a part given by triangles."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.spatial import Array, frame_with_z_along, unit_rows
from pliant.surfaces.distance_field import SampledDistance
from pliant.surfaces.geometry import Nearest, SurfaceGeometry
from pliant.surfaces.mesh_file import read_mesh

_STRIDE = 1e-3  # m of a geodesic at once
_STEEP = 1e-9


@dataclass(frozen=True)
class MeshSurface(SurfaceGeometry):
    """A mesh, closed or an open shell, concave parts allowed; smoothed between the samples of its distance.

    Contact is possible at ridges and in grooves too; a normal that turns within a sample's width is rounded by about
    that.
    """

    distance: SampledDistance = field(kw_only=True)
    """in the surface's own axes"""

    @staticmethod
    def read(
        path: str | Path,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        rotation: npt.ArrayLike | None = None,
        *,
        scale: float = 1.0,
        outside: npt.ArrayLike | None = None,
        grid: float | None = None,
    ) -> MeshSurface:
        """The surface of an STL, OBJ or PLY file.

        Args:
            path: of the file.
            origin: (3,) m, where the file's origin stands in the world.
            rotation: R_world_file (3, 3); None: not turned.
            scale: m per unit of the file.
            outside: (3,) out of the material of an open shell, in the file's axes.
            grid: m between two samples of its distance; None: as fine as 500 000 of them allow.

        Raises:
            ConfigError: as `read_mesh` and `SampledDistance`.
        """
        out = None if outside is None else tuple(float(x) for x in np.asarray(outside).tolist())
        file = Path(path)
        changed = file.stat().st_mtime_ns if file.is_file() else 0
        found = _sampled(str(file), changed, scale, out, grid)
        turned = np.eye(3) if rotation is None else np.asarray(rotation, dtype=np.float64)
        return MeshSurface(np.asarray(origin, dtype=np.float64), turned, distance=found)

    @property
    def described(self) -> str:
        kept = self.distance
        kind = "closed" if kept.triangles.closed else "an open shell"
        return (
            f"{len(kept.triangles.corners)} triangles, {kind}; distance sampled every {1e3 * kept.step:.2g} mm"
            f" ({kept.memory / 1e6:.1f} MB)"
        )

    def near(self, point: npt.ArrayLike) -> Nearest:
        local = (np.asarray(point, dtype=np.float64) - self.origin) @ self.rotation
        distance, place, normal = self.distance.nearest(local[None])
        return Nearest(float(distance[0]), self.rotation @ normal[0], self.origin + self.rotation @ place[0])

    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        """From the normals a sample's width to each side, so that a facet is not a curvature."""
        here = self.near(point)
        local, n = (here.point - self.origin) @ self.rotation, here.normal @ self.rotation
        basis = frame_with_z_along(n)[:, :2]
        width = 2.0 * self.distance.step
        around = np.concatenate([local + width * basis.T, local - width * basis.T])
        normals = self.distance.nearest(around)[2]
        turning = basis.T @ ((normals[:2] - normals[2:]) / (2.0 * width)).T
        first, second = np.linalg.eigvalsh(0.5 * (turning + turning.T)).tolist()
        return (first, second) if abs(first) > abs(second) else (second, first)

    def top(self) -> Array:
        """The first place that is met on the way down, along the world's z axis, to the middle of the part.

        Raises:
            ConfigError: there is a hole.
        """
        low, high = self.distance.triangles.bounds
        corners = np.array(np.meshgrid(*np.stack([low, high]).T.tolist())).reshape(3, -1).T @ self.rotation.T
        lowest, highest = corners.min(axis=0), corners.max(axis=0)
        place = self.origin + np.array([*(0.5 * (lowest + highest))[:2], highest[2] + _STRIDE])
        floor = self.origin[2] + lowest[2]
        while place[2] >= floor:
            local = (place - self.origin) @ self.rotation
            gap = float(self.distance.nearest(local[None])[0][0])
            if gap < 1e-6:
                return self.near(place).point
            place = place - np.array([0.0, 0.0, max(gap, 1e-6)])
        raise ConfigError("there is a hole over the middle of the mesh: give the place of the path by path.at")

    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        n = self.near(point).normal
        steps = uv[:, :1] * along + uv[:, 1:] * np.cross(n, along)
        length = np.linalg.norm(steps, axis=1)
        heading = np.divide(steps, length[:, None], out=np.tile(along, (len(uv), 1)), where=length[:, None] > 1e-15)
        places, way = np.tile((point - self.origin) @ self.rotation, (len(uv), 1)), heading @ self.rotation
        strides = max(1, math.ceil(float(length.max(initial=0.0)) / _STRIDE))
        _, places, normals = self.distance.nearest(places)
        for _ in range(strides):  # straight on in the tangent plane, then back on the surface: a geodesic
            _, places, normals = self.distance.nearest(places + (length / strides)[:, None] * way)
            flat = way - normals * np.sum(normals * way, axis=1, keepdims=True)
            way = unit_rows(np.where(np.linalg.norm(flat, axis=1, keepdims=True) > _STEEP, flat, way))
        return self.origin + places @ self.rotation.T, normals @ self.rotation.T


@lru_cache(maxsize=8)
def _sampled(
    path: str, changed: int, scale: float, outside: tuple[float, ...] | None, grid: float | None
) -> SampledDistance:
    """Args: changed: when the file was written; a file that was changed is read again."""
    return SampledDistance(read_mesh(path, scale, outside), grid)
