"""A task that is a list of phases, with its things and changes; tasks that no controller can do are refused here."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.errors import ConfigError, options
from pliant.experiments.drawn_events import changes_drawn
from pliant.references.placed_phases import Ending, PhaseChange, PlacedPhase
from pliant.robot import Robot
from pliant.signals import TaskReference
from pliant.simulation import Ball, Box, Plane, Scene
from pliant.simulation import Surface as Touch
from pliant.simulation.scene import Thing, fixed_part
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.geometry import robot_of, weighed
from pliant.studies.task.phase_axes import axes_of_phases, axis_modes, check_axes
from pliant.studies.task.pressed import with_axes
from pliant.studies.task.true_scene import true_scene
from pliant.surfaces import EdgeSurface, HoleSurface
from pliant.tasks.phase import Condition, PerAxis
from pliant.tasks.phase import Thing as Described
from pliant.wiring.registry import find_controller

_DRAWN = 4.0  # radii of a hole, half of the face that is drawn round it
_CHANGES = ("target", "wrench", "stiffness", "force_max", "range", "reset")
_TUNING, _WHOLE = ("stiffness", "force_max", "range"), ("reset",)


def tracks_of(case: TaskCase) -> bool:
    """Whether its phases track frames. Raises ConfigError for a list that does both, or tracks more than once."""
    tracking = [bool(one.tracks) for one in case.phase]
    if any(tracking) and len(tracking) > 1:
        raise ConfigError(
            "a phase with tracks is the only one of its task: what follows it would begin somewhere else; got"
            f" {len(tracking)} phases"
        )
    return any(tracking)


def frame_of(case: TaskCase) -> str:
    """That targets and wrenches are for."""
    return case.moves or case.tool.frame


def robot_of_list(case: TaskCase, unknown_mass: float = 0.0) -> Robot:
    """The robot, with the tool where the task moves the tool's frame. Args: unknown_mass: kg of the real tool."""
    driven = [frame for one in case.phase for frame in one.tracks] or [frame_of(case)]
    if case.tool.frame in driven:
        return robot_of(case, case.robot, unknown_mass)
    locked = None if case.locked is None else {joint: math.radians(angle) for joint, angle in case.locked.items()}
    return weighed(case, Robot.load(case.robot, locked=locked, rotor_inertia=case.rotor_inertia))


def scene_of(case: TaskCase) -> Scene:
    """Everything that stands around, where and as it really is."""
    return Scene(tuple(_thing(name, one) for name, one in true_scene(case).items()), contact=case.simulation.contact)


def placed_phases_of(case: TaskCase, robot: Robot, rotation: Array) -> tuple[PlacedPhase, ...]:
    """The phases; what one leaves out is as in the one before. Args: rotation: R_world_frame where it is held.

    Raises:
        ConfigError: a thing that there is not, or something that no controller can do.
    """
    frame, target, told, held = frame_of(case), None, np.zeros(6), False
    robot.frame_id(frame)
    axes = np.eye(3)
    found: list[PlacedPhase] = []
    for name, phase, about in zip(case.phase_names(), case.phase, axes_of_phases(case), strict=True):
        before, (axes, origin, _) = axes, about
        if phase.target is not None:
            target = origin + axes @ np.array(phase.target)
        if target is None:
            raise ConfigError(f"phase {name!r}: the first phase needs a target")
        if (wrench := phase.last_wrench) is not None:
            told, held = np.array([*wrench, *([0.0] * (6 - len(wrench)))]), len(wrench) == 6
        elif axes is not before:  # the same in the world
            told = np.concatenate([axes.T @ before @ told[:3], axes.T @ before @ told[3:]])
            told[np.abs(told) < 1e-9 * np.abs(told).max()] = 0.0
        check_axes(case, name, phase, told)
        if phase.modes is not None:
            held = set(phase.modes[3:]) != {"free"}
        wrench = np.concatenate([axes @ told[:3], axes @ told[3:]])
        modes = axis_modes(phase, axes, told, held)
        task = TaskReference(frame, target, rotation if held else None, wrench=wrench, modes=modes)
        endings = tuple(_ending(one, phase.otherwise) for one in phase.conditions)
        found.append(PlacedPhase(name, task, endings))
    return with_axes(found)


