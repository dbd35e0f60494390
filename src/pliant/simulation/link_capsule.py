"""A part of the robot between two frames that makes contact along its length."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pliant.errors import ConfigError


@dataclass(frozen=True)
class LinkCapsule:
    """A segment with a radius. Its contact wrench is reported at the frame where it starts.

    Raises:
        ConfigError: on construction, when the radius is not above zero or a margin is negative.
    """

    start: str
    """frame at one end; names the part"""
    end: str
    """frame at the other end, on the same body"""
    radius: float
    """m"""
    end_margin: float = 0.0
    """m left free at the end, where a contact sphere sits; without it both would push at once"""

    def __post_init__(self) -> None:
        if not (self.radius > 0.0 and self.end_margin >= 0.0):
            raise ConfigError(
                f"a link capsule needs radius > 0 and end_margin >= 0, got {self.radius:g} m and {self.end_margin:g} m"
            )

    def add_to(self, spec: mujoco.MjSpec, name: str) -> mujoco.MjsGeom:
        """Adds the invisible capsule to the body that carries both frames.

        Raises:
            ConfigError: the frames are on different bodies, or closer than the margin.
        """
        start, end = spec.site(self.start), spec.site(self.end)
        if start.parent.name != end.parent.name:
            raise ConfigError(f"a link capsule's frames must move together, got {self.start!r} and {self.end!r}")
        along = np.array(end.pos) - np.array(start.pos)
        length = float(np.linalg.norm(along))
        if length <= self.end_margin:
            raise ConfigError(
                f"link capsule {self.start!r}: end_margin must be below its length of {length:g} m, got"
                f" {self.end_margin:g} m"
            )
        tip = np.array(start.pos) + along * (1.0 - self.end_margin / length)
        geom = start.parent.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            size=[self.radius, 0.0, 0.0],
            fromto=[*start.pos, *tip],
        )
        geom.contype, geom.conaffinity, geom.mass, geom.rgba = 0, 0, 0.0, [0, 0, 0, 0]
        return geom
