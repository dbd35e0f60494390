"""The parts of a task. Angles are in degrees, because users type them."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.references.surface_task import SurfaceTaskSettings
from pliant.references.toolpaths.toolpath import PathMotion
from pliant.robots.tool import Tool, ToolShape
from pliant.spatial import Array, rpy
from pliant.tasks.along import AlongSurface
from pliant.tasks.draws import Drawn, bounds
from pliant.tasks.thing_truth import ThingTruth

Vector = tuple[float, float, float]
_USUAL = SurfaceTaskSettings()


class Pose(Config):
    """A pose."""

    xyz: Vector = quantity((0.0, 0.0, 0.0), "m", "position")
    rpy: Vector = quantity((0.0, 0.0, 0.0), "deg", "roll, pitch, yaw: about x, then y, then z, each of the fixed axes")

    @property
    def rotation(self) -> Array:
        """(3, 3)."""
        return rpy(*(math.radians(angle) for angle in self.rpy))


class ToolConfig(Config):
    """A rigid tool on the flange: a rod with a spherical tip, or a cylinder or a block."""

    mass: float = quantity(Tool.mass, "kg", "of the tool, known to the controller", ge=0.0, le=100.0)
    length: float = quantity(
        Tool.length,
        "m",
        "from the flange along its z axis to the middle of the tip, or to the end face",
        gt=0.0,
        le=2.0,
    )
    shape: ToolShape = Field(
        default="sphere",
        description="what touches: sphere, cylinder or box; the last two, at several points and with moments, need"
        " simulation.contact = 'explicit'",
    )
    radius: float = quantity(0.015, "m", "of the spherical tip, or of the cylinder", gt=0.0, le=0.5)
    shaft: float | None = quantity(
        None, "m", "radius of the rod that carries a spherical tip; none: that of the tip", gt=0.0, le=0.5
    )
    edges: tuple[float, float] | None = quantity(
        None, "m", "of a box: those of its end face, along the flange's x and y axes"
    )
    frame: str = Field(default=Tool.frame, min_length=1, description="name of the contact frame")
    parent: str = Field(default=Tool.parent, min_length=1, description="frame that carries the tool")

    @model_validator(mode="after")
    def _can_be(self) -> ToolConfig:
        if (self.shape == "box") != (self.edges is not None):
            raise ValueError("tool.edges and tool.shape = 'box' go together")
        if self.shaft is not None and self.shape != "sphere":
            raise ValueError(f"tool.shaft carries a ball, tool.shape = 'sphere'; got {self.shape!r}")
        if self.edges is not None and not 0.0 < min(self.edges) <= max(self.edges) <= 1.0:
            raise ValueError(f"tool.edges are above zero and at most 1 m, got {list(self.edges)}")
        return self

    def tool(self, unknown_mass: float = 0.0) -> Tool:
        """As the robot carries it. Args: unknown_mass: kg of the real tool beside the known ones."""
        made = Tool(self.length, self.mass + unknown_mass, self.radius, self.parent, self.frame, self.shape)
        if self.shaft is not None:
            made = replace(made, radius=self.shaft, ball=self.radius)
        return made if self.edges is None else replace(made, edges=self.edges)


class Sensor(Config):
    """Where the force sensor sits."""

    frame: str | None = Field(
        default=None,
        description="the frame that carries the tool: the sensor weighs the tool, whose known mass is taken off; none:"
        " the tool's, where it feels the contact alone",
    )


class PathConfig(Config):
    """Path of the tool on the surface."""

    pattern: Literal["raster", "spiral", "circle", "line", "square", "lemniscate", "hold", "file"] = Field(
        default="raster", description="raster, spiral, circle, line, square, lemniscate, hold or file"
    )
    size: tuple[float, float] = quantity((0.12, 0.08), "m", "along and across, measured on the surface")
    spacing: float = quantity(0.02, "m", "largest distance of two lines of a raster or spiral", ge=1e-4, le=1.0)
    turns: float = quantity(1.0, "1", "number of rounds of a circle, square or lemniscate", gt=0.0, le=1000.0)
    time: float = quantity(5.0, "s", "duration of the pattern `hold`", gt=0.0, le=3600.0)
    speed: float = quantity(PathMotion.speed, "m/s", "on the surface", ge=1e-4, le=5.0)
    acceleration: float = quantity(
        PathMotion.acceleration, "m/s²", "of starts, stops and bends: corners are rounded to keep it", gt=0.0
    )
    file: str | None = Field(
        default=None, description="CSV with x, y [, z, time, speed, force], or APT; beside the task"
    )
    unit: Literal["m", "mm", "cm", "in"] = Field(default="m", description="unit of lengths in the file that have none")
    at: Vector | None = quantity(
        None, "m", "a place near the middle of the pattern, world axes; none: the top of the surface"
    )
    direction: float = quantity(0.0, "deg", "of the path's first axis, turned about the normal", ge=-360.0, le=360.0)
    tool_tilt: float = quantity(0.0, "deg", "of the tool from the normal, towards its travel", ge=-45.0, le=45.0)
    tool_lean: float = quantity(0.0, "deg", "of the tool from the normal, to the left", ge=-45.0, le=45.0)
    spins: bool = Field(
        default=False,
        description="the rotation about the tool's own axis is free and chosen to suit the arm; else it"
        " keeps its heading",
    )
    off_surface: float = quantity(
        0.02, "m", "largest distance of a point of the file from the believed surface", gt=0.0, le=1.0
    )

    @model_validator(mode="after")
    def _consistent(self) -> PathConfig:
        if (self.pattern == "file") != (self.file is not None):
            raise ValueError("path.file and path.pattern = 'file' go together")
        return self


class Force(Config):
    """Desired force along the normal."""

    normal: float | tuple[tuple[float, float], ...] = quantity(
        ((0.0, 5.0), (0.1, 20.0), (1.0, 20.0)),
        "N",
        "one number, or pairs of (share of the path or time, force), interpolated linearly",
    )
    unit: Literal["share", "s"] = Field(default="share", description="of the first number of each pair")
    along: Literal["believed", "estimated"] = Field(
        default="believed",
        description="normal of the force: that of the believed surface, or estimated from the path of the contact",
    )

    @model_validator(mode="after")
    def _presses(self) -> Force:
        knots, values = self.knots()
        if any(late <= early for early, late in pairwise(knots)):
            raise ValueError(f"the first numbers of force.normal must increase, got {list(knots)}")
        if min(values) < 0.0:
            raise ValueError(f"a force on a surface pushes: force.normal must not be negative, got {min(values):g} N")
        return self

    def knots(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Shares (or s) and N; one number is a constant."""
        if isinstance(self.normal, float | int):
            return (0.0,), (float(self.normal),)
        return tuple(pair[0] for pair in self.normal), tuple(pair[1] for pair in self.normal)

    @property
    def largest(self) -> float:
        """N."""
        return max(self.knots()[1])


