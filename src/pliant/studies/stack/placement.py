"""Where the paths of [Stack] lie for a robot of another size, and what its tool does there.

The paper's lengths are those of an arm of 0.868 m. They are multiplied by the robot's reach over 0.868 m, seen from the
robot's shoulder; an arm of just that size gets the path as printed, or is refused. Another one that cannot follow the
path there gets it centred at its tool at home, in the plane across the tool's z axis, as large, half as large or a
quarter as large: the first that it can follow.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import RobotError
from pliant.references.postures.posture import PostureOptions, UnreachableError
from pliant.references.postures.posture_source import PostureSource, posture_source
from pliant.references.source import FrameMotion
from pliant.references.trajectories.shapes import lemniscate, sine_line
from pliant.references.trajectories.trajectory import Hold
from pliant.robot import Robot
from pliant.robots.chain import Arm, arm_of
from pliant.spatial import Array, frame_with_z_along
from pliant.studies.stack.config import StackPath
from pliant.studies.stack.paper_task import CENTRE, FIGURE8, NOMINAL, STRAIGHT, STRETCH, Z_AXIS

_REACH = 0.868  # m from the shoulder to the flange of the paper's arm
_SHOULDER = np.array([0.0, 0.0, 0.31])  # m
_SMALLER = (1.0, 0.5, 0.25)


@dataclass(frozen=True)
class Placement:
    """From the paper's coordinates to the robot's: p = R (scale p_paper) + offset."""

    scale: float
    axes: Array
    """R (3, 3): its columns are where the paper's x (across), y (towards the base) and z (up) point"""
    offset: Array
    """(3,) m"""
    rotation: Array
    """R_world_tool (3, 3) of the tool throughout"""
    nominal: Array | None
    """(n,) rad, where the posture drifts to"""
    told: str = ""
    """the rule as it was applied; empty where everything is as printed"""

    def point(self, printed: Array) -> Array:
        """Where a point (3,) of the paper lies, m."""
        return self.axes @ (self.scale * printed) + self.offset

    @property
    def printed(self) -> bool:
        """Whether the arm is of the paper's size and the path where the paper has it."""
        return not self.told

    @property
    def centre(self) -> Array:
        """(3,) m, middle of the figure-8 and of the line."""
        return self.point(CENTRE)


def placed(robot: Robot, path: StackPath, frames: tuple[str, str], duration: float) -> tuple[Placement, PostureSource]:
    """The path where the robot can follow it, and the posture along it.

    Args:
        robot: a serial arm.
        path: what its tool does.
        frames: tool and elbow.
        duration: s.

    Raises:
        UnreachableError: the robot can follow it nowhere.
        RobotError: it has no arm, or not the frames.
    """
    beyond_reach = path.kind == "stretch"
    options = PostureOptions(
        method=path.method,
        tolerance=np.inf if beyond_reach else 1e-3,
        repeats=path.period if path.kind == "figure8" else 0.0,
    )
    complaint: UnreachableError | None = None
    arm = _arm(robot)
    for frame in frames:
        robot.frame_id(frame)
    for place in _candidates(robot, arm, frames[0]):
        try:
            moved = motion(path, frames[0], place)
            return place, posture_source(robot, moved, [frames[1]], duration, place.nominal, options)
        except UnreachableError as error:
            if place.printed:
                raise
            complaint = error
    raise UnreachableError(
        f"robot {robot.name!r} cannot follow the path {path.kind!r}, neither at the paper's place in front of its"
        f" shoulder nor at its home down to a quarter of the size: {complaint}; choose a longer path.period,"
        " path.kind=hold, another home, or an arm with six joints or more"
    ) from complaint


def motion(path: StackPath, frame: str, place: Placement) -> FrameMotion:
    """What the tool does."""
    across, up, scale = place.axes[:, 0], place.axes[:, 2], place.scale
    if path.kind == "figure8":
        wide, high = (scale * size for size in FIGURE8.size)
        position = lemniscate(path.period, place.centre, wide, high, across, up)
    elif path.kind == "line":
        position = sine_line(scale * path.amplitude, scale * path.peak_speed, place.centre, across)
    elif path.kind == "stretch":
        length, speed = scale * STRETCH.size[0], scale * STRETCH.peak_speed
        position = sine_line(length, speed, place.point(STRAIGHT), -place.axes[:, 1])
    else:
        position = Hold(place.centre)
    return FrameMotion(frame, position, place.rotation).eased(path.ramp)


def _arm(robot: Robot) -> Arm:
    arm = arm_of(robot.model)
    if arm is None:
        raise RobotError(
            f"robot {robot.name!r} has no arm: it forks at its base; this task needs a serial arm, lock the joints of"
            " the other branches"
        )
    return arm


def _candidates(robot: Robot, arm: Arm, tool: str) -> Generator[Placement]:
    scale = round(arm.reach / _REACH, 6)
    yield _in_front(robot, arm.joints[1], scale)
    for share in _SMALLER:
        yield _at_home(robot, tool, share * scale)


def _in_front(robot: Robot, second_joint: int, scale: float) -> Placement:
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.home)
    shoulder = np.array(data.oMi[second_joint].translation)
    offset = np.round(shoulder - scale * _SHOULDER, 9) + 0.0
    nominal = NOMINAL if robot.n == len(NOMINAL) else None
    as_printed = scale == 1.0 and not offset.any()
    told = (
        f"the paper's path is scaled by {scale:.3f} (the robot's reach over {_REACH} m), seen from the shoulder at"
        f" {_written(shoulder)} m"
    )
    R = frame_with_z_along(Z_AXIS)
    return Placement(scale, np.eye(3), offset, R, nominal, "" if as_printed else told)


def _at_home(robot: Robot, tool: str, scale: float) -> Placement:
    position, rotation = robot.placement(robot.home, tool)
    z = rotation[:, 2]
    wanted = np.array([0.0, 0.0, 1.0])
    if abs(z @ wanted) > 0.9:  # the tool points up or down: the path lies flat, its z axis away from the base
        wanted = np.array([position[0], position[1], 0.0]) if np.hypot(*position[:2]) > 1e-3 else rotation[:, 0]
    up = wanted - (wanted @ z) * z
    up /= np.linalg.norm(up)
    axes = np.column_stack([np.cross(-z, up), -z, up])
    told = (
        f"the arm cannot follow the path in front of its shoulder: it is scaled by {scale:.3f}, centred at its tool at"
        f" home, {_written(position)} m, and lies across the tool's z axis"
    )
    return Placement(scale, axes, position - axes @ (scale * CENTRE), rotation, robot.home, told)


def _written(point: Array) -> str:
    return "(" + ", ".join(f"{x:.3f}" for x in point) + ")"
