"""A contact task as a value: everything that is asked, and the true world."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from pliant.configuration import Config
from pliant.errors import options
from pliant.quantity import Range, quantity
from pliant.robots.rotors import RotorInertia
from pliant.tasks.draws import DrawnValue
from pliant.tasks.estimation import Estimation
from pliant.tasks.events import Event
from pliant.tasks.limits import Limits
from pliant.tasks.parts import (
    Disturbance,
    Force,
    PathConfig,
    Phases,
    Pose,
    Sensor,
    Simulation,
    ToolConfig,
    TruthConfig,
)
from pliant.tasks.phase import ImpedanceConfig, Phase, PlannerConfig, Thing, TouchingLink
from pliant.tasks.surface_config import SurfaceConfig
from pliant.tasks.timing import TimingConfig

FORMAT = 1
_OF_A_PATH = {"surface": SurfaceConfig(), "path": PathConfig(), "force": Force(), "phases": Phases()}
_OF_A_LIST = ("event", "scene", "links", "moves", "start", "impedance", "landing", "timed")
_OF_THE_SURFACE = ("shift", "tilt", "axis", "stiffness", "damping", "friction")


class TaskParts(Config):
    """What a task is made of, beside the robot and the controller."""

    format: int = Field(default=FORMAT, ge=FORMAT, le=FORMAT, description="version of this form")
    description: str = Field(default="", description="one line of text, for listings")
    check: Literal["on", "off"] = Field(
        default="on",
        description="off: a task that leaves the reach on purpose; `task check` reports it and does not fail",
    )
    locked: dict[str, float] | None = quantity(
        None, "deg", "joint → angle at which it is fixed; none: those that the catalogue locks"
    )
    rotor_inertia: RotorInertia = None
    mass_scale: tuple[Annotated[float, Field(ge=1e-3, le=1e3)], ...] | None = quantity(
        None, "1", "factor on the mass and inertia of each joint's link, known to the controller; none: 1"
    )
    tool: ToolConfig = ToolConfig()
    sensor: Sensor = Sensor()
    estimation: Estimation = Estimation()
    surface: SurfaceConfig = SurfaceConfig()
    path: PathConfig = PathConfig()
    force: Force = Force()
    phases: Phases = Phases()
    phase: tuple[Phase, ...] = Field(
        default=(), description="an explicit list, in place of surface, path, force and phases"
    )
    scene: dict[str, Thing] = Field(default={}, description="name → thing that stands around, with [[phase]]")
    links: dict[str, TouchingLink] = Field(
        default={}, description="frame → part of the robot from there on that touches things, too, with [[phase]]"
    )
    event: tuple[Event, ...] = Field(default=(), description="online changes, with [[phase]]")
    moves: str | None = Field(default=None, description="frame that targets and wrenches are for; none: the tool's")
    timed: bool = Field(
        default=False,
        description="with [[phase]] of targets: each is reached when its phase ends, from rest to rest, in place of as"
        " fast as `planner` allows",
    )
    start: tuple[float, ...] | Pose | None = quantity(
        None, "deg", "joints at the start, or the pose of the moved frame, looked for from home; none: home"
    )
    impedance: ImpedanceConfig | None = Field(
        default=None, description="of the moved frame; none: the controller's own"
    )
    planner: PlannerConfig = PlannerConfig()
    landing: Literal["gentle", "off"] = Field(
        default="gentle",
        description="of each [[phase]] that goes towards a contact; gentle: where it says no limit.speed and no press,"
        " both follow from what is believed; off: as planner and wrench say",
    )
    compensates: Literal["none", "gravity", "gravity+coriolis"] = Field(
        default="none", description="what the robot compensates by itself"
    )
    velocity_share: float = quantity(1.0, "1", "of a new sample in the joint velocity; 1: no filter", gt=0.0, le=1.0)
    timing: TimingConfig = TimingConfig()
    limits: Limits = Limits()
    truth: TruthConfig = TruthConfig()
    draw: dict[str, DrawnValue] = Field(
        default={},
        description="key of the task → how its value is drawn, one draw a seed, e.g. 'scene.floor.stiffness'; unlike"
        " that of `truth` it is what is believed as well",
    )
    disturbance: tuple[Disturbance, ...] = Field(default=(), description="pushes from outside")
    accept: dict[str, float] = Field(
        default={}, description="metric → its bound: force_error, force_peak, contact_lost, path_error, …"
    )
    sweep: dict[str, Any] = Field(
        default={}, description="key → list of values, read by `pliant study`; `seeds`: how many of each"
    )
    tune: dict[str, Range] = Field(
        default={}, description="parameter of the controller → lowest and highest, read by `--tune`; none: its gains"
    )
    simulation: Simulation = Simulation()
    preset: Literal["tuned", "perfect", "paper"] | None = Field(
        default=None,
        description="weights of predictive controllers that `control` changes: tuned for an imperfect robot, for a"
        " perfect one, or those of [FFMPC]; none: tuned where readings or commands are late, else perfect",
    )
    control: dict[str, dict[str, Any]] = Field(
        default={}, description="controller → changes to its parameters, e.g. [control.haptic]"
    )

    @field_validator("format", mode="before")
    @classmethod
    def _can_be_read(cls, value: Any) -> Any:
        if isinstance(value, int) and value > FORMAT:
            raise ValueError(
                f"written for a newer pliant (format {value}), this one reads up to {FORMAT}: update pliant"
            )
        return value

    @model_validator(mode="after")
    def _is_of_one_kind(self) -> TaskParts:
        if not self.phase:
            said = [name for name in _OF_A_LIST if getattr(self, name) != type(self).model_fields[name].default]
            said += ["truth.things"] if self.truth.things else []
            if said:
                raise ValueError(f"{said[0]} belongs to a task of [[phase]]; this one has a path on a surface")
            return self
        said = [name for name, default in _OF_A_PATH.items() if getattr(self, name) != default]
        said += [
            f"truth.{name}" for name in _OF_THE_SURFACE if getattr(self.truth, name) != getattr(TruthConfig(), name)
        ]
        if said:
            raise ValueError(f"{said[0]} belongs to a task with a path on a surface; this one is a list of [[phase]]")
        names = self.phase_names()
        if len(set(names)) < len(names):
            raise ValueError(f"phases need different names, got {list(names)}")
        for phase in self.phase:
            if phase.like is not None and phase.like not in names:
                raise ValueError(f"like: there is no phase {phase.like!r}; {options(names, phase.like)}")
        return self

    def phase_names(self) -> tuple[str, ...]:
        """Of the list: each one's name, or its number."""
        return tuple(one.name or f"phase {index}" for index, one in enumerate(self.phase, start=1))


class Task(TaskParts):
    """A task with its robot."""

    robot: str = Field(default="iiwa14", description="catalogue name, or path of a URDF or MJCF file")
    controller: str = Field(
        default="offset-free-mpc", description="name, my_module:MyController or file.py:MyController"
    )
