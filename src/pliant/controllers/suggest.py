"""Parameters that suit a task, from what is believed of it."""

from __future__ import annotations

from pliant.controllers.config import FrameTaskConfig, OperationalSpaceConfig, StackConfig, TranslationConfig
from pliant.controllers.presets import SOFT_STACK
from pliant.entries import Believed
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning

_FAST = 1e-3  # s; stiffness that a slower or later loop does not bear


def suggest_stack(robot: Robot, config: StackConfig, believed: Believed) -> StackConfig:
    """A stack for the task's frames: gains of `config` where the loop is fast and its arm heavy, soft ones otherwise.

    Where a reference carries an impedance for a frame, the task has that one. The model's gravity torque is added
    where the robot does not compensate gravity by itself.
    """
    late = believed.period + believed.sensing_delay + believed.computation_delay
    gains = config if late <= _FAST and believed.compensation == "none" else SOFT_STACK
    first, *others = [task for task in gains.tasks.values() if task is not None]
    other = others[-1] if others else first
    tasks: dict[str, FrameTaskConfig | None] = dict.fromkeys(config.tasks)
    for place, frame in enumerate(believed.frames):
        label = "ee" if place == 0 else frame
        tasks[label] = _task(first if place == 0 else other, frame, believed, robot.n)
    update = {"tasks": tasks, "gravity_compensation": believed.compensation == "none"}
    return config.model_copy(update=update)


def _task(gains: FrameTaskConfig, frame: str, believed: Believed, joints: int) -> FrameTaskConfig:
    carried = believed.tunings.get(frame)
    if carried is not None and carried.axes == 3:
        return gains.model_copy(update={"frame": frame, "rotation": None, "translation": _translation(carried)})
    turned = believed.oriented and joints >= 6
    return gains.model_copy(update={"frame": frame, "rotation": gains.rotation if turned else None})


def _translation(tuning: ImpedanceTuning) -> TranslationConfig:
    def axes(values: object) -> object:
        return None if values is None else tuple(float(value) for value in values)  # type: ignore[attr-defined]

    names = ("stiffness", "force_max", "range", "linear_range")
    return TranslationConfig.model_validate({name: axes(getattr(tuning, name)) for name in names})


def suggest_operational_space(
    robot: Robot, config: OperationalSpaceConfig, believed: Believed
) -> OperationalSpaceConfig:
    """The task's first frame; the model adds what the robot does not compensate by itself."""
    missing = {"none": "gravity+coriolis", "gravity": "coriolis", "gravity+coriolis": "none"}
    return config.model_copy(update={"frame": believed.frames[0], "compensation": missing[believed.compensation]})
