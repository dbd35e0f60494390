"""In which axes a phase's numbers are, what is asked of each of them, and what nobody can do."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pliant.axis_modes import AXIS_NAMES, AxisModes, modes_of_wrench
from pliant.errors import ConfigError, options
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.tasks.parts import Pose
from pliant.tasks.phase import Phase


class PhaseAxes(NamedTuple):
    """The axes that a phase's numbers are in."""

    rotation: Array
    """R_world_frame (3, 3); the same value as in the phase before where they are the same"""
    origin: Array
    """(3,) m; of the contact, where it is believed"""
    of_contact: bool = False
    """whether they count from where the frame was when contact began"""


def axes_of_phases(case: TaskCase) -> list[PhaseAxes]:
    """Of each phase of a list; one that names no frame has those of the phase before.

    Raises:
        ConfigError: a frame that there is not.
    """
    found: list[PhaseAxes] = []
    axes, target = PhaseAxes(np.eye(3), np.zeros(3)), np.zeros(3)
    for name, phase in zip(case.phase_names(), case.phase, strict=True):
        if phase.frame == "contact" and case.timed:
            axes = axes if axes.of_contact else PhaseAxes(np.eye(3), target, of_contact=True)
        elif phase.frame is not None:
            axes = PhaseAxes(*frame_axes(case, name, phase.frame))
        if phase.target is not None:
            target = axes.origin + axes.rotation @ np.array(phase.target)
        found.append(axes)
    return found


def frame_axes(case: TaskCase, name: str, frame: str | Pose) -> tuple[Array, Array]:
    """R_world_frame (3, 3) and origin (3,) m of what a phase's numbers are in. Raises ConfigError: there is none."""
    if isinstance(frame, Pose):
        return frame.rotation, np.array(frame.xyz)
    if frame == "world":
        return np.eye(3), np.zeros(3)
    if frame not in case.scene:
        known = ["world", *(["contact"] if case.timed else []), *case.scene]
        raise ConfigError(f"phase {name!r}: frame is world, a thing of the scene or a pose; {options(known, frame)}")
    pose = case.scene[frame].pose
    return pose.rotation, np.array(pose.xyz)


def axis_modes(phase: Phase, axes: Array, wrench: Array, held: bool) -> AxisModes:
    """What a phase asks of each axis.

    Args:
        phase: says its modes, or leaves them to its wrench.
        axes: (3, 3) R_world_frame.
        wrench: (6,) in the frame's axes, N and N·m.
        held: whether the orientation is.
    """
    limit = phase.limit
    speed = math.inf if limit is None or limit.speed is None else limit.speed
    deviation = math.inf if limit is None or limit.deviation is None else limit.deviation
    modes = phase.modes or modes_of_wrench(wrench.tolist(), oriented=held)
    return AxisModes(modes, axes, speed, deviation)


def check_axes(case: TaskCase, name: str, phase: Phase, wrench: Array) -> None:
    """Raises ConfigError where a phase contradicts itself. Args: wrench: (6,) in force, in the frame's axes."""
    if phase.touch is not None and phase.touch not in case.scene:
        raise ConfigError(f"phase {name!r}: touch names no thing of the scene; {options(case.scene, phase.touch)}")
    if phase.modes is not None:
        pressed = zip(AXIS_NAMES, phase.modes, wrench.tolist(), strict=True)
        both = [axis for axis, mode, size in pressed if mode != "force" and size]
        if both:
            raise ConfigError(f"phase {name!r}: wrench presses along axes whose mode is not force: {', '.join(both)}")
    if phase.limit is not None and not (np.any(wrench) or "force" in (phase.modes or ())):
        raise ConfigError(f"phase {name!r}: limit is of the motion along force axes, and it has none")
