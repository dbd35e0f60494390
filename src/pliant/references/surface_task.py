"""Phases of a task on a surface with their posture: approach, press, follow a path, release, leave.

The surface is the believed one. Contact is searched along its normal; the whole path is then shifted along the normal
to the contact point. Position, orientation, task axes and the desired force turn with the normal, in the reference and
at every node of a preview.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.phases import PhasedSource, TaskPhase
from pliant.references.postures.path_posture import PathPosture, path_posture
from pliant.references.toolpaths.pressing import Pressing, PressingForce
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.references.trajectories.rotation import Fixed
from pliant.references.trajectories.time_scaling import EaseIn
from pliant.references.trajectories.trajectory import Hold
from pliant.references.trajectories.waypoints import Waypoints
from pliant.robot import Robot
from pliant.spatial import Array

_EASE = 0.2  # s from rest to the speed of the approach
_WAIT = 0.5  # s of waiting at the end of the search


@dataclass(frozen=True)
class SurfaceTaskSettings:
    """Settings of approach and retreat, and of the posture.

    Raises:
        ConfigError: on construction, when a value is not above zero, or names are not five different ones.
    """

    stand_off: float = 0.05
    """m over the surface, where the task starts and ends"""
    approach_speed: float = 0.05
    """m/s towards the surface until contact"""
    search: float = 0.03
    """m above and below the believed surface within which contact is searched"""
    press: float = 0.5
    """s in which the first force of the path is reached"""
    release: float = 0.2
    """s in which the last force of the path goes to zero, at its last place"""
    leave: float = 0.5
    """s in which the tool is lifted at the end"""
    spins: bool = False
    """whether the rotation about the tool's own axis is free and chosen to suit the arm; else its x axis follows the
    path's heading"""
    period: float = 0.04
    """s between samples of the posture"""
    names: tuple[str, str, str, str, str] = ("approach", "press", "follow", "release", "leave")
    """of the phases"""

    def __post_init__(self) -> None:
        for name in ("stand_off", "approach_speed", "search", "press", "release", "leave", "period"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"{name} of a task on a surface must be above zero, got {value}")
        if len(set(self.names)) != 5:
            raise ConfigError(f"a task on a surface has five phases of different names, got {list(self.names)}")

    @property
    def touches(self) -> Mapping[str, bool]:
        """Name of each phase → whether the tool touches in it."""
        return dict(zip(self.names, (False, True, True, True, False), strict=True))


@dataclass(frozen=True)
class SurfaceTask:
    """A task on a surface, ready to run."""

    robot: Robot
    frame: str
    phases: tuple[TaskPhase, ...]
    posture: PathPosture
    begins: Mapping[str, float] = field(default_factory=dict[str, float])
    """phase → s at which it begins if contact is made where the surface is believed"""

    @property
    def start(self) -> Array:
        """(n,) rad, the configuration in which a run begins: over the first place of the path."""
        return self.posture.start

    @property
    def duration(self) -> float:
        """s until the tool has left, if contact is made where the surface is believed."""
        return max(self.begins.values()) + self.phases[-1].motion.duration

    @property
    def longest(self) -> float:
        """s until the tool has left at the latest; without contact a run fails earlier."""
        first = self.phases[0]
        return self.duration - self.begins[self.phases[1].name] + first.patience

    def source(self, lookahead: Lookahead | None = None) -> PhasedSource:
        """References of the task. Phases and references do not depend on the preview."""
        R = self.phases[0].rotation
        assert R is not None
        return PhasedSource(self.robot, self.frame, self.phases, R.at(0.0).rotation, lookahead, self.start)


def surface_task(
    robot: Robot,
    frame: str,
    path: Toolpath,
    force: PressingForce,
    settings: SurfaceTaskSettings | None = None,
    nominal: npt.ArrayLike | None = None,
) -> SurfaceTask:
    """The phases approach → press → follow → release → leave of a path, with a posture on one branch along all of it.

    Args:
        robot: as it is believed.
        frame: the controlled point: the middle of a tool ball that touches (`PathMotion.lift` is its radius).
        path: on the believed surface, oriented and timed. A force of its own (a column of its file) replaces `force`.
        force: along the normal.
        settings: of the other phases.
        nominal: (n,) rad, posture that the redundancy drifts to; None: the start that was found.

    Raises:
        UnreachableError: no branch leads along the whole task; with the place and size of the error.
        RobotError: a frame that the robot does not have.
    """
    chosen = settings or SurfaceTaskSettings()
    first, last = path.position.at(0.0).value, path.position.at(path.duration).value
    R_first, R_last = path.task.at(0.0).rotation, path.task.at(path.duration).rotation
    above = first + chosen.stand_off * R_first[:, 2]
    below = first - chosen.search * R_first[:, 2]
    way = (chosen.stand_off + chosen.search) / chosen.approach_speed
    descent = Waypoints([0.0, way], [above, below], "ramp").eased(_EASE)
    landing = EaseIn(_EASE).time_of(chosen.stand_off / chosen.approach_speed)
    rise = Waypoints([0.0, chosen.leave], [last, last + chosen.stand_off * R_last[:, 2]])
    posture = path_posture(robot, frame, path, descent, landing, rise, chosen.spins, chosen.period, nominal)
    pressing = path.force if path.force is not None else force.along(path)
    fading = Waypoints([0.0, chosen.release], [[float(pressing.at(path.duration).value[0])], [0.0]])
    reach = Waypoints([0.0, chosen.press], [[0.0], [float(pressing.at(0.0).value[0])]])
    at_first, at_last = Fixed(R_first), Fixed(R_last)
    axes = (at_first, at_first, path.task, at_last, at_last)
    found = zip(chosen.names, axes, posture.rotations, posture.postures, strict=True)
    approach, press, follow, release, leave = (
        partial(TaskPhase, name, axes=task, rotation=R, posture=q) for name, task, R, q in found
    )
    phases = (
        approach(descent, ends_on_contact=True, patience=descent.duration + _WAIT, within=chosen.search),
        press(Hold(first), "surface", Pressing(reach, at_first), chosen.press, touches=True),
        follow(path.position, "surface", Pressing(pressing, path.task), path.duration, touches=True),
        release(Hold(last), "surface", Pressing(fading, at_last), chosen.release, touches=True),
        leave(rise, "surface"),
    )
    begins = np.cumsum([0.0, landing, chosen.press, path.duration, chosen.release]).tolist()
    return SurfaceTask(robot, frame, phases, posture, dict(zip(chosen.names, begins, strict=True)))
