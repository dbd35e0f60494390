"""Inputs of a stack: checks of its tasks, the target of each, which joints move its frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pliant.axis_modes import AxisModes
from pliant.controllers.task import FrameTask
from pliant.errors import ConfigError, options
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning, Reference, TaskReference

Seen = tuple[tuple[ImpedanceTuning | None, AxisModes | None, bool | None], ...]
"""of each task's reference: tuning, modes, and whether it has no rotation (None: nothing was seen yet)"""


def seen_of(targets: Sequence[TaskReference]) -> Seen:
    """What of references the tunings of a stack follow from."""
    return tuple([(target.tuning, target.modes, target.rotation is None) for target in targets])


def target_of(reference: Reference, place: int, frame: str) -> TaskReference:
    tasks = reference.tasks
    if place < len(tasks) and tasks[place].frame == frame:  # the usual case: same order
        return tasks[place]
    for task in tasks:
        if task.frame == frame:
            return task
    raise ConfigError(f"the reference has no task for frame {frame!r}; {options([t.frame for t in tasks], frame)}")


def check_stack(tasks: Sequence[FrameTask], period: float) -> None:
    if not (math.isfinite(period) and period > 0.0):
        raise ConfigError(f"the control period must be finite and above zero, got {period} s")
    labels = [task.label for task in tasks]
    if not tasks or len(set(labels)) != len(labels):
        raise ConfigError(f"a stack needs one or more tasks with different labels, got {labels}")


def loosened(tuning: ImpedanceTuning, free: tuple[bool, ...]) -> ImpedanceTuning:
    """A tuning that gives no force along free axes. Args: free: (6,)."""
    kept = np.array([not one for one in free[: tuning.axes]], dtype=np.float64)
    if kept.all():
        return tuning
    return replace(tuning, stiffness=kept * tuning.stiffness, force_max=kept * tuning.force_max, linear_range=None)


def free_axes(task: TaskReference) -> tuple[bool, ...]:
    """(6,) which axes of a task are free; empty: none."""
    if task.modes is None or "free" not in task.modes.modes:
        return ()
    free = task.modes.having("free")
    return free if task.rotation is not None or any(free[:3]) else ()


def joints_that_move(robot: Robot, frame: int) -> list[bool]:
    """Which joints (n) move a frame."""
    joint = robot.model.frames[frame].parentJoint
    above = {robot.model.joints[j].idx_v for j in robot.model.supports[joint] if j > 0}
    return [j in above for j in range(robot.n)]
