"""Common problem and interface of the inverse-kinematics methods.

For a pose (p, R) of one frame: the configuration nearest to a preferred one among those that reach the pose,

    min_q  ‖x(q) ⊖ (p, R)‖² + c² ‖q − q_prior‖²      subject to  lower ≤ q ≤ upper,

errors in m and rad. c is so small that the pose has priority; it determines the redundancy.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from pliant.robot import Robot
from pliant.spatial import Array, log3


class Target(NamedTuple):
    """A pose to reach."""

    position: Array
    """(3,) m"""
    rotation: Array | None
    """R_world_frame (3, 3); None leaves the orientation free"""
    spins: bool = False
    """whether the rotation about the frame's own z axis is free"""

    def nearest(self, R: Array) -> Target:
        """The same target, turned about its own z axis, if that is free, as near as possible to R (3, 3)."""
        if self.rotation is None or not self.spins:
            return self
        relative = self.rotation.T @ R
        angle = math.atan2(relative[1, 0] - relative[0, 1], relative[0, 0] + relative[1, 1])
        c, s = math.cos(angle), math.sin(angle)
        return Target(self.position, self.rotation @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), True)


class JointBox(NamedTuple):
    """Range of configurations that are allowed."""

    lower: Array
    """(n,) rad"""
    upper: Array
    """(n,) rad"""

    def clip(self, q: Array) -> Array:
        return np.clip(q, self.lower, self.upper)


class PoseSolver(ABC):
    """Solves for one pose of one frame, starting from a guess."""

    POSTURE_COST = 3e-3  # c, (m or rad)/rad: biases the pose by c² times a joint step, below a micrometre
    MAX_ITERATIONS = 50
    STEP_TOLERANCE = 1e-9  # rad; tolerance of convergence, for a smooth path

    def __init__(self, robot: Robot, frame: str) -> None:
        self.robot, self.frame = robot, frame
        self._id = robot.frame_id(frame)
        self._data = robot.model.createData()

    @abstractmethod
    def solve(self, guess: Array, prior: Array, box: JointBox, target: Target) -> Array:
        """The configuration (n,) inside the box that reaches the target as well as it can, near `prior`."""

    def jacobian(self, q: Array) -> Array:
        """Of the frame at q (n,), world axes, (6, n)."""
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return np.array(pin.computeFrameJacobian(self.robot.model, self._data, q, self._id, axes))

    def shortfall(self, q: Array, target: Target) -> tuple[float, float]:
        """Distance in m and angle in rad by which a configuration (n,) misses a target."""
        pin.framesForwardKinematics(self.robot.model, self._data, q)
        pose = self._data.oMf[self._id]
        distance = float(np.linalg.norm(target.position - pose.translation))
        rotation = target.nearest(np.array(pose.rotation)).rotation
        if rotation is None:
            return distance, 0.0
        return distance, math.sqrt(float(np.sum(log3(rotation @ np.array(pose.rotation).T) ** 2)))

    def rotation(self, q: Array) -> Array:
        """R_world_frame (3, 3) at q (n,)."""
        pin.framesForwardKinematics(self.robot.model, self._data, q)
        return np.array(self._data.oMf[self._id].rotation)


def joint_box(robot: Robot) -> JointBox:
    """The joint limits of a robot, ±4π where it has none."""
    return JointBox(np.maximum(robot.position_lower, -4.0 * math.pi), np.minimum(robot.position_upper, 4.0 * math.pi))
