"""A rigid tool on a robot's flange."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, options

ToolShape = Literal["sphere", "cylinder", "box"]


@dataclass(frozen=True)
class ToolBody:
    """Contact shape of a tool that is not a sphere: a cylinder or a box behind its frame, whose z axis points out of
    its end face."""

    shape: Literal["cylinder", "box"]
    half: tuple[float, float, float]
    """m, half sizes along x, y and z; of a cylinder its radius twice and half its length"""


@dataclass(frozen=True)
class Tool:
    """A rigid tool on a robot's flange.

    The inertia is that of a uniform body from the flange along its z axis, a rod or, of a box, a block; the contact
    frame sits at the end.
    """

    length: float = 0.20
    """m along the flange's z axis to the contact frame"""
    mass: float = 0.4
    """kg"""
    radius: float = 0.02
    """m of the rod"""
    parent: str = "flange"
    """frame that carries the tool"""
    frame: str = "tool"
    """name of the new contact frame, axes parallel to the parent's"""
    shape: ToolShape = "sphere"
    """contact shape: a sphere of that radius about the frame, the rod itself, or a block"""
    edges: tuple[float, float] = (0.04, 0.04)
    """m of the end face of a box, along the flange's x and y axes"""
    ball: float | None = None
    """m, radius of the spherical tip; None: that of the rod"""

    def check(self) -> None:
        """Raises ConfigError for an unknown shape, or an impossible size or mass."""
        if self.shape not in get_args(ToolShape):
            raise ConfigError(f"unknown shape of a tool {self.shape!r}; {options(get_args(ToolShape), self.shape)}")
        if (
            not (self.length > 0.0 and self.mass >= 0.0 and self.radius > 0.0 and min(self.edges) > 0.0)
            or self.ball == 0.0
        ):
            raise ConfigError(f"a tool needs length > 0, mass >= 0, radius > 0 and edges > 0, got {self}")

    @property
    def body(self) -> ToolBody | None:
        """The contact shape; None: a sphere."""
        half = 0.5 * self.length
        if self.shape == "cylinder":
            return ToolBody("cylinder", (self.radius, self.radius, half))
        return ToolBody("box", (0.5 * self.edges[0], 0.5 * self.edges[1], half)) if self.shape == "box" else None

    @property
    def reach(self) -> float:
        """m from the frame to the contact, for a tool upright on a face."""
        if self.shape != "sphere":
            return 0.0
        return self.radius if self.ball is None else self.ball

    @property
    def inertia(self) -> pin.Inertia:
        """About the tool's middle, its axes parallel to the flange's."""
        if self.shape == "box":
            return pin.Inertia.FromBox(self.mass, *self.edges, self.length)
        return pin.Inertia.FromCylinder(self.mass, self.radius, self.length)


def with_rod(
    visual: pin.GeometryModel | None, carrier: pin.Frame, frame: int, middle: pin.SE3, tool: Tool
) -> pin.GeometryModel | None:
    """The shapes with the rod among them; `middle` is its pose in the axes of the carrier's joint."""
    import coal

    if visual is None:
        return None
    shown = pin.GeometryModel(visual)
    # With its frame: pinocchio looks it up when joints are locked, and reads past the end of an array without one.
    shape = coal.Box(*tool.edges, tool.length) if tool.shape == "box" else coal.Cylinder(tool.radius, tool.length)
    rod = pin.GeometryObject(f"{tool.frame}_rod", carrier.parentJoint, frame, middle, shape)
    rod.meshColor = np.array([0.75, 0.77, 0.80, 1.0])
    shown.addGeometryObject(rod)
    return shown
