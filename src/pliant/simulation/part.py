"""A fixed workpiece: a rod, the wall of a pipe, a dome, a bowl, a plate with a hole, an edge, or a part given by
triangles."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np

from pliant._contact import SampledMesh, Solid
from pliant.errors import ConfigError
from pliant.mujoco_model import VISUAL_GROUP
from pliant.simulation.part_looks import Integers, edge_triangles, hole_triangles
from pliant.simulation.surface import Surface
from pliant.spatial import Array, quaternion
from pliant.surfaces import CylinderSurface, EdgeSurface, HoleSurface, MeshSurface, SphereSurface

WOOD = (0.78, 0.70, 0.60, 1.0)
# m, half length of MuJoCo's cylinder, longer than an arm's reach; with more, near objects would be clipped in pictures
_ENDLESS = 3.0
_FRAME = 1e-3  # m, radius of the ball that carries a mesh's frame; it is not seen and does not touch
_SEEN_THROUGH = 0.35  # opacity of a part with the tool inside


@dataclass(frozen=True)
class Part:
    """A cylinder, a sphere, a hole, an edge or a mesh that cannot move and gives way like a spring and a damper along
    its normal.

    Raises:
        ConfigError: on construction, when the half length that is drawn is not above zero.
    """

    name: str
    geometry: CylinderSurface | SphereSurface | MeshSurface | HoleSurface | EdgeSurface
    """its surface; a hollow one (touched from within), a hole, an edge and a mesh need the explicit law"""
    surface: Surface = field(default_factory=Surface)
    length: float = 0.25
    """m, half of what is drawn of a cylinder, an edge or the face round a hole; the contact has no ends (MuJoCo's: none
    within 3 m)"""
    rgba: tuple[float, float, float, float] = WOOD

    def __post_init__(self) -> None:
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise ConfigError(f"the drawn half length of part {self.name!r} must be above zero (m), got {self.length}")

    @property
    def hollow(self) -> bool:
        """Whether it is a round part that is touched from within."""
        return isinstance(self.geometry, CylinderSurface | SphereSurface) and self.geometry.hollow

    @property
    def form(self) -> SampledMesh | Solid | None:
        """Its surface, in its axes, if MuJoCo does not have that shape."""
        if isinstance(self.geometry, MeshSurface):
            return self.geometry.distance.samples
        return self.geometry.solid if isinstance(self.geometry, HoleSurface | EdgeSurface) else None

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsGeom:
        """Adds the contact shape (invisible) and a visual shape. Returns the contact geom."""
        place = {"pos": self.geometry.origin, "quat": quaternion(self.geometry.rotation)}
        if not isinstance(self.geometry, CylinderSurface | SphereSurface):
            look = _mesh_look(spec, self.name, *_triangles(self.geometry, self.length), place)
            touching = spec.worldbody.add_geom(
                name=self.name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[_FRAME, 0.0, 0.0], **place
            )
            opacity = self.rgba[3]
        else:
            look, touching = self._round(spec, self.geometry, place)
            opacity = min(self.rgba[3], _SEEN_THROUGH) if self.geometry.hollow else self.rgba[3]
        look.contype, look.conaffinity, look.group, look.rgba = 0, 0, VISUAL_GROUP, [*self.rgba[:3], opacity]
        touching.rgba = [0, 0, 0, 0]
        return touching

    def _round(
        self, spec: mujoco.MjSpec, geometry: CylinderSurface | SphereSurface, place: dict[str, Any]
    ) -> tuple[mujoco.MjsGeom, mujoco.MjsGeom]:
        """The visual shape and the contact shape."""
        rod = isinstance(geometry, CylinderSurface)
        kind = mujoco.mjtGeom.mjGEOM_CYLINDER if rod else mujoco.mjtGeom.mjGEOM_SPHERE
        look = spec.worldbody.add_geom(type=kind, size=[geometry.radius, self.length if rod else 0.0, 0.0], **place)
        size = [geometry.radius, _ENDLESS if rod else 0.0, 0.0]
        return look, spec.worldbody.add_geom(name=self.name, type=kind, size=size, **place)


def _triangles(geometry: MeshSurface | HoleSurface | EdgeSurface, length: float) -> tuple[Array, Integers]:
    """Vertices (nv, 3) m in the part's axes, and triangles (nt, 3). Args: length: m, half of it."""
    if isinstance(geometry, MeshSurface):
        return geometry.distance.triangles.vertices, geometry.distance.triangles.corners
    return hole_triangles(geometry, length) if isinstance(geometry, HoleSurface) else edge_triangles(geometry, length)


def _mesh_look(
    spec: mujoco.MjSpec, name: str, vertices: Array, corners: Integers, place: dict[str, Any]
) -> mujoco.MjsGeom:
    mesh = spec.add_mesh(
        name=f"{name}/mesh",
        uservert=vertices.astype(np.float32).ravel(),
        userface=corners.ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,  # open shells have no volume
    )
    return spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name, **place)
