"""Cases of the study from the task files of the catalogue, where their numbers stand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from pliant.configuration import validated
from pliant.errors import ConfigError
from pliant.experiments.drawn_events import changes_drawn
from pliant.spatial import rpy
from pliant.studies.haptic.config import FAMILY, HapticCaseConfig
from pliant.studies.haptic.scene_config import BallConfig, BoxConfig, Floor, HapticScene, Hardware, Material
from pliant.studies.haptic.steps_config import FootImpedance, Step
from pliant.tasks import Task, load_task
from pliant.tasks.parts import Pose
from pliant.tasks.phase import PerAxis, Thing
from pliant.tasks.task import TaskParts


def from_task(file: str, case: str = "", **more: Any) -> HapticCaseConfig:
    """The case that a task of the catalogue is.

    Args:
        file: name of the task.
        case: its variant of the same name; empty: the task itself.
        more: what a task does not hold, such as checks.

    Raises:
        ConfigError: the task is no case of this study.
    """
    task = load_task(file, case or None)
    control = task.control.get(FAMILY, {})
    values = {
        "case": case or file,
        "robot": task.robot,
        "frame": task.moves,
        "duration": sum(phase.longest for phase in task.phase),
        "period": task.simulation.period,
        "physics_step": task.simulation.physics_step,
        "environment": scene_of_task(task),
        "impedance": _impedance(task, control),
        "exploration": control.get("exploration", {}),
        "planner": task.planner,
        "hardware": _hardware(task),
        "start": _start(task),
        "steps": _steps(task),
    }
    return validated(HapticCaseConfig, values | more)


def _start(task: Task) -> tuple[float, ...] | None:
    if isinstance(task.start, Pose):
        raise ConfigError("this study starts with joint angles; the task starts with a pose")
    return None if task.start is None else tuple(math.radians(angle) for angle in task.start)


def scene_of_task(task: TaskParts) -> HapticScene:
    """What stands around, without what a task can have beside it. Raises ConfigError for another thing."""
    made: dict[str, Any] = {"floor": None, "shank": bool(task.links)}
    for name, thing in task.scene.items():
        if name == "floor":
            roll, pitch, _ = (math.radians(angle) for angle in thing.pose.rpy)
            n = rpy(roll, pitch, 0.0)[:, 2]
            height = float(n @ np.array(thing.pose.xyz) / n[2])
            made[name] = Floor(height=height, tilt=(roll, pitch, 0.0), material=_material(thing))
        elif name == "box":
            made[name] = BoxConfig(size=thing.size, position=thing.pose.xyz, mass=thing.mass, material=_material(thing))
        elif name == "ball":
            made[name] = BallConfig(
                radius=thing.radius, position=thing.pose.xyz, mass=thing.mass, material=_material(thing)
            )
        else:
            raise ConfigError(f"this study has a floor, a box and a ball; the task has {name!r}, too")
    return HapticScene(**made)


def _material(thing: Thing) -> Material:
    moving = thing.friction if thing.friction_moving is None else thing.friction_moving
    return Material(stiffness=thing.stiffness, damping=thing.damping, friction=thing.friction, friction_moving=moving)


def _impedance(task: Task, control: Mapping[str, Any]) -> FootImpedance:
    own = task.impedance
    if own is None:
        return FootImpedance()
    values: dict[str, Any] = {
        "stiffness": _three(own.stiffness),
        "force_max": _three(own.force_max),
        "range": _three(own.range),
    }
    profile = control.get("impedance", {}).get("tasks", {}).get("ee", {}).get("profile")
    return validated(FootImpedance, values | ({} if profile is None else {"profile": profile}))


def _three(value: PerAxis) -> tuple[float, ...]:
    return (value,) * 3 if isinstance(value, float | int) else value


def _hardware(task: Task) -> Hardware:
    truth = task.truth
    imperfect = cast("Mapping[str, Any]", truth.imperfections if isinstance(truth.imperfections, dict) else {})
    actuation, sensing = imperfect.get("actuation", {}), imperfect.get("sensing", {})
    return Hardware(
        compensation=task.compensates,
        joint_damping=truth.joint_damping,
        bandwidth=actuation.get("bandwidth"),
        peak_torque=actuation.get("peak_torque"),
        force_noise=sensing.get("noise_force", 0.0),
        mass_scale=None if task.draw else task.mass_scale,
    )


def _steps(task: Task) -> tuple[Step, ...]:
    """A step for each phase that asks for something else, and for each target of a stream."""
    found: list[Step] = []
    time = 0.0
    for phase in task.phase:
        if phase.target is not None or phase.wrench is not None:
            force = None if phase.wrench is None else phase.wrench[:3]
            found.append(
                Step.model_validate({"time": time, "name": phase.name, "target": phase.target, "force": force})
            )
        time = round(time + phase.longest, 9)
    streams = [(index, event) for index, event in enumerate(task.event, start=1) if event.file is not None]
    for index, event in streams:
        for place, (begin, change) in enumerate(changes_drawn(index, event, 0, time)):
            name = "" if place else "stream"
            found.append(Step.model_validate({"time": begin, "name": name, "target": change["target"]}))
    return tuple(sorted(found, key=lambda step: step.time))
