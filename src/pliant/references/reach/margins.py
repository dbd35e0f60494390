"""Margins along a joint path: joint range, distance from singularities, torque, speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.references.postures.posture import PosturePath
from pliant.references.reach.course import Course
from pliant.references.trajectories.spline import Spline
from pliant.robot import Robot
from pliant.spatial import Array

_ARM = 0.25  # m: length that corresponds to a rotation of 1 rad


@dataclass(frozen=True)
class ReachBounds:
    """Required margins of a task.

    Raises:
        ConfigError: on construction, when a value is negative.
    """

    joint_margin: float = math.radians(2.0)
    """rad (m of sliding joints) to the nearest joint limit"""
    freedom: float = 0.02
    """m/rad, the least singular value of the Jacobian, a turn of 1 rad counted as 0.25 m: 0 at a singularity"""
    load: float = 1.0
    """largest share of a joint's torque limit"""
    speed: float = 1.0
    """largest share of a joint's speed limit"""
    sideways: float = 20.0
    """N tangential force, in the worst direction, that the torques must bear in addition to weight and force"""

    def __post_init__(self) -> None:
        for name in ("joint_margin", "freedom", "load", "speed", "sideways"):
            if not getattr(self, name) >= 0.0:
                raise ConfigError(f"{name} of a reach check must not be negative, got {getattr(self, name)}")


@dataclass(frozen=True)
class Margin:
    """One quantity along a course."""

    name: str
    unit: str
    values: Array
    """(k,) the worst joint at each sample"""
    joints: tuple[str, ...]
    """(k,) which joint that is; empty: not a joint's"""
    bound: float
    least: bool
    """whether the bound is a lower one"""

    @property
    def worst(self) -> int:
        """Sample with the smallest margin."""
        return int(np.argmin(self.values) if self.least else np.argmax(self.values))

    @property
    def first_failure(self) -> int | None:
        """Sample at which the bound is first broken."""
        broken = np.flatnonzero(self.values < self.bound if self.least else self.values > self.bound)
        return int(broken[0]) if broken.size else None

    def joint(self, sample: int) -> str:
        return self.joints[sample] if self.joints else ""


def margins(
    robot: Robot, frame: str, course: Course, posture: PosturePath, bounds: ReachBounds, spins: bool
) -> tuple[Margin, ...]:
    """Joint range, freedom, load and speed at every sample of a course.

    Args:
        robot: the arm.
        frame: the controlled one.
        course: what it does.
        posture: along it.
        bounds: required margins.
        spins: whether the turn about the tool's own axis is free.
    """
    whole = Spline(posture.times, posture.postures)
    points = [whole.at(time) for time in course.times.tolist()]
    data, index = robot.model.createData(), robot.frame_id(frame)
    loads, freedom = np.empty((len(points), robot.n)), np.empty(len(points))
    for row, point in enumerate(points):
        q = point.value
        J = np.array(pin.computeFrameJacobian(robot.model, data, q, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED))
        freedom[row] = _freedom(J, None if course.rotations is None else course.rotations[row], spins)
        n = course.normals[row]
        across = J[:3] - np.outer(n, n @ J[:3])
        weight = np.array(pin.computeGeneralizedGravity(robot.model, data, q))
        needed = np.abs(weight - course.force[row] * (n @ J[:3])) + bounds.sideways * np.linalg.norm(across, axis=0)
        loads[row] = needed / robot.torque_limit
    q = np.array([point.value for point in points])
    speeds = np.abs([point.rate for point in points]) / robot.velocity_limit
    left = np.minimum(q - robot.position_lower, robot.position_upper - q)
    names = robot.joint_names
    return (
        _of_joints("joint margin", "rad", left, names, bounds.joint_margin, True),
        Margin("freedom", "m/rad", freedom, (), bounds.freedom, True),
        _of_joints("torque", "of limit", loads, names, bounds.load, False),
        _of_joints("joint speed", "of limit", speeds, names, bounds.speed, False),
    )


def _of_joints(name: str, unit: str, table: Array, joints: Sequence[str], bound: float, least: bool) -> Margin:
    rows = np.argmin(table, axis=1) if least else np.argmax(table, axis=1)
    values = table[np.arange(len(table)), rows]
    return Margin(name, unit, values, tuple(joints[int(row)] for row in rows), bound, least)


def _freedom(J: Array, R: Array | None, spins: bool) -> float:
    if R is None:
        return float(np.linalg.svd(J[:3], compute_uv=False)[-1])
    turns = _ARM * (R.T @ J[3:])
    rows = np.vstack([J[:3], turns[:2] if spins else turns])
    return float(np.linalg.svd(rows, compute_uv=False)[-1])
