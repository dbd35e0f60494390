"""Scene around the robot: surfaces and bodies with stiffness and damping in physical units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import mujoco
import numpy as np

from pliant._contact import SampledMesh, Solid
from pliant.errors import ConfigError, options
from pliant.mujoco_model import VISUAL_GROUP
from pliant.simulation.part import WOOD, Part
from pliant.simulation.surface import Surface
from pliant.spatial import Array, frame_with_z_along, quaternion, rpy
from pliant.surfaces import (
    CylinderSurface,
    EdgeSurface,
    HoleSurface,
    MeshSurface,
    PlaneSurface,
    SphereSurface,
    SurfaceGeometry,
)


@dataclass(frozen=True)
class Plane:
    """A half-space: floor, table or wall."""

    name: str
    point: tuple[float, float, float]
    """m, a point of the surface"""
    normal: tuple[float, float, float]
    """pointing out of the material"""
    surface: Surface = field(default_factory=Surface)
    extent: tuple[float, float] = (1.0, 1.0)
    """m, half sizes of the part that is drawn"""
    rgba: tuple[float, float, float, float] = (0.80, 0.82, 0.85, 1.0)

    @property
    def geometry(self) -> PlaneSurface:
        """Where its surface is."""
        return PlaneSurface.facing(self.normal, self.point)

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsGeom:
        """Adds the half-space (invisible) and a thin visual plate. Returns the contact geom."""
        R = frame_with_z_along(self.normal)
        position = np.array(self.point)
        plate = spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[*self.extent, 0.005],
            pos=position - 0.005 * R[:, 2],
            quat=quaternion(R),
            rgba=list(self.rgba),
        )
        plate.contype, plate.conaffinity, plate.group = 0, 0, VISUAL_GROUP
        geom = spec.worldbody.add_geom(
            name=self.name, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=position, quat=quaternion(R)
        )
        geom.rgba = [0, 0, 0, 0]
        return geom


@dataclass(frozen=True)
class Box:
    """A box, movable or fixed (mass 0)."""

    name: str
    size: tuple[float, float, float]
    """m, full edge lengths"""
    position: tuple[float, float, float]
    """m, of its centre"""
    mass: float = 1.0
    """kg; 0: fixed to the world"""
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """roll, pitch, yaw in rad"""
    surface: Surface = field(default_factory=Surface)
    rgba: tuple[float, float, float, float] = (0.55, 0.70, 0.86, 1.0)

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsGeom:
        """Adds the body. Returns the geom that touches."""
        body = _add_free_body(spec, self.name, self.position, rpy(*self.rotation), self.mass)
        return body.add_geom(
            name=self.name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.5 * edge for edge in self.size],
            mass=self.mass,
            rgba=list(self.rgba),
        )


@dataclass(frozen=True)
class Ball:
    """A soft ball, movable or fixed (mass 0)."""

    name: str
    radius: float
    """m"""
    position: tuple[float, float, float]
    """m, of its centre"""
    mass: float = 0.5
    """kg; 0: fixed to the world"""
    surface: Surface = field(default_factory=lambda: Surface(stiffness=1e3, damping=1e2))
    rgba: tuple[float, float, float, float] = (0.86, 0.47, 0.45, 0.9)

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsGeom:
        """Adds the body. Returns the geom that touches."""
        body = _add_free_body(spec, self.name, self.position, np.eye(3), self.mass)
        return body.add_geom(
            name=self.name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[self.radius, 0.0, 0.0],
            mass=self.mass,
            rgba=list(self.rgba),
        )


Thing = Plane | Part | Box | Ball


@dataclass(frozen=True)
class Scene:
    """The things around the robot, and the contact law.

    Raises:
        ConfigError: on construction, when two things share a name, the law is unknown, or it does not support a hollow
            part or a mesh.
    """

    things: tuple[Thing, ...] = ()
    contact: Literal["mujoco", "explicit"] = "mujoco"
    """"mujoco": its soft constraints, given the stiffness exactly; "explicit": a force law with stiction, for stiff
    contacts"""

    def __post_init__(self) -> None:
        names = [thing.name for thing in self.things]
        if len(set(names)) < len(names):
            raise ConfigError(f"the things of a scene need different names, got {names}")
        if self.contact not in ("mujoco", "explicit"):
            raise ConfigError(f"unknown contact law {self.contact!r}; {options(['mujoco', 'explicit'], self.contact)}")
        if self.hollow and self.contact == "mujoco":
            raise ConfigError(
                f"part {min(self.hollow)!r} is hollow, which MuJoCo's contacts cannot be: set contact = 'explicit'"
            )
        changing = [thing for thing in self.things if thing.surface.change is not None]
        if changing and self.contact == "mujoco":
            raise ConfigError(
                f"the stiffness of {changing[0].name!r} changes along a line, which that of MuJoCo's contacts cannot:"
                " set contact = 'explicit'"
            )
        if any(not isinstance(thing, Plane | Part) and thing.mass > 0.0 for thing in changing):
            raise ConfigError(f"{changing[0].name!r} can move: its stiffness cannot change along a line in the world")
        if self.forms and self.contact == "mujoco":
            raise ConfigError(
                f"part {min(self.forms)!r} is a mesh, a hole or an edge; MuJoCo's contacts know the convex hull of a"
                " mesh only: set contact = 'explicit'"
            )

    @property
    def hollow(self) -> frozenset[str]:
        """Names of the parts that are touched from within."""
        return frozenset(thing.name for thing in self.things if isinstance(thing, Part) and thing.hollow)

    @property
    def forms(self) -> Mapping[str, SampledMesh | Solid]:
        """Name of each part with a shape that MuJoCo does not have → its surface."""
        parts = [(thing.name, thing.form) for thing in self.things if isinstance(thing, Part)]
        return {name: form for name, form in parts if form is not None}

    @property
    def faces(self) -> tuple[Plane | Part, ...]:
        """The things that cannot move and whose whole surface has a closed form."""
        return tuple(thing for thing in self.things if isinstance(thing, Plane | Part))


def fixed_part(
    name: str,
    geometry: SurfaceGeometry,
    surface: Surface | None = None,
    extent: tuple[float, float] = (0.25, 0.25),
) -> Plane | Part:
    """The thing of a scene whose surface is a given one.

    Args:
        name: of the thing.
        geometry: a plane, cylinder, sphere, hole, edge or mesh.
        surface: contact properties; None: the defaults of `Surface`.
        extent: m, half sizes of the part of a plane that is drawn; of other parts the first one is `Part.length`.

    Raises:
        ConfigError: another kind of surface.
    """
    match geometry:
        case PlaneSurface():
            x, y, z = geometry.origin.tolist()
            n_x, n_y, n_z = geometry.rotation[:, 2].tolist()
            return Plane(name, (x, y, z), (n_x, n_y, n_z), surface or Surface(), extent, WOOD)
        case CylinderSurface() | SphereSurface() | MeshSurface() | HoleSurface() | EdgeSurface():
            return Part(name, geometry, surface or Surface(), extent[0])
        case _:
            raise ConfigError(
                f"no contact law for a {type(geometry).__name__}; valid: plane, cylinder, sphere, hole, edge, mesh"
            )


def floor(height: float = 0.0, surface: Surface | None = None) -> Plane:
    """A horizontal floor at a height in m."""
    return Plane(
        "floor", (0.0, 0.0, height), (0.0, 0.0, 1.0), surface or Surface(), (1.5, 1.5), (0.86, 0.87, 0.88, 1.0)
    )


def table(point: tuple[float, float, float], tilt: float = 0.0, surface: Surface | None = None) -> Plane:
    """A table top through a point in m, tilted about the world's x axis by an angle in rad."""
    normal = (0.0, -math.sin(tilt), math.cos(tilt))
    return Plane("table", point, normal, surface or Surface(), (0.25, 0.25), WOOD)


def wall(
    point: tuple[float, float, float],
    normal: tuple[float, float, float] = (-1.0, 0.0, 0.0),
    surface: Surface | None = None,
) -> Plane:
    """A wall through a point in m; `normal` points out of it, towards the robot."""
    return Plane("wall", point, normal, surface or Surface(), (0.35, 0.35), (0.60, 0.68, 0.74, 0.55))


def _add_free_body(
    spec: mujoco.MjSpec, name: str, position: tuple[float, float, float], R: Array, mass: float
) -> mujoco.MjsBody:
    body = spec.worldbody.add_body(name=name, pos=list(position), quat=quaternion(R))
    if mass > 0.0:
        body.add_freejoint(name=name)
    return body
