"""Triangles of a part from an STL, OBJ or PLY file, with checks of size, closure and orientation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, told
from pliant.spatial import Array, as_vector

SUFFIXES = (".stl", ".obj", ".ply")
MOST_TRIANGLES = 200_000
_LARGEST, _SMALLEST = 5.0, 2e-3  # m, of the longest side


@dataclass(frozen=True)
class Triangles:
    """A closed body, or an open shell whose outside is known."""

    vertices: Array
    """(nv, 3) m"""
    corners: npt.NDArray[np.int32]
    """(nt, 3) seen anticlockwise from outside"""
    closed: bool

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,) m of the box round it."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)


def read_mesh(path: str | Path, scale: float = 1.0, outside: npt.ArrayLike | None = None) -> Triangles:
    """Reads a part.

    Args:
        path: an STL, OBJ or PLY file.
        scale: m per unit of the file; 0.001 for millimetres.
        outside: (3,) any length, in the file's axes: out of the material, of an open shell. Its triangles are turned
            round where they look the other way, all together.

    Raises:
        ConfigError: a file that there is not or that holds no triangles, too many of them, sizes in another unit, a
            shell without `outside`, triangles that face inwards or to both sides.
    """
    file = Path(path)
    mesh = _loaded(file)
    if len(mesh.faces) > MOST_TRIANGLES:
        raise ConfigError(
            f"mesh {file.name} has {len(mesh.faces)} triangles, more than {MOST_TRIANGLES}: simplify it (20 000 show"
            " a smooth part well)"
        )
    if not (math.isfinite(scale) and scale > 0.0):
        raise ConfigError(f"the scale of mesh {file.name} must be above zero (m per unit of the file), got {scale}")
    mesh.vertices = np.asarray(mesh.vertices) * scale
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    _check_size(file, mesh, scale)
    if not mesh.is_winding_consistent:
        raise ConfigError(
            f"neighbouring triangles of mesh {file.name} have inconsistent orientation: unify the normals (and close"
            " the mesh) in the program that it comes from"
        )
    if mesh.is_watertight and mesh.volume < 0.0:
        raise ConfigError(
            f"the triangles of mesh {file.name} face inwards: flip the normals in the program that it comes from"
        )
    if not mesh.is_watertight:
        _turn_outwards(file, mesh, outside)
    return Triangles(
        np.ascontiguousarray(mesh.vertices, dtype=np.float64),
        np.ascontiguousarray(mesh.faces, dtype=np.int32),
        bool(mesh.is_watertight),
    )


def _loaded(file: Path) -> Any:
    if file.suffix.lower() not in SUFFIXES:
        raise ConfigError(f"mesh {file.name}: the file must be one of {', '.join(SUFFIXES)}")
    if not file.is_file():
        raise ConfigError(f"no mesh file {file}")
    import trimesh  # imported here because most tasks have no mesh

    try:
        mesh: Any = trimesh.load(file, force="mesh", process=True)
        triangles = len(mesh.faces)
    except Exception as error:  # any error of the reader with a damaged file
        raise ConfigError(f"mesh {file.name} cannot be read: {told(error)}") from error
    if triangles == 0 or not np.isfinite(mesh.vertices).all():
        raise ConfigError(f"mesh {file.name} has no triangles, or vertices that are not finite")
    return mesh


def _check_size(file: Path, mesh: Any, scale: float) -> None:
    if len(mesh.faces) == 0:
        raise ConfigError(f"mesh {file.name} has no triangle with an area")
    size = float(np.ptp(mesh.vertices, axis=0).max())
    if size > _LARGEST:
        raise ConfigError(
            f"mesh {file.name} is {size:.4g} m long: is it in millimetres? then set surface.scale = {1e-3 * scale:g}"
        )
    if size < _SMALLEST:
        raise ConfigError(f"mesh {file.name} is only {1e3 * size:.3g} mm long: is surface.scale = {scale:g} right?")


def _turn_outwards(file: Path, mesh: Any, outside: npt.ArrayLike | None) -> None:
    if outside is None:
        raise ConfigError(
            f"mesh {file.name} is not closed, so that it has no inside: close it, or give the direction out of the"
            " material, for example surface.outside = [0, 0, 1]"
        )
    way = as_vector(outside, 3, "surface.outside")
    looks = float(np.sum(np.asarray(mesh.face_normals) * np.asarray(mesh.area_faces)[:, None], axis=0) @ way)
    if abs(looks) < 1e-3 * float(mesh.area) * float(np.linalg.norm(way)) or not np.any(way):
        raise ConfigError(
            f"surface.outside = {way.tolist()} lies along mesh {file.name}: give a direction out of the material"
        )
    if looks < 0.0:
        mesh.invert()
