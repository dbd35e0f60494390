"""The motion that a phase with tracks gives its first frame, and the posture along it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from pliant.errors import ConfigError
from pliant.references.postures.posture import PostureOptions, UnreachableError
from pliant.references.postures.posture_source import PostureSource, posture_source
from pliant.references.source import FrameMotion
from pliant.references.trajectories.trajectory import Hold, Trajectory
from pliant.robot import Robot
from pliant.spatial import Array, frame_with_z_along, unit
from pliant.studies.task.config import TaskCase
from pliant.studies.task.curves import curve_of
from pliant.studies.task.listed import robot_of_list, tracks_of
from pliant.tasks.phase import Track


def tracked_motion(case: TaskCase) -> PostureSource:
    """The motion of the first frame with the posture along it; found once for all runs of it.

    Raises:
        PliantError: a frame that there is not, a motion out of reach, or tracks that are not one motion.
    """
    tracks_of(case)
    parts = {"case", "robot", "locked", "tool", "moves", "phase"}
    return _solved(
        case.model_copy(update={"controller": "", "case": ""}).model_dump_json(include={*parts, "controller"})
    )


@lru_cache(maxsize=8)
def _solved(text: str) -> PostureSource:
    case = TaskCase.model_validate_json(text)
    arm, (one,) = robot_of_list(case), case.phase
    frames = list(one.tracks)
    first, *others = (one.tracks[frame] for frame in frames)
    if not isinstance(first, Track) or any(isinstance(other, Track) for other in others):
        raise ConfigError(
            "tracks: the first frame has a motion, and the others are 'posture', since one posture goes with one"
            f" motion; got {frames}"
        )
    for frame in frames:
        arm.frame_id(frame)
    position, rotation = _motion(first, arm, frames[0])
    motion = FrameMotion(frames[0], position, rotation).eased(first.ramp)
    nominal = None if first.nominal is None else arm.vector(np.radians(first.nominal), "nominal")
    options = PostureOptions(tolerance=np.inf if first.beyond_reach else 1e-3)
    try:
        return posture_source(arm, motion, frames[1:], one.longest, nominal, options)
    except UnreachableError as error:
        remedy = f"move the track of {frames[0]!r} by `at`, make it smaller by `size`, or say beyond_reach = true"
        raise UnreachableError(f"{error}; {remedy}", error.time, error.place) from None


def _motion(track: Track, robot: Robot, frame: str) -> tuple[Trajectory, Array]:
    """Position over time, and R_world_frame that is held."""
    home, turned = robot.placement(robot.home, frame)
    rotation = turned if track.z_axis is None else frame_with_z_along(track.z_axis)
    z = rotation[:, 2]
    level = np.array([0.0, 0.0, 1.0]) if abs(z[2]) <= 0.9 else rotation[:, 0]
    up = level - (level @ z) * z if track.up is None else np.array(track.up)
    across = np.cross(up, z) if track.across is None else np.array(track.across)
    centre = home if track.at is None else np.array(track.at)
    if track.shape == "hold":
        return Hold(centre), rotation
    begin = centre - track.size[0] * unit(across, "across") if track.shape == "circle" else centre
    return curve_of(track.shape, track, begin, across, up), rotation
