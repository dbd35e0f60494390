"""What a stack is made of and told: checks of its tasks, the target of each, which joints move its frame."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pliant.controllers.task import FrameTask
from pliant.errors import ConfigError, options
from pliant.robot import Robot
from pliant.signals import Reference, TaskReference


def target_of(reference: Reference, place: int, frame: str) -> TaskReference:
    tasks = reference.tasks
    if place < len(tasks) and tasks[place].frame == frame:  # the usual case: same order
        return tasks[place]
    for task in tasks:
        if task.frame == frame:
            return task
    raise ConfigError(f"the reference has no task for frame {frame!r}; {options([t.frame for t in tasks], frame)}")


def check_stack(tasks: Sequence[FrameTask], period: float, joint_damping: float, force_damping: float) -> None:
    if not (math.isfinite(period) and period > 0.0):
        raise ConfigError(f"the control period must be finite and above zero, got {period} s")
    for name, value in (("joint_damping", joint_damping), ("force_damping", force_damping)):
        if not (math.isfinite(value) and value >= 0.0):
            raise ConfigError(f"{name} must be finite and not negative, got {value}")
    labels = [task.label for task in tasks]
    if not tasks or len(set(labels)) != len(labels):
        raise ConfigError(f"a stack needs one or more tasks with different labels, got {labels}")


def joints_that_move(robot: Robot, frame: int) -> list[bool]:
    """Which joints (n) move a frame."""
    joint = robot.model.frames[frame].parentJoint
    above = {robot.model.joints[j].idx_v for j in robot.model.supports[joint] if j > 0}
    return [j in above for j in range(robot.n)]
