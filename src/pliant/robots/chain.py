"""The arm of a robot: its joints from the base to the first fork, and where its flange and its elbow are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

_LEAST = 2
"""least number of joints of an arm"""


@dataclass(frozen=True)
class Arm:
    """The serial part of a robot."""

    joints: tuple[int, ...]
    """joints of the model, from the base on"""
    flange: int
    """frame of the model at its end: the last link, or what is fixed to it"""
    elbow: tuple[int, pin.SE3] | None
    """joint that carries the elbow, and where: the joint that splits the arm's length most evenly"""
    reach: float
    """m from the second joint to the flange, stretched out; prismatic joints at zero"""


def arm_of(model: pin.Model) -> Arm | None:
    """The joints up to the first fork; None if the robot forks right at its base."""
    children: dict[int, list[int]] = {index: [] for index in range(model.njoints)}
    for index in range(1, model.njoints):
        children[int(model.parents[index])].append(index)
    joints, at = list[int](), 0
    while len(children[at]) == 1:
        at = children[at][0]
        joints.append(at)
    if len(joints) < _LEAST:
        return None
    flange = _last_frame(model, at)
    lengths = [float(np.linalg.norm(model.jointPlacements[j].translation)) for j in joints[2:]]
    lengths.append(float(np.linalg.norm(model.frames[flange].placement.translation)))
    return Arm(tuple(joints), flange, _elbow(model, joints, lengths), sum(lengths))


def _last_frame(model: pin.Model, joint: int) -> int:
    """The frame furthest from the joint in the tree of frames; of several the last in the file."""

    def depth(frame: int) -> int:
        steps = 0
        while frame and int(model.frames[frame].parentJoint) == joint and steps < model.nframes:
            frame, steps = int(model.frames[frame].parentFrame), steps + 1
        return steps

    carried = [i for i in range(model.nframes) if int(model.frames[i].parentJoint) == joint]
    return max(carried, key=lambda i: (depth(i), i))


def _elbow(model: pin.Model, joints: list[int], lengths: list[float]) -> tuple[int, pin.SE3] | None:
    """`lengths[i]` is the way from joint i + 1 to the next one; the candidates are the joints in between."""
    if len(joints) < _LEAST + 1 or sum(lengths) <= 0.0:
        return None
    before = np.cumsum(lengths)[:-1]
    chosen = joints[2 + int(np.argmin(np.abs(before - 0.5 * sum(lengths))))]
    return int(model.parents[chosen]), pin.SE3(model.jointPlacements[chosen])