def longest_of(case: TaskCase) -> float:
    """s that all phases take at most, and a period more where a timeout has yet to be noticed.

    Raises:
        ConfigError: a phase that may never end.
    """
    for name, phase in zip(case.phase_names(), case.phase, strict=True):
        if math.isinf(phase.longest):
            raise ConfigError(
                f"phase {name!r} may never end: until = {{ any = [{{ … }}, {{ timeout = 8.0 }}] }}, and else says what"
                " then"
            )
    waits = any(one.timeout is not None for one in case.phase[-1].conditions)
    return sum(phase.longest for phase in case.phase) + (case.simulation.period if waits else 0.0)


def changes_of(case: TaskCase) -> tuple[PhaseChange, ...]:
    """The events, as the seed draws them. Raises ConfigError for something that no event can change."""
    until = min(case.duration, longest_of(case))
    return tuple(
        _change(case, index, change, time)
        for index, one in enumerate(case.event, start=1)
        for time, change in changes_drawn(index, one, case.seed, until)
    )


def per_axis(value: PerAxis) -> Array:
    """(3,)."""
    return np.broadcast_to(np.asarray(value, dtype=np.float64), 3).copy()


def _ending(condition: Condition, otherwise: str) -> Ending:
    if condition.timeout is not None:
        return Ending(condition.timeout, fails=otherwise == "fail")
    return Ending(condition.duration or 0.0, condition.contact, condition.force, condition.depth, condition.reached)


def _change(case: TaskCase, index: int, change: Mapping[str, Any], time: float) -> PhaseChange:
    target, wrench = None, None
    tuning: dict[str, Array] = {}
    whole: dict[str, Any] = {}
    for key, value in change.items():
        parts = key.split(".")
        name = parts[-1]
        named = len(parts) == 3 and parts[0] == "controller"
        if name not in _CHANGES or not (named or len(parts) == 1):
            raise ConfigError(f"event {index}: nothing online is called {key!r}; {options(_CHANGES, name)}")
        if named and parts[1] != case.controller:
            _require_controller(index, key, parts[1])
            continue  # of another controller than the one that runs
        if name in _WHOLE:
            if not isinstance(value, bool):
                raise ConfigError(f"event {index}: {key} is true or false, got {value!r}")
            whole[name] = value
            continue
        sizes = {"target": (3,), "wrench": (3, 6)}.get(name, (1, 3))
        numbers = _numbers(index, key, value, sizes)
        if name == "target":
            target = numbers
        elif name == "wrench":
            wrench = np.concatenate([numbers, np.zeros(6 - len(numbers))])
        else:
            tuning[name] = per_axis(numbers if len(numbers) == 3 else float(numbers[0]))  # type: ignore[arg-type]
    return PhaseChange(time, target, wrench, tuning, whole)


def _require_controller(index: int, key: str, name: str) -> None:
    try:
        find_controller(name)
    except ConfigError as error:
        raise ConfigError(f"event {index}: {key!r}: {error}") from None


def _numbers(index: int, key: str, value: Any, sizes: tuple[int, ...]) -> Array:
    try:
        found = np.atleast_1d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.ndim != 1 or len(found) not in sizes or not np.isfinite(found).all():
        wanted = " or ".join(str(size) for size in sizes)
        raise ConfigError(f"event {index}: {key} is {wanted} numbers, got {value!r}")
    return found


def _thing(name: str, one: Described) -> Thing:
    touch = Touch(one.stiffness, one.damping, one.friction, one.friction_moving, one.transition)
    place = (np.array(one.pose.xyz), one.pose.rotation)
    if one.shape == "hole":
        hole = HoleSurface(*place, one.radius, one.depth, one.chamfer)
        return fixed_part(name, hole, touch, (_DRAWN * one.radius, 0.0))
    if one.shape == "edge":
        return fixed_part(name, EdgeSurface(*place, math.radians(one.angle), one.rounding), touch)
    if one.shape == "plane":
        x, y, z = (float(entry) for entry in one.pose.rotation[:, 2])
        return Plane(name, one.pose.xyz, (x, y, z), touch, (0.5 * one.visible[0], 0.5 * one.visible[1]))
    if one.shape == "ball":
        return Ball(name, one.radius, one.pose.xyz, one.mass, touch)
    roll, pitch, yaw = (math.radians(angle) for angle in one.pose.rpy)
    return Box(name, one.size, one.pose.xyz, one.mass, (roll, pitch, yaw), touch)
