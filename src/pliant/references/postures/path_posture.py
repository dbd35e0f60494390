"""The joint path of a tool path, including approach and retreat, on one branch."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.references.postures.posture import PostureOptions, PosturePath, solve_posture
from pliant.references.source import FrameMotion
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.references.trajectories.excerpt import Excerpt, TurningExcerpt
from pliant.references.trajectories.rotation import QuaternionSpline, Turning
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.trajectory import Trajectory
from pliant.robot import Robot
from pliant.spatial import Array, quaternions


@dataclass(frozen=True)
class PathPosture:
    """Posture and orientation of the five phases of a task on a surface, each with the time of its phase."""

    solved: PosturePath
    """of the whole: down to the believed surface, along the path, away from it"""
    postures: tuple[Trajectory, Trajectory, Trajectory, Trajectory, Trajectory]
    """(n,) rad: approach, press, follow, release, leave"""
    rotations: tuple[Turning, Turning, Turning, Turning, Turning]
    """R_world_frame"""

    @property
    def start(self) -> Array:
        """(n,) rad."""
        return self.solved.postures[0]


def path_posture(
    robot: Robot,
    frame: str,
    path: Toolpath,
    descent: Trajectory,
    landing: float,
    rise: Trajectory,
    spins: bool,
    period: float,
    nominal: npt.ArrayLike | None,
) -> PathPosture:
    """Solves the posture along descent, path and retreat, one after the other.

    Args:
        robot: the arm.
        frame: that follows.
        path: what it follows.
        descent: (3,) m, ends at the path's first place at the time `landing`.
        landing: s.
        rise: (3,) m, begins at the path's last place.
        spins: whether the frame may turn about its own z axis.
        period: s between samples.
        nominal: (n,) rad, see `solve_posture`.

    Raises:
        UnreachableError: no branch leads along all of it.
    """
    ends = np.cumsum([0.0, landing, path.duration, rise.duration]).tolist()
    motion = _joined(frame, path, descent, rise, ends, period)
    solved = solve_posture(robot, motion, ends[-1], nominal, PostureOptions(period=period, spins=spins))
    whole = Spline(solved.times, solved.postures)
    _, landed, end, gone = ends
    spans = ((0.0, landed), (landed, landed), (landed, end), (end, end), (end, gone))
    postures = tuple(Excerpt(whole, *span) for span in spans)
    if spins:
        turning: Turning = _as_solved(robot, frame, solved)
        rotations = tuple(TurningExcerpt(turning, *span) for span in spans)
    else:
        T = path.duration
        rotations = tuple(TurningExcerpt(path.rotation, *span) for span in ((0, 0), (0, 0), (0, T), (T, T), (T, T)))
    return PathPosture(solved, postures, rotations)  # pyright: ignore[reportArgumentType]  # five of each


def _instants(seconds: float, period: float) -> Array:
    return np.linspace(0.0, seconds, max(math.ceil(seconds / period), 2) + 1)


def _joined(
    frame: str, path: Toolpath, descent: Trajectory, rise: Trajectory, ends: list[float], period: float
) -> FrameMotion:
    """The three motions, one after the other, as one; the tool turns on the path only."""
    times, places, turns = [np.zeros(1)], [descent.at(0.0).value[None]], [path.rotation.at(0.0).rotation]
    for part, start, end in zip((descent, path.position, rise), ends[:-1], ends[1:], strict=True):
        grid = _instants(end - start, period)[1:]
        times.append(start + grid)
        places.append(np.array([part.at(time).value for time in grid.tolist()]))
        on_path = np.clip(start + grid - ends[1], 0.0, path.duration).tolist()
        turns += [path.rotation.at(time).rotation for time in on_path]
    instants = np.concatenate(times)
    attitudes = quaternions(np.array(turns))
    return FrameMotion(frame, Spline(instants, np.vstack(places)), QuaternionSpline(instants, attitudes))


def _as_solved(robot: Robot, frame: str, solved: PosturePath) -> QuaternionSpline:
    """The frame's orientation along a joint path."""
    data, index = robot.model.createData(), robot.frame_id(frame)
    rotations = np.empty((len(solved.times), 3, 3))
    for row, q in enumerate(solved.postures):
        pin.framesForwardKinematics(robot.model, data, q)
        rotations[row] = data.oMf[index].rotation
    return QuaternionSpline(solved.times, quaternions(rotations))
