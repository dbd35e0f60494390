"""A contact task as a value: everything that is asked, and how the world differs from what is believed."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from pliant.configuration import Config, Range
from pliant.tasks.parts import Disturbance, Force, Limits, Path, Phases, Simulation, Surface, Timing, Tool, Truth

FORMAT = 1


class TaskParts(Config):
    """What a task is made of, beside the robot and the controller."""

    format: int = Field(default=FORMAT, ge=FORMAT, le=FORMAT, description="version of this form")
    description: str = Field(default="", description="one line, for people")
    locked: dict[str, float] | None = Field(
        default=None,
        description="joint → angle at which it is fixed; none: those that the catalogue locks",
        json_schema_extra={"unit": "deg"},
    )
    tool: Tool = Tool()
    surface: Surface = Surface()
    path: Path = Path()
    force: Force = Force()
    phases: Phases = Phases()
    timing: Timing = Timing()
    limits: Limits = Limits()
    truth: Truth = Truth()
    disturbance: tuple[Disturbance, ...] = Field(default=(), description="pushes from outside")
    accept: dict[str, float] = Field(
        default={}, description="metric → bound that it must keep: force_error, force_peak, contact_lost, path_error, …"
    )
    sweep: dict[str, Any] = Field(
        default={}, description="key → list of values, read by `pliant study`; `seeds`: how many of each"
    )
    tune: dict[str, Range] = Field(
        default={}, description="parameter of the controller → lowest and highest, read by `--tune`; none: its gains"
    )
    simulation: Simulation = Simulation()
    control: dict[str, dict[str, Any]] = Field(
        default={}, description="controller → changes to its parameters, e.g. [control.haptic]"
    )


class Task(TaskParts):
    """A task with its robot."""

    robot: str = Field(default="iiwa14", description="catalogue name, or path of a URDF or MJCF file")
    controller: str = Field(
        default="offset-free-mpc", description="name, my_module:MyController or file.py:MyController"
    )
