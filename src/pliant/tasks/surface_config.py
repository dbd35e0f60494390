"""The surface of a task's path."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.surfaces import (
    CylinderSurface,
    EdgeSurface,
    HoleSurface,
    MeshSurface,
    PlaneSurface,
    SphereSurface,
    SurfaceGeometry,
)
from pliant.tasks.parts import Pose, Vector


class SurfaceConfig(Config):
    """The surface, as the controller believes it. In its own axes: z is a plane's normal and a cylinder's axis."""

    shape: Literal["plane", "cylinder", "sphere", "hole", "edge", "mesh"] = Field(
        default="plane",
        description="plane, cylinder, sphere, mesh, hole (a face with a hole along −z) or edge (along x, where the face"
        " towards −y ends)",
    )
    pose: Pose | None = Field(
        default=None, description="of its own frame in the world; none: in front of the robot, well within its reach"
    )
    tilt: float = quantity(0.0, "deg", "turned about the world's y axis where no pose is given", ge=-180.0, le=180.0)
    radius: float = quantity(0.15, "m", "of a cylinder, a sphere or a hole", gt=0.0, le=10.0)
    hollow: bool = Field(default=False, description="whether a cylinder or a sphere is touched from inside")
    depth: float = quantity(HoleSurface.depth, "m", "of a hole, from its face to its bottom", gt=0.0, le=10.0)
    chamfer: float = quantity(HoleSurface.chamfer, "m", "of a hole's mouth, bevelled by 45°", ge=0.0, le=10.0)
    angle: float = quantity(90.0, "deg", "of an edge: of the material between its two faces", ge=10.0, le=170.0)
    rounding: float = quantity(EdgeSurface.rounding, "m", "of an edge: its radius", ge=0.0, le=10.0)
    file: str | None = Field(default=None, description="of a mesh: STL, OBJ or PLY; beside the task")
    scale: float = quantity(1.0, "1", "of a mesh: m per unit of its file, 0.001 for millimetres", gt=0.0, le=1e3)
    outside: Vector | None = quantity(
        None, "1", "of a mesh that is not closed: a direction out of the material, in its own axes"
    )
    grid: float | None = quantity(
        None, "m", "of a mesh: between two samples of its distance; none: as 500 000 of them allow", gt=0.0, le=0.1
    )
    stiffness: float = quantity(2e4, "N/m", "of the contact", gt=0.0, le=1e7)
    damping: float = quantity(1e2, "N·s/m", "of the contact", ge=0.0, le=1e5)
    transition: float = quantity(
        1e-3, "m", "of depth over which the force fades in, with the explicit contact law", ge=0.0, le=0.1
    )
    friction: float = quantity(0.25, "1", "Coulomb coefficient", ge=0.0, le=5.0)

    @model_validator(mode="after")
    def _consistent(self) -> SurfaceConfig:
        if (self.shape == "mesh") != (self.file is not None):
            raise ValueError("surface.file and surface.shape = 'mesh' go together")
        if self.shape == "hole" and self.chamfer >= self.depth:
            raise ValueError(f"a hole is deeper than its bevel, got depth {self.depth:g}, chamfer {self.chamfer:g} m")
        return self

    def geometry(self, pose: Pose) -> SurfaceGeometry:
        """The surface in a pose, its own or another."""
        place = np.array(pose.xyz)
        if self.shape == "plane":
            return PlaneSurface(place, pose.rotation)
        if self.shape == "hole":
            return HoleSurface(place, pose.rotation, self.radius, self.depth, self.chamfer)
        if self.shape == "edge":
            return EdgeSurface(place, pose.rotation, math.radians(self.angle), self.rounding)
        if self.file is not None:
            return MeshSurface.read(
                self.file, place, pose.rotation, scale=self.scale, outside=self.outside, grid=self.grid
            )
        kind = CylinderSurface if self.shape == "cylinder" else SphereSurface
        return kind(place, pose.rotation, self.radius, self.hollow)
