"""Typed configuration of a polishing run.

Source of the task: [FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft
contact approach", 2024, sections VI and VII. What the paper leaves open (height of the table, tool, ramps) is here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field

from pliant.configuration import merged
from pliant.controllers.step_limit import DEFAULT_SHARE, TorqueStep
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.experiments.base import CaseConfig
from pliant.mpc.config import MpcConfig
from pliant.mpc.presets import PRESETS
from pliant.quantity import quantity
from pliant.robot import Robot, Tool
from pliant.robots.rotors import RotorInertia
from pliant.simulation import Imperfections
from pliant.studies.polishing.work_config import RepeatedPushes, Table, Work
from pliant.wiring.registry import find_controller
from pliant.wiring.wire import parameters_for

FRAME = "tool"
BALL_RADIUS = 0.015  # m; the contact frame is its centre
PHASES: Mapping[str, bool] = {"reach": False, "track": False, "ramp": True, "contact": True, "circle": True}
"""name of each phase → whether the tool touches in it"""


LOCKED: Mapping[str, Mapping[str, float]] = {"iiwa14": {"A7": 0.0}}
"""robot → joint → rad; what the paper holds still"""
ROTORS: Mapping[str, RotorInertia] = {"iiwa14": 0.0}
"""robot → kg m²; the paper's model has none, and the printed numbers are those of that model"""


class PolishingConfig(CaseConfig):
    """One run of the polishing task."""

    controller: str = Field(default="force-feedback-mpc", description="name of the controller")
    robot: str = Field(
        default="iiwa14", description="catalogue name, or path of a URDF or MJCF file with a frame 'flange'"
    )
    locked: dict[str, float] | None = quantity(
        None,
        "rad",
        "joint → angle at which it is fixed, replaced as a whole; none: A7 of the iiwa14 as in the paper,"
        " of another robot what the catalogue locks; {}: none",
    )
    rotor_inertia: RotorInertia = quantity(
        None,
        "kg m²",
        "the motors' inertia as every joint feels it; assumed: 0.021 √(torque limit in N·m); none: 0 for"
        " the iiwa14, whose model in the paper has none, of another robot that of the catalogue or of the file",
    )
    duration: float = quantity(10.0, "s", "length of the run", gt=0.0)
    period: float = quantity(1e-3, "s", "control period", gt=0.0)
    physics_step: float = quantity(5e-4, "s", "of the simulation", gt=0.0)
    table: Table = Table()
    task: Work = Work()
    imperfections: Imperfections = Field(default=Imperfections(), description="of sensors, drives and computation")
    unknown_mass: float = quantity(0.0, "kg", "of the tool, beside its known 0.4 kg", ge=0.0, le=1e3)
    model_mass_error: float = quantity(
        0.0,
        "1",
        "share by which each link's mass is off in the controller's model, drawn uniformly within ±",
        ge=0.0,
        lt=1.0,
    )
    delay_error: float = quantity(0.0, "s", "of δ_o in controllers that predict: believed minus true", ge=-1.0, le=1.0)
    torque_step: TorqueStep = DEFAULT_SHARE
    pushes: RepeatedPushes | None = Field(default=None, description="pushes from outside; none: nobody pushes")
    preset: Literal["tuned", "perfect", "paper"] = Field(
        default="tuned",
        description="what `control` starts from: weights tuned for the imperfect robot, for a perfect one, or the"
        " weights of the paper's authors",
    )
    control: dict[str, Any] = Field(
        default={}, description="changes to the controller's parameters, e.g. control.contact.stiffness=[1e4]"
    )

    @property
    def clock(self) -> Mapping[str, float]:
        return {"period": self.period, "physics_step": self.physics_step}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        task = self.task
        return {
            "first contact": (task.reach, self.duration),
            "contact breaks": (task.pressed, self.duration),
            "the work": (task.circle, self.duration),
        }

    @property
    def entry(self) -> ControllerEntry[Any]:
        """The chosen controller."""
        return find_controller(self.controller)

    @property
    def perfect(self) -> bool:
        """Whether sensors, drives and computation are perfect."""
        return self.imperfections == Imperfections()

    @property
    def believed(self) -> Believed:
        """What the controller may know."""
        return Believed(
            frames=(FRAME,),
            period=self.period,
            presses=FRAME,
            sensing_delay=self.imperfections.sensing.delay,
            computation_delay=max(self.imperfections.computation_delay + self.delay_error, 0.0),
            phases=PHASES if self.task.stop is None else {**PHASES, "stop": True},
        )

    def robot_model(self, unknown_mass: float = 0.0) -> Robot:
        """The arm with its tool; the real tool may be heavier than the known one."""
        tool = Tool(frame=FRAME)
        heavier = Tool(frame=FRAME, mass=tool.mass + unknown_mass)
        locked = LOCKED.get(self.robot) if self.locked is None else self.locked
        rotors = ROTORS.get(self.robot) if self.rotor_inertia is None else self.rotor_inertia
        arm = Robot.load(self.robot, locked=locked, tool=heavier, rotor_inertia=rotors)
        return arm.with_contact(FRAME, BALL_RADIUS)

    def parameters(self) -> ControllerConfig:
        """The controller's parameters: its defaults, those of this study, what is known of the robot's delays, then
        `control`."""
        entry = self.entry
        base = merged(entry.default, PRESETS[self.preset].get(self.controller, {}))
        if self.task.stop is not None and isinstance(base, MpcConfig) and "circle" in base.phases:
            # the tool rests by the costs that drew the circle
            base = merged(base, {"phases": {"stop": base.phases["circle"].model_dump()}})
        return parameters_for(entry, self.robot_model(), self.believed, self.control, base)
