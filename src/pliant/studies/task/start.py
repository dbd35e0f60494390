"""Where a list of phases starts."""

from __future__ import annotations

import numpy as np

from pliant.errors import ConfigError
from pliant.references.postures.inverse_kinematics import Target, joint_box
from pliant.references.postures.posture import mink_solver
from pliant.robot import Robot
from pliant.spatial import Array
from pliant.tasks.parts import Pose


def start_of(robot: Robot, frame: str, start: tuple[float, ...] | Pose | None) -> Array:
    """(n,) rad.

    Args:
        robot: whose home is the start where nothing is said, and where a pose is looked for from.
        frame: that takes the pose.
        start: joints in degrees, or a pose.

    Raises:
        ConfigError: the robot cannot take the pose.
        RobotError: another number of joints.
    """
    if start is None:
        return robot.home
    if not isinstance(start, Pose):
        return robot.vector(np.radians(start), "start")
    solver, target = mink_solver(robot, frame), Target(np.array(start.xyz), start.rotation)
    q = solver.solve(robot.home, robot.home, joint_box(robot), target)
    distance, angle = solver.shortfall(q, target)
    if distance > 1e-3 or angle > 1e-2:
        raise ConfigError(
            f"robot {robot.name!r} cannot start with frame {frame!r} at {np.round(start.xyz, 3).tolist()} m, turned by"
            f" {list(start.rpy)} degrees: it misses by {1e3 * distance:.1f} mm and {angle:.2f} rad: give"
            " another start.xyz or start.rpy, or joints in its place"
        )
    return q
