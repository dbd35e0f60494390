"""One phase of a task, as data."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from pliant.axis_modes import AxisModes
from pliant.errors import ConfigError, ShapeError
from pliant.references.trajectories.rotation import Turning
from pliant.references.trajectories.trajectory import Trajectory

Anchor = Literal["world", "begin", "touch", "surface"]


@dataclass(frozen=True)
class TaskPhase:
    """One phase of a task. Its trajectories count time from the start of the phase."""

    name: str
    motion: Trajectory
    """(3,) m, relative to `anchor`"""
    anchor: Anchor = "world"
    """"world": absolute; "begin": from where the reference was when the phase began; "touch": from where the frame was
    when the last phase in which `touches` is new began; "surface": absolute, but lifted along the normal of `axes` by
    as much as contact was then found above where this phase begins"""
    wrench: Trajectory | None = None
    """(6,) desired reaction of the environment, N and N·m; None for zero"""
    duration: float = math.inf
    """s"""
    ends_on_contact: bool = False
    """the phase lasts until the estimate says that the frame touches, whatever its duration"""
    touches: bool = False
    """the frame is in contact in this phase"""
    rotation: Turning | None = None
    """R_world_frame; None: that of the source"""
    axes: Turning | None = None
    """R_world_task, whose third column is the surface's outward normal; None: the world's axes"""
    posture: Trajectory | None = None
    """(n,) rad, posture; None: that of the source"""
    patience: float = math.inf
    """s, timeout of a phase that ends on contact; the run then fails"""
    modes: AxisModes | None = None
    """of each axis; None: force along what the wrench presses, motion elsewhere"""
    within: float = math.inf
    """m, largest distance along the normal between contact and the believed surface, if the next phase is anchored to
    the surface"""

    def __post_init__(self) -> None:
        if self.motion.size != 3:
            raise ShapeError(f"the motion of phase {self.name!r} must have 3 entries, got {self.motion.size}")
        if self.wrench is not None and self.wrench.size != 6:
            raise ShapeError(f"the wrench of phase {self.name!r} must have 6 entries, got {self.wrench.size}")
        if not self.duration > 0.0:
            raise ConfigError(f"the duration of phase {self.name!r} must be above zero, got {self.duration}")
        if self.anchor == "surface" and self.axes is None:
            raise ConfigError(f"phase {self.name!r} is anchored to a surface: give its axes")
