"""Parameters that suit a task, from what is believed of it."""

from __future__ import annotations

import numpy as np

from pliant.controllers.advice import SAFE_PHASE
from pliant.controllers.attractor import Law
from pliant.controllers.config import (
    FrameTaskConfig,
    OperationalSpaceConfig,
    RotationConfig,
    StackConfig,
    TranslationConfig,
)
from pliant.controllers.presets import SOFT_STACK
from pliant.entries import Believed
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.rules import Rule
from pliant.signals import ImpedanceTuning

_INTEGRAL = 20.0  # 1/s
_SLOWER = 0.1  # largest k_i times the delay of the loop
_FAST = 1e-3  # s; above this period or delay the stiffness is reduced
_MOST_DAMPING = 20.0  # N·m·s/rad
_SOFT = 3e-3  # s; largest delay at which a wrist is stable with the rotational stiffness of the soft gains

_SOFT_GAINS = Rule(
    "tasks.*",
    "the preset of a loop of 1 ms on an arm that does not compensate gravity, else the soft preset; one whose impedance"
    " the reference carries has that one",
    "presets STIFF_STACK and SOFT_STACK, [Stack] Table I as a start",
)
STACK_RULES = (
    Rule("tasks.*.frame", "the frames of the task, the first as `ee`", "the task"),
    Rule(
        "tasks.*.rotation.stiffness",
        "that of the preset, beyond 3 ms of period and delays times 3 ms / (period + delays)",
        "measured: with 7 ms 60 N·m/rad made a wrist with a tool of 0.2 m oscillate",
    ),
    _SOFT_GAINS,
    Rule(
        "gravity_compensation", "on where the robot does not compensate gravity by itself", "the task's `compensates`"
    ),
    Rule(
        "joint_damping",
        "of plain springs: 0.4 m / (period + delays), m the smallest inertia of a joint at home, 20 N·m s/rad at most",
        "a speed loop with a delay T is stable up to π/2 · m / T",
    ),
)
"""of `suggest_stack`"""
OPERATIONAL_SPACE_RULES = (
    Rule("frame", "the first frame of the task", "the task"),
    Rule("compensation", "what the robot does not compensate by itself", "the task's `compensates`"),
    Rule(
        "force_integral",
        "0.1 / (period + delays), 20 /s at most; 0 where no force is asked for",
        "a tenth of the loop's own rate; an integral with a delay T is stable up to π/2 / T",
    ),
)
"""of `suggest_operational_space`"""


def suggest_stack(robot: Robot, config: StackConfig, believed: Believed) -> StackConfig:
    """A stack for the task's frames: gains of `config` where the loop is fast and the arm heavy, otherwise soft ones.

    Where a reference carries an impedance for a frame, the task has that one. The model's gravity torque is added
    where the robot does not compensate gravity by itself. Beyond 3 ms the rotational stiffness falls as 1 / delay: with
    a delay of 7 ms, 60 N·m/rad made a wrist with a tool of 0.2 m oscillate. Plain springs, which come to rest by
    damping alone, get a joint damping of 0.4 m / delay, m the smallest inertia of a joint at home: ω T = 0.4 of the
    joint's own speed loop.
    """
    late = believed.late
    gains = config if late <= _FAST and believed.compensation == "none" else SOFT_STACK
    first, *others = [task for task in gains.tasks.values() if task is not None]
    other = others[-1] if others else first
    tasks: dict[str, FrameTaskConfig | None] = dict.fromkeys(config.tasks)
    for place, frame in enumerate(believed.frames):
        label = "ee" if place == 0 else frame
        tasks[label] = _later(_task(first if place == 0 else other, frame, believed, robot.n), late)
    update: dict[str, object] = {"tasks": tasks, "gravity_compensation": believed.compensation == "none"}
    if config.law is Law.SPRING and config.joint_damping == 0.0:
        update["joint_damping"] = min(SAFE_PHASE * _lightest(robot) / late, _MOST_DAMPING)
    return config.model_copy(update=update)


def _lightest(robot: Robot) -> float:
    """kg m²: the smallest inertia of one joint at home, the others free."""
    M = mass_matrix(robot.model, robot.model.createData(), robot.home)
    return float(1.0 / np.max(np.diag(np.linalg.inv(M))))


def _task(gains: FrameTaskConfig, frame: str, believed: Believed, joints: int) -> FrameTaskConfig:
    carried = believed.tunings.get(frame)
    if carried is not None and carried.axes == 3:
        return gains.model_copy(update={"frame": frame, "rotation": None, "translation": _translation(carried)})
    turned = believed.oriented and joints >= 6
    rotation = gains.rotation
    if rotation is None and frame == believed.frames[0]:  # gains of a leg have none
        rotation = _rotation_of(SOFT_STACK)
    return gains.model_copy(update={"frame": frame, "rotation": rotation if turned else None})


def _rotation_of(config: StackConfig) -> RotationConfig | None:
    return next((task.rotation for task in config.tasks.values() if task is not None and task.rotation), None)


def _later(task: FrameTaskConfig, late: float) -> FrameTaskConfig:
    """With a softer rotation where the delay of the loop requires it."""
    rotation = task.rotation
    if rotation is None or late <= _SOFT:
        return task
    share = _SOFT / late
    softer = np.multiply(rotation.stiffness, share)
    stiffness = float(softer) if softer.ndim == 0 else tuple(float(axis) for axis in softer)
    return task.model_copy(update={"rotation": rotation.model_copy(update={"stiffness": stiffness})})


def _translation(tuning: ImpedanceTuning) -> TranslationConfig:
    def axes(values: object) -> object:
        return None if values is None else tuple(float(value) for value in values)  # type: ignore[attr-defined]

    names = ("stiffness", "force_max", "range", "linear_range")
    return TranslationConfig.model_validate({name: axes(getattr(tuning, name)) for name in names})


def suggest_operational_space(
    robot: Robot, config: OperationalSpaceConfig, believed: Believed
) -> OperationalSpaceConfig:
    """The task's first frame; the model adds what the robot does not compensate by itself.

    Where a force is regulated, k_i is a tenth of 1 / (period and delays), 20 /s at most: the force is regulated ten
    times more slowly than the loop responds.
    """
    late = believed.late
    pressing = 0.0 if believed.presses is None else min(_INTEGRAL, _SLOWER / late)
    missing = {"none": "gravity+coriolis", "gravity": "coriolis", "gravity+coriolis": "none"}
    update = {"frame": believed.frames[0], "compensation": missing[believed.compensation], "force_integral": pressing}
    return config.model_copy(update=update)
