"""Shapes as meshes of the page's scene."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

from pliant.spatial import Array
from pliant.visual_shapes import Look

_GHOST = (90, 150, 210)
_GHOST_OPACITY = 0.18
_SECTIONS = 28  # round a cylinder

Mesh = tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]
"""vertices (v, 3) in m, triangles (f, 3)"""


def add_look(scene: viser.SceneApi, name: str, look: Look, ghost: bool = False) -> Any:
    """Draws one shape; as a ghost it is pale and can be seen through."""
    red, green, blue = (round(255 * channel) for channel in look.rgba[:3])
    opacity = _GHOST_OPACITY if ghost else (look.rgba[3] if look.rgba[3] < 1.0 else None)
    vertices, faces = mesh_of(look)
    return scene.add_mesh_simple(
        name,
        vertices,
        faces,
        color=_GHOST if ghost else (red, green, blue),
        opacity=opacity,
        side="double" if opacity is not None and not ghost else "front",
        flat_shading=look.kind == "box",
        cast_shadow=False,
        receive_shadow=False,
        position=look.position,
        wxyz=look.quaternion,
    )


def mesh_of(look: Look) -> Mesh:
    """Triangles of a shape, in its own axes."""
    radius, half = look.size[0], look.size[1]
    match look.kind:
        case "mesh":
            assert look.vertices is not None
            assert look.faces is not None
            return look.vertices.astype(np.float32), look.faces.astype(np.uint32)
        case "sphere":
            made = trimesh.creation.icosphere(subdivisions=2, radius=radius)
        case "cylinder":
            made = trimesh.creation.cylinder(radius=radius, height=2.0 * half, sections=_SECTIONS)
        case "capsule":
            made = trimesh.creation.capsule(height=2.0 * half, radius=radius, count=[_SECTIONS, 12])
            made.apply_translation(-made.bounds.mean(axis=0))
        case "box":
            made = trimesh.creation.box(extents=2.0 * np.array(look.size))
    return np.asarray(made.vertices, dtype=np.float32), np.asarray(made.faces, dtype=np.uint32)


def cone(height: float, radius: float) -> Mesh:
    """The surface of a cone with its tip at the origin, open upwards along z. Args: height, radius in m."""
    angles = np.linspace(0.0, 2.0 * np.pi, _SECTIONS, endpoint=False)
    rim: Array = np.stack([radius * np.cos(angles), radius * np.sin(angles), np.full(_SECTIONS, height)], axis=1)
    vertices = np.vstack([np.zeros((1, 3)), rim])
    around = np.arange(_SECTIONS)
    faces = np.stack([np.zeros(_SECTIONS), 1 + around, 1 + (around + 1) % _SECTIONS], axis=1)
    return vertices.astype(np.float32), faces.astype(np.uint32)
