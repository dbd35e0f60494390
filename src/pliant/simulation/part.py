"""A fixed workpiece with a round surface: a rod, the wall of a pipe, a dome, a bowl."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import mujoco

from pliant.errors import ConfigError
from pliant.mujoco_model import VISUAL_GROUP, quaternion
from pliant.simulation.surface import Surface
from pliant.surfaces import CylinderSurface, SphereSurface

WOOD = (0.78, 0.70, 0.60, 1.0)
_ENDLESS = 3.0  # m, half length of MuJoCo's cylinder, beyond any arm's reach; more would take the near out of pictures
_SEEN_THROUGH = 0.35  # opacity of what the tool works inside of


@dataclass(frozen=True)
class Part:
    """A cylinder or a sphere that cannot move and gives way like a spring and a damper along its normal.

    Raises:
        ConfigError: on construction, when the half length that is drawn is not above zero.
    """

    name: str
    geometry: CylinderSurface | SphereSurface
    """where its surface is; a hollow one (touched from within) needs the explicit contact law"""
    surface: Surface = field(default_factory=Surface)
    length: float = 0.25
    """m, half of what is drawn of a cylinder; the contact has no ends (MuJoCo's: none within 3 m)"""
    rgba: tuple[float, float, float, float] = WOOD

    def __post_init__(self) -> None:
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise ConfigError(f"the drawn half length of part {self.name!r} must be above zero (m), got {self.length}")

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsGeom:
        """Adds the shape that touches (invisible) and one that shows it. Returns the geom that touches."""
        round_rod = isinstance(self.geometry, CylinderSurface)
        kind = mujoco.mjtGeom.mjGEOM_CYLINDER if round_rod else mujoco.mjtGeom.mjGEOM_SPHERE
        place = {"pos": self.geometry.origin, "quat": quaternion(self.geometry.rotation)}
        radius = self.geometry.radius
        look = spec.worldbody.add_geom(type=kind, size=[radius, self.length if round_rod else 0.0, 0.0], **place)
        opacity = min(self.rgba[3], _SEEN_THROUGH) if self.geometry.hollow else self.rgba[3]
        look.contype, look.conaffinity, look.group, look.rgba = 0, 0, VISUAL_GROUP, [*self.rgba[:3], opacity]
        geom = spec.worldbody.add_geom(
            name=self.name, type=kind, size=[radius, _ENDLESS if round_rod else 0.0, 0.0], **place
        )
        geom.rgba = [0, 0, 0, 0]
        return geom
