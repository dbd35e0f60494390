"""Workspace of a frame: targets outside are moved to its boundary, which is reported."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError
from pliant.references.trajectories.trajectory import positive, vector
from pliant.robot import Robot
from pliant.spatial import Array


@dataclass(frozen=True)
class Workspace:
    """A ball that holds every position that is allowed as a target."""

    centre: Array
    """(3,) m, world"""
    radius: float
    """m"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", vector(self.centre, "the centre of a workspace", 3))
        positive(self.radius, "the radius of a workspace", "m")

    def nearest(self, position: Array) -> Array:
        """The position (3,) m inside that is nearest to the given one; the same array if that is inside."""
        way = position - self.centre
        length = float(np.linalg.norm(way))
        return position if length <= self.radius else self.centre + way * (self.radius / length)


def workspace_of(robot: Robot, frame: str) -> Workspace:
    """The ball around the first revolute joint that a frame cannot leave, its radius is the length of the stretched
    arm.

    Args:
        robot: revolute joints in the chain to the frame.
        frame: its frame.

    Raises:
        RobotError: the robot has no such frame.
        ConfigError: the chain holds a prismatic joint, or no joint.
    """
    model, carrier = robot.model, robot.model.frames[robot.frame_id(frame)]
    chain = [index for index in model.supports[carrier.parentJoint] if index > 0]
    if not chain or any(not model.joints[index].shortname().startswith("JointModelR") for index in chain):
        raise ConfigError(f"frame {frame!r} is not carried by revolute joints alone: give a Workspace instead")
    centre, _ = robot.placement(robot.home, model.names[chain[0]])
    lengths = [float(np.linalg.norm(model.jointPlacements[index].translation)) for index in chain[1:]]
    return Workspace(centre, sum(lengths) + float(np.linalg.norm(carrier.placement.translation)))
