"""Joint torques of damping, friction and compensation, in addition to the torque that is sent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError, options
from pliant.interfaces import Compensation


@dataclass(frozen=True)
class JointEffects:
    """Torques of the joints in addition to the torque that is sent. Damping and friction are scalars or (n,)."""

    friction: float | tuple[float, ...] = 0.0
    """N·m of dry friction"""
    damping: float | tuple[float, ...] = 0.0
    """N·m s/rad"""
    compensation: Compensation = "none"
    """what the robot's own controller adds to the torque that is sent, without reporting it"""

    def __post_init__(self) -> None:
        for name in ("friction", "damping"):
            value = np.asarray(getattr(self, name))
            if not (np.isfinite(value).all() and (value >= 0.0).all()):
                raise ConfigError(f"joint {name} must not be negative, got {getattr(self, name)}")
        if self.compensation not in ("none", "gravity", "gravity+coriolis"):
            valid = options(["none", "gravity", "gravity+coriolis"], self.compensation)
            raise ConfigError(f"unknown compensation {self.compensation!r}; {valid}")
