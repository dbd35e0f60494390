"""A rigid tool on a robot's flange."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError


@dataclass(frozen=True)
class Tool:
    """A rigid tool on a robot's flange.

    The inertia is that of a uniform rod from the flange along its z axis; the contact frame sits at the end.
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

    def check(self) -> None:
        """Raises ConfigError for a size or mass that no rod has."""
        if not (self.length > 0.0 and self.mass >= 0.0 and self.radius > 0.0):
            raise ConfigError(f"a tool needs length > 0, mass >= 0 and radius > 0, got {self}")


def with_rod(
    visual: pin.GeometryModel | None, carrier: pin.Frame, frame: int, middle: pin.SE3, tool: Tool
) -> pin.GeometryModel | None:
    """The shapes with the rod among them; `middle` is its pose in the axes of the carrier's joint."""
    import coal

    if visual is None:
        return None
    shown = pin.GeometryModel(visual)
    # With its frame: pinocchio looks it up when joints are locked, and reads past the end without one.
    cylinder = coal.Cylinder(tool.radius, tool.length)
    rod = pin.GeometryObject(f"{tool.frame}_rod", carrier.parentJoint, frame, middle, cylinder)
    rod.meshColor = np.array([0.75, 0.77, 0.80, 1.0])
    shown.addGeometryObject(rod)
    return shown
