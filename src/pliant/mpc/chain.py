"""A robot as a serial chain for the compiled kernel."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.errors import RobotError
from pliant.rigid_body import joint_motions
from pliant.robot import Robot
from pliant.spatial import Array

_JointKind = Literal["revolute", "prismatic"]
_BRIDGE = "use the crocoddyl bridge (pliant.mpc.crocoddyl.bridge)"


def chain_from_robot(robot: Robot, frame: str, contact_frame: str | None = None) -> _mpc.Chain:
    """The robot's kinematics and inertia for the kernel.

    Args:
        robot: fixed base, every joint driven.
        frame: frame of the placement costs, on the last link.
        contact_frame: frame of the contact, on the last link; None: `frame`.

    Raises:
        RobotError: a branched robot, more than 8 joints, a frame that does not exist or is not on the last link.
    """
    model = robot.model
    check_serial(robot)
    tool = _on_last_link(robot, frame)
    contact = _on_last_link(robot, contact_frame or frame)
    axes, kinds = _joint_axes(model)
    inertias = list(model.inertias)[1:]
    placements = list(model.jointPlacements)[1:]
    return _mpc.Chain(
        rotations=np.stack([placement.rotation for placement in placements]),
        translations=np.stack([placement.translation for placement in placements]),
        joint_types=kinds,
        axes=axes,
        masses=np.array([inertia.mass for inertia in inertias]),
        coms=np.stack([inertia.lever for inertia in inertias]),
        inertias=np.stack([inertia.inertia for inertia in inertias]),
        rotor_inertia=robot.armature,
        gravity=np.array(model.gravity.linear),
        tool_rotation=tool.rotation,
        tool_translation=tool.translation,
        contact_rotation=contact.rotation,
        contact_translation=contact.translation,
    )


def check_serial(robot: Robot) -> None:
    """Raises RobotError unless the kernel can take the robot: one unbranched chain of at most 8 joints."""
    parents = [int(parent) for parent in robot.model.parents][1:]
    for joint, parent in enumerate(parents, start=1):
        if parent != joint - 1:
            names = robot.model.names
            raise RobotError(
                f"the predictive controllers' kernel takes a serial chain, but robot {robot.name!r} branches: joint"
                f" {names[joint]!r} follows {names[parent]!r}; lock the joints of the other branches, or {_BRIDGE}"
            )
    if robot.n > _mpc.MAX_JOINTS:
        raise RobotError(
            f"the predictive controllers' kernel takes 1 to {_mpc.MAX_JOINTS} joints, robot {robot.name!r} has"
            f" {robot.n}; lock some, or {_BRIDGE}"
        )


def _on_last_link(robot: Robot, name: str) -> pin.SE3:
    frame = robot.model.frames[robot.frame_id(name)]
    if frame.parentJoint != robot.n:
        carrier = robot.model.names[frame.parentJoint]
        raise RobotError(
            f"frame {name!r} must be on the last link of robot {robot.name!r} (behind joint {robot.joint_names[-1]!r}),"
            f" it is on the link of {carrier!r}"
        )
    return frame.placement


def _joint_axes(model: pin.Model) -> tuple[Array, list[_JointKind]]:
    """Axis (n, 3) of each joint in its own frame, and 'revolute' or 'prismatic'."""
    motions = joint_motions(model)
    turning = [bool(np.any(motion[3:])) for motion in motions]
    axes = np.stack([motion[3:] if turns else motion[:3] for motion, turns in zip(motions, turning, strict=True)])
    kinds: list[_JointKind] = ["revolute" if turns else "prismatic" for turns in turning]
    return axes, kinds
