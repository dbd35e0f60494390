"""Result of reading a robot file: a rigid-body model of one-degree-of-freedom joints, and notes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from pliant.errors import RobotError
from pliant.spatial import Array

UNLIMITED = 1e3
"""rad or m: a wider joint range counts as unlimited"""


@dataclass(frozen=True)
class Description:
    """A robot as its file describes it."""

    model: pin.Model
    """every joint has one angle (rad) or one length (m)"""
    visual: pin.GeometryModel | None
    """shapes to draw; None where there are none, or where the meshes are missing"""
    homes: Mapping[str, Array] = field(default_factory=dict)
    """name of a keyframe → (n,) rad or m, in the order of the file"""
    welded: frozenset[str] = frozenset()
    """locked joints that had to go before the model could be made: they stay where the file puts them"""
    notes: tuple[str, ...] = ()
    """sentences about what was assumed, changed or left out"""


def free_name(wanted: str, taken: Collection[str]) -> str:
    """`wanted`, or the first of `wanted_2`, `wanted_3`, … that is not taken."""
    name, number = wanted, 2
    while name in taken:
        name, number = f"{wanted}_{number}", number + 1
    return name


def lock_hint(joint: str, value: float = 0.0) -> str:
    """How to lock a joint, from Python and on the command line."""
    return f"locked={{{joint!r}: {value:g}}}, on the command line --set locked.{joint}={value:g}"


def set_limits(model: pin.Model, at: int, lower: float, upper: float) -> None:
    """Sets the position limits of the joint at index `at` of q; ±∞ where the range is no limit."""
    wide = not np.isfinite([lower, upper]).all() or upper - lower > UNLIMITED
    # one element at a time does not reach pinocchio's memory: the whole vector is assigned
    low, high = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    low[at], high[at] = (-np.inf, np.inf) if wide else (lower, upper)
    model.lowerPositionLimit, model.upperPositionLimit = low, high


def is_revolute(model: pin.Model, joint: int) -> bool:
    """Whether a joint is revolute; the others are prismatic."""
    return not str(model.joints[joint].shortname()).startswith("JointModelP")  # JointModelPX, JointModelPrismatic…


def require_movement(model: pin.Model, source: object) -> None:
    """Raises RobotError if the robot has no movable joint."""
    if model.nv == 0:
        raise RobotError(f"{source} has no joint that moves: a robot needs at least one revolute or prismatic joint")