class Phases(Config):
    """Approach and retreat."""

    stand_off: float = quantity(_USUAL.stand_off, "m", "over the surface, where the run starts", gt=0.0, le=1.0)
    approach_speed: float | None = quantity(
        None,
        "m/s",
        f"down to the surface, until contact; none: {_USUAL.approach_speed}, less where the surface is so stiff that"
        " the landing would press harder than the path",
        gt=0.0,
        le=1.0,
    )
    search: float = quantity(
        _USUAL.search, "m", "above and below the believed surface, within which contact is searched", gt=0.0, le=0.5
    )
    press: float = quantity(_USUAL.press, "s", "in which the first force of the path is reached", gt=0.0, le=60.0)
    release: float = quantity(_USUAL.release, "s", "in which the last force goes to zero, at rest", gt=0.0, le=60.0)
    leave: float = quantity(_USUAL.leave, "s", "in which the tool is lifted by stand_off at the end", gt=0.0, le=60.0)


class TruthConfig(Config):
    """Differences of the true world from what the controller believes. Only the simulation uses them."""

    shift: Drawn = quantity(0.0, "m", "of the surface along its normal, outwards")
    tilt: Drawn = quantity(0.0, "deg", "of the surface about `axis`, at the first contact")
    axis: Literal["random"] | Vector = Field(
        default="random", description="of the tilt: a direction in the world, or a random one across the normal"
    )
    stiffness: Drawn | AlongSurface | None = quantity(
        None, "N/m", "none: as believed; one that changes along the surface, too, with the explicit contact law"
    )
    damping: Drawn | AlongSurface | None = quantity(None, "N·s/m", "none: as believed; or along the surface, too")
    friction: Drawn | None = quantity(None, "1", "none: as believed")
    things: dict[str, ThingTruth] = Field(
        default={}, description="name of a thing of the scene → how it differs, with [[phase]]"
    )
    tool_mass: Drawn = quantity(0.0, "kg", "of the tool beside what is known")
    link_masses: float = quantity(0.0, "1", "share by which each link's mass is off, drawn within ±", ge=0.0, lt=1.0)
    joint_friction: float = quantity(0.0, "N·m", "dry friction of each joint", ge=0.0, le=1e4)
    joint_damping: float = quantity(0.0, "N·m·s/rad", "of each joint", ge=0.0, le=1e4)
    imperfections: Literal["none", "p3", "p3-without-torque-loop"] | dict[str, Any] = Field(
        default="none",
        description="of sensors, drives and computation: none; p3: those of [FFMPC] sec. VI-B; or a table of values, in"
        " which `base` names the one that it changes",
    )


class Disturbance(Config):
    """A push, or a sequence of pushes."""

    push: Drawn | Vector = quantity(15.0, "N", "a force in the world's axes, or its size in a random direction")
    direction: Literal["any", "level"] = Field(
        default="any", description="of a push of which only the size is given: any, or any horizontal one"
    )
    frame: str = Field(default="elbow", description="that is pushed")
    start: float = quantity(4.0, "s", "of the push; of the first gap, where there is one", ge=0.0)
    duration: Drawn = quantity(0.4, "s", "of a push, above zero")
    gap: Drawn | None = quantity(None, "s", "before each push, not negative: pushes come until `end`; none: one push")
    end: float | None = quantity(None, "s", "from which on no push begins; none: the end of the run", gt=0.0)

    @model_validator(mode="after")
    def _can_be(self) -> Disturbance:
        if not bounds(self.duration)[0] > 0.0:
            raise ValueError("the duration of a disturbance is above zero")
        if self.gap is not None and not (bounds(self.gap)[0] >= 0.0):
            raise ValueError("the gap between two pushes is not negative")
        return self


class Simulation(Config):
    """Settings of the simulation."""

    period: float = quantity(1e-3, "s", "of control", ge=1e-4, le=0.02)
    physics_step: float = quantity(5e-4, "s", "of the simulation", ge=1e-5, le=2e-3)
    drive_step: float | None = quantity(
        None,
        "s",
        "of drives and gears where they are imperfect, a whole multiple of the physics step; none: the physics step",
        ge=1e-5,
        le=0.02,
    )
    contact: Literal["mujoco", "explicit"] = Field(
        default="mujoco", description="contact law: MuJoCo's soft constraints, or an explicit force law with stiction"
    )
