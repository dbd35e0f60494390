"""The signed distance of a mesh, sampled on a grid: between the samples it is smooth, so that facets do not shake a
force."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from pliant._contact import SampledMesh, TriangleMesh
from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.surfaces.mesh_file import Triangles

MARGIN = 0.06
"""m round the mesh, within which the distance is sampled"""
_SAMPLES = 500_000  # default number of samples
_MOST = 8_000_000  # samples: 64 MB
_FINEST = 1e-3  # m, default step
_BAND = 0.03  # m to each side of the mesh, at least
_COARSE = 4


class SampledDistance:
    """Distances to a mesh in its own axes: from the samples near it, from its triangles farther away.

    A tricubic interpolant through the samples, with a continuous gradient (Catmull and Rom 1974). Its error is that of
    the facets: a mesh of a sphere errs by their sagitta.

    Args:
        triangles: the mesh.
        step: m between two samples; None: as fine as 500 000 samples allow, 1 mm at least.

    Raises:
        ConfigError: a grid that takes more than 64 MB.
    """

    def __init__(self, triangles: Triangles, step: float | None = None) -> None:
        low, high = triangles.bounds
        size = high - low + 2.0 * MARGIN
        self.step = max((float(np.prod(size)) / _SAMPLES) ** (1.0 / 3.0), _FINEST) if step is None else step
        count = [_COARSE * math.ceil(side / (_COARSE * self.step)) + 1 for side in size.tolist()]
        if math.prod(count) > _MOST:
            raise ConfigError(
                f"surface.grid = {1e3 * self.step:g} mm gives {math.prod(count)} samples of distance, more than {_MOST}"
                f" (64 MB): take {1e3 * (float(np.prod(size)) / _MOST) ** (1 / 3) * 1.01:.2g} mm or more"
            )
        self.triangles = triangles
        self._mesh = TriangleMesh(triangles.vertices, triangles.corners)
        places = [
            start + self.step * np.arange(number) for start, number in zip((low - MARGIN).tolist(), count, strict=True)
        ]
        self._low, self._band = low - MARGIN, max(_BAND, _COARSE * self.step)
        self._values = _sampled(self._mesh, places, self._band)
        self.samples = SampledMesh(self._mesh, self._low, self.step, self._values, self._band)
        """for the contact law"""

    @property
    def memory(self) -> int:
        """bytes"""
        return self._values.nbytes

    def __getstate__(self) -> dict[str, Any]:
        """What another process needs to build the same without sampling anew; compiled objects cannot be sent."""
        return {name: value for name, value in vars(self).items() if name not in ("_mesh", "samples")}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self.__dict__.update(state)
        self._mesh = TriangleMesh(self.triangles.vertices, self.triangles.corners)
        self.samples = SampledMesh(self._mesh, self._low, self.step, self._values, self._band)

    def nearest(self, points: Array) -> tuple[Array, Array, Array]:
        """Distance (k,) m, negative inside, and place (k, 3) m and outward unit normal (k, 3) of the smoothed surface
        next to points (k, 3)."""
        return self.samples.nearest(np.ascontiguousarray(points, dtype=np.float64))


def _sampled(mesh: TriangleMesh, axes: list[Array], band: float) -> Array:
    """Distances on a grid: from the triangles within `band` m of them, farther away interpolated between every fourth
    sample."""
    coarse = [axis[::_COARSE] for axis in axes]
    rough = mesh.nearest(_nodes(coarse))[0].reshape([len(axis) for axis in coarse])
    for i, (axis, few) in enumerate(zip(axes, coarse, strict=True)):
        rough = np.apply_along_axis(partial(np.interp, axis, few), i, rough)
    nodes, values = _nodes(axes), rough.reshape(-1)
    step = float(axes[0][1] - axes[0][0])
    off = 0.5 * math.sqrt(3.0) * _COARSE * step  # what is interpolated can be wrong by: a distance has slope 1
    near = np.abs(values) < band + off
    values[near] = mesh.nearest(np.ascontiguousarray(nodes[near]))[0]
    return values.reshape(rough.shape)


def _nodes(axes: list[Array]) -> Array:
    """(k, 3) points of a grid, the last axis fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
