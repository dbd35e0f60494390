"""Where the force sensor of a task sits, what it carries, and what of that the controller knows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pliant.errors import ConfigError, options
from pliant.estimation import CarriedMass
from pliant.simulation import ForceSensor
from pliant.tasks.parts import ToolConfig
from pliant.tasks.task import TaskParts


def sensor_of(task: TaskParts, unknown_mass: float = 0.0) -> ForceSensor:
    """The sensor in the plant. Args: unknown_mass: kg of the real tool beside what is known.

    Raises:
        ConfigError: a frame that is neither the tool's nor the one that carries it.
    """
    if not _weighs(task):
        return ForceSensor(task.tool.frame)
    load = _rod(task.tool, task.tool.mass + unknown_mass)
    return ForceSensor(task.tool.parent, load.mass, load.center, load.inertia)


def known_load(task: TaskParts) -> tuple[Mapping[str, CarriedMass], Mapping[str, str]]:
    """Sensor → what it is known to carry, and sensor → the frame beyond it that touches."""
    tool = task.tool
    return ({tool.parent: _rod(tool, tool.mass)}, {tool.parent: tool.frame}) if _weighs(task) else ({}, {})


def _weighs(task: TaskParts) -> bool:
    """Whether the tool hangs on the sensor."""
    tool, frame = task.tool, task.sensor.frame
    if frame not in (None, tool.frame, tool.parent):
        raise ConfigError(
            f"the force sensor sits at the tool's end or where the tool is mounted, got sensor.frame={frame!r};"
            f" {options([tool.frame, tool.parent], str(frame))}"
        )
    return frame == tool.parent


def _rod(tool: ToolConfig, mass: float) -> CarriedMass:
    """A uniform body from the sensor along its z axis, as the robot's model has it."""
    xx, _, yy, _, _, zz = (
        float(entry) for entry in replace(tool.tool(), mass=mass).inertia.inertia[np.tril_indices(3)]
    )
    return CarriedMass(mass, (0.0, 0.0, 0.5 * tool.length), inertia=(xx, yy, zz, 0.0, 0.0, 0.0))
